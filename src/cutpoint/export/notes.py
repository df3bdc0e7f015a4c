"""Notes on arguments for an exported function's header: units, the order of joints, the drives' numbers."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cutpoint.control import Fault, Guard
from cutpoint.control.interface import SENSED
from cutpoint.control.laws.model_law import ModelLaw
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import places_of
from cutpoint.kernels.targets.c99 import Source
from cutpoint.kernels.targets.c99_texts import Notes, Values
from cutpoint.robot import Robot
from cutpoint.scalars import leaves, named_parts
from cutpoint.simulation.control_kernel import REFERENCE, ControlStep

_POSITIONS = ("theta", "motor_reference")
_SPEEDS = ("theta_dot", "motor_speed_reference")
_UNITS = {
    "q": "rad (m)", "q_next": "rad (m)", "v": "rad/s (m/s)", "a": "rad/s2 (m/s2)", "jerk": "rad/s3 (m/s3)",
    "snap": "rad/s4 (m/s4)", "theta_ddot": "of the motors, rad/s2 (m/s2)",
    "deflection": "by which the motors lead their links, rad (m)",
    "pose": "rotation and position (m) in the world", "energy": "J",
    "h": "linear (kg m/s), then angular momentum (kg m2/s) about the world's origin, along its axes",
    "q_dot": "rad/s (m/s)", "dt": "s", "time": "s, of the measurement, from any origin",
    "memory": "of the law: initially the table whose name ends in _memory, then next_memory of the previous step",
    "next_memory": "the memory of the next step",
    "fault": "what a Guard found first, kept until memory starts anew: "
    + ", ".join(f"{fault.value} {fault.name.lower()}" for fault in Fault),
    "feedforward_torque": "N m (N), already included in torque",
    **dict.fromkeys(_POSITIONS, "of the motors, rad (m)"), **dict.fromkeys(_SPEEDS, "of the motors, rad/s (m/s)"),
    **dict.fromkeys(("torque", "tau", "motor_torque", "joint_torque"), "N m (N)"),
}  # fmt: skip
PER_DRIVE = {*_POSITIONS, *_SPEEDS, "deflection", "theta_ddot", "motor_torque", *ControlStep._fields[:4]}
"""Arguments with an entry a drive."""
_OF_LAWS = {
    "q": "measured, of the links", "v": "measured, of the links", "theta": "measured", "theta_dot": "measured",
    **dict.fromkeys(REFERENCE, "desired, of the links"), "torque": "of the motors", "motor_reference": "desired",
    "motor_speed_reference": "desired",
}  # fmt: skip
"""Words on a law's arguments, before their units."""
_REACTIONS_TOLD = {
    "hold": "the last safe torque is held",
    "ramp": "the torque goes to zero within the parameter ramp_time (s)",
    "stop": "the torque is zero at once",
}
"""What each reaction of a Guard does."""
_AXES = {
    "local": "along the frame's own axes",
    "local_world_aligned": "along the world's axes",
    "world": "of its body's point at the world's origin, along the world's axes",
}
"""What a frame's velocity can be expressed in."""


def result_of(robot: Robot, function: str, frame: str = "", expressed_in: str = "local", **_: Any) -> str:
    """A description of a function's result, where its name alone does not suffice: its rows and columns."""
    speeds = ", ".join(_order(robot, "v", robot.nv, ()))
    bodies = ", ".join(body.name for body in robot.mechanism.bodies)
    velocity = "linear (m/s), then angular velocity (rad/s)"
    acceleration = "linear (m/s2), then angular (rad/s2), without gravity"
    told = {
        "jacobian": f"rows: {velocity} of frame {frame}, {_AXES[expressed_in]}; columns: speeds of {speeds}",
        "frame_acceleration": f"rate of the velocity of frame {frame}, {_AXES[expressed_in]}: {acceleration}",
        "velocity_map": f"rows: {velocity} of each of {bodies}, along the axes of its joint frame, z along the joint; "
        f"columns: speeds of {speeds}",
        "regressor": f"rows: torques of {speeds}; columns: ten for each of {bodies}: mass (kg), mass times centre of "
        "mass x y z (kg m), inertia about the body's origin xx xy xz yy yz zz (kg m2), in its frame of the robot file",
        "mass_matrix": f"kg m2 (kg m, kg); rows and columns: {speeds}",
        "coriolis_matrix": f"torque per speed, SI units; rows and columns: {speeds}",
        "power_flows": "W, outward through the cuts from " + ", ".join(f"{c.inner} to {c.outer}" for c in robot.cuts),
    }
    return told.get(function, "")


def left_out_of(robot: Robot, function: str, strains: Any = None, **_: Any) -> list[str]:
    """Words on what the drives state, and simulation computes, but a function of their motion does not."""
    if function.removesuffix("_derivatives") not in ("elastic_inverse_dynamics", "elastic_forward_dynamics"):
        return []
    steady = "friction as in steady sliding and no hysteresis, for want of strains"
    told = [steady] if robot.strain_names and strains is None else []
    has_motors = any(drive.motor for drive in robot.drives.values())
    return [*told, "without the motors' current loops, delays, limits, ripple and cogging"] if has_motors else told


def notes_of(
    robot: Robot,
    function: Graph | Source,
    about: str,
    values: Mapping[str, Values],
    result: str = "",
    per_drive: Collection[str] = PER_DRIVE,
) -> Notes:
    """The notes on a function's arguments; of the values, those that it takes.

    result: of its only output.  per_drive: arguments with an entry per drive.
    """
    kept = {key: value for key, value in values.items() if key in [p.name for p in function.inputs]}
    if isinstance(function, Graph) and "parameters" in kept:
        kept["parameters"] = _marked(function, "parameters", kept["parameters"])
    told = {p.name: _told(robot, p.name, p.shape, per_drive) for p in (*function.inputs, *function.outputs)}
    if result:
        told[function.outputs[0].name] = result
    if isinstance(function, Graph):
        told |= {p.name: f"not read; {told[p.name]}" for p in function.inputs if p.name not in function.inputs_read}
    sides = "at the joints' side: a rotor's angle over its gear's ratio, a motor's torque times the ratio"
    return Notes(f"{about}.  SI units and radians, {sides if robot.drives else 'at the joints'}.", told, kept)


def notes_of_law(robot: Robot, law: Any, graph: Graph, about: str, values: Mapping[str, Values]) -> Notes:
    """The notes on the arguments of a law's step."""
    notes = notes_of(robot, graph, about, values, per_drive={*PER_DRIVE, "q", "v"})
    told = {name: f"{_OF_LAWS[name]}, {x}" if name in _OF_LAWS else x for name, x in notes.arguments.items()}
    if has_guard(law):
        told |= {name: f"{told[name]}; NaN where there is no encoder" for name in SENSED}
    else:
        told["fault"] = "0, unless the law itself reports one: it has no Guard"
    if isinstance(law, Guard):
        told["fault"] += _reactions_told(law)
    return replace(notes, arguments=told)


def has_guard(law: Any) -> bool:
    """Whether a law's step reports the faults that a Guard finds."""
    return getattr(law, "reports_faults", False)


def _reactions_told(guard: Guard) -> str:
    """What a guard does after each fault, which the fault's number alone does not say."""
    said = ""
    for reaction, does in _REACTIONS_TOLD.items():
        faults = " or ".join(fault for fault, its in guard.all_reactions.items() if its == reaction)
        said += f"; after {faults} {does}" if faults else ""
    return said


def _told(robot: Robot, name: str, shape: Sequence[int], per_drive: Collection[str]) -> str:
    """Unit and order of an argument."""
    if name == "parameters":
        return "the table whose name ends in _parameters: numbers of the drives, and others listed there"
    if name.startswith("wrench_"):
        return "on the robot: force (N), then moment (N m), at its frame's origin, along its axes"
    if name == "strains":
        return f"rad (m): {', '.join(robot.strain_names)}"
    if name in ("link", "motor"):
        columns = ", ".join(robot.drive_coefficients)
        return f"SI units; rows: torques of {', '.join(robot.drives)}; columns: per unit of {columns}"
    if name.startswith("d_"):
        return _slopes_told(robot, name)
    unit = _UNITS.get(name.removeprefix("reference_"), "SI units")
    ordered = len(shape) == 1 and name not in ("h", "memory", "next_memory")
    order = _order(robot, name, shape[0], per_drive) if ordered else []
    if name in ("q", "q_next") and any("(3)" in entry for entry in order):
        unit += "; for bodies that turn freely a quaternion x y z w of length 1, after the position if they move freely"
    return f"{unit}: {', '.join(order)}" if (len(order),) == tuple(shape) else unit


def _marked(graph: Graph, name: str, values: Values) -> Values:
    """An input's values; labels say which of them no result depends on, since changing these changes nothing."""
    places = places_of(graph.inputs)
    read = {places[x.args[0]] for x in graph.nodes if x.op == "input"}
    return values._replace(labels=[x if (name, k) in read else f"not read; {x}" for k, x in enumerate(values.labels)])


def _slopes_told(robot: Robot, name: str) -> str:
    """Rows and columns of derivatives: d_q of a function's only result, d_a_d_q of one of several."""
    result, _, by = name.removeprefix("d_").rpartition("_d_")
    speeds = ", ".join(_order(robot, "v", robot.nv, ()))
    rows, columns = (", ".join(robot.drives) if x in PER_DRIVE else speeds for x in (result, by))
    tangents = "along the directions of the speeds, " if by == "q" else ""
    sides = f"rows and columns: {rows}" if rows == columns else f"rows: {rows}; columns: {columns}"
    return f"{tangents}SI units; {sides}"


def _order(robot: Robot, name: str, size: int, per_drive: Collection[str]) -> list[str]:
    """What a vector's entries belong to: drives, coordinates, or speeds."""
    # a torque has an entry per drive or, for links with a floating base, per speed
    if size == len(robot.drives) and (name in per_drive or name.startswith("reference_")):
        return list(robot.drives)
    side, count = ("q", robot.nq) if name in ("q", "q_next", "q_dot") else ("v", robot.nv)
    entries = [""] * count
    for segment, body in zip(robot.machine.system.segments, robot.mechanism.bodies, strict=True):
        places = [] if segment.follower else range(count)[getattr(segment, side)]
        for k, place in enumerate(places):
            entries[place] = body.joint.name if len(places) == 1 else f"{body.joint.name}({k})"
    return entries


def drive_labels(robot: Robot) -> list[str]:
    """What each of a robot's `drive_parameters` is."""
    return [label for name, drive in robot.drives.items() for label in labels_of(drive, name)]


def labels_of(record: Any, path: str) -> Iterator[str]:
    """A label for each of `scalars.leaves` of a record: the path to it."""
    if isinstance(record, np.ndarray):
        yield from (f"{path}[{k}]" for k in range(record.size))
        return
    parts = named_parts(record)
    if not parts:
        yield from [path for _ in leaves(record)]
    for name, part in parts:
        if name == "parameters" and isinstance(record, ModelLaw):
            yield from (f"{path} {label}" for label in drive_labels(record.robot))
        else:
            yield from labels_of(part, f"{path}{name}" if name.startswith("[") else f"{path} {name}".strip())
