"""Files in and out: robots (URDF, xacro) and what drives them (YAML)."""

from cutpoint.formats.drives import drive_of, dump_drives, load_drives, parse_drives, save_drives
from cutpoint.formats.urdf import DegreesWarning, MimicWarning, load_urdf, parse_urdf

__all__ = [
    "DegreesWarning",
    "MimicWarning",
    "drive_of",
    "dump_drives",
    "load_drives",
    "load_urdf",
    "parse_drives",
    "parse_urdf",
    "save_drives",
]
