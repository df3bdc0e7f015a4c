"""Parameters of drives that two encoders determine: spring, hysteresis, kinematic error, rotor."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.stats import t

from cutpoint.identification.drives.columns import amplitude_errors
from cutpoint.identification.drives.one_drive import DriveEstimate
from cutpoint.identification.drives.rotor import RotorEstimate, vague
from cutpoint.identification.drives.scatter import DEGREES
from cutpoint.identification.drives.stated_parts import law_of, loss
from cutpoint.identification.drives.two_encoders import SpringEstimate
from cutpoint.identification.output.numbers import EntryPath, Number
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.model.drive import Drive

UNKNOWN = float("nan")

LEVEL = 0.95
"""Confidence level of the intervals."""

UNITS: Mapping[str, str] = {
    **dict.fromkeys(("stiffness", "k1", "k2", "k3"), "N m/rad"),
    **dict.fromkeys(("t1", "t2", "coulomb, by the motor alone"), "N m"),
    **dict.fromkeys(("damping", "viscous, by the motor alone"), "N m s/rad"),
    "hardening": "1/(N m)",
    "hysteresis loss": "rad",
    "rotor inertia": "kg m2",
}

LATENESS = 0.02
"""Standard deviation of an unknown delay of torques, as a share of a period; it looks like damping."""

NOT_APART = "its spring, which would separate it from the link, is not seen; what torques tell of it is with the links"

BY_COULOMB = "by Coulomb's law, whatever was chosen with the links, so its interval covers scatter only"

SUMS = {"t2": ("t1", "t2 - t1")}
"""Constants of spring laws that are sums of unknowns."""


@dataclass(frozen=True)
class _Rows:
    """margin: standard deviations to the interval's ends.  why: what is undetermined, each with the reason."""

    joint: str
    margin: float
    why: Mapping[str, str]

    def row(
        self,
        name: str,
        found: tuple[float, float],
        path: EntryPath,
        prior: float = UNKNOWN,
        thing: str = "",
        scale: float = 1.0,
    ) -> Number:
        """found: value and standard deviation.  thing: key in `why`.  Without a path the model does not use it."""
        value, reach = found[0], self.margin * found[1]
        why = self.why.get(thing, "")
        used = (prior if why else value) if path else UNKNOWN
        unit = UNITS.get(name, "rad")
        return Number(
            self.joint, name, unit, value, value - reach, value + reach, used, prior, not why, why, path, scale
        )  # fmt: skip


def drive_numbers(joint: str, before: Drive, found: DriveEstimate, rotors: bool) -> tuple[Number, ...]:
    """The numbers of one drive; before: as the files state it.  rotors: whether the model takes its rotor from here."""
    why = found.unidentifiable if rotors else {"rotor inertia": NOT_APART, **found.unidentifiable}
    rows = _Rows(joint, float(t.ppf(0.5 + 0.5 * LEVEL, DEGREES)), why)
    spring, stated, law = found.spring, float(before.reflected_inertia), law_of(before.compliance)
    own = [
        rows.row(name, each, ("compliance", spring.law, name), _stated(law, name), "stiffness")
        for name in vars(spring.compliance)
        if (each := _found(spring, *SUMS.get(name, (name,))))
    ]
    damping = _found(spring, "damping")
    if damping:
        late = LATENESS * found.period * float(spring.compliance.tangent(0.0))
        damping = damping[0], float(np.hypot(damping[1], late))
        own.append(rows.row("damping", damping, ("damping",), _stated(before, "damping"), "damping"))
    loops = _loops(rows, spring, loss(before))
    waves = _waves(rows, spring, before.kinematic_error)
    return (*own, *loops, *waves, *_of_rotor(rows, found.rotor, stated, rotors))


def _found(estimate: SpringEstimate | RotorEstimate, *names: str) -> tuple[float, float] | None:
    """Value and standard deviation of a sum of unknowns; None if it was not sought."""
    if not set(names) <= set(estimate.names):
        return None
    where = [estimate.names.index(name) for name in names]
    variance = float(estimate.covariance[np.ix_(where, where)].sum())
    return float(estimate.values[where].sum()), float(np.sqrt(max(variance, 0.0)))


def _of_rotor(rows: _Rows, rotor: RotorEstimate, stated: float, used: bool) -> list[Number]:
    """Numbers of the motor's side; its friction is a second opinion on that identified with the links."""
    scale, inertia = 1.0 / rotor.ratio**2, _found(rotor, "inertia")
    own: list[Number] = []
    if inertia:
        path: EntryPath = ("rotor", "inertia") if used else ()
        own.append(rows.row("rotor inertia", inertia, path, stated, "rotor inertia", scale))
    common, vaguely = rows.why.get("motor friction", BY_COULOMB), rotor.unidentifiable.get("motor friction")
    for name in ("coulomb", "viscous"):
        each = _found(rotor, name)
        why = vague(rotor, name) if common == vaguely else common
        own += [replace(rows.row(f"{name}, by the motor alone", each, ()), told=False, why=why)] if each else []
    return own


def _waves(rows: _Rows, spring: SpringEstimate, before: Any) -> list[Number]:
    """Amplitudes of the kinematic error's waves; before: the stated error, of which a user's own law has no waves."""
    if spring.kinematic_error is None:
        return []
    error: Any = spring.kinematic_error
    waves = before.harmonics if isinstance(before, KinematicError) else ()
    stated = {wave.order: float(wave.amplitude) for wave in waves}
    start = spring.names.index(f"sine {error.harmonics[0].order}")
    among = slice(start, start + 2 * len(error.harmonics))
    deviations = amplitude_errors(spring.values[among], spring.covariance[among, among]).tolist()
    paths: list[EntryPath] = [("kinematic_error", "amplitude")]
    paths += [("kinematic_error", "harmonics", str(k)) for k in range(len(error.harmonics) - 1)]
    found: list[Number] = []
    for wave, deviation, path in zip(error.harmonics, deviations, paths, strict=True):
        name, prior = f"kinematic error, order {wave.order}", stated.get(wave.order, UNKNOWN)
        found.append(rows.row(name, (float(wave.amplitude), deviation), path, prior, "kinematic_error"))
    return found


def _loops(rows: _Rows, spring: SpringEstimate, stated: float) -> list[Number]:
    """Width of wide loops at zero torque, 2 sum(stiffness reach) over the spring's stiffness; stated: rad."""
    law: Any = spring.hysteresis
    if law is None:
        return []
    values = zip(spring.names, spring.values.tolist(), strict=True)
    used = [k for k, (name, x) in enumerate(values) if name.startswith("element") and x > 0.0]
    softness = float(spring.compliance.deflection(law.friction)) / float(law.friction)
    slope = 2.0 * softness * np.array(law.reach)
    deviation = float(np.sqrt(slope @ spring.covariance[np.ix_(used, used)] @ slope))
    width = float(slope @ law.stiffness), deviation
    return [rows.row("hysteresis loss", width, ("hysteresis", "loss"), stated, "hysteresis")]


def _stated(part: Any, name: str) -> float:
    value = getattr(part, name, None)
    return UNKNOWN if value is None else float(value)
