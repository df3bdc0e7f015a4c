"""A floating base, as passes that run once: a root with several axes, before bodies with one each."""

from collections.abc import Sequence
from typing import Any

from cutpoint.kernels import Stage
from cutpoint.mechanics.bodies.articulated import NO_ROTOR, Articulated, accelerations
from cutpoint.mechanics.bodies.joints import JointMotion
from cutpoint.mechanics.bodies.rigid_body import inertia_of, net_wrench, parameters_of
from cutpoint.mechanics.bodies.spatial import IDENTITY, STILL, ZERO, Motion, Pose, Vec3
from cutpoint.mechanics.inverse_dynamics import motions
from cutpoint.mechanics.kinematics import coordinate_jets
from cutpoint.mechanics.system import Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.bodies import BASE_NUMBERS, Columns
from cutpoint.rolled.packing import (
    by_columns,
    flat,
    motion_of,
    packed_resistance,
    pose_by_columns,
    pose_of,
    resistance_of,
    wrench_of,
)
from cutpoint.rolled.passes import Order, Pass, Scalars
from cutpoint.scalars import where


def base_in(columns: Columns) -> "Base | None":
    """The base of a tree, if it has one."""
    return Base(columns.base) if columns.base else None


def sizes_apart(base: "Base | None", names: Sequence[str]) -> tuple[dict[str, int], dict[str, int]]:
    """Sizes of a base's numbers: its parts of the arrays of these names, and its constants."""
    if base is None:
        return {}, {}
    return {f"base.{x}": base.kind.coordinates if x == "q" else base.axes for x in names}, {"base.body": BASE_NUMBERS}


class Base:
    """A base in the form that passes take.

    Names of regions that begin with "base." are its own numbers, or its row among those of the bodies.
    """

    def __init__(self, kind: JointMotion) -> None:
        self.kind, self.axes = kind, len(kind.axes)

    def segment(self, row: Scalars) -> Segment:
        q, v = slice(0, self.kind.coordinates), slice(0, self.axes)
        return Segment("", WORLD, pose_of(row[:12]), self.kind, inertia_of(row[12:22]), q, v, IDENTITY)

    def alone(self, own: Segment, upward: Vec3) -> System:
        """The base without what it carries.  upward: gravity's opposite, m/s2."""
        return System((own,), -upward, {}, self.kind.coordinates, self.axes, (0,) * self.axes)

    def motions(self) -> list[Motion]:
        """Its motions at unit speed of each of its axes, in its own frame."""
        return [self.kind.motion([int(j == k) for j in range(self.axes)]) for k in range(self.axes)]

    def moves(self, order: Order, rates: Sequence[str]) -> Pass:
        """Its motion, and the net wrench of that."""
        m = order.numbers

        def moves(row: Any, world: Any, *given: Any) -> Any:
            own = self.segment(row)
            alone = self.alone(own, Vec3(*world[3 * m :: m][:3]))
            v, a = order.rate(given, 1), order.rate(given, 2)
            q = given[0] if m == 1 else coordinate_jets(alone, given[0], v)
            (moved,) = motions(alone, q, v, a)
            return order.packed([*moved.V.angular, *moved.A]), order.packed(net_wrench(own.inertia, moved.A, moved.U))

        reads = ("base.body", "world.motion", *(f"base.{rate}" for rate in rates))
        return Pass("once", Stage(moves, reads, ("base.motion", "base.wrench")))

    def bears(self, order: Order, written: str = "tau") -> Pass:
        """The torques of its joint under all wrenches."""

        def bears(wrench: Any) -> Any:
            return self.kind.effort(wrench_of(wrench[:: order.numbers]))

        return Pass("once", Stage(bears, ("base.wrench",), (f"base.{written}",)))

    def resists(self) -> Pass:
        """Its pose, its angular velocity and acceleration while coasting, and its inertia, along the world's axes."""

        def resists(row: Any, world: Any, q: Any, v: Any) -> Any:
            own = self.segment(row)
            (coast,) = motions(self.alone(own, motion_of(world).linear), q, v, [0] * self.axes)
            turn = Pose(coast.X.rotation, ZERO)
            M = Articulated.of(own.inertia).seen_from_parent(turn)
            P, A = turn.inward(net_wrench(own.inertia, coast.A, coast.U)), coast.A.seen_from_parent(turn)
            return by_columns(coast.X), [*turn.rotation @ coast.V.angular], [*A], packed_resistance(M, P)

        reads = ("base.body", "world.coasting", "base.q", "base.v")
        writes = ("base.turned", "base.omega", "base.coasting", "base.resistance")
        return Pass("once", Stage(resists, reads, writes))

    def eliminates(self) -> Pass:
        """What its joint adds to its acceleration, axis by axis in its own frame.

        Featherstone (2008) eqs. (7.38)-(7.44).
        """

        def eliminates(turned: Any, resistance: Any, tau: Any) -> Any:
            turn = Pose(pose_by_columns(turned).rotation, ZERO)
            back = Pose(turn.rotation.T, ZERO)
            M, P = resistance_of(resistance)
            steps = M.seen_from_parent(back).eliminate(self.kind.axes, back.inward(P), tau, [NO_ROTOR] * self.axes)[2]
            a = accelerations(steps, STILL)
            return a, [*self.kind.motion(a).seen_from_parent(turn)]

        reads = ("base.turned", "base.resistance", "base.tau")
        return Pass("once", Stage(eliminates, reads, ("base.a", "base.share")))

    def is_placed(self) -> Pass:
        """Where it is in the world."""

        def is_placed(row: Any, q: Any) -> Any:
            X = pose_of(row[:12]) @ self.kind.pose(q)
            return [*flat(X.rotation), *X.position]

        return Pass("once", Stage(is_placed, ("base.body", "base.q"), ("base.turned",)))

    def stands(self) -> Pass:
        """A base at the world's origin, and its inertia."""

        def stands(row: Any) -> Any:
            return [*flat(IDENTITY), *ZERO], parameters_of(self.segment(row).inertia)

        return Pass("once", Stage(stands, ("base.body",), ("base.turned", "base.carried")))

    def couples(self) -> list[Pass]:
        """The base's rows of the mass matrix: from each carried body's momentum, and from its own motions."""

        def couples(base: Any, span: Any, momentum: Any) -> Any:
            carried = span[0] <= base[-1]
            return [where(carried, effort, 0) for effort in self.kind.effort(wrench_of(momentum))]

        def moved(carried: Any) -> Any:
            rows = [self.kind.effort(inertia_of(carried) * S) for S in self.motions()]
            return [rows[max(j, k)][min(j, k)] for j in range(self.axes) for k in range(self.axes)]

        alone = Pass("alone", Stage(couples, ("base.body", "span", "momentum"), ("matrix_rows",)))
        return [alone, Pass("once", Stage(moved, ("base.carried",), ("base.matrix",)))]
