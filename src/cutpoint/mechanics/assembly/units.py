"""A unit of length in which a robot's most frequent length is 1: products with it vanish from the equations.

The unit of mass changes with it, so that kg m2, N m and J keep their values; angles and time do not change.  So joint
torques of a robot with revolute joints only are the same numbers, from fewer operations.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace

from cutpoint.arrays import Array
from cutpoint.mechanics.assembly.placements import NEGLIGIBLE
from cutpoint.mechanics.bodies.spatial import Inertia, Pose, Vec3
from cutpoint.mechanics.system import Place, System
from cutpoint.model.mechanism import WORLD, Body
from cutpoint.scalars import Scalar, is_plain_zero

PURELY_TURNING = ("revolute", "continuous", "spherical")
"""Kinds whose coordinates and efforts have no length in them."""

_DIGITS = 13
"""After the point, in which lengths that are the same agree, the longest being 1."""

_LEAST = 1e-3
"""Of the longest length: what is shorter is no unit for it."""


def unit_of_length(bodies: Sequence[Body], placements: Iterable[Array]) -> float:
    """The length between joints that occurs most often, the first of equals, m; 1 if some joint slides."""
    if any(body.joint.kind not in PURELY_TURNING for body in bodies):
        return 1.0
    pairs = zip(bodies, placements, strict=True)
    between = [abs(x) for body, T in pairs if body.parent != WORLD for x in T[:3, 3].tolist() if x]
    reach = max(between, default=0.0)
    alike = defaultdict[float, list[float]](list)
    for x in between:
        if x > _LEAST * reach:
            alike[round(x / reach, _DIGITS)].append(x)
    return max(alike.values(), key=len)[0] if alike else 1.0


def in_unit_of_length(system: System, length: float) -> System:
    """The same system with another unit of length, `length` in its present one; if that is not 1, all joints turn."""
    if length == 1.0:
        return system

    def scaled(v: Vec3, by: float) -> Vec3:
        return Vec3(*(_times(x, by) for x in v))

    def moved(X: Pose) -> Pose:
        return Pose(X.rotation, scaled(X.position, 1 / length))

    def weighed(M: Inertia) -> Inertia:
        return Inertia(_times(M.mass, length * length), scaled(M.first_moment, length), M.rotational)

    bodies = [replace(b, placement=moved(b.placement), inertia=weighed(b.inertia)) for b in system.segments]
    frames = {name: Place(place.body, moved(place.pose)) for name, place in system.frames.items()}
    gravity = scaled(system.gravity, 1 / length)
    return replace(system, segments=tuple(bodies), frames=frames, gravity=gravity, length=system.length * length)


def _times(x: Scalar, by: float) -> Scalar:
    """The product, as a whole number where it is 0, 1 or -1 up to rounding, so that it vanishes when traced."""
    if is_plain_zero(x):
        return 0
    product = x * by
    if isinstance(product, float) and abs(abs(product) - 1) <= NEGLIGIBLE:
        return 1 if product > 0 else -1
    return product
