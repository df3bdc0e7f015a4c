"""The numbers of tables as JSON: SI units, null for what is infinite, nothing for what a drive does not state."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from cutpoint.arrays import Array
from cutpoint.commands.limits import limits_by_joint
from cutpoint.commands.shared import say_path
from cutpoint.commands.tables import carrier_of
from cutpoint.files import replacing
from cutpoint.mechanics.elastic_inverse import ElasticTorques
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import Body, Limits
from cutpoint.reporting.numbers import json_bytes, json_values
from cutpoint.robot import Robot

if TYPE_CHECKING:
    from cutpoint.analysis import Modes

LAWS = ("compliance", "link_friction", "motor_friction", "hysteresis", "kinematic_error")
"""Parts of a drive that are of several classes, whose name is told."""


def save_sheet(sheet: dict[str, Any], path: Path) -> None:
    """Writes the sheet, whole or not at all."""
    with replacing(path) as file:
        file.write(json_bytes(sheet))
    say_path("numbers saved", path)


def robot_sheet(robot: Robot) -> dict[str, Any]:
    """Bodies by joint, with the limits of their joints, and drives by joint."""
    masses = robot.inertial_parameters.reshape(-1, 10)[:, 0].tolist()
    in_force = limits_by_joint(robot)
    joints = {
        body.joint.name: {**_body(robot, body, in_force[body.joint.name]), "mass": mass}
        for body, mass in zip(robot.mechanism.bodies, masses, strict=True)
    }
    return {
        "robot": robot.name,
        "subsystems": len(robot.subsystems),
        "cutting_points": len(robot.cuts),
        "joints": joints,
        "drives": {name: _drive(drive) for name, drive in robot.drives.items()},
        "gravity": robot.gravity.tolist(),
        "frames": list(robot.frames),
    }


def torque_sheet(robot: Robot, q: Array, v: Array, a: Array, u: ElasticTorques[Array]) -> dict[str, Any]:
    """A motion and its torques by joint, at the joint's side."""
    columns = {
        "position": q, "speed": v, "acceleration": a, "gravity": robot.gravity_forces(q),
        "joint_torque": u.joint_torque, "motor_torque": u.motor_torque, "motor_lead": u.theta - q,
    }  # fmt: skip
    rows = zip(*columns.values(), strict=True)
    of_joints = {name: dict(zip(columns, row, strict=True)) for name, row in zip(robot.joints, rows, strict=True)}
    return {"robot": robot.name, "joints": of_joints}


def modes_sheet(robot: Robot, found: "Modes") -> dict[str, Any]:
    """Modes by frequency, Hz, with each drive's share."""
    own = [
        {"frequency": f, "damping_ratio": zeta, "drives": found.joints_of(k)}
        for k, (f, zeta) in enumerate(zip(found.frequencies, found.damping, strict=True))
    ]
    return {"robot": robot.name, "friction": found.model.friction, "modes": own, "remark": found.remark or None}


def _body(robot: Robot, body: Body, limits: Limits) -> dict[str, Any]:
    """What carries it, and the limits in force; a follower has its leader instead."""
    joint = body.joint
    told = {"kind": joint.kind, "carries": body.name, "carried_by": carrier_of(robot, body)}
    if joint.mimic and robot.mechanism.coupled:
        return {**told, "follows": joint.mimic}
    return {
        **told,
        "position_limits": [limits.lower, limits.upper],
        "speed_limit": limits.velocity,
        "effort_limit": limits.effort,
    }


def _drive(drive: Drive) -> dict[str, Any]:
    laws = {part: type(getattr(drive, part)).__name__ for part in LAWS if getattr(drive, part) is not None}
    return {**json_values(drive), "reflected_inertia": drive.reflected_inertia, "laws": laws}
