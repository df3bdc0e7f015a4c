"""File formats: robots (URDF, xacro, MJCF), drives (YAML), and the catalogue of drives."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from cutpoint.formats.not_carried_over import NotCarriedOver
from cutpoint.formats.plain_drive import drive_of
from cutpoint.formats.urdf.urdf import MimicWarning, load_urdf, parse_urdf
from cutpoint.model.limits import DegreesWarning

if TYPE_CHECKING:
    from cutpoint.formats.catalogue.catalogue import catalogue_drive, catalogue_gear, catalogue_names, entry_of
    from cutpoint.formats.drives.drives import dump_drives, load_drives, parse_drives, save_drives
    from cutpoint.formats.drives.unlikely_units import UnitsWarning
    from cutpoint.formats.mjcf.mjcf import MjcfRobot, RenamedWarning, load_mjcf, parse_mjcf

__all__ = [
    "DegreesWarning",
    "MimicWarning",
    "MjcfRobot",
    "NotCarriedOver",
    "RenamedWarning",
    "UnitsWarning",
    "catalogue_drive",
    "catalogue_gear",
    "catalogue_names",
    "drive_of",
    "dump_drives",
    "entry_of",
    "load_drives",
    "load_mjcf",
    "load_urdf",
    "parse_drives",
    "parse_mjcf",
    "parse_urdf",
    "save_drives",
]

_ELSEWHERE = {
    **dict.fromkeys(("catalogue_drive", "catalogue_gear", "catalogue_names", "entry_of"), "catalogue.catalogue"),
    **dict.fromkeys(("dump_drives", "load_drives", "parse_drives", "save_drives"), "drives.drives"),
    "UnitsWarning": "drives.unlikely_units",
    **dict.fromkeys(("MjcfRobot", "RenamedWarning", "load_mjcf", "parse_mjcf"), "mjcf.mjcf"),
}
"""Modules of names that are imported on first use: with SciPy, YAML and the validation of sheets they cost more than
all else here."""


def __getattr__(name: str) -> Any:
    if name not in _ELSEWHERE:
        raise AttributeError(f"module 'cutpoint.formats' has no attribute {name!r}")
    found = globals()[name] = getattr(import_module(f"cutpoint.formats.{_ELSEWHERE[name]}"), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
