"""Where every body is, in its parent and in the world: the passes with which functions of the coordinates begin."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies.spatial import Pose
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import flat, pose_of
from cutpoint.rolled.passes import PLAIN, Kept, Order, Pass, Scalars
from cutpoint.scalars import Scalar

RATES = ("q", "v", "a", "jerk", "snap")
"""What is given of a motion, as far as an order asks for it."""

PARENT = View("above", "turned", "parent")

POSE = ("mounting", "pose")
"""What stages read to know a body's pose in its parent."""


class Poses(NamedTuple):
    """Bodies' poses in their parents: the stage that computes them, which depends on no other body; how many numbers it
    stores as "pose"; and a pose from what stages read as POSE.
    """

    stage: Stage
    size: int
    of: Callable[[Scalars, Scalars], Pose]


def placing(columns: Columns, order: Order, rates: Sequence[str]) -> Poses:
    """rates: of coordinates, as many as the order takes."""

    def placed(mounting: Any, row: Any, *given: Any) -> list[Scalar]:
        X = columns.mounting(mounting) @ columns.subsystem(row).body.joint.pose(order.rate(given, 0))
        return order.packed([*flat(X.rotation), *X.position])

    def of(mounting: Scalars, at: Scalars) -> Pose:
        return pose_of(order.scalars(pose.all(at, mounting)))

    sizes = {**columns.sizes, "q": len(rates)}
    pose = Kept(lambda mounting, body, q: placed(mounting, body, *([x] for x in q)), sizes["mounting"], **sizes)
    stage = Stage(lambda *given: pose.some(placed(*given)), ("mounting", "body", *rates), ("pose",))
    return Poses(stage, pose.size, of)


def world_poses(columns: Columns, first: list[Pass], order: Order = PLAIN) -> tuple[list[Pass], dict[str, int]]:
    """Every body's pose in the world, stored as "turned", and what else is stored.  first: passes that place a base."""
    poses = placing(columns, order, RATES[: order.numbers])

    def outward(mounting: Any, at: Any, above: Any) -> Any:
        X = pose_of(order.scalars(above)) @ poses.of(mounting, at)
        return order.packed([*flat(X.rotation), *X.position])

    passes = [Pass("alone", poses.stage), *first, Pass("outward", Stage(outward, (*POSE, "above"), ("turned",)))]
    return passes, {"pose": poses.size, "turned": 12 * order.numbers}
