"""Figures of drives with two encoders: loops of torque over deflection, and waves of the kinematic error."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.filtering import low_pass
from cutpoint.identification.conditioning.motion import motion_of
from cutpoint.identification.drives.identify_drives import DriveEstimates
from cutpoint.identification.drives.one_drive import DriveEstimate
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.output.pictures import ROW, thinned, titled
from cutpoint.identification.rigid.identify_rigid import RigidEstimate
from cutpoint.identification.rigid.rigid_robot import link_torques
from cutpoint.joint_units import at_joints
from cutpoint.mechanics.drives.harmonic_drive import friction_torque
from cutpoint.reporting.style import MOTOR, SPRING, WIDTH
from cutpoint.robot import Robot

ORDERS = np.arange(0.25, 8.001, 0.05)
"""Waves per turn of the motor in the spectrum."""


@dataclass(frozen=True, eq=False)
class Bending:
    """One drive, each (N,): torque on its link, N m, and deflection without kinematic error, rad, through one filter;
    angle of the motor, rad, and the encoders' difference less the spring's deflection, rad."""

    torque: Array
    deflection: Array
    angle: Array
    left: Array


def bendings(
    robot: Robot, rigid: RigidEstimate, drives: DriveEstimates, recording: Recording, bandwidth: float
) -> Mapping[str, Bending]:
    """Of every elastic drive; its torque is that of the links' motion, with the identified inertias.

    bandwidth: Hz, of the loops.
    """
    motion = motion_of(robot, recording, rigid.cutoff)
    load = link_torques(robot, motion, rigid.model.inertial)
    recording = recording.in_order(robot.joints)
    theta, lead = recording["theta"], recording["theta"] - recording["q"]
    found: dict[str, Bending] = {}
    for joint, estimate in drives.joints.items():
        j, drive = robot.joints.index(joint), robot.drives[joint]
        torque = load[:, j] + friction_torque(drive.link_friction, motion.v[:, j])
        spring: Any = estimate.spring
        error = spring.kinematic_error.value(theta[:, j], drive.ratio) if spring.kinematic_error else 0.0
        bent = np.asarray(_law(estimate).deflection(torque))
        left = lead[:, j] - spring.offset - bent
        loop = low_pass(np.column_stack([torque, lead[:, j] - spring.offset - error]), motion.period, bandwidth)
        found[joint] = Bending(loop[:, 0], loop[:, 1], drive.ratio * theta[:, j], left)
    return found


def loop_picture(robot: Robot, drives: DriveEstimates, found: Mapping[str, Bending]) -> Figure:
    """Torque over deflection, a panel per joint, and the spring's law."""
    figure, panels = _panels(len(found), 1.5 * ROW)
    forces, ways = at_joints(robot, "N m"), at_joints(robot, "mrad")
    for axes, (joint, each) in zip(panels, found.items(), strict=True):
        some, known = thinned(each.torque.size), each.torque[np.isfinite(each.torque)]
        # wider and paler than the law on top of it, which might otherwise hide it
        axes.plot(1e3 * each.deflection[some], each.torque[some], color=MOTOR, linewidth=2.4, alpha=0.4, label="log")
        if known.size:
            torque = np.linspace(known.min(), known.max(), 100)
            law: Any = _law(drives.joints[joint])
            axes.plot(1e3 * np.asarray(law.deflection(torque)), torque, color=SPRING, linewidth=0.8, label="spring")
        titled(axes, f"{joint}: torque [{forces[joint]}]")
        axes.set_xlabel(f"deflection [{ways[joint]}]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    return figure


def _panels(count: int, height: float) -> tuple[Figure, list[Axes]]:
    """So many panels, at most two per row; height: of a row."""
    columns = min(count, 2)
    rows = -(-count // columns)
    figure = Figure(figsize=(WIDTH, 0.6 + height * rows), layout="constrained")
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    for axes in panels[count:]:
        axes.set_visible(False)
    return figure, panels[:count]


def _law(found: DriveEstimate) -> Any:
    """The model's law; for a drive that stays rigid in it, the one found."""
    return found.drive.compliance or found.spring.compliance


def wave_picture(robot: Robot, found: Mapping[str, Bending]) -> Figure:
    """Amplitude of the encoders' difference less the spring's deflection, over waves per turn of the motor."""
    figure, panels = _panels(len(found), ROW)
    ways = at_joints(robot, "µrad")
    for axes, (joint, each) in zip(panels, found.items(), strict=True):
        axes.plot(ORDERS, 1e6 * amplitudes(each.angle, each.left, ORDERS), color=MOTOR, linewidth=1.0)
        titled(axes, f"{joint}: amplitude [{ways[joint]}]")
        axes.set_xlabel("waves per motor turn")
    return figure


def amplitudes(angle: Array, values: Array, orders: Sequence[float] | Array) -> Array:
    """(k,): of waves sin(order * angle + phase) in values (N,), each order on its own; NaN samples do not count.

    All angles have equal weight, however long the motor stays there.
    """
    known = np.isfinite(angle) & np.isfinite(values)
    way = np.abs(np.gradient(angle[known])) if known.sum() > 1 else np.zeros(1)
    if not way.any():
        return np.zeros(len(orders))
    share, angle, values = way / way.sum(), angle[known], values[known]
    apart = share * (values - share @ values)
    return np.array([2.0 * np.abs(apart @ np.exp(-1j * order * angle)) for order in orders])
