"""Inputs of runs, as arrays: sample times, references, rows per period, noise."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import checked_array, given_times, number, positive
from cutpoint.errors import InputError, listed
from cutpoint.model.limits import check_configuration
from cutpoint.robot import Robot
from cutpoint.simulation.beginning import vector
from cutpoint.simulation.loop.loop import ClosedLoop
from cutpoint.simulation.loop.noise import Noise
from cutpoint.simulation.plant import State
from cutpoint.trajectories.motion_at import motion_at
from cutpoint.trajectories.trajectory import Moves, duration_of, names_of, size_of

Disturbance = Callable[[Array], ArrayLike]

MOST_SAMPLES = 10_000_000
"""Of a run: hours at 1 kHz, and with six joints and all channels some 10 GB."""

MOST_STEPS = 100_000
"""Of integration in a control period: at 1 kHz, 10 ns each."""


def sample_times(trajectory: Moves | None, duration: float | None, period: float) -> Array:
    """Times of control samples, s: from 0 to the duration, as rounded.  Raises InputError: none, or too many."""
    if duration is None:
        if trajectory is None:
            raise InputError("simulate: without a trajectory, give duration= in seconds")
        duration = duration_of("simulate", trajectory)
    duration = number("simulate", "duration", duration, "s")
    period = positive("simulate", "control_period", period, "s")
    if not duration > period / 2:
        raise InputError(f"simulate: duration {duration} s must be more than half a control period, {period} s")
    if not duration / period < MOST_SAMPLES:
        found = f"duration {duration:g} s at control_period {period:g} s takes {duration / period:.3g} samples"
        parts = "run in parts, each with initial=log.end of the previous one, without delayed commands"
        remedy = f"shorten the duration, lengthen the control_period, or {parts}"
        raise InputError(f"simulate: {found}, but at most {MOST_SAMPLES:,} are kept in memory; {remedy}")
    return np.arange(round(duration / period) + 1, dtype=np.float64) * period


def reference_at(robot: Robot, trajectory: Moves | None, initial: State | None, times: Array) -> Array:
    """The links' reference with four derivatives, (5, N, drives).  Raises InputError for one that does not fit."""
    n = len(robot.drives)
    if trajectory is None:
        hold = np.zeros((5, len(times), n))
        if initial is not None and initial.q is not None:
            q = vector("q", initial.q, robot.nq)
            hold[0] = q[[d.q for d in robot.machine.drives]]
        return hold
    check_fits("simulate", trajectory, robot)
    reference = motion_at("simulate", trajectory, times, robot.joints)
    by_joint = np.ascontiguousarray(reference[0].T)  # NumPy scans contiguous numbers ten times as fast
    for extreme in (by_joint.min(axis=1), by_joint.max(axis=1)):
        check_configuration(robot.mechanism, extreme.tolist())
    return reference


def check_fits(function: str, trajectory: Moves, robot: Robot) -> None:
    """Raises InputError for a trajectory with another number of joints, or other joint names."""
    n = len(robot.drives)
    if (size := size_of(function, trajectory)) != n:
        raise InputError(f"{function}: the trajectory has {size} joints, but the robot has {n} drives")
    names = names_of(function, trajectory)
    if names and names != robot.joints:
        found = f"the trajectory is for {listed(names)}, but the robot's joints are {listed(robot.joints)}"
        raise InputError(f"{function}: {found}: read it with joints=robot.joints, or in their order", joints=names)


def rows_of(loop: ClosedLoop, times: Array, reference: Array, disturbances: Disturbance | None) -> Array:
    """Inputs of each control period: see `Layout.row`.  Raises InputError for disturbances that do not fit."""
    layout = loop.layout
    rows: Array = np.zeros((len(times), layout.row))
    rows[:, 0] = times
    layout.references(rows)[:] = reference
    if disturbances is not None:
        with given_times("disturbances", times):
            given = disturbances(times)
        pushed = checked_array("simulate", "disturbances(times)", given, layout.nv)
        if pushed.shape not in ((layout.nv,), (len(times), layout.nv)):
            expected = (len(times), layout.nv)
            raise InputError(f"simulate: disturbances(times) has shape {pushed.shape}, but must be {expected}")
        layout.disturbances(rows)[:] = pushed
    return rows


def noise_of(loop: ClosedLoop, samples: int) -> Array:
    """Standard normal numbers of a run, one row per sample."""
    rows: Array = np.empty((samples, loop.layout.noise))
    Noise([loop.encoders.seed], loop.layout.noise, loop.robot.backend).fill(rows)
    return rows
