"""The recursions as loops over subsystems: what one body's step reads and writes, by the mechanics' own steps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from typing import Any

from cutpoint.kernels import Loop, Region, Stage, View
from cutpoint.mechanics.articulated import NO_ROTOR, Articulated, FeltRotor, Yield, accelerations
from cutpoint.mechanics.forward_dynamics import prepare
from cutpoint.mechanics.inverse_dynamics import BodyMotion, move
from cutpoint.mechanics.rigid_body import acceleration_gradient, net_wrench
from cutpoint.mechanics.spatial import AT_ORIGIN, ZERO, Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.rolled.bodies import Columns, Subsystem, is_nothing, mat3
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]

UPPER = [(j, k) for j in range(6) for k in range(j, 6)]
"""Entries of a symmetric (6, 6) matrix that are kept."""


@dataclass(frozen=True)
class Rolled:
    """A function as loops over bodies.

    regions: they have a row for each body, and as the last one, where bodies have parents, the world's.
    numbers: names of those that have one number for each body of each configuration.
    """

    body: Loop
    regions: tuple[Region, ...]
    numbers: tuple[str, ...]


def inverse_dynamics(columns: Columns, lanes: int = 1) -> Rolled:
    """Torques tau of a motion q, v, a.  Xia (2019) eqs. (29)-(31), (44)-(47).

    motion: angular velocity, acceleration, its gradient; linear velocities take no part.  wrench: what a body bears of
    its children.  lanes: how many configurations are computed side by side.
    """

    def outward(row: Any, pose: Any, v: Any, a: Any, carrier: Any) -> Any:
        own, X, parent = columns.subsystem(row), _pose(pose), _motion_from(carrier)
        zv, za = own.body.joint.motion(v), own.body.joint.motion(a)
        moved = move(X, X.outward(parent.V).angular + zv.angular, zv, parent, zv, za)
        tau = own.armature * a[0] + (own.spin.torque(parent.A.angular) if own.spin else 0)
        motion = [*moved.V.angular, *moved.A, *_flat(moved.U)]
        return motion, [0] * 6, [tau]

    def spin(row: Any, v: Any, a: Any, carrier: Any, borne: Any) -> Any:
        rotor, omega = columns.subsystem(row).spin, _motion_from(carrier).V.angular
        return [*(_wrench(borne) + rotor.reaction(omega, v[0], a[0]))] if rotor else borne

    def inward(row: Any, pose: Any, motion: Any, wrench: Any, tau: Any, borne: Any) -> Any:
        own, X, m = columns.subsystem(row), _pose(pose), _motion_from(motion)
        F = _wrench(wrench) + net_wrench(own.body.inertia, m.A, m.U)
        return [tau[0] + own.body.joint.effort(F)[0]], [*(_wrench(borne) + X.inward(F))]

    there = [Stage(outward, ("body", "pose", "v", "a", "carrier"), ("motion", "wrench", "tau"))]
    there += [Stage(spin, ("body", "v", "a", "carrier", "borne"), ("borne",))] * _has_spins(columns)
    back = [Stage(inward, ("body", "pose", "motion", "wrench", "tau", "borne"), ("tau", "borne"))]
    views = (View("carrier", "motion", "parent"), View("borne", "wrench", "parent"))
    kept = {"motion": 18, "pose": 12, "wrench": 6}
    return _rolled(columns, lanes, kept, "q v a tau", views, [[_place(columns)], there], [back])


def forward_dynamics(columns: Columns, lanes: int = 1) -> Rolled:
    """Accelerations a under torques tau, of so many configurations side by side.  Featherstone (2008) section 7.3."""

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
    kept = {"omega": 3, "pose": 12, "bias": 6, "resistance": 27, "step": 7, "acceleration": 6}
    return _rolled(columns, lanes, kept, "q v tau a", views, [[_place(columns)], there], [back], [again])


def _place(columns: Columns) -> Stage:
    """Where each body is in its parent.  A pass of its own: it waits for nothing, and the next one waits less."""

    def place(row: Any, q: Any) -> Any:
        body = columns.subsystem(row).body
        return _flat_pose(body.placement @ body.joint.pose(q))

    return Stage(place, ("body", "q"), ("pose",))


def _rolled(
    columns: Columns,
    lanes: int,
    kept: Mapping[str, int],
    inputs: str,
    views: Sequence[View],
    *passes: Sequence[Sequence[Stage]],
) -> Rolled:
    """Passes over the bodies of each configuration: some outward, some inward, and so on in turn."""
    numbers = tuple(inputs.split())
    loops = [
        Loop("bodies", [replace(stage, lanes=lanes) for stage in stages], ("body", *kept), None, numbers, inward, views)
        for inward, direction in zip(cycle((False, True)), passes, strict=False)
        for stages in direction
    ]
    sizes = {**kept, **dict.fromkeys(numbers, 1)}
    regions = [Region(name, size * lanes, lanes) for name, size in sizes.items()]
    return Rolled(Loop("groups", loops), (Region("body", columns.read.shape[1]), *regions), numbers)


def _has_spins(columns: Columns) -> bool:
    return columns.subsystem([1.0] * columns.read.shape[1]).spin is not None


def _felt(own: Subsystem) -> FeltRotor:
    """The rotor as its joint's axis feels it; none, said as such, where the axis is known to be a unit vector."""
    known = all(isinstance(x, int) for axis in own.body.joint.axes for x in axis)
    if own.spin is None and is_nothing(own.armature) and known:
        return NO_ROTOR
    return FeltRotor(own.armature, own.spin.geared if own.spin else 0)


def _motion_from(numbers: Scalars) -> BodyMotion:
    omega, A, U = Vec3(*numbers[:3]), _motion(numbers[3:9]), mat3(iter(numbers[9:]))
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


def _motion(six: Scalars) -> Motion:
    return Motion(Vec3(*six[:3]), Vec3(*six[3:]))


def _wrench(six: Scalars) -> Wrench:
    return Wrench(Vec3(*six[:3]), Vec3(*six[3:]))


def _pose(twelve: Scalars) -> Pose:
    return Pose(mat3(iter(twelve[:9])), Vec3(*twelve[9:]))
