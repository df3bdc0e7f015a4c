"""Components of a measured deflection besides the spring's: a column of samples for each unknown."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.kernels import Loop, Program, Region, Stage, compile_program
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.model.drive import Harmonic

NEARBY = 0.02
"""Step for derivatives, as a share of a reach: slipping elements reverse at samples, not between them."""


def wave_columns(motor_angle: Array, orders: Sequence[int]) -> Array:
    """Sine and cosine (N, 2 k) of k waves per turn of the motor, at its angle (N,), rad."""
    parts = [wave(order * motor_angle) for order in orders for wave in (np.sin, np.cos)]
    return np.column_stack(parts) if parts else np.empty((motor_angle.size, 0))


def wave_slopes(motor_angle: Array, orders: Sequence[int]) -> Array:
    """Derivatives (N, 2 k) of `wave_columns` by the motor's angle."""
    parts = [order * wave(order * motor_angle) for order in orders for wave in (np.cos, lambda x: -np.sin(x))]
    return np.column_stack(parts) if parts else np.empty((motor_angle.size, 0))


def waves(orders: Sequence[int], weights: Array) -> KinematicError | None:
    """The kinematic error with these weights of sines and cosines (2 k,), rad; None for no orders."""
    pairs = weights.reshape(-1, 2)
    found = [
        Harmonic(order, float(np.hypot(s, c)), float(np.arctan2(c, s)))
        for order, (s, c) in zip(orders, pairs, strict=True)
    ]
    return KinematicError(tuple(found)) if found else None


def amplitude_errors(weights: Array, covariance: Array) -> Array:
    """Standard deviations (k,) of the amplitudes of k waves, from their weights (2 k,) and the weights' covariance."""
    found = []
    for k, pair in enumerate(weights.reshape(-1, 2)):
        along = pair / max(float(np.hypot(*pair)), np.finfo(float).tiny)
        found.append(along @ covariance[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] @ along)
    return np.sqrt(np.array(found))


def strain_columns(deflection: Array, reaches: Array) -> Array:
    """Strains (N, k) of elements that slip beyond reaches (k,), rad, along a deflection (N,), initially zero.

    Where the deflection is unknown, the strain is held.
    """
    known = np.isfinite(deflection)
    path = deflection[np.flatnonzero(known)[np.maximum(np.cumsum(known) - 1, 0)]]
    found = np.empty((path.size, reaches.size))
    if found.size:
        elements, started = np.array(reaches, float), {"at": path[:1].copy(), "strains": np.zeros(reaches.size)}
        _slipping(reaches.size).run(
            {"samples": path.size}, path=path[:, None], reaches=elements, found=found, **started
        )
    return found


@lru_cache
def _slipping(elements: int) -> Program:
    """Follows the strains of so many elements along a path, sample by sample."""

    def slip(path: Any, at: Any, strains: Any, reaches: Any) -> Any:
        after = MaxwellSlip((), tuple(reaches)).strains(tuple(strains), path[0] - at[0])
        return path, [*after], [*after]

    stage = Stage(slip, ("path", "at", "strains", "reaches"), ("at", "strains", "found"))
    sizes = {"path": 1, "at": 1, "strains": elements, "reaches": elements, "found": elements}
    regions = [Region(name, size) for name, size in sizes.items()]
    return compile_program(Loop("samples", [stage], ("path", "found")), regions, name="strains")


def reach_columns(deflection: Array, stiffness: Array, reaches: Array) -> Array:
    """Derivatives (N, k), N m/rad, of elements' torques by their reaches."""
    ends = [strain_columns(deflection, reaches * (1.0 + x)) for x in (NEARBY, -NEARBY)]
    return stiffness * (ends[0] - ends[1]) / (2.0 * NEARBY * reaches)


def paired(stiffness: Array, reaches: Array, ratio: float) -> tuple[Array, Array]:
    """Elements (k,) after merging pairs whose reaches differ by at most a factor `ratio`; stiffnesses add up.

    One element that slips between two of the offered reaches is estimated as these two.
    """
    found: list[tuple[float, float]] = []
    left = [(float(k), float(r)) for k, r in zip(stiffness, reaches, strict=True) if k > 0.0]
    while left:
        k, r = left.pop(0)
        if left and left[0][1] <= ratio * r:
            other, longer = left.pop(0)
            k, r = k + other, (k * r + other * longer) / (k + other)
        found.append((k, r))
    both = np.array(found).reshape(-1, 2)
    return both[:, 0], both[:, 1]


def slipping(stiffness: Array, reaches: Array) -> MaxwellSlip | None:
    """Elements as a hysteresis model of the drive; None if there are none."""
    used = stiffness > 0.0
    return MaxwellSlip(tuple(stiffness[used].tolist()), tuple(reaches[used].tolist())) if used.any() else None
