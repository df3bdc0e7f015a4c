"""Limits as functions of a motion: joints' bounds, motor torques, boxes around frames."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint import definitions
from cutpoint.arrays import Array
from cutpoint.door import checked_name
from cutpoint.errors import InputError
from cutpoint.identification.excitation.bounds import Bounds
from cutpoint.identification.excitation.kernels import pullback
from cutpoint.joint_units import at_joints
from cutpoint.mechanics.elastic_inverse import Options
from cutpoint.mechanics.kinematics import frame_pose
from cutpoint.robot import Robot

Box = tuple[ArrayLike, ArrayLike]

KINDS = ("position", "speed", "acceleration")


class Limit(NamedTuple):
    """m bounded quantities of a motion, each with its name and unit; low and high (m,), at least one of them finite.

    values: of a motion (5, N, n), (N, m).  gradient: of the sum of weights (N, m) times values, (5, N, n).
    """

    kind: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    low: Array
    high: Array
    values: Callable[[Array], Array]
    gradient: Callable[[Array, Array], Array]

    @property
    def scale(self) -> Array:
        """(m,): half the width, or one unit where there is a bound on one side only."""
        width = self.high - self.low
        return np.where(np.isfinite(width), width / 2.0, 1.0)

    def slack(self, motion: Array) -> Array:
        """(2, N, m): distances to the low and high bounds over scale; negative beyond them, infinite without one."""
        x = self.values(motion)
        return np.stack([x - self.low, self.high - x]) / self.scale


@dataclass(frozen=True)
class Use:
    """A motion's use of a limit: least and largest value, and the allowed ones; infinite if not stated.

    kind: position, speed, acceleration, torque, or place.  name: the joint, or frame and axis.
    """

    kind: str
    name: str
    unit: str
    least: float
    largest: float
    low: float
    high: float


def limits_of(robot: Robot, bounds: Bounds, boxes: Mapping[str, Box]) -> list[Limit]:
    """All stated limits.  boxes: low and high (3,) of frames' positions in the world, m.

    Raises InputError for an unknown frame or an invalid box.
    """
    found = [_of_joints(robot, 0, bounds.low, bounds.high)]
    found += [_of_joints(robot, k, -most, most) for k, most in ((1, bounds.speed), (2, bounds.acceleration))]
    found += [_torque(robot, bounds.torque), *(_box(robot, frame, box) for frame, box in boxes.items())]
    return [limit for limit in found if limit.names]


def _of_joints(robot: Robot, order: int, low: Array, high: Array) -> Limit:
    """Limit on a derivative of the positions, for the joints where it is bounded."""
    which = np.flatnonzero(np.isfinite(high))
    suffix = ("", "/s", "/s2")[order]
    names = tuple(robot.joints[k] for k in which)
    units = tuple(f"{at_joints(robot, 'rad')[joint]}{suffix}" for joint in names)

    def gradient(motion: Array, weights: Array) -> Array:
        found = np.zeros_like(motion)
        found[order][:, which] = weights
        return found

    return Limit(KINDS[order], names, units, low[which], high[which], lambda motion: motion[order][:, which], gradient)


def _torque(robot: Robot, most: Array) -> Limit:
    """Limit on motor torques at the joints' side, friction included: rigid or elastic, as each drive is."""
    which = np.flatnonzero(np.isfinite(most))
    names = tuple(robot.joints[k] for k in which)
    units = tuple(at_joints(robot, "N m")[joint] for joint in names)
    gradient = pullback(robot, partial(_motor_torque, which=which), (which.size,), 4) if which.size else _none

    def values(motion: Array) -> Array:
        return robot.elastic_inverse_dynamics(*motion, quasi_rigid=True).motor_torque[:, which]

    return Limit("torque", names, units, -most[which], most[which], values, gradient)


def _box(robot: Robot, frame: str, box: Box) -> Limit:
    checked_name("frame", frame, robot.frames)
    try:
        low, high = (np.broadcast_to(np.asarray(side, dtype=np.float64), 3) for side in box)
    except (TypeError, ValueError):
        raise InputError(f"frame {frame!r}: a box is (low, high), each three numbers, m", frame=frame) from None
    if not (low < high).all():
        raise InputError(f"frame {frame!r}: box from {low} to {high} is empty: low must be below high", frame=frame)
    which = np.flatnonzero(np.isfinite(low) | np.isfinite(high))
    gradient = pullback(robot, partial(_position, frame=frame, which=which), (which.size,), 0) if which.size else _none
    names = tuple(f"{frame} {'xyz'[k]}" for k in which)

    def values(motion: Array) -> Array:
        return robot.frame_pose(motion[0], frame)[:, which, 3]

    return Limit("place", names, ("m",) * which.size, low[which], high[which], values, gradient)


def _motor_torque(m: definitions.Machine, which: NDArray[np.intp], **motion: Any) -> list[Any]:
    torques = definitions.elastic_inverse_dynamics(m, **motion, options=Options(friction_rates=False, quasi_rigid=True))
    return [torques.motor_torque[k] for k in which]


def _position(m: definitions.Machine, q: list[Any], frame: str, which: NDArray[np.intp]) -> list[Any]:
    place = [*frame_pose(m.system, q, frame).position]
    return [place[k] for k in which]


def _none(motion: Array, weights: Array) -> Array:
    return np.zeros_like(motion)
