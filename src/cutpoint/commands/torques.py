"""Torques of a robot: at one place, or along a motion."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

import cutpoint
from cutpoint.arrays import Array
from cutpoint.commands.limits import beyond_efforts, beyond_limits
from cutpoint.commands.robot_file import RobotFile, takes_robot
from cutpoint.commands.shared import (
    Degrees,
    Json,
    Smoothing,
    above_zero,
    app,
    check_targets,
    console,
    keep,
    motion_of,
    numbers_of,
    positions_of,
    say_notes,
)
from cutpoint.commands.sheets import save_sheet, torque_sheet
from cutpoint.commands.tables import motion_table, torque_table
from cutpoint.errors import InputError
from cutpoint.joint_units import at_joints
from cutpoint.mechanics.elastic_inverse import ElasticTorques
from cutpoint.model.limits import check_configuration
from cutpoint.reporting.fitting import print_table
from cutpoint.robot_arguments import check_all_driven

CHANNELS = {
    "q": "rad", "v": "rad/s", "a": "rad/s2", "joint_torque": "N m", "motor_torque": "N m", "theta": "rad",
    "theta_dot": "rad/s",
}  # fmt: skip
"""Channels of a motion's log, in units of revolute joints."""


FEWEST_SAMPLES, MOST_SAMPLES = 1000, 1e6
"""Samples of a motion: those for its peaks, and the most that a log may have."""


@app.command(epilog="Example: cutpoint torque xia2019 --q 0,30,60,0,45,0 --degrees")
@takes_robot()
def torque(
    robot: RobotFile,
    trajectory: Annotated[
        Path | None, typer.Argument(metavar="TRAJECTORY", help="CSV file of a motion: time and joint positions.")
    ] = None,
    q: Annotated[
        str | None,
        typer.Option(help="Without a file: positions, rad (m), separated by commas, in the order of inspect."),
    ] = None,
    v: Annotated[str, typer.Option(help="Speeds there, rad/s; default zero.")] = "",
    a: Annotated[str, typer.Option(help="Accelerations there, rad/s2; default zero.")] = "",
    degrees: Degrees = False,
    smoothing: Smoothing = None,
    duration: Annotated[
        float | None, typer.Option(callback=above_zero, help="Run a file's motion in this time, s.")
    ] = None,
    period: Annotated[
        float, typer.Option(callback=above_zero, help="Time between samples along a file's motion, s.")
    ] = 1e-3,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Save a motion's torques and the motors' motion: .npz or .csv.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Save a picture of them: .png, .pdf or .svg.")
    ] = None,
    json: Json = None,
) -> None:
    """Torques that hold or move a robot and, with elastic drives, the motor positions they take."""
    check_targets(output=output, plot=plot, json=json)
    loaded = robot.load(degrees=degrees)
    if trajectory is not None:
        if q is not None or v or a or degrees:
            rule = "leave out --q, --v, --a and --degrees; its first line names the units, and --lock is in rad"
            raise InputError(f"trajectory {str(trajectory)!r} is already a motion: {rule}")
        if json:
            raise InputError("torque: --json applies only to --q; save a motion's torques by --output")
        check_all_driven("torque", loaded, "a file has motions of motors only; fix it in the robot file, or use Python")
        motion = motion_of(loaded, trajectory, smoothing, ("", ""), duration, degrees)
        if output or plot:
            keep(torques_along(loaded, motion, period), output, plot)
        fine = torques_along(loaded, motion, min(period, motion.duration / FEWEST_SAMPLES))
        print_table(motion_table(loaded, fine), console)
        say_notes(beyond_limits(loaded, fine["q"].min(axis=0), fine["q"].max(axis=0), fine.max("v")))
        return say_notes(beyond_efforts(loaded, fine.max("motor_torque"), fine.max("joint_torque")))
    if q is None or not q.strip():
        raise InputError("torque: give a CSV file TRAJECTORY, or one position as --q")
    if output or plot or smoothing is not None or duration is not None:
        options = "--output, --plot, --smoothing and --duration"
        raise InputError(f"torque: {options} apply only to a CSV file TRAJECTORY: leave them out")
    position = positions_of(loaded, "q", q, degrees)
    speed, acceleration = (numbers_of(loaded, *given, degrees) for given in (("v", v), ("a", a)))
    check_configuration(loaded.mechanism, position.tolist())
    still = np.zeros(len(loaded.joints))
    torques = _torques(loaded, position, speed, acceleration, still, still)
    if json:
        save_sheet(torque_sheet(loaded, position, speed, acceleration, torques), json)
    print_table(torque_table(loaded, position, speed, acceleration, torques), console)
    say_notes(beyond_limits(loaded, position, position, np.abs(speed)))
    say_notes(beyond_efforts(loaded, np.abs(torques.motor_torque), np.abs(torques.joint_torque)))


def torques_along(
    robot: cutpoint.Robot, trajectory: "cutpoint.trajectories.Trajectory", period: float
) -> "cutpoint.Log":
    """Motor torques along a motion, every `period` s; full rotor coupling as with `quasi_rigid`."""
    if trajectory.duration / period > MOST_SAMPLES:
        found = f"a motion of {trajectory.duration:.6g} s then has {trajectory.duration / period:.3g} samples"
        rule = f"at most {MOST_SAMPLES:g} are allowed: lengthen it"
        raise InputError(f"torque: --period {period:g} s: {found}, {rule}", period=period)
    times = np.linspace(0.0, trajectory.duration, max(2, int(np.ceil(trajectory.duration / period - 1e-9)) + 1))
    motion = trajectory.derivatives(times, 4)
    u = _torques(robot, *motion)
    found = (*motion[:3], u.joint_torque, u.motor_torque, u.theta, u.theta_dot)
    units = {name: tuple(at_joints(robot, unit).values()) for name, unit in CHANNELS.items()}
    return cutpoint.Log(times, dict(zip(CHANNELS, found, strict=True)), units, robot.joints)


def _torques(robot: cutpoint.Robot, q: Array, v: Array, *rates: Array) -> ElasticTorques[Array]:
    """Of a motion.  A joint's torque is what its gear exerts on its link, against friction too, as in simulate."""
    u = robot.elastic_inverse_dynamics(q, v, *rates, quasi_rigid=True)
    return u._replace(joint_torque=u.joint_torque + robot.friction_torques(v))
