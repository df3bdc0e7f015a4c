"""A recording in the form that the equations take: all joints in order, with speeds, accelerations and torques."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import InputError, listed, those_that_exist, unknown_name
from cutpoint.identification.conditioning.filtering import LITTLE, STILL, derivative, low_pass, noise_cutoff
from cutpoint.identification.logs.recording import Recording, travel
from cutpoint.mechanics.drives.friction import Sliding
from cutpoint.mechanics.drives.presliding import Presliding, sliding_of
from cutpoint.model.drive import Drive
from cutpoint.robot import Robot
from cutpoint.robot_arguments import STANDS, check_all_driven

DEAD = 5e-5
"""Share of the liveliest joint's torque variation: a torque that varies less carries no information."""


class Motion(NamedTuple):
    """Motion of the joints, each (N, n), one column per joint of the robot; NaN where unknown.

    q, v, a: of the links; theta, w, w_dot: of the motors, over ratio; rad, rad/s, rad/s2 (m ...).
    period: s between samples.  cutoff: Hz, of the positions.
    """

    q: Array
    v: Array
    a: Array
    theta: Array
    w: Array
    w_dot: Array
    period: float
    cutoff: float

    def known(self) -> NDArray[np.bool_]:
        """Which samples hold every number, (N,)."""
        return np.asarray(np.isfinite(np.column_stack([self.q, self.v, self.a, self.w, self.w_dot])).all(axis=1))


def motion_of(robot: Robot, recording: Recording, cutoff: float | None = None) -> Motion:
    """Positions low-passed at a cut-off (Hz), and their derivatives.

    cutoff: by default where the positions fall below their noise, see `noise_cutoff`.  Where only one side of the gear
    was measured, it stands for both.

    Raises InputError: joints that were not recorded, no positions, uneven times, joints without a drive.
    """
    check_all_driven("identify", robot, STANDS)
    period, channels = recording.period, _channels(robot, recording)
    sides = {name: channels[name] for name in ("q", "theta") if name in channels}
    if not sides:
        raise InputError(f"the recording holds no positions, q or theta; there are: {', '.join(channels)}")
    _refuse_empty(robot, sides)
    if not any(travel(x) for positions in sides.values() for x in positions.T):
        words = f"no joint moves: {' and '.join(sides)} never change{'s' * (len(sides) == 1)} at {listed(robot.joints)}"
        raise InputError(f"{words}; record a motion, as of cutpoint excite, or map other channels")
    cutoff = noise_cutoff(np.column_stack([*sides.values()]), period) if cutoff is None else cutoff
    smooth = {name: _without_noise_at_rest(low_pass(x, period, cutoff)) for name, x in sides.items()}
    q, theta = (smooth.get(name, next(iter(smooth.values()))) for name in ("q", "theta"))
    v, a, w, w_dot = (derivative(x, period, order) for x in (q, theta) for order in (1, 2))
    return Motion(q, v, a, theta, w, w_dot, period, cutoff)


def still_joints(robot: Robot, motion: Motion) -> list[str]:
    """Joints that stood still in the whole motion."""
    return [joint for joint, v in zip(robot.joints, motion.v.T, strict=True) if not np.nan_to_num(v).any()]


def _without_noise_at_rest(positions: Array) -> Array:
    """Positions (N, n), without encoder flicker for joints that stand still compared with the liveliest."""
    known = np.isfinite(positions)
    low = np.min(positions, axis=0, where=known, initial=np.inf)
    high = np.max(positions, axis=0, where=known, initial=-np.inf)
    stands = high - low <= min(STILL * np.max(high - low), LITTLE)
    return np.where(known & stands, (low + high) / 2.0, positions)


def check_friction(function: str, robot: Robot, on_motors: Any = Sliding | Presliding) -> None:
    """Raises InputError for friction whose parameters cannot be identified.  on_motors: kinds of which theirs can."""
    for joint, drive in robot.drives.items():
        for law, kinds in ((drive.link_friction, Sliding | Presliding), (drive.motor_friction, on_motors)):
            if law is not None and not isinstance(law, kinds):
                rule = "whose parameters cannot be identified: state Coulomb's or Stribeck's law, or bristles on one"
                raise InputError(f"{function}: friction of {joint!r} is {type(law).__name__}, {rule}", joint=joint)


def slide_with_motors(robot: Robot) -> NDArray[np.bool_]:
    """(n,): whether each joint's friction depends on the motor's speed: all that is stated, or most of the dry part, is
    the motor's."""
    return np.array([_is_of_motor(drive) for drive in robot.drives.values()], np.bool_)


def _is_of_motor(drive: Drive) -> bool:
    if drive.motor_friction is None or drive.link_friction is None:
        return drive.motor_friction is not None
    link, motor = (getattr(sliding_of(law), "coulomb", 0.0) for law in (drive.link_friction, drive.motor_friction))
    return bool(motor > link)


def sliding_speeds(robot: Robot, motion: Motion) -> Array:
    """(N, n): the speed on which each joint's friction depends."""
    return np.where(slide_with_motors(robot), motion.w, motion.v)


def torques_of(robot: Robot, recording: Recording, constants: Mapping[str, float] | None) -> Array:
    """(N, n): torques of the motors times ratio, N m (N), as recorded, in the order of the robot's joints.

    constants: N m at the joint per ampere of its motor, by joint; if given, currents are used.  They also are where no
    torque was recorded, with the constants of the drives' motors.

    Raises InputError: joints that were not recorded, neither torques nor currents, currents without a constant.
    """
    channels = _channels(robot, recording)
    if "torque" in channels and constants is None:
        return _telling(robot, "torque", channels["torque"])
    if "current" not in channels:
        wanted = "current" if constants is not None else "torque or current"
        remedy = "map one, or name its columns as in 'torque.JOINT' or 'current.JOINT'"
        raise InputError(f"the recording holds no {wanted}; there are: {', '.join(channels)}; {remedy}")
    current = _telling(robot, "current", channels["current"])
    unknown = set(constants or {}) - set(robot.joints)
    if unknown:
        raise unknown_name("driven joint", sorted(unknown)[0], robot.joints)
    return current * [_constant(robot, joint, constants or {}) for joint in robot.joints]


def _channels(robot: Robot, recording: Recording) -> dict[str, Array]:
    missing = [joint for joint in robot.joints if joint not in recording.joints]
    if missing:
        there = those_that_exist(missing[0], recording.joints)
        several = len(missing) > 1
        what, its, it = ("joints", "their", "them") if several else ("joint", "its", "it")
        rule = f"map {its} channels, or lock {it} (--lock on the command line)"
        raise InputError(f"{what} {listed(missing)} {'were' if several else 'was'} not recorded; {there}; {rule}")
    return recording.in_order(robot.joints).channels


def _refuse_empty(robot: Robot, channels: Mapping[str, Array]) -> None:
    """Raises InputError for a joint with an empty channel."""
    for name, values in channels.items():
        for joint, x in zip(robot.joints, values.T, strict=True):
            if not np.isfinite(x).any():
                rule = f"{name} of joint {joint!r} holds no numbers in the whole log"
                raise InputError(f"{rule}: map another channel, or lock the joint", joint=joint)


def _telling(robot: Robot, name: str, values: Array) -> Array:
    """Torques or currents unchanged.  Raises InputError if one is empty or never changes."""
    _refuse_empty(robot, {name: values})
    changes = np.nanmax(values, axis=0) - np.nanmin(values, axis=0)
    if not changes.any():
        raise InputError(f"{name} never changes in the whole log for any joint: map another channel")
    dead = [joint for joint, change in zip(robot.joints, changes, strict=True) if change <= DEAD * changes.max()]
    if dead:
        most = robot.joints[int(np.argmax(changes))]
        rule = f"never changes in the whole log, or by far less than that of {most}: was it measured, and in this unit?"
        raise InputError(f"{name} of {', '.join(dead)} {rule}  Map another channel, or lock the joint", joint=dead[0])
    return values


def _constant(robot: Robot, joint: str, given: Mapping[str, float]) -> float:
    """N m at the joint per ampere."""
    drive = robot.drives[joint]
    if joint in given:
        if not (np.isfinite(given[joint]) and given[joint] != 0.0):
            raise InputError(f"torque_constants[{joint!r}] is {given[joint]}: it must be finite and not 0", joint=joint)
        return given[joint]
    if drive.motor is None:
        raise InputError(
            f"joint {joint!r}: only its current was recorded, and its drive has no motor with a torque constant; "
            "state one, or give torque_constants={...} in N m at the joint per ampere",
            joint=joint,
        )
    return float(drive.motor.torque_constant * drive.ratio)
