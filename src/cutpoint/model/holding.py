"""Joints that do not move on their own: locked ones, and mimics, which follow a leader."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cutpoint.callers import warn
from cutpoint.errors import those_that_exist
from cutpoint.model.limits import DegreesWarning, looks_like_millimetres
from cutpoint.model.mechanism import Joint, Mimic
from cutpoint.model.places import Places
from cutpoint.model.pose import pose, rotation_about
from cutpoint.model.validation import DEGREES_BEYOND, ONE_COORDINATE, check_size

LONGEST_CHAIN = 16
"""Of mimics of mimics, in joints."""


class Degrees(float):
    """Where a joint is locked, in degrees; of a joint that slides, in m."""


def hold(joints: Sequence[Joint], lock: Mapping[str, float], coupled: bool, places: Places) -> list[Joint]:
    """The joints with locked ones fixed at their value, and every mimic pointing at the leader of its chain.

    lock: rad (m), or `Degrees`, by joint.
    If followers are coupled, those of a locked leader are locked too.  If not, they are free, even if their leader does
    not exist.
    Raises ModelError: unknown name, a joint that cannot be locked, a follower locked apart from its leader, a circular
    mimic or one of a joint that does not move, numbers beyond those of any machine.
    Warns, DegreesWarning, of joints without limits that are locked beyond a turn.
    """
    by_name = {joint.name: joint for joint in joints}
    radians = {name: _in_radians(by_name.get(name), value) for name, value in lock.items()}
    holder = _Holder(by_name, radians, coupled, places)
    for name, value in radians.items():
        holder.check_lock(name, value)
    for name, value in lock.items():
        if not isinstance(value, Degrees) and _is_beyond_a_turn(by_name[name], value):
            told = f"position {value:g} rad is beyond a turn: {value:g} degrees are {math.radians(value):.6g} rad"
            warn(f"lock of joint {name!r}: {told}", DegreesWarning)
    return [holder.held(joint) for joint in joints]


def _in_radians(joint: Joint | None, value: float) -> float:
    slides = joint is not None and joint.kind == "prismatic"
    return math.radians(value) if isinstance(value, Degrees) and not slides else value


def _is_beyond_a_turn(joint: Joint, value: float) -> bool:
    """Whether the joint turns without a limit on that side, and by more than a turn."""
    limit = joint.limits.upper if value > 0.0 else joint.limits.lower
    return joint.kind in ("revolute", "continuous") and math.isinf(limit) and abs(value) > 2.0 * math.pi


def fixed_at(joint: Joint, value: float) -> Joint:
    """The joint as a fixed one, at coordinate `value` (rad or m)."""
    angle = 0.0 if joint.kind == "prismatic" else value
    slide = {"prismatic": value, "helical": joint.pitch * value}.get(joint.kind, 0.0)
    motion = pose(rotation_about(joint.axis, angle), slide * joint.axis)
    return replace(joint, kind="fixed", placement=joint.placement @ motion, mimic=None)


@dataclass(frozen=True)
class _Holder:
    by_name: Mapping[str, Joint]
    lock: Mapping[str, float]
    coupled: bool
    places: Places

    def held(self, joint: Joint) -> Joint:
        if joint.name in self.lock:
            return self.fixed(joint, self.lock[joint.name])
        mimic = None if joint.kind == "fixed" else self.leader(joint)
        if mimic is None or mimic.joint not in self.lock:
            return replace(joint, mimic=mimic)
        if not self.coupled:
            return replace(joint, mimic=None)
        return self.fixed(joint, mimic.multiplier * self.lock[mimic.joint] + mimic.offset)

    def fixed(self, joint: Joint, value: float) -> Joint:
        fixed = fixed_at(joint, value)
        check_size(f"joint {joint.name!r}", "placement where it is locked", fixed.placement, self.places)
        return fixed

    def leader(self, joint: Joint) -> Mimic | None:
        """A joint's relation to the end of its mimic chain: a joint that follows none, or a locked one."""
        end, multiplier, offset, passed = joint, 1.0, 0.0, {joint.name}
        while end.mimic is not None and end.name not in self.lock:
            step = end.mimic
            leader = self.by_name.get(step.joint)
            if not self.coupled and (leader is None or leader.kind == "fixed"):
                return None
            self.check_step(joint, step, passed)
            multiplier, offset = multiplier * step.multiplier, multiplier * step.offset + offset
            sizes = np.array([multiplier, offset])
            check_size(f"joint {joint.name!r}", "mimic multiplier and offset", sizes, self.places)
            end = self.by_name[step.joint]
            passed.add(end.name)
        return None if end is joint else Mimic(end.name, multiplier, offset)

    def check_step(self, joint: Joint, step: Mimic, passed: set[str]) -> None:
        thing = f"joint {joint.name!r}"
        if step.joint not in self.by_name:
            there = those_that_exist(step.joint, self.by_name)
            raise self.places.error(thing, f"mimics joint {step.joint!r}, which does not exist; {there}")
        if step.joint in passed:
            raise self.places.error(thing, f"mimics in a circle, through joint {step.joint!r}")
        if len(passed) > LONGEST_CHAIN:
            raise self.places.error(thing, f"mimics through more than {LONGEST_CHAIN} joints; name the leader itself")
        if not np.isfinite([step.multiplier, step.offset]).all():
            complaint = f"mimic multiplier {step.multiplier!r} and offset {step.offset!r} must be finite"
            raise self.places.error(thing, complaint)
        kind = self.by_name[step.joint].kind
        if kind not in ONE_COORDINATE:
            leaders = f"a leader must be one of {', '.join(ONE_COORDINATE)}"
            remedy = ", which can be locked; or load with independent mimics" if kind == "fixed" else ""
            complaint = f"mimics joint {step.joint!r}, which is {kind}; {leaders}{remedy}"
            raise self.places.error(thing, complaint)

    def check_lock(self, name: str, value: float) -> None:
        thing = f"lock of joint {name!r}"
        joint = self.by_name.get(name)
        if joint is None:
            raise self.places.error(thing, f"no joint has this name; {those_that_exist(name, self.by_name)}")
        if joint.kind not in ONE_COORDINATE:
            raise self.places.error(thing, f"the joint is {joint.kind}; it must be one of {', '.join(ONE_COORDINATE)}")
        if not isinstance(value, (int, float, np.number)) or not np.isfinite(value):
            raise self.places.error(thing, f"value {value!r} must be a finite number")
        check_size(thing, "value", value, self.places)
        outside = not joint.limits.lower <= value <= joint.limits.upper
        if joint.kind == "revolute" and outside and abs(value) > DEGREES_BEYOND:
            radians = f"{value:g} degrees are {np.deg2rad(value):.6g} rad"
            raise self.places.error(thing, f"value {value!r} rad is far outside its limits; {radians}")
        if joint.kind == "prismatic" and looks_like_millimetres(value, joint.limits):
            metres = f"{value:g} mm are {value / 1e3:.6g} m"
            raise self.places.error(thing, f"value {value!r} m is far outside its limits; {metres}")
        if self.coupled and joint.mimic is not None:
            complaint = f"the joint follows joint {joint.mimic.joint!r}; lock that one, or load with independent mimics"
            raise self.places.error(thing, complaint)
