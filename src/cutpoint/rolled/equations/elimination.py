"""Elimination of every joint of a robot, as passes over its bodies: accelerations per unit of torque."""

from functools import reduce
from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies.articulated import Articulated
from cutpoint.mechanics.bodies.joints import dot
from cutpoint.mechanics.bodies.spatial import IDENTITY, NO_WRENCH, ZERO, Pose
from cutpoint.mechanics.factors import factors_of, solve
from cutpoint.rolled.algorithms.base import Base, base_in, sizes_apart
from cutpoint.rolled.algorithms.forward import eliminate, turned_pose
from cutpoint.rolled.algorithms.placing import POSE, placing
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import (
    INERTIA,
    articulated_of,
    by_columns,
    flat,
    packed_inertia,
    pose_by_columns,
)
from cutpoint.rolled.passes import PLAIN, Kept, Pass, Steps
from cutpoint.scalars import Scalar, minimum

UNLIMITED = 1e300
"""More than any inertia."""


def elimination(columns: Columns) -> tuple[Steps, Kept]:
    """Every joint's response to torque and to its carrier, and its storage as "step".

    Featherstone (2008) eqs. (7.38)-(7.44).

    A step: the joint's axis, its share of its carrier's acceleration, the acceleration per unit of torque, and the
    body's position in its carrier, along the world's axes.  least: the least articulated inertia of all joints.
    base.step: accelerations per unit of its torques, and its axes along the world's.
    """
    poses, base = placing(columns, PLAIN, ("q",)), base_in(columns)
    along = columns.along_the_world

    def turns(mounting: Any, at: Any, above: Any) -> Any:
        return by_columns(turned_pose(pose_by_columns(above), poses.of(mounting, at)))

    def stands(row: Any, turned: Any) -> Any:
        return packed_inertia(Articulated.of(along(row, turned).body.inertia).T)

    def eliminates(row: Any, turned: Any, inertia: Any, carrier: Any) -> tuple[list[Scalar], Scalar, list[Scalar]]:
        own = along(row, turned)
        left, _, step = eliminate(own, articulated_of(inertia), NO_WRENCH, 1, articulated_of(carrier), NO_WRENCH)
        numbers = [*step.axis, *step.share, step.own, *own.body.placement.position]
        return numbers, 1 / step.own, packed_inertia(left)

    def inward(row: Any, turned: Any, inertia: Any, carrier: Any, least: Any) -> Any:
        numbers, D, left = eliminates(row, turned, inertia, carrier)
        return step.some(numbers), left, [minimum(least[0], D)]

    sizes = {"row": columns.sizes["body"], "turned": 12, "inertia": INERTIA, "carrier": INERTIA}
    step, reads = Kept(lambda **x: eliminates(**x)[0], **sizes), ("body", "turned", "inertia", "resisted")
    passes = [
        Pass("alone", poses.stage),
        Pass("once", Stage(lambda: [UNLIMITED], (), ("least",))),
        *([_stands(base)] if base else []),
        Pass("outward", Stage(turns, (*POSE, "above"), ("turned",))),
        Pass("outward", Stage(stands, ("body", "turned"), ("inertia",))),
        Pass("inward", Stage(inward, (*reads, "least"), ("step", "resisted", "least"))),
        *([_eliminates(base)] if base else []),
    ]
    kept = {"pose": poses.size, "turned": 12, "inertia": INERTIA, "step": step.size}
    views = (View("above", "turned", "parent"), View("resisted", "inertia", "parent"))
    world: dict[str, list[Any]] = {"turned": flat(IDENTITY)}
    apart, constants = sizes_apart(base, ("q",))
    apart |= {"least": 1, **({"base.step": base.axes * (base.axes + 6)} if base else {})}
    return Steps(kept, ("q",), views, world, passes, apart, constants, threes=("turned", "inertia")), step


def _stands(base: Base) -> Pass:
    """A base's axes, and its inertia, along the world's."""

    def stands(row: Any, q: Any) -> Any:
        own = base.segment(row)
        X = own.placement @ base.kind.pose(q)
        return by_columns(X), packed_inertia(Articulated.of(own.inertia).seen_from_parent(Pose(X.rotation, ZERO)))

    return Pass("once", Stage(stands, ("base.body", "base.q"), ("base.turned", "base.inertia")))


def _eliminates(base: Base) -> Pass:
    """A base's response, with all its axes at once."""

    def eliminates(turned: Any, inertia: Any, least: Any) -> Any:
        turn, M, n = Pose(pose_by_columns(turned).rotation, ZERO), articulated_of(inertia), base.axes
        axes = [S.seen_from_parent(turn) for S in base.motions()]
        lower = [[dot([*S], [dot(row, [*z]) for row in M.rows]) for S in axes] for z in axes]
        factors = factors_of(lower)
        gains = [x for k in range(n) for x in solve(factors, [int(j == k) for j in range(n)])]
        return [*gains, *(x for S in axes for x in S)], [reduce(minimum, [factors.L[k][k] for k in range(n)], least[0])]

    return Pass("once", Stage(eliminates, ("base.turned", "base.inertia", "least"), ("base.step", "least")))
