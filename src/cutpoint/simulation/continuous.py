"""A controller in continuous time instead of once a period, as stability proofs assume."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from cutpoint import kernels
from cutpoint.errors import InputError
from cutpoint.scalars import leaves
from cutpoint.simulation.adaptive import ATOL, RTOL, end_period, plant_rates
from cutpoint.simulation.loop import ClosedLoop
from cutpoint.simulation.runner import NoNumberError
from cutpoint.trajectories import Trajectory

Array = NDArray[np.float64]


def check_continuous(loop: ClosedLoop) -> None:
    """Raises InputError for memory of law, sensors or drives, which is not defined between samples.

    Raises TraceError for a law that cannot be compiled.
    """
    if loop.refusal:
        raise loop.refusal
    what = None
    if leaves(loop.memory):
        what = f"{type(loop.controller).__name__} remembers"
    elif loop.encoders.memory(*[[0.0] * loop.layout.n] * 4) or loop.encoders.normals:
        what = "sensors with noise, delay or differences go by samples"
    elif loop.layout.state != loop.robot.nq + loop.robot.nv + 2 * loop.layout.n:
        what = "drives with current loops, hysteresis or presliding go by samples"
    elif any(d.motor is not None and d.motor.delay for d in loop.robot.drives.values()):
        what = "motors with a delay go by samples"
    if what:
        raise InputError(f"simulate: hold=False is for laws, sensors and drives without memory; {what}")


def continuous_step(loop: ClosedLoop, trajectory: Trajectory | None) -> Callable[[dict[str, Array], Array], None]:
    """A function that advances the loop's memory by one period, the controller in the differential equation: DOP853."""
    n, layout = loop.layout.n, loop.layout

    def rates(x: list, row: list, law: list, parameters: list) -> list:
        measured, _ = loop.sense(loop.lanes.padded(x), [], [], parameters)
        command, _ = loop.control(measured, [], row, law)
        limited, _ = loop.actuate(loop.lanes.padded(x), command, [0] * loop.lanes.size(n), parameters)
        machine = loop.robot.machine_with(parameters[: len(loop.robot.drive_parameters)])
        return [*command[:n], *plant_rates(machine, x, x, loop.lanes.dense(limited), layout.disturbance(row))]

    sizes: dict[str, Any] = {"x": layout.state, "row": layout.row}
    kernel: Any = None

    def step(memory: dict[str, Array], row: Array) -> None:
        nonlocal kernel
        numbers, at = [memory[name] for name in ("law", "parameters")], row.copy()
        if kernel is None:
            law, parameters = map(len, numbers)
            kernel = kernels.compile(
                rates, name="closed_loop", backend=loop.robot.backend, **sizes, law=law, parameters=parameters
            )

        def f(t: float, x: Array) -> Array:
            at[0] = t
            if trajectory is not None:
                at[1 : 1 + 5 * n] = trajectory.derivatives(np.array([t]), 4)[:, 0].ravel()
            found = kernel(x, at, *numbers)
            if np.isnan(found[:n]).any():
                raise NoNumberError(t, found[:n])
            return found[n:]

        x = np.array(loop.lanes.dense(memory["state"]))
        with np.errstate(all="ignore"):  # numbers that are not finite end the run below
            found = solve_ivp(f, (row[0], row[0] + loop.period), x, "DOP853", rtol=RTOL, atol=ATOL)
        x = found.y[:, -1] if found.success else np.full_like(x, np.nan)
        end_period(loop, memory, x)

    return step
