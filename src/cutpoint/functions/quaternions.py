"""Quaternions among a robot's coordinates: where they are, and functions that refuse zero ones."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.kernels.arrays.backends import chosen
from cutpoint.mechanics.bodies.joints import Floating, Spherical
from cutpoint.mechanics.system import System
from cutpoint.model import Mechanism

Function = Callable[..., Any]

SHORTEST = 1e-50
"""A quaternion with no number beyond it counts as zero: its length to the fourth, which derivatives divide by, is."""


def quaternions_of(mechanism: Mechanism, system: System) -> dict[str, slice]:
    """Positions of the quaternions in q, by the joint's name."""
    pairs = zip(mechanism.bodies, system.segments, strict=True)
    kinds = (Spherical, Floating)
    return {b.joint.name: slice(s.q.stop - 4, s.q.stop) for b, s in pairs if isinstance(s.joint, kinds)}


def check_quaternions(function: str, name: str, q: Array, quaternions: Mapping[str, slice]) -> None:
    """Raises InputError for a zero quaternion in q (..., nq), which has no orientation."""
    for joint, own in quaternions.items():
        if (np.abs(q[..., own.stop - 1]) > SHORTEST).all():  # the usual case, and checking one number is fast
            continue
        zero = (np.abs(q[..., own]) <= SHORTEST).all(axis=-1)
        if zero.any():
            where = "".join(f"[{', '.join(map(str, place))}]" for place in np.argwhere(zero)[:1] if zero.ndim)
            found = f"the quaternion of joint {joint!r} is zero in {name}{where}"
            raise InputError(f"{function}: {found}; start from robot.neutral()", name=name, joint=joint)


def with_quaternions(
    function: Function, name: str, inputs: Sequence[str], quaternions: Mapping[str, slice], nq: int, backend: str
) -> Function:
    """The function with checks of the quaternions among its inputs, each (..., nq)."""
    places = {k: key for k, key in enumerate(inputs) if key in ("q", "q_next")}
    if not places:
        return function

    def checked(*given: Any) -> Any:
        found = function(*given)  # checks them first: they are numbers of the right size
        for k, key in places.items():
            check_quaternions(name, key, np.asarray(given[k], np.float64), quaternions)
        return found

    if chosen(backend) != "llvm":
        return checked
    from cutpoint.kernels.arrays.looking import looking

    last = [own.stop - 1 for own in quaternions.values()]
    return looking(function, checked, name, [*places], last, nq, SHORTEST)
