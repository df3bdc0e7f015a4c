"""Validation of links, joints and lumped bodies, before any equation uses them.

Links and joints are checked as the file lists them.  Inertia tensors are checked once lumped, on bodies that move:
only their sum enters the dynamics, and files distribute it over fixed pieces in ways that are wrong one by one and
harmless together.  Tolerances on principal moments: RELATIVE of the largest one, plus that of a radius of gyration of a
micrometre.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import listed, those_that_exist
from cutpoint.model.lumping import MassProperties
from cutpoint.model.mechanism import DRIVEN_KINDS, Body, Joint, JointKind, Limits, Link
from cutpoint.model.places import Places
from cutpoint.model.pose import is_rigid, unit_vector
from cutpoint.model.units import SLIDING

RELATIVE = 1e-6
GYRATION = 1e-6
"""Radius of gyration, m, below which a tensor is taken for rounding."""

LARGEST_NUMBER = 1e12
"""Masses, inertias, places and gravity (SI) beyond it belong to no machine, and their products overflow."""

AXIS_MINIMUM = 1e-6
"""Shorter axes have no direction that can be trusted."""

DEGREES_BEYOND = 4.0 * np.pi
"""An angle (rad) beyond two turns is more likely to be in degrees."""

TURNING_UNITS = {
    "position": "rad",
    "velocity": "rad/s",
    "effort": "N m",
    "damping": "N m s/rad",
    "friction": "N m",
}
SLIDING_UNITS = {what: SLIDING[unit] for what, unit in TURNING_UNITS.items()}

ONE_COORDINATE: tuple[JointKind, ...] = (*DRIVEN_KINDS, "helical")
"""Kinds that can be locked at a value, lead and follow."""

WITH_AXIS: tuple[JointKind, ...] = (*ONE_COORDINATE, "universal", "planar")
"""Kinds with an axis; a planar joint's is the normal of its plane."""


def check_link(link: Link, places: Places) -> None:
    """Checks shapes, finite numbers of plausible size, nonnegative mass, symmetric inertia."""
    thing = f"link {link.name!r}"
    for what, value, shape in (("mass", link.mass, ()), ("com", link.com, (3,)), ("inertia", link.inertia, (3, 3))):
        _check_numbers(thing, what, value, shape, places)
        check_size(thing, what, value, places)
    if link.mass < 0.0:
        raise places.error(thing, f"mass {link.mass!r} kg must not be negative", link=link.name, mass=link.mass)
    skew = np.max(np.abs(link.inertia - link.inertia.T))
    if skew > RELATIVE * np.max(np.abs(link.inertia)):
        complaint = f"inertia must be symmetric; mirrored entries differ by {skew:.3g} kg m2"
        raise places.error(thing, complaint, link=link.name, inertia=link.inertia)


def check_joint(joint: Joint, places: Places) -> None:
    """Checks kind, shapes, finite numbers, rigid placement, nonzero axes, pitch, ordered limits."""
    thing = f"joint {joint.name!r}"
    if joint.kind not in get_args(JointKind):
        complaint = f"kind {joint.kind!r} is not supported; {those_that_exist(joint.kind, get_args(JointKind))}"
        raise places.error(thing, complaint, joint=joint.name, kind=joint.kind)
    _check_numbers(thing, "placement", joint.placement, (4, 4), places)
    check_size(thing, "placement", joint.placement, places)
    if not is_rigid(joint.placement):
        complaint = "placement must be a proper rotation and a translation (R R^T = 1, det R = 1, last row 0 0 0 1)"
        raise places.error(thing, complaint, joint=joint.name, placement=joint.placement)
    _check_own_numbers(joint, places)
    unit = SLIDING_UNITS if joint.kind == "prismatic" else TURNING_UNITS
    for what in ("damping", "friction"):
        value = getattr(joint, what)
        _check_numbers(thing, what, value, (), places)
        if value < 0.0:
            raise places.error(thing, f"{what} {value!r} {unit[what]} must not be negative", joint=joint.name)
    check_limits(thing, joint.limits, unit, places)


def _check_own_numbers(joint: Joint, places: Places) -> None:
    """Checks what only some kinds need: axis, second axis, pitch; and that a follower has one coordinate."""
    thing = f"joint {joint.name!r}"
    if joint.kind in WITH_AXIS:
        _checked_axis(thing, "axis", joint.axis, places)
    if joint.kind == "universal":
        second = _checked_axis(thing, "second_axis", joint.second_axis, places)
        if np.linalg.norm(np.cross(unit_vector(joint.axis), unit_vector(second))) < AXIS_MINIMUM:
            complaint = f"second_axis {joint.second_axis} must not be parallel to axis {joint.axis}"
            raise places.error(thing, complaint, joint=joint.name)
    if joint.kind == "helical":
        _check_numbers(thing, "pitch", joint.pitch, (), places)
        check_size(thing, "pitch", joint.pitch, places)
        if joint.pitch == 0.0:
            complaint = "pitch 0.0 m/rad must not be zero; without one the joint is revolute"
            raise places.error(thing, complaint, joint=joint.name)
    if joint.mimic and joint.kind not in (*ONE_COORDINATE, "fixed"):
        kinds = ", ".join(ONE_COORDINATE)
        complaint = f"mimics joint {joint.mimic.joint!r}, but is {joint.kind}; a follower must be one of {kinds}"
        raise places.error(thing, complaint, joint=joint.name)


def _checked_axis(thing: str, what: str, axis: Array | None, places: Places) -> Array:
    if axis is None:
        raise places.error(thing, f"needs a {what}, a direction (3,)", what=what)
    _check_numbers(thing, what, axis, (3,), places)
    if math.hypot(*axis) < AXIS_MINIMUM:
        raise places.error(thing, f"{what} {axis} has no length; give it a direction", what=what)
    return axis


def check_limits(thing: str, limits: Limits, unit: Mapping[str, str], places: Places) -> None:
    """Checks: no NaN, lower <= upper, speed and effort not negative; infinite means no limit."""
    for what in ("lower", "upper", "velocity", "effort"):
        if np.isnan(getattr(limits, what)):
            raise places.error(thing, f"limit {what} must be a number, got nan", limits=limits)
    if limits.lower > limits.upper:
        found = f"lower limit {limits.lower!r} must not exceed upper limit {limits.upper!r} {unit['position']}"
        complaint = f"{found}; exchange them, or leave both out for no limit"
        raise places.error(thing, complaint, limits=limits)
    for what in ("velocity", "effort"):
        bound = getattr(limits, what)
        if bound < 0.0:
            rule = "must not be negative; leave it out or state inf for no limit"
            raise places.error(thing, f"{what} limit {bound!r} {unit[what]} {rule}", limits=limits)


def check_gravity(gravity: Array, places: Places) -> None:
    if not gravity.ndim and gravity.dtype.kind in "fiu":
        rule = "must be a vector (3,) in the world's frame, such as (0, 0, -9.81)"
        raise places.error("gravity", f"{rule}, got one number, {gravity}", gravity=gravity)
    _check_numbers("gravity", "vector", gravity, (3,), places)
    check_size("gravity", "vector", gravity, places)


def check_bodies(bodies: Sequence[Body], pieces: Sequence[Sequence[str]], places: Places) -> None:
    """Checks that lumped tensors are physical: none without mass, no negative principal moment, none above the sum of
    the other two.  pieces: names of the links that each body is made of."""
    faults = [(body, own, fault) for body, own in zip(bodies, pieces, strict=True) if (fault := fault_of(body))]
    if not faults:
        return
    body, own, fault = faults[0]
    lump = f" (lumped: {listed(own)})" if list(own) != [body.name] else ""
    others = "".join(f", of {each.name!r} by {lacking(each):.4g}" for each, *_ in faults[1:] if each.mass > 0.0)
    option = "; mend_inertia=True does that (--mend-inertia)" if body.mass > 0.0 else ""
    told = f"{fault.moments}{lump}: {fault.rule}; {fault.remedy}{others}{option}"
    links = [each.name for each, *_ in faults]
    raise places.error(f"link {body.name!r}", told, link=body.name, inertia=body.inertia, links=links)


def lacking(body: Body) -> float:
    """What a body's inertia lacks about every axis to be physical, kg m2.

    With that added, the largest principal moment is the sum of the others, in any frame, less a thousandth.
    """
    small, middle, large = np.linalg.eigvalsh(body.inertia)
    return 1.001 * float(large - small - middle)


def mended(body: Body) -> Body:
    """The same body, with what its inertia lacks."""
    return replace(body, inertia=body.inertia + lacking(body) * np.eye(3))


class Fault(NamedTuple):
    """What is wrong with a body's inertia tensor, in words."""

    moments: str
    rule: str
    remedy: str


def fault_of(body: Body) -> Fault | None:
    """What is physically impossible in a body's inertia about its com; None if nothing is."""
    small, middle, large = np.linalg.eigvalsh(body.inertia)
    tolerance = RELATIVE * max(large, -small) + GYRATION**2 * body.mass
    moments = f"principal moments of inertia {small:.6g}, {middle:.6g}, {large:.6g} kg m2"
    if body.mass == 0.0 and np.any(body.inertia):
        rule = "without mass (0 kg) there is no inertia"
        return Fault(moments, rule, "state the mass or leave out <inertial>")
    beyond = large - small - middle
    remedy = f"check <inertia> and its <origin>; increasing ixx, iyy and izz by {lacking(body):.4g} would do"
    if small < -tolerance:
        return Fault(moments, "none must be negative", remedy)
    if beyond > tolerance:
        rule = f"the largest exceeds the sum of the others by {beyond / large:.2%} of itself (triangle inequality)"
        return Fault(moments, rule, remedy)
    return None


def check_all_bear_mass(bodies: Sequence[Body], places: Places) -> None:
    """Checks that every moving body has or carries mass or inertia: otherwise nothing resists its joint."""
    bears = [not MassProperties(body.mass, body.com, body.inertia).is_nothing for body in bodies]
    for index in reversed(range(len(bodies))):
        if bears[index] and bodies[index].parent >= 0:
            bears[bodies[index].parent] = True
    empty = [body for body, has_mass in zip(bodies, bears, strict=True) if not has_mass]
    if empty:
        joint = empty[0].joint.name
        hold = f", or hold the joint: lock={{{joint!r}: 0.0}} (--lock {joint}=0)" if any(bears) else ""
        complaint = f"moves with joint {joint!r} but has no mass and carries none; give it an <inertial>{hold}"
        more = f" (likewise {listed([body.name for body in empty[1:]])})" if len(empty) > 1 else ""
        raise places.error(f"link {empty[0].name!r}", complaint + more, links=[body.name for body in empty])


def _check_numbers(thing: str, what: str, value: float | Array, shape: tuple[int, ...], places: Places) -> None:
    found = any_array(value)
    if found.shape != shape or found.dtype.kind not in "fiu":
        complaint = f"{what} must have shape {shape} and hold real numbers, got shape {found.shape} of {found.dtype}"
        raise places.error(thing, complaint, what=what, value=value)
    if not np.all(np.isfinite(found)):
        raise places.error(thing, f"{what} must be finite, got {value}", what=what, value=value)


def check_size(thing: str, what: str, value: float | Array, places: Places) -> None:
    """Raises ModelError for numbers beyond LARGEST_NUMBER."""
    largest = float(np.max(np.abs(value)))
    if largest > LARGEST_NUMBER:
        most = f"must not exceed {LARGEST_NUMBER:g} in SI units, beyond any machine"
        rule = f"{what} {most}, got {largest:g}; check its unit"
        raise places.error(thing, rule, what=what, value=value)


def any_array(value: Any) -> NDArray[Any]:
    """Any value as an array, left to later checks to refuse, even with rows of different lengths."""
    try:
        return np.asarray(value)
    except ValueError:
        return np.asarray(value, object)
