"""From recorded rows to a log of named channels with units."""

import numpy as np
from numpy.typing import NDArray

from cutpoint.mechanics.harmonic_drive import slipping_torque
from cutpoint.mechanics.strains import count, dealt, taken
from cutpoint.simulation.log import Log
from cutpoint.simulation.loop import ClosedLoop

Array = NDArray[np.float64]

POSITIONS = ("q", "theta", "measured_q", "measured_theta", "motor_reference", "reference_q", "position_error",
             "motor_position_error")  # fmt: skip
SPEEDS = ("v", "theta_dot", "measured_v", "measured_theta_dot", "motor_speed_reference", "reference_v")
MEMORY = ("link_strain", "motor_strain", "hysteresis_torque")
BASE_COORDINATES = ("base_x", "base_y", "base_z", "base_qx", "base_qy", "base_qz", "base_qw")
BASE_SPEEDS = ("base_vx", "base_vy", "base_vz", "base_wx", "base_wy", "base_wz")


def log_of(loop: ClosedLoop, record: Array, times: Array, reference: Array, meta: dict[str, object]) -> Log:
    """Everything recorded, and what follows from it; a floating base's coordinates and speeds one channel each."""
    channels: dict[str, Array] = {}
    start = 0
    for name, size in loop.channels.items():
        channels[name] = record[:, start : start + size]
        start += size
    del channels["current"]  # it is in motor_torque
    faults = channels.pop("fault")[:, 0]
    if getattr(loop.controller, "reports_faults", False):
        channels["fault"] = faults
    channels.update(_remembered(loop, channels.pop("strains")))
    drives, samples = loop.robot.machine.drives, len(record)
    units = _units(loop)
    if loop.robot.nv > len(drives):
        for names, whole, unit in ((BASE_COORDINATES, "q", "m"), (BASE_SPEEDS, "v", "m/s")):
            for k, name in enumerate(names):
                channels[name] = channels[whole][:, k]
                units[name] = unit if k < 3 else {"m": "", "m/s": "rad/s"}[unit]
    channels["q"] = _columns(channels["q"], [d.q for d in drives])
    for name in ("v", "friction_torque"):
        channels[name] = _columns(channels[name], [d.v for d in drives])
    channels["reference_q"], channels["reference_v"] = reference[0, :samples], reference[1, :samples]
    channels["position_error"] = channels["reference_q"] - channels["q"]
    channels["motor_position_error"] = channels["motor_reference"] - channels["theta"]
    channels["feedback_torque"] = channels["command_torque"] - channels["feedforward_torque"]
    about = {"robot": loop.robot.name, "control_period": loop.period, **meta}
    channels, units = {name: _read_only(x) for name, x in channels.items()}, {name: units[name] for name in channels}
    return Log(_read_only(times)[:samples], channels, units, tuple(loop.robot.drives), about)


def _columns(values: Array, which: list[int]) -> Array:
    return values if which == [*range(values.shape[1])] else values[:, which]


def _read_only(values: Array) -> Array:
    """The same numbers, never to be written again: a log takes these without copying them."""
    owner = values if values.base is None else values.base
    owner.setflags(write=False)
    values.setflags(write=False)
    return values


def _remembered(loop: ClosedLoop, strains: Array) -> dict[str, Array]:
    """What drives remember, one column a drive, where any of them does: strains of friction, torque of hysteresis."""
    channels = {name: np.zeros((len(strains), loop.layout.n)) for name in MEMORY}
    drives = [d.drive for d in loop.robot.machine.drives]
    for k, (drive, columns) in enumerate(zip(drives, dealt([*map(count, drives)], [*strains.T]), strict=True)):
        held = taken(drive, iter(columns))
        for name, values in zip(MEMORY, (held.link, held.motor, slipping_torque(drive, held.spring)), strict=True):
            if values is not None:
                channels[name][:, k] = values
    return {name: values for name, values in channels.items() if values.any()}


def _units(loop: ClosedLoop) -> dict[str, str | tuple[str, ...]]:
    """Units of every channel, one a joint where some slide and some turn."""
    kinds = {body.joint.name: body.joint.kind for body in loop.robot.mechanism.bodies}
    slides = [kinds[name] == "prismatic" for name in loop.robot.drives]
    angle, speed, torque = (_one_or_each(slides, *pair) for pair in (("rad", "m"), ("rad/s", "m/s"), ("N m", "N")))
    units: dict[str, str | tuple[str, ...]] = {name: torque for name in loop.channels}
    units["feedback_torque"] = units["hysteresis_torque"] = torque
    units["fault"] = ""
    units["link_strain"] = units["motor_strain"] = angle
    units.update({name: angle for name in POSITIONS})
    units.update({name: speed for name in SPEEDS})
    return units


def _one_or_each(slides: list[bool], turning: str, sliding: str) -> str | tuple[str, ...]:
    if not any(slides):
        return turning
    return sliding if all(slides) else tuple(sliding if s else turning for s in slides)
