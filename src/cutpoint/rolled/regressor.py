"""The torque regressor as passes: what a unit of each parameter of a body takes, then every pair of bodies.

All about one place and along the world's axes, as in the mass matrix.
"""

from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.rigid_body import body_regressor
from cutpoint.mechanics.spatial import IDENTITY, Motion, Pose
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.kinematics import ABOVE, world_poses
from cutpoint.rolled.packing import flat, motion_of, pose_of, wrench_of
from cutpoint.rolled.passes import UPWARD, Pass, Steps
from cutpoint.rolled.steps import RATES
from cutpoint.scalars import where

PARAMETERS = 10
"""Of a body, in the order of `body_regressor`."""


def torque_regressor(columns: Columns) -> Steps:
    """Y(q, v, a), of trees without a base that moves freely.  Atkeson, An and Hollerbach (1986).

    column: a body's motion at unit speed of its joint.  velocity, acceleration: of the point of the body that is at
    that one place, and angular.  wrenches: what its motion takes for a unit of each of its parameters, along the axes
    that the user knows.  span: the body's number, and the last number that it carries.
    """
    placed, kept = world_poses(columns, [])

    def outward(row: Any, turned: Any, carrier: Any, lift: Any, v: Any, a: Any) -> Any:
        S = columns.subsystem(row).body.joint.motion([1]).seen_from_parent(pose_of(turned))
        V_p, zv = motion_of(carrier), S * v[0]
        return [*S], [*(V_p + zv)], [*(motion_of(lift) + S * a[0] + V_p.cross(zv))]

    def alone(row: Any, turned: Any, velocity: Any, acceleration: Any) -> Any:
        own, X, V, A = columns.subsystem(row), pose_of(turned), motion_of(velocity), motion_of(acceleration)
        R, p = X.rotation @ columns.turn(row).T, X.position
        omega = R.T @ V.angular
        linear = A.linear + A.angular.cross(p) + V.angular.cross(V.linear + V.angular.cross(p))
        wrenches = body_regressor(Motion(R.T @ linear, R.T @ A.angular), omega, omega)
        return [x for F in wrenches for x in Pose(R, p).inward(F)], [own.number, own.last]

    motion = ("velocity", "acceleration")
    passes = [
        *placed,
        Pass("outward", Stage(outward, ("body", "turned", "carrier", "lift", *RATES[1:3]), ("column", *motion))),
        Pass("alone", Stage(alone, ("body", "turned", *motion), ("wrenches", "span"))),
        Pass("pairs", Stage(_entries, ("held", "column", "wrenches", "span"), ("Y",))),
    ]
    views = (ABOVE, View("carrier", "velocity", "parent"), View("lift", "acceleration", "parent"))
    kept |= {"column": 6, "velocity": 6, "acceleration": 6, "wrenches": 6 * PARAMETERS, "span": 2}
    world = {"turned": flat(IDENTITY), "acceleration": [(UPWARD, k) for k in range(6)]}
    return Steps(kept, RATES[:3], views, world, passes, entries={"Y": PARAMETERS})


def _entries(held: Any, column: Any, wrenches: Any, span: Any) -> Any:
    """What one body's joint bears of each of the other's wrenches, if it carries that."""
    S, (number, last) = motion_of(held[:6]), held[-2:]
    carries = (number <= span[0]) & (span[0] <= last)
    return [where(carries, S.power(wrench_of(wrenches[k : k + 6])), 0) for k in range(0, len(wrenches), 6)]
