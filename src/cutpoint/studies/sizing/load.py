"""Demands of a motion on every drive, sample by sample."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.mechanics.drives.harmonic_drive import waves_of
from cutpoint.mechanics.drives.motor import torque_for
from cutpoint.mechanics.inverse_dynamics import motions, rotor_efforts
from cutpoint.model import Drive
from cutpoint.robot import Robot
from cutpoint.trajectories.motion_at import motion_at
from cutpoint.trajectories.trajectory import Moves

FEWEST, MOST = 2_000, 500_000
"""Intervals into which a motion is cut: at least, and at most."""

A_WAVE = 8
"""Intervals in the shortest wave of kinematic error, ripple or cogging, as far as MOST allows."""

NEARLY = 0.9
"""What a sample on the flank of the highest crest has of it at least: 1 - (pi / A_WAVE)^2 / 2 is 0.92."""

CRESTS, AROUND = 16, 64
"""Crests that are looked at more closely, for each drive and quantity, and the intervals into which the two are cut."""


class Load(NamedTuple):
    """Samples of a motion with its pause: time (N,), s; the others (N, drives), nan where a drive does not tell.

    position and joint_speed: of the joints, rad and rad/s (m, m/s).  output_torque: what the gear exerts on its link,
    link friction overcome, N m (N).  motor_torque: what the current makes, ripple and cogging overcome, N m at the
    shaft.  motor_speed: of the shaft, rad/s.  current (A) and voltage (V) of the motor; power: torque by speed, W.
    """

    time: Array
    position: Array
    joint_speed: Array
    output_torque: Array
    motor_torque: Array
    motor_speed: Array
    current: Array
    voltage: Array
    power: Array


def sampled(robot: Robot, trajectory: Moves, period: float, dwell: float) -> Load:
    """The load every `period` s, at least FEWEST times and A_WAVE times a wave, more finely near the highest crests.

    After the motion it stands still for dwell, s, in its last position.
    """
    end = trajectory.duration
    count = max(FEWEST, int(np.ceil(end / period)))
    if count > MOST:
        rule = f"at most {MOST:,} are taken: give a longer period"
        raise InputError(f"sizing: {end:g} s in steps of {period:g} s is too many samples; {rule}", period=period)
    load = _moving(robot, trajectory, np.linspace(0.0, end, count + 1))
    waves = int(np.ceil(A_WAVE * end * _highest_frequency(robot, load)))
    if waves > count:
        count = min(waves, MOST)
        load = _moving(robot, trajectory, np.linspace(0.0, end, count + 1))
    crests = np.unique(np.concatenate([_crests(column) for x in load[1:] for column in x.T]))
    near = load.time[crests][:, None] + np.linspace(-end / count, end / count, AROUND + 1)
    times = np.unique(np.r_[load.time, np.clip(near, 0.0, end).ravel()])
    moving = _moving(robot, trajectory, times)
    if not dwell:
        return moving
    still = np.zeros((5, 2, moving.position.shape[1]))
    still[0] = moving.position[-1]
    pause = load_of(robot, np.array([np.nextafter(end, np.inf), end + dwell]), still)
    return Load(*map(np.concatenate, zip(moving, pause, strict=True)))


def _moving(robot: Robot, trajectory: Moves, times: Array) -> Load:
    return load_of(robot, times, motion_at("sizing", trajectory, times, robot.joints))


def load_of(robot: Robot, times: Array, motion: Array) -> Load:
    """The load at times (N,); friction as in steady sliding, full rotor coupling as `quasi_rigid` says.

    motion: (5, N, drives), positions and four derivatives.
    """
    q, v, a, jerk, snap = motion
    u = robot.elastic_inverse_dynamics(q, v, a, jerk, snap, quasi_rigid=True)
    drives = [*robot.drives.values()]
    ratio, constant, resistance = np.array([_motor(drive) for drive in drives]).T
    electric = [torque_for(d, u.motor_torque[:, k], u.theta[:, k]) for k, d in enumerate(drives)]
    torque, speed = np.stack(electric, axis=1) / ratio, u.theta_dot * ratio
    current = torque / constant
    output = u.joint_torque + robot.friction_torques(v) - _of_rotors(robot, q, v, a)
    voltage = resistance * current + constant * speed
    return Load(times, q, v, output, torque, speed, current, voltage, torque * speed)


def _of_rotors(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    """What of rigid drives' joint torques moves their own rotors, and does not pass through the gear, (N, drives)."""
    if all(drive.is_elastic for drive in robot.drives.values()):
        return np.zeros(a.shape)
    system, columns = robot.machine.system, [[*x.T] for x in (q, v, a)]
    efforts = rotor_efforts(system, motions(system, *columns), columns[2])
    return np.stack(np.broadcast_arrays(*efforts), axis=1)


def _motor(drive: Drive) -> tuple[float, float, float]:
    """Ratio, torque constant and resistance, nan where not stated."""
    motor = drive.motor
    if motor is None:
        return drive.ratio, np.nan, np.nan
    return drive.ratio, motor.torque_constant, np.nan if motor.resistance is None else motor.resistance


def _highest_frequency(robot: Robot, load: Load) -> float:
    """Of the waves that go with a rotor's turns, Hz."""
    orders = [max((wave.order for wave in waves_of(drive)), default=0) for drive in robot.drives.values()]
    return float((orders * np.abs(load.motor_speed).max(axis=0)).max(initial=0.0) / (2 * np.pi))


def _crests(x: Array) -> NDArray[np.intp]:
    """Indices of the highest crests of |x|, (N,), its ends among them if they are."""
    size = np.where(np.isnan(x), -1.0, np.abs(x))
    rises = np.r_[True, size[1:] >= size[:-1]] & np.r_[size[:-1] >= size[1:], True]
    found = np.flatnonzero(rises & (size >= NEARLY * size.max()))
    return found[np.argsort(-size[found], kind="stable")[:CRESTS]]
