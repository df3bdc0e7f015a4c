"""Tables for the command line: robots, drives, torques and errors."""

from dataclasses import is_dataclass
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.table import Table

from cutpoint.arrays import Array
from cutpoint.commands.limits import in_units, limits_by_joint, range_of
from cutpoint.errors import counted
from cutpoint.joint_units import are_prismatic, at_joints, either
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.elastic_inverse import ElasticTorques
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import Body, Joint, Limits, Mimic
from cutpoint.model.units import joint_unit
from cutpoint.reporting.fitting import natural_width
from cutpoint.robot import Robot

if TYPE_CHECKING:
    from cutpoint.analysis import Modes
    from cutpoint.simulation import Log

COLUMNS = ("joint", "kind", "carries", "carried by", "mass / kg", "position limits", "speed limit", "effort limit")
STACKED = ("joint,\nkind", "carries,\ncarried by", "mass\nkg", "position\nlimits", "speed\nlimit", "effort\nlimit")
"""Of robots, in one line each and, where it is narrow, in two."""

NO_LIMITS = ("-", "-", "-")
"""Limits of a joint without any of its own."""

OF_TORQUES = "the joint's torque includes the link's friction, the motor's also its own, rotor and kinematic error"
"""What a drive exerts on its link, and what that takes."""


def robot_table(robot: Robot, console: Console) -> Table:
    """Bodies with their joints, masses and limits: the tightest of the robot file's, the drive's and its current's."""
    sizes = counted(len(robot.subsystems), "subsystem"), counted(len(robot.cuts), "cutting point")
    title = f"{robot.name}: {', '.join(sizes)}"
    wide, stacked = _table(title, *COLUMNS), _table(title, *STACKED)
    stacked.columns[-1].no_wrap = True
    masses, in_force = robot.inertial_parameters.reshape(-1, 10)[:, 0], limits_by_joint(robot)
    for body, mass in zip(robot.mechanism.bodies, masses, strict=True):
        joint, mimic = body.joint, body.joint.mimic if robot.mechanism.coupled else None
        kind = f"{joint.kind}\n{_following(mimic, joint.kind)}" if mimic else joint.kind
        carrier = carrier_of(robot, body)
        limits = NO_LIMITS if mimic else _in_words(joint, in_force[joint.name])
        wide.add_row(joint.name, kind, body.name, carrier, f"{mass:.4g}", *limits)
        stacked.add_row(f"{joint.name}\n{kind}", f"{body.name}\n{carrier}", f"{mass:.4g}", *limits)
    return wide if natural_width(wide, console) <= console.width else stacked


def carrier_of(robot: Robot, body: Body) -> str:
    """The name of the body that carries this one."""
    return robot.mechanism.bodies[body.parent].name if body.parent >= 0 else "world"


def _following(mimic: Mimic, kind: str) -> str:
    """Whom a joint follows, and how."""
    parts = [f"x {mimic.multiplier:g}"] if mimic.multiplier != 1.0 else []
    if mimic.offset:
        parts.append(
            f"{'-' if mimic.offset < 0.0 else '+'} {abs(mimic.offset):g} {'m' if kind == 'prismatic' else 'rad'}"
        )
    return f"follows {mimic.joint}" + (f"\n{' '.join(parts)}" if parts else "")


def _in_words(joint: Joint, limits: Limits) -> tuple[str, str, str]:
    """A joint's limits in force of position, speed and effort."""
    factor, length, force = (1.0, "m", "N") if joint.kind == "prismatic" else (180 / np.pi, "deg", "N m")
    return (
        range_of(limits.lower, limits.upper, factor, length),
        "-" if np.isinf(limits.velocity) else f"{limits.velocity * factor:.4g} {length}/s",
        "-" if np.isinf(limits.effort) else f"{limits.effort:g} {force}",
    )


def drive_table(robot: Robot) -> Table:
    """Each joint's drive, at the joint's side, without columns in which no drive has anything."""
    names = ("joint", "ratio", "rotor", "compliance", "link friction", "motor friction", "also")
    rows = [
        _drive_row(*drive, slides) for drive, slides in zip(robot.drives.items(), are_prismatic(robot), strict=True)
    ]
    told = [k for k, cells in enumerate(zip(*rows, strict=True)) if any(cell != "-" for cell in cells)]
    table = _table("drives, at the joint's side", *(names[k] for k in told))
    for row in rows:
        table.add_row(*(row[k] for k in told))
    if any("\n" in law for row in rows for law in row[3:6]):
        units = sorted("N, m and s on prismatic joints" if x else "N m, rad and s" for x in are_prismatic(robot))
        table.caption = f"laws in {either(units)}"
    return table


def _drive_row(name: str, drive: Drive, slides: bool) -> tuple[str, ...]:
    rotor = f"{drive.reflected_inertia:.4g} {joint_unit('kg m2', slides)}" if drive.rotor else "-"
    laws = (_law(drive.compliance) or "rigid", _law(drive.link_friction) or "-", _law(drive.motor_friction) or "-")
    return name, f"{drive.ratio:g}", rotor, *laws, "\n".join(_also(drive, slides) + _limits(drive, slides)) or "-"


def _limits(drive: Drive, slides: bool) -> list[str]:
    """Limits that the drive states in addition to the robot file's."""
    limits, torque, length = drive.limits, joint_unit("N m", slides), joint_unit("rad", slides)
    parts = [f"limit {limits.effort:.4g} {torque}"] if limits.effort < np.inf else []
    parts += [f"limit {limits.velocity:.4g} {length}/s"] if limits.velocity < np.inf else []
    positions = range_of(limits.lower, limits.upper, 1.0 if slides else 180 / np.pi, "m" if slides else "deg")
    return parts if positions == "-" else [*parts, f"from {positions}"]


def _also(drive: Drive, slides: bool) -> list[str]:
    """Further properties of a drive."""
    parts, torque, length = list[str](), joint_unit("N m", slides), joint_unit("rad", slides)
    if drive.damping:
        parts.append(f"damping {drive.damping:.4g} {torque} s/{length}")
    if isinstance(drive.hysteresis, MaxwellSlip):
        parts.append(f"hysteresis {drive.hysteresis.friction:.4g} {torque}")
    if isinstance(drive.kinematic_error, KinematicError):
        waves = [f"{h.amplitude:.3g} {length} x {h.order}" for h in drive.kinematic_error.harmonics]
        parts.append(f"kinematic error {', '.join(waves)}")
    if drive.motor:
        parts.append(f"motor {drive.motor.torque_constant:.4g} N m/A")
    if drive.ratings and drive.ratings.rated_torque:
        parts.append(f"rated {drive.ratings.rated_torque:.4g} {torque}")
    return parts


def torque_table(robot: Robot, q: Array, v: Array, a: Array, u: ElasticTorques[Array]) -> Table:
    """Torques of a motion, and each motor's lead."""
    title = "torques at the joint's side (N m; N on prismatic joints)"
    names = ["joint", "position", "gravity", "joint torque", "motor torque", "motor leads by"]
    table = _table(title, *names)
    torques = _without_rounding(np.array([robot.gravity_forces(q), u.joint_torque, u.motor_torque]))
    leads = _without_rounding(u.theta - q)
    rows = zip(robot.joints, are_prismatic(robot), q, *torques, leads, strict=True)
    for name, slides, position, gravity, on_link, at_motor, lead in rows:
        table.add_row(
            name, in_units(position, slides), f"{gravity:.6g}", f"{on_link:.6g}", f"{at_motor:.6g}",
            f"{lead * 1e3:.4g} mm" if slides else f"{np.degrees(lead) * 60:.4g} arcmin",
        )  # fmt: skip
    rates = (", ".join(f"{x:.4g}" for x in values) for values in (v, a))
    motion = "speeds {}; accelerations {}; SI units".format(*rates) if v.any() or a.any() else "at rest"
    table.caption = f"{motion}; {OF_TORQUES}"
    return table


def motion_table(robot: Robot, log: "Log") -> Table:
    """RMS and peaks along a motion."""
    table = _table("torques along the motion, at the joint's side", "joint", "RMS joint torque", "peak joint torque",
                   "RMS motor torque", "peak motor torque", "peak speed")  # fmt: skip
    torques = [take(name) for name in ("joint_torque", "motor_torque") for take in (log.rms, log.max)]
    units = at_joints(robot, "N m")
    for name, slides, speed, *found in zip(robot.joints, are_prismatic(robot), log.max("v"), *torques, strict=True):
        table.add_row(name, *(f"{x:.4g} {units[name]}" for x in found), f"{in_units(speed, slides)}/s")
    table.caption = OF_TORQUES
    return table


def _without_rounding(numbers: Array) -> Array:
    """N m (N) or rad (m): zero where only rounding errors of the largest are left, or below 1e-14."""
    return np.where(np.abs(numbers) > max(1e-13 * np.abs(numbers).max(initial=0.0), 1e-14), numbers, 0.0)


def error_table(robot: Robot, log: "Log") -> Table:
    """Tracking errors of a run."""
    table = _table("tracking", "joint", "RMS error", "peak error", "RMS feedback torque", "peak motor torque")
    rms, peak = log.rms("position_error"), log.max("position_error")
    feedback, torque = log.rms("feedback_torque"), log.max("motor_torque")
    units = at_joints(robot, "N m")
    for k, (name, slides) in enumerate(zip(robot.joints, are_prismatic(robot), strict=True)):
        table.add_row(
            name,
            in_units(rms[k], slides),
            in_units(peak[k], slides),
            f"{feedback[k]:.4g} {units[name]}",
            f"{torque[k]:.4g} {units[name]}",
        )
    return table


def modes_table(robot: Robot, found: "Modes") -> Table:
    """Frequencies, dampings, and the drives that deflect."""
    friction = "with friction's slope at rest" if found.model.friction else "without friction"
    table = _table(
        f"{robot.name}: modes of the drives, {friction}", "mode", "Hz", "damping ratio", "drives that deflect"
    )
    for k, (f, zeta) in enumerate(zip(found.frequencies, found.damping, strict=True)):
        shares = ", ".join(f"{name} {share:.0%}" for name, share in found.joints_of(k).items())
        table.add_row(str(k + 1), f"{f:.2f}", f"{zeta:z.4f}", shares)
    table.caption = found.remark or None
    return table


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left")
    for k, column in enumerate(columns):
        table.add_column(column, justify="left" if k == 0 else "right", overflow="fold")
    return table


def _law(law: object) -> str:
    """A law's name and its numbers, one per line."""
    if law is None:
        return ""
    lines = [type(law).__name__]
    for name, value in vars(law).items():
        if is_dataclass(value):
            lines += [f"  {line}" for line in _law(value).splitlines()]
        elif value is not None:
            lines.append(f"{name.replace('_', ' ')} {value:.6g}")
    return "\n".join(lines)
