"""Where every body is in its parent: the pass with which functions of the coordinates begin."""

from collections.abc import Sequence
from typing import Any

from cutpoint.kernels import Stage
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import flat
from cutpoint.rolled.passes import Kept, Order
from cutpoint.scalars import Scalar

RATES = ("q", "v", "a", "jerk", "snap")
"""What is given of a motion, as far as an order asks for it."""


def placing(columns: Columns, order: Order, rates: Sequence[str]) -> tuple[Stage, Kept]:
    """Pose of each body in its parent, and its storage.  It depends on no other body."""

    def placed(row: Any, *given: Any) -> list[Scalar]:
        body = columns.subsystem(row).body
        X = body.placement @ body.joint.pose(order.rate(given, 0))
        return order.packed([*flat(X.rotation), *X.position])

    pose = Kept(lambda body, q: placed(body, *([x] for x in q)), body=columns.width, q=len(rates))
    return Stage(lambda *given: pose.some(placed(*given)), ("body", *rates), ("pose",)), pose
