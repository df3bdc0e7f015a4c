"""Where every body is, in its parent and in the world: the passes with which functions of the coordinates begin."""

from collections.abc import Sequence
from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import flat, pose_of
from cutpoint.rolled.passes import PLAIN, Kept, Order, Pass
from cutpoint.scalars import Scalar

RATES = ("q", "v", "a", "jerk", "snap")
"""What is given of a motion, as far as an order asks for it."""

PARENT = View("above", "turned", "parent")


def placing(columns: Columns, order: Order, rates: Sequence[str]) -> tuple[Stage, Kept]:
    """Pose of each body in its parent, and its storage.  It depends on no other body."""

    def placed(row: Any, *given: Any) -> list[Scalar]:
        body = columns.subsystem(row).body
        X = body.placement @ body.joint.pose(order.rate(given, 0))
        return order.packed([*flat(X.rotation), *X.position])

    pose = Kept(lambda body, q: placed(body, *([x] for x in q)), body=columns.width, q=len(rates))
    return Stage(lambda *given: pose.some(placed(*given)), ("body", *rates), ("pose",)), pose


def world_poses(columns: Columns, first: list[Pass], order: Order = PLAIN) -> tuple[list[Pass], dict[str, int]]:
    """Every body's pose in the world, stored as "turned", and what else is stored.  first: passes that place a base."""
    place, pose = placing(columns, order, RATES[: order.numbers])

    def outward(at: Any, above: Any) -> Any:
        X = pose_of(order.scalars(above)) @ pose_of(order.scalars(pose.all(at)))
        return order.packed([*flat(X.rotation), *X.position])

    passes = [Pass("alone", place), *first, Pass("outward", Stage(outward, ("pose", "above"), ("turned",)))]
    return passes, {"pose": pose.size, "turned": 12 * order.numbers}
