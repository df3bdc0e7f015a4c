"""Numeric poses (4, 4), child to parent, cleaned of rounding errors."""

from math import cos, sin

import numpy as np

from cutpoint.arrays import Array

NEGLIGIBLE = 1e-13
"""A number this small beside 1, or beside others of its kind, is taken for 0.

It is above the rounding of a product of poses (1e-15) and below what files mean, or miss: 1.57079632679 for a quarter
turn is off by 5e-12, and stays so.  Along an arm of n joints torques move by less than 4 n NEGLIGIBLE of their scale.
"""


def about_z(angle: float) -> Array:
    """A turn about z (rad), exact for quarter turns."""
    turn = np.eye(4)
    c, s = (round(x) if abs(x - round(x)) <= NEGLIGIBLE else x for x in (cos(angle), sin(angle)))
    turn[:2, :2] = (c, -s), (s, c)
    return turn


def shift(by: Array) -> Array:
    """A translation by (3,), m."""
    moved = np.eye(4)
    moved[:3, 3] = by
    return moved


def inverse(T: Array) -> Array:
    R_T = T[:3, :3].T
    back = np.eye(4)
    back[:3, :3], back[:3, 3] = R_T, -R_T @ T[:3, 3]
    return back


def joined(*factors: Array) -> Array:
    """The product, with exact 0, 1 and -1 where only rounding differs from them."""
    product, reach = factors[0].copy(), np.abs(factors[0][:3, 3]).max()
    for T in factors[1:]:
        product, reach = product @ T, reach + np.abs(T[:3, 3]).max()
    R, p = product[:3, :3], product[:3, 3]
    whole = np.round(R)
    near = np.abs(R - whole) <= NEGLIGIBLE
    R[near] = whole[near]
    p[np.abs(p) <= NEGLIGIBLE * reach] = 0.0
    return product + 0.0
