"""Friction as a drive file states it, read and written."""

from typing import Any

from cutpoint.errors import InputError
from cutpoint.formats.drives.drive_sheet import DriveSheet
from cutpoint.formats.drives.friction_sheets import FrictionLawSheet, MotorFrictionSheet
from cutpoint.formats.drives.section import Section
from cutpoint.mechanics.drives.friction import Coulomb, Grease, Stribeck
from cutpoint.mechanics.drives.presliding import ElastoPlastic, LuGre
from cutpoint.model.drive import Friction


def to_friction(sheet: FrictionLawSheet, side: str, section: Section) -> Friction:
    """The law on one side, "link" or "motor".

    Raises ModelError: static without Stribeck velocity or the other way round, static below Coulomb friction,
    presliding without Coulomb friction.
    """
    sliding = _sliding(sheet, ("friction", side), section)
    if sheet.presliding is None:
        return sliding
    if sheet.coulomb == 0.0:
        path = ("friction", side, "presliding")
        raise section.error(path, f"{'.'.join(path)} needs dry friction while sliding: a 'coulomb' above 0")
    own = sheet.presliding
    if own.law == "lugre":
        return LuGre(sliding, own.distance, own.damping)
    return ElastoPlastic(sliding, own.distance, own.damping, own.elastic)


def friction_entry(law: Friction | None) -> dict[str, Any] | None:
    """The fields that give the same law when read back."""
    match law:
        case None:
            return None
        case Stribeck(coulomb=coulomb, static=static) if static < coulomb:
            rule = f"static {static} must not be below coulomb {coulomb}"
            raise InputError(f"a drive file cannot express friction that rises from rest: {rule}", law=law)
        case Stribeck() | Coulomb():
            values = {name: value for name, value in vars(law).items() if value is not None and name != "grease"}
            grease = {"grease": {name: float(x) for name, x in vars(law.grease).items()}} if law.grease else {}
            return {name: float(value) for name, value in values.items()} | grease
        case LuGre(sliding, distance, damping):
            own = {"law": "lugre"}
        case ElastoPlastic(sliding, distance, damping, elastic):
            own = {"law": "elasto_plastic", "elastic": float(elastic)}
        case _:
            raise InputError(f"a drive file cannot express {law!r}", law=law)
    own |= {"distance": float(distance), "damping": float(damping)}
    return (friction_entry(sliding) or {}) | {"presliding": own}


def _sliding(sheet: FrictionLawSheet, path: tuple[str, ...], section: Section) -> Stribeck | Coulomb:
    more = {
        "asymmetry": sheet.asymmetry,
        "per_load": sheet.per_load if isinstance(sheet, MotorFrictionSheet) else None,
        "grease": Grease(**sheet.grease.model_dump()) if sheet.grease else None,
    }
    if sheet.static is None and sheet.stribeck_velocity is None:
        return Coulomb(sheet.coulomb, sheet.viscous, sheet.smoothing, **more)
    if sheet.static is None or sheet.stribeck_velocity is None:
        raise section.error(path, f"{'.'.join(path)} must state 'static' and 'stribeck_velocity' together")
    if sheet.static < sheet.coulomb:
        stated = section.stated(DriveSheet, (*path, "static"), sheet.static)
        remedy = "; the catalogue's friction applies where the entry states none: state both"
        told = f"{stated} must not be below coulomb {sheet.coulomb!r}"
        raise section.error((*path, "static"), told + (remedy if section.is_stated(("catalogue",)) else ""))
    return Stribeck(sheet.coulomb, sheet.static, sheet.viscous, sheet.stribeck_velocity, sheet.smoothing, **more)
