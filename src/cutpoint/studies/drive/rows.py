"""A drive of the catalogue in lines: the maker's data beside the laws' results."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from cutpoint.formats.catalogue.sheets import Efficiency, Group, Running
from cutpoint.model.units import ARC_MINUTE
from cutpoint.studies.drive.measured import Specimen

SPEEDS = (500.0, 1000.0, 2000.0, 3500.0)
"""rpm of the input, at which makers print efficiency."""

_NOT_SHOWN = ("source", "verified", "points")


class Printed(NamedTuple):
    """A number of the sheet, with its source and reliability."""

    group: str
    quantity: str
    value: str
    unit: str
    source: str
    status: str


class Derived(NamedTuple):
    """A law's result, and the sheet's number if there is one."""

    quantity: str
    value: str
    sheet: str
    unit: str
    remark: str


def printed(specimen: Specimen) -> Iterator[Printed]:
    """Every number of the sheet, in its order."""
    for name, group in specimen.gear.groups.items():
        yield from (Printed(name, *line, group.source.key, group.status) for line in _lines(group))


def derived(specimen: Specimen) -> Iterator[Derived]:
    """Results of the laws, for the data in the sheet."""
    yield from _stiffness(specimen)
    yield from _angles(specimen)
    yield from _losses(specimen)


def _lines(group: Group) -> Iterator[tuple[str, str, str]]:
    if isinstance(group, Running):
        yield from ((f"running torque at {rpm:g} rpm", f"{torque:g}", "N m") for rpm, torque in group.points)
    if isinstance(group, Efficiency):
        yield from ((f"efficiency at {rpm:g} rpm, {tau:g} N m", f"{eta:g}", "") for rpm, tau, eta in group.points)
    for name, field in type(group).model_fields.items():
        value = getattr(group, name)
        if name in _NOT_SHOWN or value is None or (value == field.default and not field.is_required()):
            continue
        extra = field.json_schema_extra
        unit = str(extra["unit"]) if isinstance(extra, dict) else "1"
        shown = value if isinstance(value, str) else f"{value:g}"
        yield field.description or name, shown, "" if unit == "1" else unit


def _stiffness(specimen: Specimen) -> Iterator[Derived]:
    spring = specimen.spring
    if spring is None:
        return
    remark = "with the output's spring" if specimen.gear.output and specimen.gear.output.spring else ""
    chords, sheet = specimen.chords, (float(spring.k1), float(spring.k2))
    for what, chord, stated in zip(("0 to T1", "T1 to T2"), chords, sheet, strict=True):
        yield Derived(f"stiffness, chord {what}", f"{chord:.0f}", f"{stated:.0f}", "N m/rad", remark)
    yield Derived("departs from straight segments by", f"{float(spring.fit_error):.2g}", "", "N m", "rounded corners")


def _angles(specimen: Specimen) -> Iterator[Derived]:
    gear = specimen.gear
    if specimen.loop and gear.hysteresis:
        loss = f"{specimen.loop.width / ARC_MINUTE:.4g}"
        yield Derived(
            "hysteresis loss", loss, f"{gear.hysteresis.loss_arcmin:g}", "arcmin", f"to {specimen.load:g} N m"
        )
    if specimen.lost_motion is not None:
        bound = gear.hysteresis and gear.hysteresis.lost_motion_arcmin
        springy = bool(gear.output and gear.output.spring)
        stated = f"at most {bound:g}" if bound and not springy else ""
        remark = "with the output's spring" if springy else "to 4 % of rated torque"
        yield Derived("lost motion", f"{specimen.lost_motion / ARC_MINUTE:.3g}", stated, "arcmin", remark)
    if gear.accuracy:
        stated = f"{gear.accuracy.transmission_arcmin:g}"
        yield Derived(
            "transmission accuracy", f"{specimen.accuracy / ARC_MINUTE:.4g}", stated, "arcmin", "peak to peak"
        )


def _losses(specimen: Specimen) -> Iterator[Derived]:
    estimated = specimen.friction.estimated
    fitted = "fitted to efficiency" if specimen.is_fitted else ""
    if specimen.knows_speed:
        remark = "estimate" if {"dry", "slope"} & {*estimated} else fitted
        motor = ", motor's friction included" if specimen.gear.motor else ""
        for rpm in SPEEDS:
            value = f"{specimen.running_torque(rpm):.3g}"
            yield Derived(
                f"no-load torque, {rpm:g} rpm{motor}", value, "" if motor else _read(specimen, rpm), "N m", remark
            )
    if specimen.knows_load and specimen.load:
        remark = "estimate" if estimated else fitted
        for rpm in SPEEDS:
            eta, stated = specimen.efficiency(rpm, specimen.load), _read(specimen, rpm, specimen.load)
            yield Derived(f"efficiency, {rpm:g} rpm, {specimen.load:g} N m", f"{eta:.3f}", stated, "", remark)


def _read(specimen: Specimen, *at: float) -> str:
    """The sheet's number at a speed, or at a speed and a torque."""
    group: Any = specimen.gear.running if len(at) == 1 else specimen.gear.efficiency
    found = [value for *where, value in group.points if (*where,) == at] if group else []
    return f"{found[0]:g}" if found else ""
