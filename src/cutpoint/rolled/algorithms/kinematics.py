"""Pose and Jacobian of a frame, as passes.  The frame's body is not part of the code."""

from typing import Any

from cutpoint.definitions import matrix_of
from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Motion, Pose
from cutpoint.mechanics.kinematics import ExpressedIn
from cutpoint.rolled.algorithms.base import Base, base_in, sizes_apart
from cutpoint.rolled.algorithms.placing import RATES, placing
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import flat, pose_of
from cutpoint.rolled.passes import PLAIN, Order, Pass, Steps
from cutpoint.scalars import where

FRAME = {"frame": 13}
"""Of a frame: its pose in its body's frame, and the number of that body, whose row is "tip"; of the world, infinity."""

PARENT = View("above", "turned", "parent")


def frame_pose(columns: Columns) -> Steps:
    """A frame in the world, (4, 4)."""
    base = base_in(columns)

    def shown(turned: Any, frame: Any) -> Any:
        return [x for row in matrix_of(pose_of(turned) @ pose_of(frame[:12])) for x in row]

    passes, kept = world_poses(columns, [base.is_placed()] if base else [])
    found = Pass("once", Stage(shown, ("tip.turned", "frame"), ("placement",)))
    return _of_frame(base, kept, [*passes, found], {"placement": 16})._replace(shapes={"placement": (4, 4)})


def jacobian(columns: Columns, expressed_in: ExpressedIn) -> Steps:
    """A frame's Jacobian, (6, nv): the columns of the mechanics' own, every body along the world's axes.

    seen: the axes along which velocities are expressed, and the point whose velocity it is, in the world.  column: for
    a body that carries the frame, the motion there at its joint's unit speed; for all others, zeros.
    """
    base = base_in(columns)

    def at_frame(turned: Any, frame: Any) -> Any:
        X = pose_of(turned) @ pose_of(frame[:12])
        axes, point = flat(X.rotation if expressed_in == "local" else IDENTITY), X.position
        return [*axes, *(ZERO if expressed_in == "world" else point)]

    def column(row: Any, turned: Any, seen: Any, frame: Any) -> Any:
        own, tip = columns.subsystem(row), frame[12]
        carries = (own.number <= tip) & (tip <= own.last)
        return [where(carries, x, 0) for x in _seen(own.body.joint.motion([1]), pose_of(turned), pose_of(seen))]

    passes, kept = world_poses(columns, [base.is_placed()] if base else [])
    passes += [Pass("once", Stage(at_frame, ("tip.turned", "frame"), ("seen",)))]
    passes += [Pass("alone", Stage(column, ("body", "turned", "seen", "frame"), ("column",)))]
    apart = {"seen": 12}
    if base:
        passes, apart = [*passes, _of_base(base)], {**apart, "base.columns": 6 * base.axes}
    return _of_frame(base, {**kept, "column": 6}, passes, apart)


def world_poses(columns: Columns, first: list[Pass], order: Order = PLAIN) -> tuple[list[Pass], dict[str, int]]:
    """Every body's pose in the world, stored as "turned", and what else is stored.  first: passes that place a base."""
    place, pose = placing(columns, order, RATES[: order.numbers])

    def outward(at: Any, above: Any) -> Any:
        X = pose_of(order.scalars(above)) @ pose_of(order.scalars(pose.all(at)))
        return order.packed([*flat(X.rotation), *X.position])

    passes = [Pass("alone", place), *first, Pass("outward", Stage(outward, ("pose", "above"), ("turned",)))]
    return passes, {"pose": pose.size, "turned": 12 * order.numbers}


def _of_base(base: Base) -> Pass:
    """Motion of a frame that a base carries, at unit speed of each of the base's axes."""

    def columns(row: Any, turned: Any, seen: Any, frame: Any) -> Any:
        motions = [_seen(S, pose_of(turned), pose_of(seen)) for S in base.motions()]
        return [where(frame[12] <= row[-1], x, 0) for V in motions for x in V]

    return Pass("once", Stage(columns, ("base.body", "base.turned", "seen", "frame"), ("base.columns",)))


def _seen(V: Motion, X: Pose, frame: Pose) -> Motion:
    """A motion of a body at X, expressed for another frame fixed to the body."""
    to_frame = Pose(frame.rotation.T @ X.rotation, frame.rotation.T @ (X.position - frame.position))
    return V.seen_from_parent(to_frame)


def _of_frame(base: Base | None, kept: dict[str, int], passes: list[Pass], apart: dict[str, int]) -> Steps:
    sizes, constants = sizes_apart(base, ("q",))
    world = {"turned": flat(IDENTITY)}
    return Steps(kept, ("q",), (PARENT,), world, passes, {**sizes, **apart}, {**constants, **FRAME})
