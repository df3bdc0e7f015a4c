"""Bodies as rows of numbers, and a body with its joint and its drive from such a row.

Numbers that are the same whole number for all bodies (an axis's zeros, a turn by a quarter) are part of the code; all
others it reads.  So one piece of code, of one size, serves trees of any size.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from cutpoint.mechanics.elastic import Driven
from cutpoint.mechanics.joints import Helical, Prismatic
from cutpoint.mechanics.rotors import Spin
from cutpoint.mechanics.spatial import IDENTITY, ZERO, Inertia, Mat3, Pose, Vec3
from cutpoint.mechanics.system import Segment, System
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.subsystem import OneAxis, Subsystem, is_nothing, mat3, vec3
from cutpoint.scalars import Scalar, leaves, rebuild

Array = np.ndarray

BODY = 31
"""Numbers of a body and its joint; those of its drive follow."""


def rows_of(system: System, drives: Sequence[Driven] = ()) -> Array:
    """(n, BODY and more) each body's numbers, in the order of `subsystem`, and its drive's, one for each if any."""
    spins = {spin.joint: spin for spin in system.spins if not spin.elastic}
    last = _last_carried(system)
    rows = [[*_row(system, i, spins.get(i)), i, last[i]] for i in range(len(system.segments))]
    for driven in drives:
        rows[driven.segment] += leaves(driven.drive)
    return np.array(rows, dtype=np.float64)


def _last_carried(system: System) -> list[int]:
    """For each body the highest number of a body that it carries, or its own: mechanisms are in depth-first order."""
    last = [*range(len(system.segments))]
    for i, body in reversed([*enumerate(system.segments)]):
        if body.parent != WORLD:
            last[body.parent] = max(last[body.parent], last[i])
    return last


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

    stated: the first, by column.  read: (n, width), the others.
    """

    def __init__(self, rows: Array, drives: Sequence[Driven] = ()) -> None:
        """drives: of which the first serves as a model of all."""
        first = rows[0]
        same = (rows == first).all(axis=0) & np.isin(first, (-1.0, 0.0, 1.0))
        self.stated = {int(k): int(first[k]) for k in np.flatnonzero(same)}
        self.read = np.ascontiguousarray(rows[:, ~same])
        self.width = self.read.shape[1]
        self._columns = rows.shape[1]
        self._drive = drives[0].drive if drives else None

    def subsystem(self, read: Iterable[Scalar]) -> Subsystem:
        """The body whose row holds these."""
        row = iter(self._whole(read))
        pose = Pose(mat3(row), vec3(row))
        mass, first_moment = next(row), vec3(row)
        xx, xy, xz, yy, yz, zz = (next(row) for _ in range(6))
        inertia = Inertia(mass, first_moment, Mat3(Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)))
        joint, armature, axis, geared = OneAxis(next(row), next(row)), next(row), vec3(row), next(row)
        number, last = next(row), next(row)
        own = Segment("", WORLD, pose, joint, inertia, slice(0, 1), slice(0, 1), IDENTITY)
        spin = None if is_nothing(geared) else Spin(0, 0, axis, 0, geared, False)
        return Subsystem(own, armature, spin, number, last)

    def drive(self, read: Iterable[Scalar]) -> Drive:
        """The drive of the body whose row holds these."""
        return rebuild(self._drive, iter(self._whole(read)[BODY:]))

    def _whole(self, read: Iterable[Scalar]) -> list[Scalar]:
        others = iter(read)
        return [self.stated[k] if k in self.stated else next(others) for k in range(self._columns)]
