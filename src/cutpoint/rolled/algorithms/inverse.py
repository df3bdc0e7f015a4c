"""Inverse dynamics as passes: what one body's step reads and writes, by the mechanics' own steps."""

from collections.abc import Sequence
from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies.rigid_body import acceleration_gradient, net_wrench
from cutpoint.mechanics.bodies.spatial import AT_ORIGIN, ZERO, Motion, Vec3
from cutpoint.mechanics.inverse_dynamics import BodyMotion, move
from cutpoint.rolled.algorithms.base import base_in, sizes_apart
from cutpoint.rolled.algorithms.placing import POSE, RATES, placing
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import motion_of, wrench_of
from cutpoint.rolled.passes import PLAIN, UPWARD, Order, Pass, Steps
from cutpoint.scalars import Scalar


def inverse_dynamics(columns: Columns, order: Order = PLAIN) -> Steps:
    """Torques tau of a motion q, v, a.  Xia (2019) eqs. (29)-(31), (44)-(47).

    motion: angular velocity and acceleration; linear velocities are not needed.  wrench: of a body's motion, then
    including its children's.  order: torques have as many rates as motions have beyond the acceleration.
    """
    m, base = order.numbers, base_in(columns)
    rates = RATES[: m + 2]
    poses = placing(columns, order, rates[:m])

    def outward(mounting: Any, at: Any, row: Any, carrier: Any, *given: Any) -> Any:
        X, joint = poses.of(mounting, at), columns.subsystem(row).body.joint
        parent = _moving(order.scalars(carrier))
        zv, za = (joint.motion(order.rate(given, k)) for k in (0, 1))
        moved = move(X, X.outward(parent.V).angular + zv.angular, zv, parent, zv, za)
        return order.packed([*moved.V.angular, *moved.A])

    def cost(row: Any, motion: Any) -> Any:
        moved = _moving(order.scalars(motion))
        return order.packed(net_wrench(columns.subsystem(row).body.inertia, moved.A, moved.U))

    def inward(mounting: Any, at: Any, row: Any, wrench: Any, carrier: Any, borne: Any, *given: Any) -> Any:
        X, own, F = poses.of(mounting, at), columns.subsystem(row), wrench_of(order.scalars(wrench))
        (speed,), (acceleration,) = (order.rate(given, k) for k in (0, 1))
        tau, handed = own.body.joint.effort(F)[0] + own.armature * acceleration, X.inward(F)
        if own.spin:
            parent = _moving(order.scalars(carrier))
            tau = tau + own.spin.along(parent.A.angular)
            handed = handed + own.spin.reaction(parent.V.angular, speed, acceleration)
        return order.packed([tau]), order.packed(wrench_of(order.scalars(borne)) + handed)

    passes = [
        Pass("alone", poses.stage),
        *([base.moves(order, rates)] if base else []),
        Pass("outward", Stage(outward, (*POSE, "body", "carrier", *rates[1:]), ("motion",))),
        Pass("alone", Stage(cost, ("body", "motion"), ("wrench",))),
        Pass("inward", Stage(inward, (*POSE, "body", "wrench", "carrier", "borne", *rates[1:]), ("tau", "borne"))),
        *([base.bears(order)] if base else []),
    ]
    views = (View("carrier", "motion", "parent"), View("borne", "wrench", "parent"))
    kept = {"pose": poses.size, "motion": 9 * m, "wrench": 6 * m}
    upward = [x for n in range(6) for x in ((UPWARD, n), *[0] * (m - 1))]
    numbers = (*rates, "tau")
    return Steps(kept, numbers, views, {"motion": [0] * (3 * m) + upward}, passes, *sizes_apart(base, numbers))


def _moving(motion: Sequence[Scalar]) -> BodyMotion:
    """A body's motion from its stored numbers."""
    omega, A = Vec3(*motion[:3]), motion_of(motion[3:])
    return BodyMotion(AT_ORIGIN, Motion(ZERO, omega), A, acceleration_gradient(A.angular, omega, omega))
