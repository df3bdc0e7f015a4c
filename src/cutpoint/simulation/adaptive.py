"""Adaptive integration between two samples, as a reference for the fixed steps."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from cutpoint import kernels
from cutpoint.simulation.loop import BEYOND, ClosedLoop
from cutpoint.simulation.plant import rates

Array = NDArray[np.float64]

RTOL, ATOL = 1e-12, 1e-13


def adaptive_step(loop: ClosedLoop) -> Callable[[dict[str, Array], Array], None]:
    """A function that takes the loop's memory one control period on: DOP853, Hairer et al. (1993) section II.5."""
    layout, robot = loop.layout, loop.robot
    parameters = robot.drive_parameters

    def plant(x: list, motor_torque: list, disturbance: list, numbers: list) -> list:
        return rates(robot.machine_with(numbers), x, motor_torque, disturbance)

    sizes = {"x": layout.state, "motor_torque": layout.n, "disturbance": layout.nv, "numbers": len(parameters)}
    f = kernels.compile(plant, name="plant", backend=robot.backend, **sizes)

    def step(memory: dict[str, Array], row: Array) -> None:
        torque, pushed = memory["torque"], np.array(layout.disturbance([*row]), float)

        def f_held(_: float, x: Array) -> Array:
            return f(x, torque, pushed, parameters)

        with np.errstate(all="ignore"):  # what is not finite ends the run below
            found = solve_ivp(f_held, (0.0, loop.period), memory["state"], method="DOP853", rtol=RTOL, atol=ATOL)
        memory["state"][:] = found.y[:, -1] if found.success else np.nan
        memory["fault"][0] = not (np.abs(memory["state"]) < BEYOND).all()

    return step
