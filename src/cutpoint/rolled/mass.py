"""The mass matrix as passes: composite inertias inward, then every pair of bodies.

All about the world's origin and along its axes, where what bodies carry is a plain sum.
"""

from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.rigid_body import inertia_of
from cutpoint.mechanics.spatial import IDENTITY, ZERO, Inertia, Vec3, Wrench
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.passes import PLAIN, Pass, Steps
from cutpoint.rolled.steps import flat, motion_of, placing, pose_of, wrench_of
from cutpoint.scalars import Scalar, where


def mass_matrix(columns: Columns) -> Steps:
    """M(q), kg m2 (kg).  Featherstone (2008) section 6.2.

    column: the motion of body and all it carries at unit speed of its joint.  momentum: what they then have, with that
    of the rotor that turns them.  span: the body's number, the last number that it carries, and what the joint alone
    feels of its rotor.
    """
    place, pose = placing(columns, PLAIN, ("q",))

    def outward(at: Any, above: Any) -> Any:
        X = pose_of(above) @ pose_of(pose.all(at))
        return [*flat(X.rotation), *X.position]

    def alone(row: Any, turned: Any) -> Any:
        body, X = columns.subsystem(row).body, pose_of(turned)
        own = body.joint.motion([1])
        angular = X.rotation @ own.angular
        linear = X.rotation @ own.linear + X.position.cross(angular)
        return [*linear, *angular], _ten(body.inertia.seen_from_parent(X))

    def inward(carried: Any, borne: Any) -> Any:
        return [x + y for x, y in zip(borne, carried, strict=True)]

    def momentum(row: Any, turned: Any, column: Any, carried: Any) -> Any:
        own, motion = columns.subsystem(row), motion_of(column)
        F, felt = inertia_of(carried) * motion, own.armature
        if own.spin:
            tie = Wrench(ZERO, pose_of(turned).rotation @ Vec3(0, 0, 1) * own.spin.geared)
            F, felt = F + tie, felt - motion.power(tie)
        return [*F], [own.number, own.last, felt]

    passes = [
        Pass("alone", place),
        Pass("outward", Stage(outward, ("pose", "above"), ("turned",))),
        Pass("alone", Stage(alone, ("body", "turned"), ("column", "carried"))),
        Pass("inward", Stage(inward, ("carried", "borne"), ("borne",))),
        Pass("alone", Stage(momentum, ("body", "turned", "column", "carried"), ("momentum", "span"))),
        Pass("pairs", Stage(_entry, ("held", "column", "momentum", "span"), ("matrix",))),
    ]
    views = (View("above", "turned", "parent"), View("borne", "carried", "parent"))
    kept = {"pose": pose.size, "turned": 12, "column": 6, "carried": 10, "momentum": 6, "span": 3}
    return Steps(kept, ("q",), views, {"turned": flat(IDENTITY)}, passes)


def _entry(held: Any, column: Any, momentum: Any, span: Any) -> Any:
    """The power of one body's momentum by the other's motion, if one carries the other."""
    motion, F, (number, last, felt) = motion_of(held[:6]), wrench_of(held[6:12]), held[12:]
    inside, outside = (number <= span[0]) & (span[0] <= last), (span[0] <= number) & (number <= span[1])
    coupled = where(inside, motion.power(wrench_of(momentum)), where(outside, motion_of(column).power(F), 0))
    return [coupled + where(inside & outside, felt, 0)]


def _ten(M: Inertia) -> list[Scalar]:
    """In the order of `inertia_of`."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = M.rotational
    return [M.mass, *M.first_moment, xx, xy, xz, yy, yz, zz]
