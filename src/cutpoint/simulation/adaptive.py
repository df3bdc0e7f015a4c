"""Adaptive integration between two samples, as a reference for the fixed steps."""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from cutpoint import kernels
from cutpoint.mechanics.harmonic_drive import transmission
from cutpoint.simulation.loop import BEYOND, ClosedLoop
from cutpoint.simulation.plant import arrived, own_parts, rates, settled, sizes

Array = NDArray[np.float64]

RTOL, ATOL = 1e-12, 1e-13

PAST_A_TURN = 1e-4
"""Share of a period that is integrated without looking for turning points after one."""


def adaptive_step(loop: ClosedLoop) -> Callable[[dict[str, Array], Array], None]:
    """A function that takes the loop's memory one control period on: DOP853, Hairer et al. (1993) section II.5.

    Strains are settled wherever a drive turns back, and commands change when they arrive.
    """
    way = _Way(loop)
    delays = [d.motor.delay for d in loop.robot.drives.values() if d.motor is not None and d.motor.delay]
    ends = sorted({*delays, loop.period})

    def step(memory: dict[str, Array], row: Array) -> None:
        pushed, start = np.array(loop.layout.disturbance([*row]), float), 0.0
        with np.errstate(all="ignore"):  # what is not finite ends the run below
            for end in ends:
                commands = zip(loop.robot.machine.drives, memory["torque"], memory["torque_before"], strict=True)
                told = np.array([arrived(d.drive, u, old, start) for d, u, old in commands], float)
                way.go(memory["state"], told, pushed, start, end)
                start = end
        memory["fault"][0] = not (np.abs(memory["state"]) < BEYOND).all()

    return step


class _Way:
    """Integration under held commands, kernels compiled once."""

    def __init__(self, loop: ClosedLoop) -> None:
        robot, layout = loop.robot, loop.layout
        self._parameters, self._period = robot.drive_parameters, loop.period
        self._strained, self._drives = sizes(robot.machine).strains > 0, layout.n
        numbers: dict[str, Any] = {"numbers": len(self._parameters)}
        states: dict[str, Any] = {"x": layout.state, "origin": layout.state}

        def plant(x: list, origin: list, command: list, disturbance: list, numbers: list) -> list:
            return rates(robot.machine_with(numbers), x, origin, command, disturbance)

        def settle(x: list, origin: list, numbers: list) -> list:
            return settled(robot.machine_with(numbers), x, origin)

        def turning(x: list, numbers: list) -> list:
            return _speeds(robot.machine_with(numbers), x)

        inputs = {**states, "command": layout.n, "disturbance": layout.nv}
        self._rates = kernels.compile(plant, name="plant", backend=robot.backend, **inputs, **numbers)
        self._settle = self._speeds = None
        if self._strained:
            self._settle = kernels.compile(settle, backend=robot.backend, **states, **numbers)
            self._speeds = kernels.compile(turning, backend=robot.backend, x=layout.state, **numbers)

    def go(self, x: Array, command: Array, disturbance: Array, start: float, end: float) -> None:
        """Take the state x along, in place; where it cannot be followed it becomes NaN."""
        looks = self._strained
        while start < end:
            origin = x.copy()

            def f(_: float, y: Array, origin: Array = origin) -> Array:
                return self._rates(y, origin, command, disturbance, self._parameters)

            stop = end if looks or not self._strained else min(start + PAST_A_TURN * self._period, end)
            events = self._turning_points if looks else None
            found = solve_ivp(f, (start, stop), origin, "DOP853", events=events, rtol=RTOL, atol=ATOL)
            if not found.success:
                x[:] = np.nan
                return
            x[:], start = found.y[:, -1], found.t[-1]
            if self._settle:
                x[:] = self._settle(x, origin, self._parameters)
            looks = self._strained and found.status != 1  # past a turning point a hair without looking for it again

    @cached_property
    def _turning_points(self) -> list[Any]:
        """A function of time and state for each speed that strains follow, 0 where it turns back."""

        def speed(k: int) -> Any:
            def at(_: float, x: Array) -> float:
                assert self._speeds is not None
                return float(self._speeds(x, self._parameters)[k])

            at.terminal = True  # type: ignore[attr-defined]
            return at

        return [speed(k) for k in range(3 * self._drives)]


def _speeds(machine: Any, x: list[Any]) -> list[Any]:
    """Of links, motors and deflections."""
    found = []
    for d, own in zip(machine.drives, own_parts(machine, x), strict=True):
        found += [own.at.v, own.at.theta_dot, transmission(d.drive, own.at.theta) * own.at.theta_dot - own.at.v]
    return found
