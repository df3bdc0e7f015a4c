"""A controller in continuous time instead of once a period, as stability proofs assume."""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from cutpoint import kernels
from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.scalars import leaves
from cutpoint.simulation.adaptive import ATOL, RTOL, Scalars, end_period, plant_rates
from cutpoint.simulation.loop.loop import ClosedLoop
from cutpoint.simulation.runner import NoNumberError
from cutpoint.trajectories.trajectory import Moves, derivatives_of


def check_continuous(loop: ClosedLoop) -> None:
    """Raises InputError for memory of law, sensors or drives, which is not defined between samples.

    Raises TraceError for a law that cannot be compiled.
    """
    if loop.refusal:
        raise loop.refusal
    what = None
    if leaves(loop.memory):
        what = f"{type(loop.controller).__name__} remembers"
    elif loop.encoders.delay or loop.encoders.differenced or loop.encoders.normals:
        what = "sensors with noise, delay or differences go by samples"
    elif loop.layout.state != loop.robot.nq + loop.robot.nv + 2 * loop.layout.n:
        what = "drives with current loops, hysteresis or presliding go by samples"
    elif any(d.motor is not None and d.motor.delay for d in loop.robot.drives.values()):
        what = "motors with a delay go by samples"
    if what:
        raise InputError(f"simulate: hold=False is for laws, sensors and drives without memory; {what}")


def continuous_step(loop: ClosedLoop, trajectory: Moves | None) -> Callable[[dict[str, Array], Array], None]:
    """A function that advances the loop's memory by one period, the controller in the differential equation: DOP853."""
    rates = _Rates(loop, trajectory)

    def step(memory: dict[str, Array], row: Array) -> None:
        x, given = np.array(loop.lanes.dense(memory["state"])), (row.copy(), memory["law"], memory["parameters"])
        with np.errstate(all="ignore"):  # numbers that are not finite end the run below
            found = solve_ivp(rates, (row[0], row[0] + loop.period), x, "DOP853", args=given, rtol=RTOL, atol=ATOL)
        end_period(loop, memory, found.y[:, -1] if found.success else np.full_like(x, np.nan))

    return step


class _Rates:
    """dx/dt of the plant with its controller, compiled at the first use."""

    def __init__(self, loop: ClosedLoop, trajectory: Moves | None) -> None:
        self._loop, self._trajectory = loop, trajectory

    def __call__(self, t: float, x: Array, row: Array, law: Array, parameters: Array) -> Array:
        """At the time t, s, to which it sets the row's time and reference.  Raises NoNumberError."""
        n = self._loop.layout.n
        row[0] = t
        if self._trajectory is not None:
            row[1 : 1 + 5 * n] = derivatives_of("simulate", self._trajectory, np.array([t]), 4).ravel()
        found = self._kernel(x, row, law, parameters)
        if np.isnan(found[:n]).any():
            raise NoNumberError(t, found[:n])
        return found[n:]

    @cached_property
    def _kernel(self) -> Any:
        loop = self._loop
        lengths = {region.name: region.size for region in loop.regions()}
        sizes = {name: lengths[name] for name in ("row", "law", "parameters")}
        backend = loop.robot.backend
        return kernels.compile(self._traced, name="closed_loop", backend=backend, x=loop.layout.state, **sizes)

    def _traced(self, x: Scalars, row: Scalars, law: Scalars, parameters: Scalars) -> Scalars:
        """The command's torques, then dx/dt."""
        loop, n, disturbance = self._loop, self._loop.layout.n, self._loop.layout.disturbance(row)
        measured = loop.sense(loop.lanes.padded(x), [], parameters)
        command, _ = loop.control(measured, [], row, law)
        limited, _ = loop.actuate(loop.lanes.padded(x), command, [0] * loop.lanes.size(n), parameters)
        machine = loop.robot.machine_with(parameters[: len(loop.robot.drive_parameters)])
        return [*command[:n], *plant_rates(machine, x, x, loop.lanes.dense(limited), disturbance)]
