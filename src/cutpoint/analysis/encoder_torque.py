"""Torque from two encoders, one on either side of a drive: error bound and error sources."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.control.sensors import Sensors, one_each
from cutpoint.door import check_kind, checked_array
from cutpoint.errors import InputError
from cutpoint.mechanics.drives.harmonic_drive import deflection
from cutpoint.model.drive import Drive
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot

COVERED = 3.2905
"""Standard deviations within which 99.9 % of a normal distribution lie."""


@dataclass(frozen=True, eq=False)
class TorqueBound:
    """Bounds of each source's error in a reading, each (..., drives), N m (N), and of their sum.

    resolution: of both encoders, half a step each.  noise: of both, at 99.9 %.  hysteresis: the elements parallel to
    the spring, which encoders do not see.  damping: of the spring, at the given winding speed.
    """

    resolution: Array
    noise: Array
    hysteresis: Array
    damping: Array

    @property
    def total(self) -> Array:
        """The sum: a bound for at least 99.9 % of readings."""
        return self.resolution + self.noise + self.hysteresis + self.damping

    @property
    def largest_part(self) -> list[str]:
        """For each drive its largest error source, on average; "none" if there is none."""
        parts = {"none": np.zeros(self.total.shape), **vars(self)}
        sums = {name: part.reshape(-1, *part.shape[-1:]).sum(axis=0) for name, part in parts.items()}
        return [max(sums, key=lambda name: sums[name][k]) for k in range(self.total.shape[-1])]


def torque_bound(
    robot: Robot,
    theta: ArrayLike,
    q: ArrayLike,
    sensors: Sensors,
    *,
    winding_speed: ArrayLike | None = None,
    record: bool = False,
) -> TorqueBound:
    """How far `Robot.drive_torque(theta, q)` can be from what the drives exert on their links.

    The robot's drives must match the machine's: errors of stiffness or unknown kinematic error are not included.  A
    rigid drive gives no reading, and its bound is 0.

    Args:
        theta, q: encoder readings, (..., drives), rad (m) at the joint's side.
        sensors: the encoders' resolution and noise; their delay does not count, since both sides have it.
        winding_speed: largest rate of deflection, one number or (..., drives), rad/s (m/s).  It must be given where a
            spring is damped, since the reading is the torque without damping; 0 bounds it at rest.
        record: whether the readings (N, drives) are one motion that starts with unstrained elements: then no element of
            hysteresis is strained further than the deflection has moved so far.

    Raises:
        InputError: a joint with several coordinates, numbers that are not finite, shapes that do not match, sensors on
            one side only, or a damped spring without winding_speed.
    """
    check_robot("torque_bound", robot)
    speed = _winding_speed(robot, winding_speed)
    theta, q, speed = _readings("torque_bound", robot, theta=theta, q=q, winding_speed=speed)
    if record:
        _check_motion("torque_bound", theta)
    check_kind("torque_bound", "sensors", sensors, Sensors, "Sensors, such as cutpoint.Sensors(link_resolution=1e-5)")
    if sensors.sides != "both":
        rule = "a torque is read from encoders on both sides of a drive"
        raise InputError(f"torque_bound: sensors.sides is {sensors.sides!r}; {rule}", sides=sensors.sides)
    drives = [*robot.drives.values()]
    steps, sigmas = (_of_both(sensors, what, len(drives)) for what in ("resolution", "noise"))
    parts = [np.zeros(theta.shape) for _ in range(4)]
    for k, drive in enumerate(drives):
        if drive.compliance is not None:
            wound = deflection(drive, theta[..., k], q[..., k])
            own = _parts(drive, wound, steps[:, k], sigmas[:, k], speed[..., k], record)
            for part, each in zip(parts, own, strict=True):
                part[..., k] = each
    return TorqueBound(*parts)


def _winding_speed(robot: Robot, given: ArrayLike | None) -> ArrayLike:
    """For each drive.  Raises InputError where a damped spring needs it."""
    damped = [name for name, drive in robot.drives.items() if drive.is_elastic and drive.damping]
    if given is None and damped:
        why = f"the spring of {damped[0]!r} is damped, and encoder positions do not show the torque of its damping"
        remedy = "give winding_speed, the largest |theta_dot - v| in rad/s, or 0 at rest"
        raise InputError(f"torque_bound: {why}; {remedy}", joint=damped[0])
    speed = 0.0 if given is None else given
    return speed if np.ndim(speed) else np.full(len(robot.drives), speed)


def _parts(
    drive: Drive, wound: Array, steps: Array, sigmas: Array, fastest: Array, record: bool
) -> tuple[Array, Array, Array | float, Array]:
    """One drive's parts as `TorqueBound` has them.  steps, sigmas: of motor and link.  wound, fastest: as read."""
    passed = 1.0 + (drive.kinematic_error.steepest(drive.ratio) if drive.kinematic_error else 0.0)
    angle = (passed * steps[0] + steps[1]) / 2
    spread = COVERED * np.hypot(passed * sigmas[0], sigmas[1])
    steepness = _steepness(drive, wound, angle + spread)
    hysteresis = _hysteresis(drive, wound - wound[:1] if record else None, angle + spread)
    return steepness * angle, steepness * spread, hysteresis, (drive.damping or 0.0) * np.abs(fastest)


def followed_hysteresis(robot: Robot, theta: ArrayLike, q: ArrayLike) -> Array:
    """Torque of the hysteresis elements along a recorded motion (N, drives), N m, unstrained at its start.

    Added to `Robot.drive_torque` it corrects the reading for hysteresis, as far as the model matches the machine.

    Raises:
        InputError: a joint with several coordinates, numbers that are not finite, or shapes that do not match.
    """
    check_robot("followed_hysteresis", robot)
    theta, q = _readings("followed_hysteresis", robot, theta=theta, q=q)
    _check_motion("followed_hysteresis", theta)
    found = np.zeros(theta.shape)
    for k, drive in enumerate(robot.drives.values()):
        if drive.hysteresis is None:
            continue
        wound = deflection(drive, theta[:, k], q[:, k])
        strains = tuple(0.0 for _ in drive.hysteresis.reach)
        for sample, displacement in enumerate(np.diff(wound, prepend=wound[:1])):
            strains = drive.hysteresis.strains(strains, displacement)
            found[sample, k] = drive.hysteresis.torque(strains)
    return found


def _steepness(drive: Drive, wound: Array, off: float) -> Array:
    """Largest error of a spring's torque per rad of its deflection's error `off`; the law is monotonic, so the ends of
    that range are the worst."""
    assert drive.compliance is not None
    if not off:
        return np.zeros(wound.shape)
    low, read, high = (drive.compliance.torque(x) for x in (wound - off, wound, wound + off))
    return np.maximum(high - read, read - low) / off


def _hysteresis(drive: Drive, way: Array | None, off: float) -> Array | float:
    """Bound of the hysteresis elements' torque, given the deflection's change since they were unstrained.

    Elements that cannot have slipped are strained by that change itself, both ends of which have reading errors.
    """
    if drive.hysteresis is None:
        return 0.0
    elements = [*zip(drive.hysteresis.stiffness, drive.hysteresis.reach, strict=True)]
    if way is None:
        return sum(k * r for k, r in elements)
    farthest = np.maximum.accumulate(np.abs(way)) + 2 * off
    sticks = sum(np.where(farthest < r, k, 0.0) for k, r in elements)
    slipped = sum(np.where(farthest < r, 0.0, k * r) for k, r in elements)
    return slipped + sticks * (np.abs(way) + 2 * off)


def _readings(function: str, robot: Robot, **given: ArrayLike) -> tuple[Array, ...]:
    """Readings and their accompanying arrays, broadcast together, (..., drives).  Raises InputError."""
    n = len(robot.drives)
    if robot.nq != n:
        raise InputError(f"{function}: every joint must have one coordinate; {n} drives have {robot.nq}", nq=robot.nq)
    arrays = {name: checked_array(function, name, value, n) for name, value in given.items()}
    try:
        return np.broadcast_arrays(*arrays.values())
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise InputError(f"{function}: shapes do not fit together: {shapes}") from None


def _check_motion(function: str, readings: Array) -> None:
    if readings.ndim != 2:
        rule = "those of a motion are (N, drives)"
        raise InputError(f"{function}: readings have shape {readings.shape}, {rule}", shape=readings.shape)


def _of_both(sensors: Sensors, what: str, size: int) -> Array:
    """A property of the motors' and links' encoders, (2, drives); 0 where it is absent."""
    found = [one_each(sensors, f"{side}_{what}", size) for side in ("motor", "link")]
    return np.array([np.zeros(size) if each is None else each for each in found])
