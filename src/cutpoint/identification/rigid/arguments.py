"""Checks of the arguments of `identify_rigid`."""

from collections.abc import Mapping, Sequence
from types import NoneType
from typing import Any

import numpy as np

from cutpoint.door import check_kind, checked_name, number
from cutpoint.errors import InputError
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.rigid.least_squares import METHODS
from cutpoint.mechanics.drives.friction import Sliding
from cutpoint.mechanics.drives.presliding import Presliding
from cutpoint.model.drive import Friction, KinematicError
from cutpoint.robot import Robot


def check_method(method: str) -> None:
    """Raises InputError for an unknown method of `identify_rigid`."""
    checked_name("method of identification", method, (*METHODS, "instrumental"))


def check_options(method: str, instruments: Recording | None, level: float, spread: float) -> None:
    """Raises InputError for an unknown method, for instruments that do not match it, and for shares out of range."""
    check_method(method)
    rule = "a Recording of the commanded motion, at the same times"
    check_kind("identify_rigid", "instruments", instruments, (Recording, NoneType), rule)
    if instruments is not None and method != "instrumental":
        raise InputError(f"instruments go with method='instrumental', not with {method!r}", method=method)
    if not 0.0 < number("identify_rigid", "level", level) < 1.0:
        raise InputError(f"level {level} must lie between 0 and 1, such as 0.95", level=level)
    if not 0.0 < number("identify_rigid", "prior_spread", spread) < np.inf:
        raise InputError(f"prior_spread {spread} must be a positive share: 0.5 is half of a body's mass")


def checked_friction(of_links: Mapping[str, Friction] | None, robot: Robot) -> Mapping[str, Friction]:
    """Known link friction, by joint.  Raises InputError for anything else."""
    rule = "a mapping of joint names to laws, such as {'elbow': Coulomb(2.0, 0.5)}"
    check_kind("identify_rigid", "link_friction", of_links, (Mapping, NoneType), rule)
    check_parts("link_friction", of_links or {}, robot, (Sliding, Presliding), "a law of friction")
    return of_links or {}


def checked_errors(errors: Mapping[str, KinematicError] | None, robot: Robot) -> Mapping[str, KinematicError]:
    """Known kinematic errors, by joint.  Raises InputError for anything else."""
    rule = "a mapping of joint names to KinematicErrors"
    check_kind("identify_rigid", "kinematic_errors", errors, (Mapping, NoneType), rule)
    check_parts("kinematic_errors", errors or {}, robot, KinematicError, "a KinematicError")
    return errors or {}


def check_parts(name: str, given: Mapping[str, Any], robot: Robot, kind: type | tuple[type, ...], rule: str) -> None:
    """Raises InputError for parts of drives, by joint, that are of another kind, or of joints that are not driven."""
    for joint, part in given.items():
        checked_name("driven joint", joint, robot.joints)
        check_kind("identify_rigid", f"{name}[{joint!r}]", part, kind, rule)


def check_rotor_errors(errors: Mapping[str, float] | None, robot: Robot, sought: Sequence[str]) -> None:
    """Raises InputError for deviations that are not numbers, or of rotors that are identified (sought, by joint)."""
    rule = "a mapping of joint names to standard deviations, kg m2"
    check_kind("identify_rigid", "rotor_errors", errors, (Mapping, NoneType), rule)
    for joint, error in (errors or {}).items():
        checked_name("driven joint", joint, robot.joints)
        if not 0.0 <= number("identify_rigid", f"rotor_errors[{joint!r}]", error, "kg m2") < np.inf:
            rule = "must be finite, and not negative"
            raise InputError(f"identify_rigid: rotor_errors[{joint!r}] {error} kg m2 {rule}", joint=joint)
        if joint in sought:
            rule = f"is for a rotor that is sought; name only the others in rotors=, of {', '.join(sought)}"
            raise InputError(f"identify_rigid: rotor_errors[{joint!r}] {rule}", joint=joint)
