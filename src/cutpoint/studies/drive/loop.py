"""Torque over deflection with the wave generator blocked: a drive's spring and hysteresis in a cycle."""

from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from cutpoint.arrays import Array
from cutpoint.model.drive import Compliance, Drive


class SpringState(NamedTuple):
    """Deflection of a drive's spring, rad, and the strains of the elements of hysteresis beside it, rad."""

    deflection: float
    strains: tuple[float, ...]


class Loop(NamedTuple):
    """One cycle, in steady state: from the lower end up to the upper one, and back.  Arrays (n,), rad and N m."""

    up: tuple[Array, Array]
    down: tuple[Array, Array]
    width: float
    """Between the branches at zero torque, rad."""
    span: float
    """Between the ends, rad."""


def cycle(drive: Drive, peak: float, points: int = 400) -> Loop:
    """The loop between torques -peak and peak, N m."""
    ends = [_relaxed(drive)]
    for torque in (peak, -peak, peak, -peak):
        ends.append(state_at(drive, ends[-1], torque))
    low, high = ends[-1], ends[-2]
    zero = [state_at(drive, end, 0.0).deflection for end in (low, high)]
    paths = [np.linspace(low.deflection, high.deflection, points), np.linspace(high.deflection, low.deflection, points)]
    up, down = ((path, branch(drive, end, path)) for end, path in zip((low, high), paths, strict=True))
    return Loop(up, down, abs(zero[1] - zero[0]), high.deflection - low.deflection)


def state_at(drive: Drive, start: SpringState, torque: float) -> SpringState:
    """Where a torque is reached, in one direction from `start`."""
    spring = _spring(drive)
    slipping = float(drive.hysteresis.torque(drive.hysteresis.reach)) if drive.hysteresis else 0.0
    bound = float(spring.deflection(abs(torque) + slipping)) * (1 + 1e-9) + 1e-12
    deflection: Any = brentq(lambda x: float(branch(drive, start, x)) - torque, -bound, bound, xtol=1e-16)
    return SpringState(deflection, _strains(drive, start, deflection))


def branch(drive: Drive, start: SpringState, deflection: Any) -> Any:
    """Torque at deflections on one side of `start`, N m."""
    torque = _spring(drive).torque(deflection)
    if drive.hysteresis is None:
        return torque
    return torque + drive.hysteresis.torque(_strains(drive, start, deflection))


def _relaxed(drive: Drive) -> SpringState:
    return SpringState(0.0, (0.0,) * len(drive.hysteresis.reach) if drive.hysteresis else ())


def _strains(drive: Drive, start: SpringState, deflection: Any) -> tuple[Any, ...]:
    return drive.hysteresis.strains(start.strains, deflection - start.deflection) if drive.hysteresis else ()


def _spring(drive: Drive) -> Compliance:
    assert drive.compliance is not None, "a rigid drive has no loop"
    return drive.compliance
