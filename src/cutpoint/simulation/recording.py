"""From recorded rows to a log of named channels with units."""

from collections.abc import Mapping

import numpy as np

from cutpoint.arrays import Array
from cutpoint.joint_units import at_joints
from cutpoint.mechanics.drives.harmonic_drive import slipping_torque
from cutpoint.mechanics.drives.motor import within_limits
from cutpoint.mechanics.drives.strains import count, dealt, taken
from cutpoint.simulation.log.channels import BASE_COORDINATES, BASE_SPEEDS, DIFFERENCES, MEMORY, base_of
from cutpoint.simulation.log.log import Log, Run
from cutpoint.simulation.loop.loop import ClosedLoop
from cutpoint.simulation.plant import State

POSITIONS = ("q", "theta", "measured_q", "measured_theta", "motor_reference", "reference_q", "position_error",
             "motor_position_error")  # fmt: skip
ROUNDING = 1e-9
"""Share of a torque by which limits are not passed."""

SPEEDS = ("v", "theta_dot", "measured_v", "measured_theta_dot", "motor_speed_reference", "reference_v")


def log_of(loop: ClosedLoop, record: Array, times: Array, rows: Array, meta: dict[str, object]) -> Log:
    """All recorded and derived channels, or the requested ones; a floating base's coordinates and speeds are one each.

    rows: inputs of each control period.
    """
    channels = _recorded(loop, record)
    rows = rows[: len(record)]
    reference = loop.layout.references(rows)
    channels["reference_q"], channels["reference_v"] = reference[:2]
    channels |= _disturbance(loop, rows)
    differences = {name: pair for name, pair in DIFFERENCES.items() if _is_wanted(loop, name)}
    channels |= {name: channels[whole] - channels[part] for name, (whole, part) in differences.items()}
    channels, units = {name: _read_only(x) for name, x in channels.items() if _is_wanted(loop, name)}, _units(loop)
    about = {"robot": loop.robot.name, "control_period": loop.period, **meta, **_over_limit(loop, channels)}
    units = {name: units[name] for name in channels}
    run = Run(loop.robot, loop.controller, reference, _end_of(loop, record))
    return Log(_read_only(times)[: len(record)], channels, units, tuple(loop.robot.drives), about, run)


def _over_limit(loop: ClosedLoop, channels: Mapping[str, Array]) -> dict[str, dict[str, float]]:
    """By joint, the share of samples in which its motor is asked for more torque than its limits of effort and current,
    or its voltage at that speed, allow, if any."""
    asked, speeds, robot = channels.get("command_torque"), channels.get("theta_dot"), loop.robot
    if asked is None:
        return {}
    over = np.abs(asked) > robot.effort_limits
    for k, drive in enumerate(robot.drives.values()):
        if speeds is not None and drive.motor and drive.motor.voltage_limit is not None:
            allowed = within_limits(drive, asked[:, k], speeds[:, k])
            over[:, k] |= np.abs(allowed - asked[:, k]) > ROUNDING * np.abs(asked[:, k])
    shares = over.mean(axis=0).tolist()
    found = {joint: share for joint, share in zip(robot.drives, shares, strict=True) if share > 0.0}
    return {"over_limit": found} if found else {}


def _end_of(loop: ClosedLoop, record: Array) -> State | None:
    """The state in the last row, if all of it was recorded."""
    if loop.kept is not None:
        return None
    ends = np.cumsum([*loop.channels.values()])
    parts = dict(zip(loop.channels, np.split(record[-1].copy(), ends[:-1]), strict=True))
    return State(**{name: parts.get(name, np.zeros(0)) for name in State._fields})


def _is_wanted(loop: ClosedLoop, name: str) -> bool:
    return loop.kept is None or name in loop.kept


def _recorded(loop: ClosedLoop, record: Array) -> dict[str, Array]:
    """Recorded quantities, channel by channel, one column per drive."""
    channels, start, drives = dict[str, Array](), 0, loop.robot.machine.drives
    for name, size in loop.channels.items():
        channels[name] = record[:, start : start + size]
        start += size
    channels.pop("current", None)  # it is in motor_torque
    if "fault" in channels:
        faults = channels.pop("fault")[:, 0]
        channels |= {"fault": faults} if getattr(loop.controller, "reports_faults", False) else {}
    channels |= _remembered(loop, channels.pop("strains")) if "strains" in channels else {}
    base = base_of(loop.robot)
    for names, whole in ((BASE_COORDINATES, "q"), (BASE_SPEEDS, "v")):
        if base and whole in channels:
            channels |= dict(zip(names, channels[whole][:, getattr(base, whole)].T, strict=True))
    for name, which in (("q", "q"), ("v", "v"), ("friction_torque", "v")):
        if name in channels:
            channels[name] = _columns(channels[name], [getattr(d, which) for d in drives])
    return channels


def _columns(values: Array, which: list[int]) -> Array:
    return values if which == [*range(values.shape[1])] else values[:, which]


def _read_only(values: Array) -> Array:
    """The same array, made read-only: a log takes it without a copy."""
    owner = values if values.base is None else values.base
    owner.setflags(write=False)
    values.setflags(write=False)
    return values


def _remembered(loop: ClosedLoop, strains: Array) -> dict[str, Array]:
    """Strains and hysteresis torque, one column per drive, if any drive has them or they are requested."""
    channels = {name: np.zeros((len(strains), loop.layout.n)) for name in MEMORY}
    drives = [d.drive for d in loop.robot.machine.drives]
    for k, (drive, columns) in enumerate(zip(drives, dealt([*map(count, drives)], [*strains.T]), strict=True)):
        held = taken(drive, iter(columns))
        for name, values in zip(MEMORY, (held.link, held.motor, slipping_torque(drive, held.spring)), strict=True):
            if values is not None:
                channels[name][:, k] = values
    return {name: values for name, values in channels.items() if values.any() or loop.kept is not None}


def _disturbance(loop: ClosedLoop, rows: Array) -> dict[str, Array]:
    """Disturbances of the links, one column per drive, if there are any or they are requested."""
    if not _is_wanted(loop, "disturbance_torque"):
        return {}
    pushed = loop.layout.disturbances(rows)[:, [d.v for d in loop.robot.machine.drives]]
    return {"disturbance_torque": pushed} if pushed.any() or loop.kept is not None else {}


def _units(loop: ClosedLoop) -> dict[str, str | tuple[str, ...]]:
    """Units of every channel, one per joint if some slide and some turn."""
    angle, speed, torque = (_one_or_each(at_joints(loop.robot, unit), unit) for unit in ("rad", "rad/s", "N m"))
    units: dict[str, str | tuple[str, ...]] = dict.fromkeys(loop.channels, torque)
    units["feedback_torque"] = units["hysteresis_torque"] = units["disturbance_torque"] = torque
    units["fault"] = ""
    units["link_strain"] = units["motor_strain"] = angle
    for names, straight, turning in ((BASE_COORDINATES, "m", ""), (BASE_SPEEDS, "m/s", "rad/s")):
        units.update({name: straight if k < 3 else turning for k, name in enumerate(names)})
    units.update({name: angle for name in POSITIONS})
    units.update({name: speed for name in SPEEDS})
    return units


def _one_or_each(units: dict[str, str], turning: str) -> str | tuple[str, ...]:
    """turning: the unit if there are no joints."""
    different = {*units.values()} or {turning}
    return different.pop() if len(different) == 1 else tuple(units.values())
