"""Demands of a cycle on one drive: its worst instants and its averages."""

from dataclasses import dataclass

import numpy as np

from cutpoint.arrays import Array
from cutpoint.studies.sizing import duty
from cutpoint.studies.sizing.load import Load
from cutpoint.trajectories.arrays import durations


@dataclass(frozen=True)
class Peak:
    """The largest value by size, with its sign; when, s; and the robot's position then, rad (m)."""

    value: float
    time: float
    position: tuple[float, ...]


@dataclass(frozen=True)
class Demand:
    """Of one drive; None where its motor is not stated.

    At the joint's side, N m and rad/s (N, m/s): output_torque and its rms, what the gear exerts on its link; its
    average_torque, T_av; joint_speed.  position: where the joint is farthest from the middle of its travel, rad (m).
    Of the motor: motor_torque and its rms, what the current makes, N m at the shaft; motor_speed and its mean, rad/s;
    power, torque by speed, W; current and its rms, A; voltage, V; heat: mean loss in the winding, W.
    """

    output_torque: Peak
    output_torque_rms: float
    average_torque: float
    joint_speed: Peak
    position: Peak
    motor_torque: Peak
    motor_torque_rms: float
    motor_speed: Peak
    mean_motor_speed: float
    power: Peak
    current: Peak | None
    current_rms: float | None
    voltage: Peak | None
    heat: float | None


def demand_of(load: Load, k: int, middle: float) -> Demand:
    """Of the k-th drive, whose range of positions has its middle there, rad (m)."""
    span = durations(load.time)
    torque, motor, speed = load.output_torque[:, k], load.motor_torque[:, k], load.motor_speed[:, k]
    current, voltage = load.current[:, k], load.voltage[:, k]
    has_motor, has_winding = bool(np.isfinite(current).all()), bool(np.isfinite(voltage).all())
    return Demand(
        output_torque=_peak(load, torque),
        output_torque_rms=duty.rms(span, torque),
        average_torque=duty.average_torque(span, torque, speed),
        joint_speed=_peak(load, load.joint_speed[:, k]),
        position=_peak(load, load.position[:, k], middle),
        motor_torque=_peak(load, motor),
        motor_torque_rms=duty.rms(span, motor),
        motor_speed=_peak(load, speed),
        mean_motor_speed=duty.mean(span, speed),
        power=_peak(load, load.power[:, k]),
        current=_peak(load, current) if has_motor else None,
        current_rms=duty.rms(span, current) if has_motor else None,
        voltage=_peak(load, voltage) if has_winding else None,
        # electrical input power less mechanical output power
        heat=duty.mean(span, voltage * current - motor * speed) if has_winding else None,
    )


def _peak(load: Load, x: Array, middle: float = 0.0) -> Peak:
    worst = int(np.abs(x - middle).argmax())
    return Peak(float(x[worst]), float(load.time[worst]), tuple(load.position[worst].tolist()))
