"""The torque regressor as passes: wrenches per unit of each parameter of a body, then every pair of bodies.

All about one point and along the world's axes, as in the mass matrix; with a floating base, about its position.
"""

from collections.abc import Sequence
from typing import Any

from cutpoint.kernels import Stage
from cutpoint.mechanics.bodies.rigid_body import body_regressor
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Mat3, Motion, Pose, Wrench
from cutpoint.rolled.algorithms.base import Base, base_in, sizes_apart
from cutpoint.rolled.algorithms.motions import MOVED, VIEWS, acceleration_at, against_gravity, body_motions, world_rows
from cutpoint.rolled.algorithms.placing import RATES, world_poses
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.kinship import Kinship
from cutpoint.rolled.packing import flat, motion_of, pose_of, wrench_of
from cutpoint.rolled.passes import PLAIN, Pass, Steps
from cutpoint.scalars import Scalar, where

PARAMETERS = 10
"""Of a body, in the order of `body_regressor`."""


def torque_regressor(columns: Columns) -> Steps:
    """Y(q, v, a).  Atkeson, An and Hollerbach (1986).

    column: a body's motion at unit speed of its joint.  velocity, acceleration: of the body's point at that one point,
    and angular.  wrenches: of its motion per unit of each of its parameters, along the user's axes.  span: the body's
    number, and the last number that it carries.
    """
    base = base_in(columns)
    placed, kept = world_poses(columns, [_moves(base, columns.base_to_user_axes)] if base else [])

    def alone(row: Any, turned: Any, velocity: Any, acceleration: Any) -> Any:
        own, X = columns.subsystem(row), pose_of(turned)
        own_axes = Pose(X.rotation @ columns.to_user_axes(row).T, X.position)
        wrenches = _of_units(own_axes, motion_of(velocity), motion_of(acceleration))
        return [x for F in wrenches for x in F], [own.number, own.last]

    passes = [
        *placed,
        *body_motions(columns, PLAIN, RATES[:3]),
        Pass("alone", Stage(alone, ("body", "turned", *MOVED), ("wrenches", "span"))),
        *([_couples(base)] if base else []),
        Pass("carrying", Stage(_entries, ("held", "column", "wrenches", "span"), ("Y",))),
    ]
    kept |= {"column": 6, "velocity": 6, "acceleration": 6, "wrenches": 6 * PARAMETERS, "span": 2}
    sizes, constants = sizes_apart(base, RATES[:3])
    if base:
        kept, sizes = kept | {"Y_rows": base.axes * PARAMETERS}, sizes | {"base.Y": base.axes * PARAMETERS}
    return Steps(kept, RATES[:3], VIEWS, world_rows(PLAIN), passes, sizes, constants, entries={"Y": PARAMETERS})


def _of_units(X: Pose, V: Motion, A: Motion) -> list[Wrench]:
    """Wrenches per unit of each parameter of a body at X that moves with V and A, all about the one point."""
    R_T, omega = X.rotation.T, X.rotation.T @ V.angular
    units = body_regressor(Motion(R_T @ acceleration_at(X.position, V, A), R_T @ A.angular), omega, omega)
    return [X.inward(F) for F in units]


def _entries(kin: Kinship, held: Any, column: Any, wrenches: Any, span: Any) -> Any:
    """One body's joint torques under each of the other's wrenches, if it carries that body."""
    S, carries = motion_of(held[:6]), kin.of(held[-2:], span).carries
    return [where(carries, S.power(wrench_of(wrenches[k : k + 6])), 0) for k in range(0, len(wrenches), 6)]


def _moves(base: Base, to_user_axes: Mat3) -> Pass:
    """A base in its current frame: its motion, and the wrenches per unit of its own parameters."""

    def moves(row: Any, q: Any, v: Any, a: Any, world: Any) -> Any:
        V, A = base.kind.motion(v), against_gravity(base, row, q, world) + base.kind.motion(a)
        wrenches = _of_units(Pose(to_user_axes.T, ZERO), V, A)
        return [*flat(IDENTITY), *ZERO], [*V], [*A], _by_axis(base, wrenches)

    reads = ("base.body", *(f"base.{x}" for x in RATES[:3]), "world.acceleration")
    return Pass("once", Stage(moves, reads, [f"base.{x}" for x in ("turned", "velocity", "acceleration", "Y")]))


def _couples(base: Base) -> Pass:
    """A base's joint torques under the wrenches of bodies that it carries."""

    def couples(row: Any, wrenches: Any, span: Any) -> Any:
        borne = _by_axis(base, [wrench_of(wrenches[k : k + 6]) for k in range(0, len(wrenches), 6)])
        return [where(span[0] <= row[-1], x, 0) for x in borne]

    return Pass("alone", Stage(couples, ("base.body", "wrenches", "span"), ("Y_rows",)))


def _by_axis(base: Base, wrenches: Sequence[Wrench]) -> list[Scalar]:
    """The torques of each axis of a base's joint under each wrench."""
    efforts = [base.kind.effort(F) for F in wrenches]
    return [effort[axis] for axis in range(base.axes) for effort in efforts]
