"""Bodies as rows of numbers, and a body with its joint from such a row.

Numbers that are the same whole number for all bodies (an axis's zeros, a turn by a quarter) are part of the code; all
others it reads.  So one piece of code, of one size, serves trees of any size.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cutpoint.mechanics.joints import Helical, JointKind, Prismatic, Revolute, about_z
from cutpoint.mechanics.rotors import Spin
from cutpoint.mechanics.spatial import IDENTITY, ZERO, Inertia, Mat3, Pose, Vec3
from cutpoint.mechanics.system import Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]
Array = np.ndarray


@dataclass(frozen=True)
class OneAxis(JointKind):
    """Turns about z by turn q (rad), and slides along it by slide q (m): every joint with one coordinate."""

    turn: Scalar
    slide: Scalar

    @property
    def axes(self) -> tuple[tuple[Scalar, ...], ...]:
        return ((0, 0, self.slide, 0, 0, self.turn),)

    def pose(self, q: Scalars) -> Pose:
        return Pose(about_z(self.turn * q[0]), Vec3(0, 0, self.slide * q[0]))


@dataclass(frozen=True)
class Subsystem:
    """A body with its joint, and the rotor that its parent carries: armature and spin, 0 where there is none."""

    body: Segment
    armature: Scalar
    spin: Spin | None


def unsuited(system: System) -> str | None:
    """A joint that loops do not take, if there is one: they need one coordinate of its own for each body."""
    for body in system.segments:
        if body.follower:
            return f"the joint of {body.name!r}, which follows another"
        if type(body.joint) not in (Revolute, Prismatic, Helical):
            return f"the joint of {body.name!r}, of kind {type(body.joint).__name__.lower()}"
    return None


def rows_of(system: System) -> Array:
    """(n, 28) each body's numbers, in the order of `subsystem`."""
    spins = {spin.joint: spin for spin in system.spins if not spin.elastic}
    return np.array([_row(system, i, spins.get(i)) for i in range(len(system.segments))], dtype=np.float64)


def _row(system: System, i: int, spin: Spin | None) -> list[Scalar]:
    body, joint = system.segments[i], system.segments[i].joint
    R, M = body.placement.rotation, body.inertia
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = M.rotational
    slide = joint.pitch if isinstance(joint, Helical) else int(isinstance(joint, Prismatic))
    screw = (int(not isinstance(joint, Prismatic)), slide)
    placed = (*(x for row in R for x in row), *body.placement.position)
    heavy = (M.mass, *M.first_moment, xx, xy, xz, yy, yz, zz)
    return [*placed, *heavy, *screw, system.armature[i], *(spin.axis if spin else ZERO), spin.geared if spin else 0]


class Columns:
    """Which of the bodies' numbers are code and which are read.

    stated: the first, by column.  read: (n, m), the others.
    """

    def __init__(self, rows: Array) -> None:
        first = rows[0]
        same = (rows == first).all(axis=0) & np.isin(first, (-1.0, 0.0, 1.0))
        self.stated = {int(k): int(first[k]) for k in np.flatnonzero(same)}
        self.read = np.ascontiguousarray(rows[:, ~same])
        self._width = rows.shape[1]

    def subsystem(self, read: Iterable[Scalar]) -> Subsystem:
        """The body whose row holds these."""
        others = iter(read)
        row = iter([self.stated[k] if k in self.stated else next(others) for k in range(self._width)])
        pose = Pose(mat3(row), vec3(row))
        mass, first_moment = next(row), vec3(row)
        xx, xy, xz, yy, yz, zz = (next(row) for _ in range(6))
        inertia = Inertia(mass, first_moment, Mat3(Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)))
        joint, armature, axis, geared = OneAxis(next(row), next(row)), next(row), vec3(row), next(row)
        own = Segment("", WORLD, pose, joint, inertia, slice(0, 1), slice(0, 1), IDENTITY)
        return Subsystem(own, armature, None if is_nothing(geared) else Spin(0, 0, axis, 0, geared, False))


def vec3(numbers: Iterator[Scalar]) -> Vec3:
    """The next three numbers."""
    return Vec3(next(numbers), next(numbers), next(numbers))


def mat3(numbers: Iterator[Scalar]) -> Mat3:
    """The next nine numbers, row by row."""
    return Mat3(vec3(numbers), vec3(numbers), vec3(numbers))


def is_nothing(x: Scalar) -> bool:
    """Whether it is known, when traced, to be 0."""
    return isinstance(x, int) and x == 0
