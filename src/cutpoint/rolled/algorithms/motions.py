"""Motions of all bodies, as passes: about one point and along fixed axes, as in `mass`.

With a floating base these are where it is at this instant.
"""

from collections.abc import Sequence
from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Motion, Vec3
from cutpoint.rolled.algorithms.base import Base
from cutpoint.rolled.algorithms.placing import PARENT
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import flat, motion_of, pose_of
from cutpoint.rolled.passes import UPWARD, Order, Pass, Scalars

MOVED = ("velocity", "acceleration")
"""Of the point of a body that is at the one place, and angular."""

VIEWS = (PARENT, View("carrier", "velocity", "parent"), View("lift", "acceleration", "parent"))


def body_motions(columns: Columns, order: Order, rates: Sequence[str]) -> list[Pass]:
    """A body's motion at unit speed of its joint, "column", and what is `MOVED`, from where bodies are "turned".

    Featherstone (2008) section 2.11: about a place that stands still accelerations add as velocities do.
    """
    read, packed = order.scalars, order.packed

    def column(row: Any, turned: Any) -> Any:
        return packed(columns.subsystem(row).body.joint.motion([1]).seen_from_parent(pose_of(read(turned))))

    def outward(column: Any, carrier: Any, lift: Any, *rates: Any) -> Any:
        S, V_p, A_p = (motion_of(read(x)) for x in (column, carrier, lift))
        (v,), (a,) = (order.rate(rates, k) for k in (0, 1))
        zv = S * v
        return packed(V_p + zv), packed(A_p + S * a + V_p.cross(zv))

    return [
        Pass("alone", Stage(column, ("body", "turned"), ("column",))),
        Pass("outward", Stage(outward, ("column", "carrier", "lift", *rates[1:]), MOVED)),
    ]


def acceleration_at(p: Vec3, V: Motion, A: Motion) -> Vec3:
    """Of the point of a body that is at p: with the convective term omega x v.  Featherstone (2008) section 2.11."""
    return A.linear + A.angular.cross(p) + V.angular.cross(V.linear + V.angular.cross(p))


def against_gravity(base: Base, row: Scalars, q: Scalars, world: Scalars) -> Motion:
    """What a base's acceleration begins with, as seen from where it is."""
    X = base.segment(row).placement @ base.kind.pose(q)
    return Motion(X.rotation.T @ motion_of(world).linear, ZERO)


def world_rows(order: Order) -> dict[str, list[Any]]:
    """Of the world: where it is, and its acceleration against gravity."""
    upward = [x for k in range(6) for x in ((UPWARD, k), *[0] * (order.numbers - 1))]
    return {"turned": order.packed(flat(IDENTITY)), "acceleration": upward}
