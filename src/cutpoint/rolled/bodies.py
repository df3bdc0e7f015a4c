"""Bodies as rows of numbers, and a body with its joint and its drive from such a row.

Numbers that are the same whole number for all bodies (an axis's zeros, a quarter turn) are part of the code; all others
are read.  So the same code, of fixed size, serves trees of any size.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from cutpoint.mechanics.bodies.joints import Helical, Prismatic
from cutpoint.mechanics.bodies.rigid_body import inertia_of, parameters_of
from cutpoint.mechanics.bodies.rotors import Spin
from cutpoint.mechanics.bodies.spatial import AT_ORIGIN, IDENTITY, ZERO, Mat3, Pose, Vec3
from cutpoint.mechanics.system import Driven, Place, Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.drives import Model, drive_rows, models_of
from cutpoint.rolled.packing import flat, mat3_of, pose_by_columns, pose_of
from cutpoint.rolled.subsystem import OneAxis, Subsystem
from cutpoint.scalars import Scalar, is_plain_zero, rebuild, where

MOUNTING = 12
"""Numbers of the joint's place in the parent: its rotation and position."""

FIELDS = {
    "inertia": 10, "screw": 2, "armature": 1, "rotor's axis": 3, "geared momentum": 1,
    "sprung momentum": 1, "sprung inertia": 1, "number": 1, "last carried": 1,
}  # fmt: skip
"""All else about a body, in order, and how many numbers each takes; those of its drive follow.

A rotor's momentum is that at unit speed: of one rigidly geared, or of one behind a spring.
"""

_ENDS = dict(zip(FIELDS, accumulate(FIELDS.values()), strict=True))
BODY, SPRUNG = _ENDS["last carried"], _ENDS["sprung momentum"] - 1

BASE = -2
"""Where a body's number is asked for, a base that moves freely."""

BASE_NUMBERS = MOUNTING + FIELDS["inertia"] + FIELDS["last carried"]
"""Of a base that moves freely."""


def rooted(system: System) -> System:
    """The same trees, with the first joint of each at the world's origin, so that sums about it lose no digits.

    The joints' results do not change.
    """
    roots = [replace(body, placement=Pose(body.placement.rotation, ZERO)) for body in system.segments]
    pairs = zip(system.segments, roots, strict=True)
    return replace(system, segments=tuple(root if body.parent == WORLD else body for body, root in pairs))


def base_of(system: System) -> Segment | None:
    """The first body, if its joint has several axes; all others are numbered from the one after it."""
    first = system.segments[0]
    return first if len(first.joint.axes) > 1 else None


def bodies_of(system: System) -> range:
    """All bodies but the base."""
    return range(int(base_of(system) is not None), len(system.segments))


def parents_of(system: System) -> np.ndarray:
    """(n,) numbers of the bodies' parents, WORLD or BASE."""
    given = np.array([body.parent for body in system.segments])
    return given if base_of(system) is None else np.where(given > 0, given - 1, np.where(given == 0, BASE, WORLD))[1:]


def place_of(system: System, frame: str) -> Place:
    """A frame's body, by number, WORLD or BASE, and the frame's pose in it."""
    place, first = system.frames[frame], int(base_of(system) is not None)
    return place if place.body == WORLD else Place(place.body - first if place.body >= first else BASE, place.pose)


def base_row(system: System) -> np.ndarray:
    """(BASE_NUMBERS,) the base's numbers."""
    base = system.segments[0]
    return np.array([*_mounting(base), *parameters_of(base.inertia), _last_carried(system)[0] - 1.0])


def columns_of(system: System, drives: Sequence[Driven] = (), *, user_axes: bool = False) -> "Columns":
    """drives: those whose numbers are read.  user_axes: whether `Columns.to_user_axes` will be used."""
    spins, last, bodies = {spin.joint: spin for spin in system.spins}, _last_carried(system), bodies_of(system)
    mountings = [_mounting(system.segments[i]) for i in bodies]
    rows = [[*_row(system, i, spins.get(i)), i - bodies.start, last[i] - bodies.start] for i in bodies]
    own = np.hstack([np.array(rows, dtype=np.float64), drive_rows(bodies, drives)])
    if user_axes:
        own = np.hstack([own, [[x for row in system.segments[i].to_user_axes for x in row] for i in bodies]])
    return Columns(np.array(mountings, dtype=np.float64), own, models_of(bodies, drives), base_of(system))


def _last_carried(system: System) -> list[int]:
    """For each body the highest number in its subtree: mechanisms are in depth-first order."""
    last = [*range(len(system.segments))]
    for i, body in reversed([*enumerate(system.segments)]):
        if body.parent != WORLD:
            last[body.parent] = max(last[body.parent], last[i])
    return last


def _mounting(body: Segment) -> list[Scalar]:
    return [*flat(body.placement.rotation), *body.placement.position]


def _row(system: System, i: int, spin: Spin | None) -> list[Scalar]:
    body, joint = system.segments[i], system.segments[i].joint
    slide = joint.pitch if isinstance(joint, Helical) else int(isinstance(joint, Prismatic))
    screw = (int(not isinstance(joint, Prismatic)), slide)
    return [*parameters_of(body.inertia), *screw, system.armature[body.v.start], *_coupling(spin)]


def _coupling(spin: Spin | None) -> list[Scalar]:
    """A rotor's axis, and its momentum at unit speed: rigidly geared, or behind a spring with its own inertia."""
    if spin is None:
        return [0] * 6
    return [*spin.axis, *((0, spin.geared, spin.inertia) if spin.elastic else (spin.geared, 0, 0))]


class Rows(NamedTuple):
    """Numbers of all bodies.  stated: those built into the code, by column.  read: (n, ...) the others."""

    stated: dict[int, int]
    read: np.ndarray

    @classmethod
    def of(cls, rows: np.ndarray) -> "Rows":
        first = rows[0]
        same = (rows == first).all(axis=0) & np.isin(first, (-1.0, 0.0, 1.0))
        return cls({int(k): int(first[k]) for k in np.flatnonzero(same)}, np.ascontiguousarray(rows[:, ~same]))

    def whole(self, read: Iterable[Scalar]) -> list[Scalar]:
        """A row, from what is read of it."""
        others, width = iter(read), len(self.stated) + self.read.shape[1]
        return [self.stated[k] if k in self.stated else next(others) for k in range(width)]


class Columns:
    """The bodies' numbers.

    read: those that are not built into the code, by the region that holds them: "mounting", (n, ...) of the joint's
    place in the parent, and "body", (n, ...) of all else.  sizes: of their rows.  bodies: n.  base: its joint, if there
    is one, and its `Segment.to_user_axes`.  are_coupled: whether rotors with full coupling are behind springs.
    """

    def __init__(
        self, mountings: np.ndarray, rows: np.ndarray, models: Sequence[Model] = (), base: Segment | None = None
    ) -> None:
        """models: of the drives' structures."""
        self.base, self.models, self.bodies = base.joint if base else None, models, len(rows)
        self.base_to_user_axes = base.to_user_axes if base else IDENTITY
        self.are_coupled = bool(rows[:, SPRUNG].any())
        self._mounting, self._body = Rows.of(mountings), Rows.of(rows)
        self.read = {"mounting": self._mounting.read, "body": self._body.read}
        self.sizes = {name: numbers.shape[1] for name, numbers in self.read.items()}

    def mounting(self, read: Iterable[Scalar]) -> Pose:
        """The joint's place in the parent, for the body whose row holds these."""
        return pose_of(self._mounting.whole(read))

    def subsystem(self, read: Iterable[Scalar]) -> Subsystem:
        """The body whose row holds these, as if its joint were at its parent's origin."""
        row = self._body.whole(read)
        of = {name: row[end - FIELDS[name] : end] for name, end in _ENDS.items()}
        joint, inertia = OneAxis(*of["screw"]), inertia_of(of["inertia"])
        own = Segment("", WORLD, AT_ORIGIN, joint, inertia, slice(0, 1), slice(0, 1), IDENTITY)
        axis, (J,) = Vec3(*of["rotor's axis"]), of["sprung inertia"]
        (geared,), (sprung,) = of["geared momentum"], of["sprung momentum"]
        spin = None if is_plain_zero(geared) else Spin(0, 0, axis, 0, geared, False)
        behind = None if is_plain_zero(sprung) else Spin(0, 0, axis, J, sprung, True)
        (armature,), (number,), (last,) = of["armature"], of["number"], of["last carried"]
        return Subsystem(own, armature, spin, number, last, behind)

    def along_the_world(self, read: Iterable[Scalar], turned: Sequence[Scalar]) -> Subsystem:
        """The same along the world's axes.  turned: the twelve numbers of its pose, by columns."""
        return self.subsystem(read).along_the_world(pose_by_columns(turned))

    def to_user_axes(self, read: Iterable[Scalar]) -> Mat3:
        """The user's axes of the body whose row holds these, along its own axes."""
        return mat3_of(self._body.whole(read)[-9:])

    def by_drive(self, read: Iterable[Scalar], step: Callable[[Model], list[Scalar]]) -> list[Scalar]:
        """The result of a step for the drive of the body whose row holds these."""
        kind, *row = self._body.whole(read)[BODY:]
        numbers, found = iter(row), list[Scalar]()
        for k, model in enumerate(self.models):
            own = step(rebuild(model, numbers))
            found = [where(kind < k, x, y) for x, y in zip(found, own, strict=True)] if k else own
        return found
