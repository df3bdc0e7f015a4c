"""`load`: a robot from the files a user brings."""

from collections.abc import Collection, Mapping
from os import PathLike
from pathlib import Path
from types import NoneType
from typing import Literal

from numpy.typing import ArrayLike

from cutpoint.callers import warn
from cutpoint.door import check_kind, check_truths, path_of
from cutpoint.errors import InputError, ModelError
from cutpoint.formats import load_urdf
from cutpoint.formats.plain_drive import drives_of
from cutpoint.model import Drive, Mechanism
from cutpoint.model.drive_validation import DRIVES
from cutpoint.model.mechanism import STANDARD_GRAVITY
from cutpoint.robot import Backend, Robot


class DroppedWarning(UserWarning):
    """A drive file's entry omits data that the robot file gives for its joint, which is therefore ignored."""


def load(
    path: str | Path,
    drives: str | Path | Mapping[str, Drive] | None = None,
    *,
    gravity: ArrayLike | None = None,
    floating_base: bool = False,
    lock: Mapping[str, float] | None = None,
    mimic: Literal["independent", "coupled"] = "independent",
    mend_inertia: bool = False,
    xacro: Mapping[str, str] | None = None,
    backend: Backend = "auto",
) -> Robot:
    """A robot from a URDF (.urdf, .xacro) or MJCF (.mjcf, .xml) file, its drives from a drive file: docs/drive-file.md.

    drives: a file, or drives by joint name; a joint without one is driven rigidly, with the friction (and an MJCF's
    armature) that the robot file states.
    gravity: acceleration of free fall in the world's frame, m/s2; None is (0, 0, -9.81), or what an MJCF file states.
    lock: coordinates (rad or m) at which joints are held fixed, by name; their drives are passed over.
    backend: how kernels are compiled: "llvm", "numpy", or "auto", LLVM where llvmlite is installed.
    Of a URDF only: floating_base carries the root link on a free joint; mimic joints are "independent" coordinates, or
    "coupled" to their leader, whose drive then bears their friction; mend_inertia adds to inertias that no mass can
    have what they lack, and warns of it.
    xacro: arguments of a .xacro file, as in {"ur_type": "ur10e"}.
    Raises ModelError, with file and line, for whatever is wrong in the files; InputError for other arguments.
    """
    path = path_of("load", path, "a robot file")
    check_kind("load", "drives", drives, (str, PathLike, Mapping, NoneType), f"the path of a drive file, or {DRIVES}")
    check_kind("load", "lock", lock, (Mapping, NoneType), "a coordinate for each joint that is held, by name")
    check_truths("load", floating_base=floating_base, mend_inertia=mend_inertia)
    check_kind("load", "xacro", xacro, (Mapping, NoneType), "arguments of a .xacro file, by name")
    suffix = path.suffix.lower()
    if suffix in (".urdf", ".xacro"):
        fall = STANDARD_GRAVITY if gravity is None else gravity
        stated = dict[str, Drive]()
        mechanism = load_urdf(
            path,
            gravity=fall,
            floating_base=floating_base,
            lock=lock,
            mimic=mimic,
            mend_inertia=mend_inertia,
            xacro=xacro,
        )
    elif suffix in (".mjcf", ".xml"):
        from cutpoint.formats import load_mjcf  # slow to import

        _check_is_no_urdf(path, floating_base, mimic, mend_inertia, xacro)
        mechanism, stated = load_mjcf(path, gravity=gravity, lock=lock)
    else:
        raise ModelError(f"robot file {str(path)!r} must be a .urdf, .xacro, .mjcf or .xml")
    return Robot(mechanism, _drives(mechanism, stated, drives, lock or {}), backend=backend)


def _check_is_no_urdf(
    path: Path, floating_base: bool, mimic: str, mend_inertia: bool, xacro: Mapping[str, str] | None
) -> None:
    """Raises InputError for options of URDF files, given with an MJCF file."""
    if floating_base or mimic != "independent":
        raise InputError("load: floating_base and mimic are for URDF files; an MJCF file itself says what floats")
    if xacro:
        raise InputError(f"load: xacro={xacro!r} is for .xacro files, got {str(path)!r}: leave it out")
    if mend_inertia:
        remedy = 'state <compiler balanceinertia="true"/> in an MJCF file'
        raise InputError(f"load: mend_inertia is for URDF files; {remedy}")


def _drives(
    mechanism: Mechanism,
    stated: Mapping[str, Drive],
    given: str | Path | Mapping[str, Drive] | None,
    locked: Collection[str],
) -> dict[str, Drive]:
    """For every driven joint: the given drive, or the robot file's, or its friction alone."""
    drives = drives_of(mechanism) | dict(stated)
    if isinstance(given, (str, PathLike)):
        from cutpoint.formats import load_drives  # slow to import

        found = load_drives(given, mechanism, locked)
        _say_what_is_dropped(drives, found, given)
        return drives | found
    return drives | {name: drive for name, drive in (given or {}).items() if name not in locked}


def _say_what_is_dropped(stated: Mapping[str, Drive], found: Mapping[str, Drive], place: str | Path) -> None:
    """Warns of armature and friction in the robot file that entries of a drive file omit."""
    armature = [name for name, drive in found.items() if stated[name].rotor and not drive.rotor]
    rubbing = [name for name, drive in found.items() if not (drive.link_friction or drive.motor_friction)]
    friction = [name for name in rubbing if stated[name].link_friction]
    dropped = {"armature": (armature, "rotor"), "damping and friction": (friction, "friction")}
    told = [f"{what} of {', '.join(map(repr, names))}" for what, (names, _) in dropped.items() if names]
    if told:
        fields = " and ".join(repr(field) for names, field in dropped.values() if names)
        rule = f"a drive's entry replaces them: state {fields} there to keep any ({place})"
        warn(f"the robot file's {' and '.join(told)} are ignored, since {rule}", DroppedWarning)
