"""Drive files (YAML, version 1): the drive of each joint of a robot.  `docs/drive-file.md` describes every field."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from cutpoint.callers import warn
from cutpoint.door import check_kind, path_of
from cutpoint.errors import InputError, listed, those_that_exist
from cutpoint.files import replacing
from cutpoint.formats.degrees import warn_of_degrees
from cutpoint.formats.drives.drive_sheet import DriveSheet, FileSheet
from cutpoint.formats.drives.entry import to_drive
from cutpoint.formats.drives.section import Section
from cutpoint.formats.drives.unlikely_units import UnitsWarning, doubts_of, doubts_of_sliding
from cutpoint.formats.drives.words import to_entry
from cutpoint.formats.reading import read_bytes
from cutpoint.formats.safe_yaml import MAXIMUM_BYTES, parse_yaml
from cutpoint.model.drive import Drive
from cutpoint.model.drive_validation import DRIVES, check_drive
from cutpoint.model.mechanism import DRIVEN_KINDS, Joint, Mechanism

VERSION = 1

ALTERNATIVES = (frozenset({"ratio", "gear"}), frozenset({"linear", "flexspline", "catalogue"}))
"""Alternative fields: stating one drops the other from the defaults."""

OF_A_SPRING = ("damping", "backlash", "hysteresis", "kinematic_error")
"""Fields that belong to a spring: defaults and catalogue do not apply them to a drive that is stated to be rigid."""


def load_drives(path: str | Path, mechanism: Mechanism, locked: Collection[str] = ()) -> dict[str, Drive]:
    """The drives that a file gives to joints of a robot, by joint; docs/drive-file.md has its fields.

    mechanism: the robot's, `robot.mechanism`.
    locked: joints whose drives are ignored, since they are held fixed.
    Warns, DegreesWarning, of position limits that look like degrees; UnitsWarning, of numbers in a data sheet's units.
    Raises ModelError, with file and line, for whatever is wrong in the file or does not fit the robot.
    """
    path = path_of("load_drives", path)
    check_kind("load_drives", "mechanism", mechanism, Mechanism, "a Mechanism, as robot.mechanism")
    return parse_drives(read_bytes(path, MAXIMUM_BYTES), mechanism, str(path), locked)


def parse_drives(
    content: str | bytes, mechanism: Mechanism, place: str = "<string>", locked: Collection[str] = ()
) -> dict[str, Drive]:
    """The drives of a drive file in memory, by joint.

    content: its text, or a file's bytes, UTF-8.  place: its name in messages.  Other arguments, warnings and errors are
    those of `load_drives`; content that is neither text nor bytes, or no mechanism, raises InputError.
    """
    check_kind("parse_drives", "content", content, (str, bytes), "the text of a drive file (load_drives reads files)")
    check_kind("parse_drives", "mechanism", mechanism, Mechanism, "a Mechanism, as robot.mechanism")
    document = parse_yaml(content.encode() if isinstance(content, str) else content, place)
    whole = Section("drive file", document, ((),))
    sheet = whole.read(FileSheet, document.value)
    if sheet.version != VERSION:
        raise whole.error(("version",), f"version {sheet.version:g} is unknown; this cutpoint reads version {VERSION}")
    if sheet.defaults and not sheet.drives:
        remedy = f"name the joints there, as in '{next(iter(mechanism.driven_joints), 'elbow')}: {{}}'"
        raise whole.error(("defaults",), f"'defaults' apply to joints that 'drives' names, but it names none; {remedy}")
    joints = {body.joint.name: body.joint for body in mechanism.bodies}
    drives: dict[str, Drive] = {}
    doubts: dict[str, list[str]] = {}
    for name, entry in sheet.drives.items():
        if name in locked:
            continue
        section = Section(f"joint {name!r}", document, (("drives", name), ("defaults",)))
        joint = _driven(name, joints, mechanism, section)
        section = replace(section, slides=joint.kind == "prismatic")
        own = section.read(DriveSheet, _laid_over(sheet.defaults, entry, section))
        drives[name] = to_drive(own, section)
        doubted = doubts_of_sliding if section.slides else doubts_of
        for words, path in doubted(own, section, drives[name].ratio):
            doubts.setdefault(f"{words} ({section.place(path)})", []).append(name)
    for words, names in doubts.items():
        warn(f"drive of {listed(names)}: {words}", UnitsWarning)
    turning = {name: drive.limits for name, drive in drives.items() if joints[name].kind != "prismatic"}
    warn_of_degrees(turning, "a drive file's angles are radians", place)
    return drives


def dump_drives(drives: Mapping[str, Drive]) -> str:
    """The text of a drive file that loads back to the same drives.

    Hysteresis, which a file states by the loop that it opens on its spring, comes back to rounding.
    Raises ModelError for what no robot takes as a drive, InputError for what a file has no words for.
    """
    check_kind("dump_drives", "drives", drives, Mapping, DRIVES)
    for name, drive in drives.items():
        check_kind("dump_drives", name, drive, Drive, "a Drive")
    entries = {name: _entry_of(name, drive) for name, drive in drives.items()}
    for name, drive in drives.items():
        check_drive(name, drive)
    return yaml.safe_dump({"version": VERSION, "drives": entries}, sort_keys=False, allow_unicode=True)


def _entry_of(name: str, drive: Drive) -> dict[str, Any]:
    try:
        return to_entry(drive)
    except InputError as error:
        raise InputError(f"drive of {name!r}: {error}", **error.evidence | {"joint": name}) from None


def save_drives(path: str | Path, drives: Mapping[str, Drive]) -> None:
    """Write a drive file, whole or not at all.  Raises as `dump_drives` does."""
    check_kind("save_drives", "drives", drives, Mapping, DRIVES)
    text = dump_drives(drives)
    with replacing(path_of("save_drives", path)) as file:
        file.write(text.encode())


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """`over` merged into `base`, mapping by mapping; of alternatives, those that `over` does not state are dropped.

    A wave generator's compliance belongs to the flexspline's.
    """
    replaced = {key for group in ALTERNATIVES if group & over.keys() for key in group - over.keys()}
    replaced |= {"wave_generator"} if "flexspline" in replaced else set()
    result = {key: value for key, value in base.items() if key not in replaced}
    for key, value in over.items():
        both = isinstance(value, dict) and isinstance(result.get(key), dict)
        result[key] = merged(result[key], value) if both else value
    return result


def _laid_over(defaults: Mapping[str, Any], entry: Mapping[str, Any], section: Section) -> dict[str, Any]:
    """An entry merged over its defaults, with the catalogue's drive that either names between or below them."""
    if entry.get("compliance") == "rigid":
        defaults = {key: value for key, value in defaults.items() if key not in OF_A_SPRING}
    layers = [defaults, entry]
    for k in (1, 0):
        if isinstance(name := layers[k].get("catalogue"), str):
            springs = [layer["compliance"] for layer in layers[k:] if "compliance" in layer]
            layers.insert(k, _from_catalogue(name, section, rigid=springs[-1:] == ["rigid"]))
            break
    stated = merged(layers[0], layers[1])
    return merged(stated, layers[2]) if layers[2:] else stated


def _from_catalogue(name: str, section: Section, rigid: bool) -> dict[str, Any]:
    # slow to import, and most files name no catalogue drive
    from cutpoint.formats.catalogue.catalogue import catalogue_names, entry_of, unknown_gear

    if name not in catalogue_names():
        raise section.error(("catalogue",), unknown_gear(name))
    if section.slides:
        raise section.error(
            ("catalogue",), f"catalogue {name!r} is rotary but this joint slides; state the fields in N and m"
        )
    return {key: value for key, value in entry_of(name).items() if not (rigid and key in OF_A_SPRING)}


def _driven(name: str, joints: Mapping[str, Joint], mechanism: Mechanism, section: Section) -> Joint:
    """The joint of an entry.  Refused if no drive can move it."""
    joint = joints.get(name)
    if joint is None and name in mechanism.frames:
        raise section.error((), "it is fixed (or a link), but a drive needs a joint that moves")
    if joint is None:
        raise section.error((), f"the robot has no such joint; {those_that_exist(name, joints)}")
    if joint.kind not in DRIVEN_KINDS:
        raise section.error((), f"it is {joint.kind}; a drive needs one of {', '.join(DRIVEN_KINDS)}")
    if joint.mimic and mechanism.coupled:
        raise section.error((), f"it follows joint {joint.mimic.joint!r}; give that joint the drive")
    return joint
