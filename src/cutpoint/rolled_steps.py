"""The recursions as loops over subsystems: what one body's step reads and writes, by the mechanics' own steps.

A body is a row of numbers.  Those that are the same whole number for all bodies (an axis's zeros, a turn by a quarter)
are part of the code; all others it reads.  So one piece of code, of one size, serves trees of any size.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.kernels import Loop, Region, Stage, View
from cutpoint.mechanics.articulated import NO_ROTOR, Articulated, FeltRotor, Yield, accelerations
from cutpoint.mechanics.forward_dynamics import prepare
from cutpoint.mechanics.inverse_dynamics import BodyMotion, move
from cutpoint.mechanics.joints import Helical, JointKind, Prismatic, Revolute, about_z
from cutpoint.mechanics.rigid_body import acceleration_gradient, net_wrench
from cutpoint.mechanics.rotors import Spin
from cutpoint.mechanics.spatial import AT_ORIGIN, IDENTITY, ZERO, Inertia, Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.mechanics.system import Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]
Array = np.ndarray

UPPER = [(j, k) for j in range(6) for k in range(j, 6)]
"""Entries of a symmetric (6, 6) matrix that are kept."""


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
        pose = Pose(_mat3(row), _vec3(row))
        mass, first_moment = next(row), _vec3(row)
        xx, xy, xz, yy, yz, zz = (next(row) for _ in range(6))
        inertia = Inertia(mass, first_moment, Mat3(Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)))
        joint, armature, axis, geared = OneAxis(next(row), next(row)), next(row), _vec3(row), next(row)
        own = Segment("", WORLD, pose, joint, inertia, slice(0, 1), slice(0, 1), IDENTITY)
        return Subsystem(own, armature, None if _is_nothing(geared) else Spin(0, 0, axis, 0, geared, False))


@dataclass(frozen=True)
class Rolled:
    """A function as loops over bodies.

    regions: they have a row for each body, and as the last one, where bodies have parents, the world's.
    numbers: names of those that have one number for each body of each configuration.
    """

    body: Loop
    regions: tuple[Region, ...]
    numbers: tuple[str, ...]


def inverse_dynamics(columns: Columns) -> Rolled:
    """Torques tau of a motion q, v, a.  Xia (2019) eqs. (29)-(31), (44)-(47).

    motion: angular velocity, acceleration, its gradient; linear velocities take no part.
    """

    def outward(row: Any, pose: Any, v: Any, a: Any, carrier: Any) -> Any:
        own, X, parent = columns.subsystem(row), _pose(pose), _motion_from(carrier)
        zv, za = own.body.joint.motion(v), own.body.joint.motion(a)
        moved = move(X, X.outward(parent.V).angular + zv.angular, zv, parent, zv, za)
        tau = own.armature * a[0] + (own.spin.torque(parent.A.angular) if own.spin else 0)
        motion = [*moved.V.angular, *moved.A, *_flat(moved.U)]
        return motion, [*net_wrench(own.body.inertia, moved.A, moved.U)], [tau]

    def spin(row: Any, v: Any, a: Any, carrier: Any, borne: Any) -> Any:
        rotor, omega = columns.subsystem(row).spin, _motion_from(carrier).V.angular
        return [*(_wrench(borne) + rotor.reaction(omega, v[0], a[0]))] if rotor else borne

    def inward(row: Any, pose: Any, wrench: Any, tau: Any, borne: Any) -> Any:
        own, X, F = columns.subsystem(row), _pose(pose), _wrench(wrench)
        return [tau[0] + own.body.joint.effort(F)[0]], [*(_wrench(borne) + X.inward(F))]

    there = [Stage(outward, ("body", "pose", "v", "a", "carrier"), ("motion", "wrench", "tau"))]
    there += [Stage(spin, ("body", "v", "a", "carrier", "borne"), ("borne",))] * _has_spins(columns)
    back = [Stage(inward, ("body", "pose", "wrench", "tau", "borne"), ("tau", "borne"))]
    views = (View("carrier", "motion", "parent"), View("borne", "wrench", "parent"))
    kept = (Region("motion", 18), Region("pose", 12), Region("wrench", 6))
    return _rolled(columns, kept, "q v a tau", views, [[_place(columns)], there], [back])


def forward_dynamics(columns: Columns) -> Rolled:
    """Accelerations a under torques tau.  Featherstone (2008) section 7.3."""

    def outward(row: Any, pose: Any, v: Any, carrier: Any) -> Any:
        own, X, omega = columns.subsystem(row), _pose(pose), Vec3(*carrier)
        found = prepare(own.body, X, Motion(ZERO, omega), acceleration_gradient(ZERO, omega, omega), v)
        return [*found.V.angular], [*found.bias], [*_upper(found.M), *found.P]

    def spin(row: Any, v: Any, carrier: Any, borne: Any) -> Any:
        rotor = columns.subsystem(row).spin
        return [*borne[:21], *(_wrench(borne[21:]) + rotor.reaction(Vec3(*carrier), v[0], 0))] if rotor else borne

    def inward(row: Any, tau: Any, pose: Any, bias: Any, resistance: Any, borne: Any) -> Any:
        own, X, C, M, P = columns.subsystem(row), _pose(pose), _motion(bias), _articulated(resistance), resistance[21:]
        M_left, P_left, (step,) = M.give_way(own.body.joint.axes, _wrench(P) + M * C, tau, [_felt(own)])
        M_p, P_p = _articulated(borne) + M_left.seen_from_parent(X), _wrench(borne[21:]) + X.inward(P_left)
        return [step.own, *step.share], [*_upper(M_p), *P_p]

    def give_way(row: Any, pose: Any, bias: Any, step: Any, carried: Any) -> Any:
        joint, A = columns.subsystem(row).body.joint, _pose(pose).outward(_motion(carried))
        a = accelerations([Yield(joint.axes[0], step[0], step[1:])], A)
        return a, [*(A + _motion(bias) + joint.motion(a))]

    there = [Stage(outward, ("body", "pose", "v", "carrier"), ("omega", "bias", "resistance"))]
    there += [Stage(spin, ("body", "v", "carrier", "borne"), ("borne",))] * _has_spins(columns)
    back = [Stage(inward, ("body", "tau", "pose", "bias", "resistance", "borne"), ("step", "borne"))]
    again = [Stage(give_way, ("body", "pose", "bias", "step", "carried"), ("a", "acceleration"))]
    views = (View("carrier", "omega", "parent"), View("borne", "resistance", "parent"))
    views += (View("carried", "acceleration", "parent"),)
    sizes = {"omega": 3, "pose": 12, "bias": 6, "resistance": 27, "step": 7, "acceleration": 6}
    return _rolled(columns, [Region(*pair) for pair in sizes.items()], "q v tau a", views, [[_place(columns)], there], [back], [again])


def _place(columns: Columns) -> Stage:
    """Where each body is in its parent.  A pass of its own: it waits for nothing, and the next one waits less."""

    def place(row: Any, q: Any) -> Any:
        body = columns.subsystem(row).body
        return _flat_pose(body.placement @ body.joint.pose(q))

    return Stage(place, ("body", "q"), ("pose",))


def _rolled(
    columns: Columns, kept: Sequence[Region], inputs: str, views: Sequence[View], *passes: Sequence[Sequence[Stage]]
) -> Rolled:
    """Passes over the bodies of each configuration: some outward, some inward, and so on in turn."""
    numbers = tuple(inputs.split())
    streams = ("body", *(region.name for region in kept))
    loops = [
        Loop("bodies", stages, streams, onward=numbers, backward=bool(k % 2), views=views)
        for k, direction in enumerate(passes)
        for stages in direction
    ]
    given = [Region(name, 1) for name in numbers]
    regions = (Region("body", columns.read.shape[1]), *kept, *given)
    return Rolled(Loop("configurations", loops), regions, numbers)


def _has_spins(columns: Columns) -> bool:
    return columns.subsystem([1.0] * columns.read.shape[1]).spin is not None


def _felt(own: Subsystem) -> FeltRotor:
    """The rotor as its joint's axis feels it; none, said as such, where the axis is known to be a unit vector."""
    known = all(isinstance(x, int) for axis in own.body.joint.axes for x in axis)
    if own.spin is None and _is_nothing(own.armature) and known:
        return NO_ROTOR
    return FeltRotor(own.armature, own.spin.geared if own.spin else 0)


def _is_nothing(x: Scalar) -> bool:
    return isinstance(x, int) and x == 0


def _motion_from(numbers: Scalars) -> BodyMotion:
    omega, A, U = Vec3(*numbers[:3]), _motion(numbers[3:9]), _mat3(iter(numbers[9:]))
    return BodyMotion(AT_ORIGIN, Motion(ZERO, omega), A, U)


def _flat(A: Mat3) -> list[Scalar]:
    return [x for row in A for x in row]


def _flat_pose(X: Pose) -> list[Scalar]:
    return [*_flat(X.rotation), *X.position]


def _upper(M: Articulated) -> list[Scalar]:
    return [M.rows[j][k] for j, k in UPPER]


def _articulated(numbers: Scalars) -> Articulated:
    rows: list[list[Any]] = [[0] * 6 for _ in range(6)]
    for (j, k), x in zip(UPPER, numbers, strict=False):
        rows[j][k] = rows[k][j] = x
    return Articulated(rows)


def _vec3(numbers: Iterator[Scalar]) -> Vec3:
    return Vec3(next(numbers), next(numbers), next(numbers))


def _mat3(numbers: Iterator[Scalar]) -> Mat3:
    return Mat3(_vec3(numbers), _vec3(numbers), _vec3(numbers))


def _motion(six: Scalars) -> Motion:
    return Motion(Vec3(*six[:3]), Vec3(*six[3:]))


def _wrench(six: Scalars) -> Wrench:
    return Wrench(Vec3(*six[:3]), Vec3(*six[3:]))


def _pose(twelve: Scalars) -> Pose:
    return Pose(_mat3(iter(twelve[:9])), Vec3(*twelve[9:]))
