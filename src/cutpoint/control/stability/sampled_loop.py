"""Stability of a sampled control law on a robot with elastic joints, linearised at a pose."""

import math
from dataclasses import replace
from types import NoneType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.control.interface import SENSED, Control, name_of
from cutpoint.control.law import as_law, check_drives
from cutpoint.control.laws.model_law import OF_LAWS, ModelLaw, with_models
from cutpoint.control.own_law import check_encoders, fields_read, innermost, own_parts, traced
from cutpoint.control.sensors import SAMPLED, Encoders, Sensors, encoders_of
from cutpoint.control.stability.law_at_rest import LawAtRest, Slopes, differences
from cutpoint.door import check_kind, positive
from cutpoint.errors import InputError
from cutpoint.mechanics.drives.friction import Coulomb, Sliding
from cutpoint.mechanics.drives.presliding import steady_sliding
from cutpoint.model.drive import Drive, Friction
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_all_driven, checked_pose
from cutpoint.scalars import rebuild

if TYPE_CHECKING:
    from cutpoint.analysis import LinearModel


STEADY = 1 + 1e-9
"""The largest pole of what does not grow: an adaptive law's parameters stay at 1 at rest."""

MOST_REMEMBERED = 1500
"""Numbers that sensors have on their way: of six drives 62 periods; the poles of more take many seconds to find."""


class SampledPole(NamedTuple):
    """The sampled loop's largest pole: magnitude (below 1 decays), frequency in Hz, and the joint that swings.

    joint: the one with the most kinetic energy, in which a light wrist that others shake, or metres beside radians, do
    not count for more than they are.
    """

    size: float
    frequency: float
    joint: str


class SampledLoop(NamedTuple):
    """Linearised at rest, x becomes alone @ x + into @ u after a period, with the law's command u = command @ x, N m.

    x: the linear robot's states, currents, delayed commands, and the memory of law and sensors.
    robot: the linear robot, whose states are the first.
    inertia: (2 n, 2 n), of links and of elastic drives' rotors, for v and theta_dot; kg m2 (kg).
    """

    robot: "LinearModel"
    inertia: Array
    alone: Array
    into: Array
    command: Array

    @property
    def closed(self) -> Array:
        """Closed loop: x becomes closed @ x after a period."""
        return self.alone + self.into @ self.command


class SmallSignal(NamedTuple):
    """A law's response near rest, by joint (n,): stiffness, N m/rad, and damping, N m s/rad."""

    stiffness: Array
    damping: Array


def slowest_pole(
    robot: Robot, law: Control, q: ArrayLike, control_period: float, *, sensors: Sensors | None = None
) -> SampledPole:
    """The slowest-decaying (or growing) pole of the robot at rest at q (nq,) under a sampled law.

    The robot is linearised at q and discretised exactly, its motors' current loops and delays included; the law is
    differenced about rest.  Of friction both include the viscous part; not dry friction, whose slope at rest is that of
    its smoothing, nor kinematic error, ripple and cogging, whose slopes change within each wave.  Laws that jump at
    rest have no slope: `SuperTwisting` is refused, and to one's own such law the result does not apply.  Memory counts
    where motion changes it and the command depends on it; clocks and latched faults do not.  `Backlash` counts as its
    slope at rest: limit cycles across the play are not seen.

    The law's reference is chosen so that it carries the robot's load there.
    control_period: s, from one step of the law to the next; no shorter than a motor's delay.
    sensors: their delay and differenced speeds count, their noise and resolution do not; perfect by default.

    Raises:
        InputError: q of a wrong shape; a joint has no motor; the period is not positive, or shorter than a motor's
            delay; sensors delay for no whole number of periods, or for so long that there are too many poles; the law
            is for other drives, jumps at rest, reports a fault at that pose, or reads missing encoders.
        ModelError: a joint can move without moving any inertia.
        TraceError: the law is a user's own, and cannot be compiled.
    """
    return slowest_of(sampled_loop("slowest_pole", robot, law, q, control_period, sensors), control_period)


def slowest_of(loop: SampledLoop, control_period: float) -> SampledPole:
    """See `slowest_pole`."""
    poles, shapes = np.linalg.eig(loop.closed)
    model, worst = loop.robot, int(np.abs(poles).argmax())
    speeds = (model.C @ shapes[: len(model.states), worst]).reshape(4, -1)[1::2].ravel()
    energies = (speeds.conj() * (loop.inertia @ speeds)).real.reshape(2, -1).sum(axis=0)
    frequency = float(abs(np.angle(poles[worst])) / (2 * np.pi * control_period))
    return SampledPole(float(abs(poles[worst])), frequency, model.joints[int(energies.argmax())])


def sampled_loop(
    function: str, robot: Robot, law: Control, q: ArrayLike, period: float, sensors: Sensors | None
) -> SampledLoop:
    """See `slowest_pole`; function: the name for error messages."""
    robot, q, law = _checked(function, robot, law, q)
    check_kind(function, "sensors", sensors, (Sensors, NoneType), "Sensors, or None")
    period = positive(function, "control_period", period, "s")
    check_delays(function, robot, period)
    encoders = encoders_of(sensors or Sensors(), len(robot.drives), period)
    check_encoders(function, fields_read(law, ((x, traced(x, encoders.size)) for x in own_parts(law))), encoders.sides)
    model = _linear(robot, q)
    encoded = _encoded(function, encoders, period)
    answer, plant = _slopes(function, robot, law, model, period), _sampled(robot, model, period)
    if not (np.isfinite(plant.ahead).all() and np.isfinite(plant.now).all()):
        told = f"{function}: over a control_period of {period:g} s the robot falls out of all bounds; is it in s?"
        raise InputError(told, control_period=period)
    # one row per state: the plant's, the previous sample's commands, the law's memory and the sensors'
    sizes = len(plant.ahead), len(robot.drives), len(answer.kept), len(encoded.kept)
    state, before, memory, line = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1])
    sample = model.C @ state[: len(model.states)]  # laws do not measure currents
    seen = encoded.at_once @ sample + encoded.from_memory @ line
    alone = [
        plant.ahead @ state + plant.before @ before,
        0 * before,
        answer.into_memory @ seen + answer.kept @ memory,
        encoded.into_memory @ sample + encoded.kept @ line,
    ]
    into = [plant.now, np.eye(sizes[1]), np.zeros((sizes[2], sizes[1])), np.zeros((sizes[3], sizes[1]))]
    command = answer.at_once @ seen + answer.from_memory @ memory
    return SampledLoop(model, _inertia(robot, q), np.vstack(alone), np.vstack(into), command)


def _inertia(robot: Robot, q: Array) -> Array:
    """See `SampledLoop`."""
    rotors = [d.reflected_inertia if d.is_elastic else 0.0 for d in robot.drives.values()]
    none = np.zeros((len(rotors),) * 2)
    return np.block([[robot.mass_matrix(q), none], [none, np.diag(rotors)]])


def check_delays(function: str, robot: Robot, period: float) -> None:
    """Raises InputError if a command does not reach its motor within the control period, s."""
    for name, drive in robot.drives.items():
        if drive.motor is not None and drive.motor.delay is not None and drive.motor.delay > period:
            told = f"its motor's delay {drive.motor.delay} s must not exceed the control period, {period} s"
            remedy = "is it in ms?  State whole periods in Sensors(delay=)"
            raise InputError(f"{function}: joint {name!r}: {told}; {remedy}", joint=name, delay=drive.motor.delay)


def _encoded(function: str, encoders: Encoders, period: float) -> Slopes:
    """Measured q, v, theta and theta_dot (4 n,), in that order, without noise and rounding."""
    n, delayed = encoders.size, 4 * encoders.size * encoders.delay
    kept = delayed + (2 * n if encoders.differenced else 0)
    if kept > MOST_REMEMBERED:
        rule = f"{kept} delayed numbers are too many to compute poles with, at most {MOST_REMEMBERED}; is it in ms?"
        raise InputError(f"{function}: sensors delay by {encoders.delay} periods: {rule}", delay=encoders.delay)
    # encoders have both positions first, which exchanges two of the four: the same there and back
    order = np.arange(4 * n).reshape(4, n)[[SENSED.index(name) for name in SAMPLED]].ravel()

    def measured(numbers: Array) -> Array:
        line, before = [*numbers[4 * n : 4 * n + delayed], *numbers[order]], [*numbers[4 * n + delayed :]]
        reading, line = line[: 4 * n], line[4 * n :]  # the oldest is the first
        if encoders.differenced:
            reading, before = encoders.difference(reading, before, period)
        return np.array([*np.array(reading)[order], *line, *before])

    slopes = np.stack([measured(one) for one in np.eye(4 * n + kept)], axis=1)
    return Slopes(*(x for rows in np.split(slopes, [4 * n]) for x in np.split(rows, [4 * n], axis=1)))


class _Plant(NamedTuple):
    """x becomes ahead @ x + now @ command + before @ (the previous command) after a period; x ends in currents."""

    ahead: Array
    now: Array
    before: Array


def _sampled(robot: Robot, model: "LinearModel", period: float) -> _Plant:
    """The linear plant, discretised exactly, with its motors' current loops and delays."""
    motors = [drive.motor for drive in robot.drives.values()]
    lags = {k: math.tau * x.bandwidth for k, x in enumerate(motors) if x is not None and x.bandwidth is not None}
    delays = [0.0 if x is None or x.delay is None else float(x.delay) for x in motors]
    count, n, lagging = len(model.states), len(motors), [*lags]
    A, B = np.zeros((count + len(lags),) * 2), np.zeros((count + len(lags), n))
    A[:count, :count], B[:count] = model.A, model.B
    # currents drive the motors, and follow the commands
    A[:count, count:], B[:count, lagging] = model.B[:, lagging], 0.0
    rates = np.array([*lags.values()], float)
    A[count:, count:], B[range(count, len(A)), lagging] = -np.diag(rates), rates

    from scipy.linalg import expm  # slow to import

    def moved(time: float) -> tuple[Array, Array]:
        both = np.asarray(expm(np.block([[A, B], [np.zeros((n, len(A) + n))]]) * time), np.float64)
        return both[: len(A), : len(A)], both[: len(A), len(A) :]

    ahead, whole = moved(period)
    now = np.stack([moved(period - delay)[1][:, k] for k, delay in enumerate(delays)], axis=1)
    return _Plant(ahead, now, whole - now)


def small_signal(robot: Robot, law: Control, q: ArrayLike, period: float) -> SmallSignal:
    """A law's own stiffness and damping of each joint at rest at q, with link and motor displaced together.

    stiffness_i = -(du_i/dq_i + du_i/dtheta_i), damping_i the same of speeds, while the law's memory stands still.  The
    law is differenced as in `slowest_pole`; one that jumps at rest has no slope.
    """
    robot, q, law = _checked("compare", robot, law, q)
    rest = LawAtRest(robot, law, _linear(robot, q).point, period)
    n = len(robot.drives)
    together = np.vstack([np.eye(2 * n)] * 2)  # of link and motor, positions and then speeds
    slopes = differences(lambda x: rest.response((together @ x).reshape(4, n), rest.memory), np.zeros(2 * n))[0]
    return SmallSignal(-np.diag(slopes[:, :n]), -np.diag(slopes[:, n:]))


def _checked(function: str, robot: Robot, law: Control, q: ArrayLike) -> tuple[Robot, Array, Any]:
    """The robot and the law with drives as they count here, and the pose."""
    check_all_driven(function, robot, OF_LAWS)
    made = as_law(law)
    check_drives(made, robot.joints)
    for part in innermost(made):
        if getattr(part, "jumps_at_rest", False):
            told = f"{name_of(part)} jumps where errors vanish, so it has no slopes at rest"
            raise InputError(f"{function}: {told}: judge it by simulation")
    bare = robot.with_drives({name: _bare(drive) for name, drive in robot.drives.items()})
    return bare, checked_pose(function, robot, q), with_models(made, _bare_model)


def _linear(robot: Robot, q: Array) -> "LinearModel":
    rubs = any(drive.link_friction or drive.motor_friction for drive in robot.drives.values())
    return robot.linearize(q, friction=rubs)


def _bare(drive: Drive) -> Drive:
    """The drive with viscous friction only, and without kinematic error."""
    link, motor = map(_viscous, (drive.link_friction, drive.motor_friction))
    return replace(drive, link_friction=link, motor_friction=motor, kinematic_error=None)


def _viscous(law: Friction | None) -> Friction | None:
    sliding = steady_sliding(law)
    return Coulomb(0.0, sliding.viscosity) if isinstance(sliding, Sliding) and sliding.viscosity else None


def _bare_model(law: ModelLaw) -> Robot:
    """A law's model with drives that have viscous friction only, and no kinematic error."""
    drives = rebuild([*law.robot.drives.values()], iter([*law.parameters]))
    return law.robot.with_drives(dict(zip(law.robot.drives, map(_bare, drives), strict=True)))


def _slopes(function: str, robot: Robot, law: Any, model: "LinearModel", period: float) -> Slopes:
    """Slopes of a law's torque and memory with respect to measured q, v, theta and theta_dot (4 n,)."""
    slopes = LawAtRest(robot, law, model.point, period).slopes().of_what_matters()
    if not all(np.isfinite(x).all() for x in slopes):
        rule = "commands or remembers a number that is not finite at rest, so it has no slopes there"
        raise InputError(f"{function}: {name_of(law)} {rule}", q=model.point.q)
    return slopes
