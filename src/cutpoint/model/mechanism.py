"""The structure of a robot, before any equation: a tree of bodies, the joints that carry them, named frames.

Plain numbers in SI units, immutable.  `build` (see `build.py`) validates and makes them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from cutpoint.arrays import Array

JointKind = Literal[
    "fixed", "revolute", "continuous", "prismatic", "helical", "universal", "planar", "spherical", "floating"
]

DRIVEN_KINDS: tuple[JointKind, ...] = ("revolute", "continuous", "prismatic")
"""Kinds that a drive may move."""

WORLD = -1
"""Index of the world where the index of a body is asked for."""

STANDARD_GRAVITY = (0.0, 0.0, -9.81)


class Immutable:
    """Holds read-only arrays and dictionaries of its own: they cannot be changed through the originals, in a copy, or
    after unpickling."""

    def __post_init__(self) -> None:
        vars(self).update({name: frozen(value) for name, value in vars(self).items()})

    def __reduce__(self) -> tuple[Any, ...]:
        values = (dict(x) if isinstance(x, MappingProxyType) else x for x in vars(self).values())
        return type(self), tuple(values)


def frozen(value: Any) -> Any:
    """A copy that cannot be written to, of an array (float64 if it holds real numbers) or a dictionary."""
    if isinstance(value, np.ndarray):
        copy = np.array(value, np.float64 if value.dtype.kind in "iuf" else value.dtype)
        copy.flags.writeable = False
        return copy
    return MappingProxyType(dict(value)) if isinstance(value, (dict, MappingProxyType)) else value


@dataclass(frozen=True, eq=False)
class Link(Immutable):
    """A rigid piece as a file describes it.

    mass in kg; com (3,) in m in the link's frame; inertia (3, 3) in kg m2 about the com, along the link's axes.
    """

    name: str
    mass: float = 0.0
    com: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))


@dataclass(frozen=True)
class Limits:
    """Bounds of a joint: position (rad or m), speed (rad/s or m/s), effort (N m or N); infinite where not stated."""

    lower: float = -np.inf
    upper: float = np.inf
    velocity: float = np.inf
    effort: float = np.inf


UNLIMITED = Limits()


@dataclass(frozen=True)
class Mimic:
    """A coordinate that follows another: q = multiplier * q[joint] + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class Joint(Immutable):
    """How a child link moves on its parent.

    placement (4, 4): the joint's frame, at coordinate zero, in the parent's frame; it is the child's frame too.
    axis (3,): unit vector in the joint's frame (unused for fixed, spherical and floating joints).
    pitch: of a helical joint, m/rad.  second_axis: of a universal joint, in the frame that its first axis turned.
    damping (N m s/rad or N s/m) and friction (N m or N) as a URDF's <dynamics> states them.
    """

    name: str
    kind: JointKind
    parent: str
    child: str
    placement: Array = field(default_factory=lambda: np.eye(4))
    axis: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    limits: Limits = UNLIMITED
    damping: float = 0.0
    friction: float = 0.0
    pitch: float = 0.0
    second_axis: Array | None = None
    mimic: Mimic | None = None


@dataclass(frozen=True, eq=False)
class Body(Immutable):
    """A moving link with all that is fixed to it, and the joint that carries it.

    parent: index of the carrying body, or WORLD.  placement (4, 4): the joint's frame in that body's frame.
    mass, com, inertia: of the lumped body, in its own frame, as in Link.
    """

    name: str
    joint: Joint
    parent: int
    placement: Array
    mass: float
    com: Array
    inertia: Array


@dataclass(frozen=True, eq=False)
class Frame(Immutable):
    """A named place on a body (or in the world, WORLD): placement (4, 4) in the body's frame."""

    name: str
    body: int
    placement: Array


@dataclass(frozen=True, eq=False)
class Mechanism(Immutable):
    """A robot as a tree of bodies, parents before children, in the file's depth-first order.

    gravity (3,): acceleration of free fall in the world's frame, m/s2.
    coupled: whether mimic joints follow their leader (True) or are coordinates of their own.
    """

    name: str
    bodies: tuple[Body, ...]
    frames: Mapping[str, Frame]
    gravity: Array = field(default_factory=lambda: np.array(STANDARD_GRAVITY))
    coupled: bool = False

    @property
    def sliding(self) -> frozenset[str]:
        """Names of the prismatic joints, with m in place of rad, and N in place of N m."""
        return frozenset(body.joint.name for body in self.bodies if body.joint.kind == "prismatic")

    @property
    def driven_joints(self) -> dict[str, int]:
        """Joints with a drive of their own, by name, with the index of their body: one coordinate, not a follower's."""
        return {
            body.joint.name: i
            for i, body in enumerate(self.bodies)
            if body.joint.kind in DRIVEN_KINDS and not (self.coupled and body.joint.mimic)
        }

    def with_gravity(self, gravity: Array) -> "Mechanism":
        return replace(self, gravity=gravity)
