"""Estimated operation counts of a model's numbers in inverse dynamics: the criterion for choosing frames.

Entries that are 0 cost nothing, and those of a rotation that are 1 or -1 half.  A rotation is multiplied with three
vectors outward and two inward: two operations each for an entry, or 20 where it turns two numbers.  A position enters
one product outward and one inward; an entry of an inertia, about one for each axis.
"""

from math import atan2, hypot, pi

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.assembly.placements import NEGLIGIBLE, about_z, joined

TURNING = ("revolute", "continuous")
"""Kinds that may turn by a constant beside their coordinate."""


def inertia_cost(P: Array) -> float:
    """Of a pseudo-inertia (4, 4)."""
    squares, products = np.count_nonzero(np.diag(P)[:3]), np.count_nonzero(P[[0, 0, 1], [1, 2, 2]])
    return 4.0 * squares + 9 * products + 10 * np.count_nonzero(P[:3, 3]) + 6 * np.count_nonzero(P[3, 3])


def rotation_cost(T: Array, turning: bool) -> float:
    """Of a placement's rotation, with or without the joint's turn about z after it."""
    R, total = T[:3, :3].tolist(), 0.0
    for a, b, c in R:
        if turning and (a or b):
            total += 20 + (6 if a and b else 2 * (abs(a + b) != 1.0))
        elif not turning:
            total += sum(5 if abs(x) == 1.0 else 10 for x in (a, b) if x)
        total += (5 if abs(c) == 1.0 else 10) if c else 0
    return total + 0.1 * sum(x < 0.0 for row in R for x in row)  # fewer minus signs decide between equal costs


def position_cost(T: Array) -> float:
    return 7.0 * np.count_nonzero(T[:3, 3])


def least_position_cost(T: Array) -> float:
    """Of the position that remains when both frames are shifted along their z axes to the common normal."""
    (x, y, _), p = T[:3, 2], T[:3, 3]
    across = hypot(x, y)
    if across <= NEGLIGIBLE:
        return 7.0 * np.count_nonzero(p[:2])
    normal = np.array([-y, x, 0.0]) / across
    meeting = abs(normal @ p) <= NEGLIGIBLE * np.abs(p).sum()
    return 0.0 if meeting else 7.0 * np.count_nonzero(np.abs(normal) > NEGLIGIBLE)


def cheapest_zero(T: Array, kind: str) -> tuple[Array, float]:
    """The cheapest equivalent of a placement: another placement, and an offset of the joint's coordinate (rad)."""
    best, least = (T, 0.0), rotation_cost(T, True)
    for a, b, _ in T[:3, :3].tolist() if kind in TURNING else ():
        if a and b:
            angle = within_quarter(atan2(b, a))
            turned = joined(T, about_z(angle))
            cost = rotation_cost(turned, True) + 1
            if cost < least:
                best, least = (turned, -angle), cost
    return best


def within_quarter(angle: float) -> float:
    """The angle modulo quarter turns, which only rename axes."""
    return angle - round(angle / (pi / 2)) * pi / 2
