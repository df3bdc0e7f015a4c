"""`load`: a robot from the files a user brings."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from numpy.typing import ArrayLike

from cutpoint.door import driven_joints
from cutpoint.errors import ModelError
from cutpoint.formats import drive_of, load_drives, load_urdf
from cutpoint.model import Drive, Mechanism
from cutpoint.model.mechanism import STANDARD_GRAVITY
from cutpoint.robot import Backend, Robot


def load(
    path: str | Path,
    drives: str | Path | Mapping[str, Drive] | None = None,
    *,
    gravity: ArrayLike = STANDARD_GRAVITY,
    floating_base: bool = False,
    lock: Mapping[str, float] | None = None,
    mimic: Literal["independent", "coupled"] = "independent",
    backend: Backend = "auto",
) -> Robot:
    """A robot from a URDF (or .xacro) file, and its drives from a drive file (see docs/drive-file.md).

    drives: a file, or drives by joint name; a joint without one is driven rigidly, with the friction its URDF states.
    gravity: acceleration of free fall in the world's frame, m/s2.  floating_base: carry the root link on a free joint.
    lock: coordinates at which joints are held fixed, by name.  mimic: "independent" coordinates, or "coupled" to their
    leader.  backend: how kernels are compiled.
    Raises ModelError, with file and line, for whatever is wrong in the files.
    """
    if Path(path).suffix.lower() not in (".urdf", ".xacro"):
        raise ModelError(f"robot file {str(path)!r} must be a .urdf or a .xacro")
    mechanism = load_urdf(path, gravity=gravity, floating_base=floating_base, lock=lock, mimic=mimic)
    return Robot(mechanism, _drives(mechanism, drives), backend=backend)


def _drives(mechanism: Mechanism, given: str | Path | Mapping[str, Drive] | None) -> dict[str, Drive]:
    joints = {body.joint.name: body.joint for body in mechanism.bodies}
    drives = {name: drive_of(joints[name]) for name in driven_joints(mechanism)}
    drives.update(load_drives(given, mechanism) if isinstance(given, (str, Path)) else given or {})
    return drives
