"""Adaptive integration between two samples, the reference for fixed steps."""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from cutpoint import kernels
from cutpoint.arrays import Array
from cutpoint.definitions import Machine
from cutpoint.mechanics.drives import strains
from cutpoint.mechanics.drives.harmonic_drive import transmission
from cutpoint.mechanics.drives.strains import Strains
from cutpoint.mechanics.elastic_forward import drive_effort, driven_accelerations
from cutpoint.model.drive import Drive
from cutpoint.simulation.loop.loop import BEYOND, ClosedLoop
from cutpoint.simulation.plant import Own, all_rates, arrived, by_drive, shaft_and_current, split

Scalars = list[Any]

RTOL, ATOL = 1e-12, 1e-13

PAST_A_TURN = 1e-4
"""Share of a period that is integrated without looking for turning points after one."""


def adaptive_step(loop: ClosedLoop) -> Callable[[dict[str, Array], Array], None]:
    """A function that advances the loop's memory by one control period: DOP853, Hairer et al. (1993) section II.5.

    Bristles follow their differential equation; elements of hysteresis are updated at each reversal of a drive;
    commands change when they arrive.
    """
    way = _Way(loop)
    delays = [d.motor.delay for d in loop.robot.drives.values() if d.motor is not None and d.motor.delay]
    ends = sorted({*delays, loop.period})

    def step(memory: dict[str, Array], row: Array) -> None:
        pushed, start = np.array(loop.layout.disturbance([*row]), float), 0.0
        x = np.array(loop.lanes.dense(memory["state"]))
        with np.errstate(all="ignore"):  # numbers that are not finite end the run below
            for end in ends:
                now, before = (loop.lanes.dense(memory[name]) for name in ("torque", "torque_before"))
                commands = zip(loop.robot.machine.drives, now, before, strict=True)
                middle, length = (start + end) / 2, end - start
                torque = [arrived(d.drive, u, old, middle, length) for d, u, old in commands]
                way.go(x, np.array(torque, float), pushed, start, end)
                start = end
        end_period(loop, memory, x)

    return step


def end_period(loop: ClosedLoop, memory: dict[str, Array], x: Array) -> None:
    """Stores the state at the end of a period, and whether it has diverged."""
    memory["state"][:] = loop.lanes.padded(x)
    memory["fault"][0] = not (np.abs(memory["state"]) < BEYOND).all()


class _Way:
    """Integration under held commands, kernels compiled once."""

    def __init__(self, loop: ClosedLoop) -> None:
        robot, layout = loop.robot, loop.layout
        self._parameters, self._period = robot.drive_parameters, loop.period
        self._slipping = [k for k, d in enumerate(robot.drives.values()) if d.hysteresis]
        numbers: dict[str, Any] = {"numbers": len(self._parameters)}
        states: dict[str, Any] = {"x": layout.state, "origin": layout.state}

        def plant(x: Scalars, origin: Scalars, command: Scalars, disturbance: Scalars, numbers: Scalars) -> Scalars:
            return plant_rates(robot.machine_with(numbers), x, origin, command, disturbance)

        def settle(x: Scalars, origin: Scalars, numbers: Scalars) -> Scalars:
            return _settled(robot.machine_with(numbers), x, origin)

        def turning(x: Scalars, numbers: Scalars) -> Scalars:
            return _winding_speeds(robot.machine_with(numbers), x)

        inputs = {**states, "command": layout.n, "disturbance": layout.nv}
        self._rates = kernels.compile(plant, name="plant", backend=robot.backend, **inputs, **numbers)
        self._settle = self._speeds = None
        if self._slipping:
            self._settle = kernels.compile(settle, backend=robot.backend, **states, **numbers)
            self._speeds = kernels.compile(turning, backend=robot.backend, x=layout.state, **numbers)

    def go(self, x: Array, command: Array, disturbance: Array, start: float, end: float) -> None:
        """Integrates the state x in place; it becomes NaN if integration fails."""
        looks = bool(self._slipping)
        while start < end:
            origin = x.copy()

            def f(_: float, y: Array, origin: Array = origin) -> Array:
                return self._rates(y, origin, command, disturbance, self._parameters)

            stop = end if looks or not self._slipping else min(start + PAST_A_TURN * self._period, end)
            events = self._turning_points if looks else None
            found = solve_ivp(f, (start, stop), origin, "DOP853", events=events, rtol=RTOL, atol=ATOL)
            if not found.success:
                x[:] = np.nan
                return
            x[:], start = found.y[:, -1], found.t[-1]
            if self._settle:
                x[:] = self._settle(x, origin, self._parameters)
            looks = bool(self._slipping) and found.status != 1  # after a turning point, a short stretch without events

    @cached_property
    def _turning_points(self) -> list[Any]:
        """A function of time and state for each drive with hysteresis, 0 at reversals of its spring."""

        def speed(k: int) -> Any:
            def at(_: float, x: Array) -> float:
                assert self._speeds is not None
                return float(self._speeds(x, self._parameters)[k])

            at.terminal = True  # type: ignore[attr-defined]
            return at

        return [speed(k) for k in self._slipping]


def plant_rates(machine: Machine, x: Scalars, origin: Scalars, command: Scalars, disturbance: Scalars) -> Scalars:
    """dx/dt, on a path from origin without reversals of springs."""
    efforts, electric, winding = [], [], []
    for d, own, past, u in zip(machine.drives, by_drive(machine, x), by_drive(machine, origin), command, strict=True):
        held = _stretched(d.drive, own, past)
        shaft, rate = shaft_and_current(d.drive, own, u)
        effort = drive_effort(d.drive, own.at, shaft, held)
        efforts.append(effort)
        electric += rate
        winding.append(strains.rates(d.drive, held, own.at, effort.transmitted if d.drive.is_elastic else 0))
    s = split(machine, x)
    a, alpha = driven_accelerations(*machine, s.q, s.v, s.theta_dot, efforts, disturbance)
    return [*all_rates(machine, s, a, alpha, electric), *strains.gathered(winding)]


def _stretched(drive: Drive, own: Own, past: Own) -> Strains:
    """The drive's strains, those of its spring's elements stretched since the origin."""
    return own.strains._replace(spring=strains.moved(drive, past.strains, past.at, own.at).spring)


def _settled(machine: Machine, x: Scalars, origin: Scalars) -> Scalars:
    parts = zip(machine.drives, by_drive(machine, x), by_drive(machine, origin), strict=True)
    hands = [strains.flat(_stretched(d.drive, own, past)) for d, own, past in parts]
    return [*x[: len(x) - sum(map(len, hands))], *strains.gathered(hands)]


def _winding_speeds(machine: Machine, x: Scalars) -> Scalars:
    """d deflection / dt of each drive."""
    parts = zip(machine.drives, by_drive(machine, x), strict=True)
    return [transmission(d.drive, own.at.theta) * own.at.theta_dot - own.at.v for d, own in parts]
