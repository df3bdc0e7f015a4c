"""Pose, Jacobian and acceleration of a frame, as passes.  The frame's body is not part of the code."""

from typing import Any

from cutpoint.definitions import matrix_of
from cutpoint.kernels import Stage
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Motion, Pose
from cutpoint.mechanics.kinematics import ExpressedIn
from cutpoint.rolled.algorithms.base import Base, base_in, sizes_apart
from cutpoint.rolled.algorithms.motions import MOVED, VIEWS, acceleration_at, body_motions
from cutpoint.rolled.algorithms.placing import PARENT, RATES, world_poses
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import flat, motion_of, pose_of
from cutpoint.rolled.passes import PLAIN, Pass, Steps
from cutpoint.scalars import where

FRAME = {"frame": 13}
"""Of a frame: its pose in its body's frame, and the number of that body, whose row is "tip"; of the world, infinity."""


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


def frame_acceleration(columns: Columns, expressed_in: ExpressedIn) -> Steps:
    """The time derivative of a frame's velocity, (6,), m/s2 and rad/s2, without gravity, from all bodies' motions.

    Spatial accelerations change their place and axes as velocities do: Featherstone (2008) section 2.11.
    """
    base = base_in(columns)

    def at_frame(turned: Any, velocity: Any, acceleration: Any, frame: Any) -> Any:
        X, V, A = pose_of(turned) @ pose_of(frame[:12]), motion_of(velocity), motion_of(acceleration)
        if expressed_in == "local_world_aligned":
            return [*acceleration_at(X.position, V, A), *A.angular]
        return [*(X.outward(A) if expressed_in == "local" else A)]

    passes, kept = world_poses(columns, [base.is_placed(), _moves(base)] if base else [])
    passes += body_motions(columns, PLAIN, RATES[:3])
    reads = (*(f"tip.{x}" for x in ("turned", *MOVED)), "frame")
    passes += [Pass("once", Stage(at_frame, reads, ("frame_acceleration",)))]
    kept |= {"column": 6, **dict.fromkeys(MOVED, 6)}
    steps = _of_frame(base, kept, passes, {"frame_acceleration": 6}, RATES[:3])
    return steps._replace(views=VIEWS, shapes={"frame_acceleration": (6,)})


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


def _moves(base: Base) -> Pass:
    """Motion of a base, about the world's origin and along its axes."""

    def moves(turned: Any, *rates: Any) -> Any:
        return [[*base.kind.motion(x).seen_from_parent(pose_of(turned))] for x in rates]

    return Pass("once", Stage(moves, ("base.turned", "base.v", "base.a"), [f"base.{x}" for x in MOVED]))


def _of_frame(
    base: Base | None, kept: dict[str, int], passes: list[Pass], apart: dict[str, int], given: tuple[str, ...] = ("q",)
) -> Steps:
    sizes, constants = sizes_apart(base, given)
    world = {"turned": flat(IDENTITY)}
    return Steps(kept, given, (PARENT,), world, passes, {**sizes, **apart}, {**constants, **FRAME})
