"""A segment in the form of the classical formulations: mass, centroid, and inertia about the centroid."""

from dataclasses import dataclass

from cutpoint.mechanics.bodies.spatial import IDENTITY, Inertia, Mat3, Pose, Vec3
from cutpoint.mechanics.system import System
from cutpoint.scalars import Scalar

Z = Vec3(0, 0, 1)
"""Every joint's axis, in its own frame and, as it turns about itself, in the unmoved one."""


@dataclass(frozen=True, eq=False)
class Link:
    """placement: its pose at some q in the link before it.  com (m), inertia about it (kg m2): in its own frame."""

    placement: Pose
    mass: Scalar
    com: Vec3
    inertia: Mat3


def links(system: System, q: list[Scalar]) -> list[Link]:
    """The links of a chain of revolute joints at q (rad)."""
    return [
        Link(body.placement @ body.joint.pose([q_i]), body.inertia.mass, *_about_centroid(body.inertia))
        for body, q_i in zip(system.segments, q, strict=True)
    ]


def _about_centroid(M: Inertia) -> tuple[Vec3, Mat3]:
    """Centroid and inertia about it, by the parallel axis theorem."""
    c = M.first_moment * (1 / M.mass)
    across = IDENTITY * c.dot(c) - Mat3(*(c * c_i for c_i in c))
    return c, M.rotational - across * M.mass
