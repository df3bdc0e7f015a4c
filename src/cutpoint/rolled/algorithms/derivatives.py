"""Derivatives of a motion's torques with respect to it, as passes: clouds of mass inward, then every pair of bodies.

All quantities are about one point and along fixed axes, as in `mass`: there what bodies carry is a plain sum.  With a
floating base these are where it is at this instant.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from cutpoint.drive_slopes import MOTION, motor_slopes
from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies.rigid_body import inertia_of, parameters_of
from cutpoint.mechanics.bodies.spatial import AT_ORIGIN, IDENTITY, ZERO, Inertia, Motion, Vec3, Wrench
from cutpoint.mechanics.elastic_inverse import DEFAULT, Options
from cutpoint.mechanics.torque_derivatives import Change, Cloud, Effort, along_motion
from cutpoint.model import Drive
from cutpoint.rolled.algorithms.base import Base, base_in, sizes_apart
from cutpoint.rolled.algorithms.motions import MOVED, VIEWS, against_gravity, body_motions, world_rows
from cutpoint.rolled.algorithms.placing import RATES, world_poses
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.kinship import Kinship
from cutpoint.rolled.packing import added, flat, mat3_of, motion_of, pose_of, wrench_of
from cutpoint.rolled.passes import PLAIN, WITH_RATES, Order, Pass, Steps
from cutpoint.scalars import Scalar, where

Scalars = Sequence[Scalar]

MATRICES = ("d_q", "d_v", "d_a")
"""Of joint torques."""

OF_MOTORS = tuple(f"d_motor_torque_d_{rate}" for rate in RATES)

SEEN = {"column": 6, "changes": 15, "effort": 9, "felt": 12}
"""What one body of a pair needs to know of the other, beside its span."""

KEPT = {"velocity": 6, "acceleration": 6, "carried": 28, **SEEN}
"""Of each body, beside its pose and its span."""


def inverse_dynamics(columns: Columns) -> Steps:
    """d torque / d (q, v, a).  Carpentier and Mansard (2018), by the records of `mechanics.torque_derivatives`."""
    found, base = _changes_within(columns, PLAIN), base_in(columns)
    own = _couples(base, dict(zip(MATRICES, MATRICES, strict=True))) if base else NO_BASE

    def entries(kin: Kinship, held: Any, *other: Any) -> Any:
        return [[x] for x in _entries(kin, _like(other, held), other)]

    reads = ("held", *SEEN, "span")
    return own.with_pairs(found, Pass("pairs", Stage(entries, reads, MATRICES)))


def coriolis_matrix(columns: Columns) -> Steps:
    """C(q, v) for which M' - 2 C is skew and C(q, v) w - C(q, w) v is M times the bracket of v and w.

    For coordinate rates it is zero, so the derivative of the torques C v by v is 2 C: C, then, at half the speed.
    A base's speeds are those of a moving frame, with bracket V x W: with it they change a motion as joints' speeds do.
    Wensing, Englsberger and Slotine (2023), Coriolis factorizations and their connections to Riemannian geometry, arXiv
    2312.14425.
    """
    base = base_in(columns)
    found = _changes_within(columns, PLAIN, brackets=True)
    own = _couples(base, {"d_v": "C"}) if base else NO_BASE

    def halved(v: Any) -> Any:
        return [x * 0.5 for x in v]

    def entries(kin: Kinship, held: Any, *other: Any) -> Any:
        return [_entries(kin, _like(other, held), other)[1]]

    first = [Pass("alone", Stage(halved, ("v",), ("v",)))]
    first += [Pass("once", Stage(halved, ("base.v",), ("base.v",)))] if base else []
    whole = own.with_pairs(found, Pass("pairs", Stage(entries, ("held", *SEEN, "span"), ("C",))))
    return whole._replace(passes=[*first, *whole.passes])


def elastic_inverse_dynamics(columns: Columns, options: Options = DEFAULT) -> Steps:
    """d motor torque / d (q, v, a, jerk, snap), of trees without a floating base.

    A motor's torque depends on its joint's torque with two rates, and on its own joint's motion.  slopes: by all these.
    """
    found, read = _changes_within(columns, WITH_RATES), WITH_RATES.scalars

    def motor(row: Any, column: Any, carried: Any, *motion: Any) -> Any:
        (_, F), (acceleration,) = _cloud(read(carried)), WITH_RATES.rate(motion, 2)
        torque = motion_of(read(column)).power(F) + columns.subsystem(row).armature * acceleration
        given = [*WITH_RATES.packed([torque]), *(x for (x,) in motion)]
        return columns.by_drive(row, lambda drive: motor_slopes(drive or Drive(), given, options))

    def entries(kin: Kinship, held: Any, *other: Any) -> Any:
        *own, slopes = _like(other, held)
        by = [WITH_RATES.packed([x]) for x in _entries(kin, *([*map(read, x[:4]), x[4]] for x in (own, other)))]
        rates, is_own = range(len(OF_MOTORS)), kin.of(own[4], other[4]).is_same
        through = (sum((h * along_motion(by, k, rate) for k, h in enumerate(slopes[:3])), 0) for rate in rates)
        return [[where(is_own, x + own_rate, x)] for x, own_rate in zip(through, slopes[3:], strict=True)]

    reads = ("held", *SEEN, "span", "slopes")
    alone = Pass("alone", Stage(motor, ("body", "column", "carried", *RATES), ("slopes",)))
    passes = [*found.passes, alone, Pass("pairs", Stage(entries, reads, OF_MOTORS))]
    return found._replace(kept={**found.kept, "slopes": len(MOTION)}, passes=passes)


def _changes_within(columns: Columns, order: Order, *, brackets: bool = False) -> Steps:
    """How each body's joint changes torques, and how that acts further in: everything but the pairs.

    column: a body's motion at unit speed of its joint.  velocity, acceleration: of the point of the body that is at
    that one place, and angular.  carried: the cloud of the body and its wrench, then with those of all that it carries.
    changes: of the motion of all that, by the joint's position and by its speed.  effort: what changes further in take
    along the joint.  felt: what the joint's own changes take, further in.  span: the body's number, the last number
    that it carries, and its armature.

    brackets: whether a base's speeds also change motions by their brackets with its velocity.
    """
    base, read, packed, m = base_in(columns), order.scalars, order.packed, order.numbers
    placed, kept = world_poses(columns, [_moves(base, 1 + brackets)] if base else [], order)

    def alone(row: Any, turned: Any, velocity: Any, acceleration: Any) -> Any:
        M = columns.subsystem(row).body.inertia.seen_from_parent(pose_of(read(turned)))
        return packed(_costs(M, motion_of(read(velocity)), motion_of(read(acceleration))))

    def changed(row: Any, column: Any, velocity: Any, acceleration: Any, carried: Any) -> Any:
        own, S = columns.subsystem(row), motion_of(read(column))
        by_q, by_v = _changes(S, motion_of(read(velocity)), motion_of(read(acceleration)))
        cloud, F = _cloud(read(carried))
        effort, felt = cloud.effort(S), [cloud.wrench(by_q) + S.cross_wrench(F), cloud.wrench(by_v)]
        found = ([*by_q.A, *by_q.omega, *by_v.A], [*effort.F, *effort.moment], [x for G in felt for x in G])
        return *map(packed, found), [own.number, own.last, own.armature]

    rates, (_, *seen) = RATES[: m + 2], (*SEEN, "span")
    passes = [
        *placed,
        *body_motions(columns, order, rates),
        Pass("alone", Stage(alone, ("body", "turned", *MOVED), ("carried",))),
        Pass("inward", Stage(added, ("carried", "borne"), ("borne",))),
        Pass("alone", Stage(changed, ("body", "column", *MOVED, "carried"), seen)),
    ]
    sizes, constants = sizes_apart(base, rates)
    sizes |= {"base.changes": 12 * base.axes} if base else {}
    kept |= {"span": 3, **{name: size * m for name, size in KEPT.items()}}
    views = (*VIEWS, View("borne", "carried", "parent"))
    return Steps(kept, rates, views, world_rows(order), passes, sizes, constants)


def _changes(S: Motion, V: Motion, A: Motion) -> tuple[Change, Change]:
    """Derivatives of the motion of a body that moves with V and A, by the position and speed of its joint along S.

    Singh, Russell and Wensing (2022), arXiv 2105.05102: from the rates of S.  A joint's own speed does not move its
    axis, so the body's velocity gives the same as its carrier's.
    """
    rate = V.cross(S)
    return Change(A.cross(S) + V.cross(rate), rate.angular), Change(rate * 2, S.angular)


def _costs(M: Inertia, V: Motion, A: Motion) -> list[Scalar]:
    """A body's cloud about a fixed point, and the net wrench of its motion."""
    cloud = Cloud.of(M, V.angular).seen_from_parent(AT_ORIGIN, V.linear)
    F = M * A + V.cross_wrench(M * V)
    return [*parameters_of(M), *cloud.twice_momentum, *flat(cloud.drift), *F]


def _cloud(carried: Scalars) -> tuple[Cloud, Wrench]:
    return Cloud(inertia_of(carried[:10]), Vec3(*carried[10:13]), mat3_of(carried[13:22])), wrench_of(carried[22:])


def _entries(kin: Kinship, own: Sequence[Any], other: Sequence[Any]) -> list[Scalar]:
    """Derivatives of one body's torque by another's joint: entries of three matrices, if one carries the other."""
    own_column, _, own_effort, _, own_span = own
    column, changes, their_effort, felt, span = other
    S, effort, related = motion_of(own_column), _effort(own_effort), kin.of(own_span, span)
    by_q, by_v = Change(motion_of(changes[:6]), Vec3(*changes[6:9])), Change(motion_of(changes[9:]), Vec3(*column[3:]))
    inner = [effort.of(by_q), effort.of(by_v), motion_of(column).power(effort.F)]
    outer = [S.power(wrench_of(felt[:6])), S.power(wrench_of(felt[6:])), S.power(_effort(their_effort).F)]
    further_in, further_out, is_same = related.is_carried, related.carries, related.is_same
    d_q, d_v, d_a = (where(further_in, x, where(further_out, y, 0)) for x, y in zip(inner, outer, strict=True))
    return [d_q, d_v, where(is_same, d_a + own_span[2], d_a)]


def _like(parts: Sequence[Scalars], numbers: Scalars) -> list[Scalars]:
    """The numbers split into parts of the same lengths as these."""
    rest = iter(numbers)
    return [[next(rest) for _ in part] for part in parts]


def _effort(numbers: Scalars) -> Effort:
    return Effort(wrench_of(numbers[:6]), Vec3(*numbers[6:]))


def _moves(base: Base, times: int) -> Pass:
    """A base in its current frame: its motion, the net wrench of that, and their derivatives by each of its speeds.

    times: how often its velocity moves an axis: twice where brackets count.
    """

    def moves(row: Any, q: Any, v: Any, a: Any, world: Any) -> Any:
        upward, V = against_gravity(base, row, q, world), base.kind.motion(v)
        A = upward + base.kind.motion(a)
        changes = [x for S in base.motions() for x in (*upward.cross(S), *(V.cross(S) * times))]
        return [*flat(IDENTITY), *ZERO], [*V], [*A], _costs(base.segment(row).inertia, V, A), changes

    reads = ("base.body", *(f"base.{x}" for x in RATES[:3]), "world.acceleration")
    writes = ("base.turned", "base.velocity", "base.acceleration", "base.carried", "base.changes")
    return Pass("once", Stage(moves, reads, writes))


class BasePart(NamedTuple):
    """A base's part of matrices: passes, and sizes of regions with a row for each body and of those apart."""

    passes: list[Pass]
    kept: Mapping[str, int]
    apart: Mapping[str, int]

    def with_pairs(self, steps: Steps, pairs: Pass) -> Steps:
        """Steps, followed by all of the matrices."""
        kept, apart = {**steps.kept, **self.kept}, {**steps.apart, **self.apart}
        return steps._replace(passes=[*steps.passes, *self.passes, pairs], kept=kept, apart=apart)


NO_BASE = BasePart([], {}, {})


def _couples(base: Base, names: Mapping[str, str]) -> BasePart:
    """Entries of a base's torques and speeds with each carried body, and among themselves.

    names: which of `MATRICES` are wanted, and their names there.
    """

    def by_each(numbers: Scalars) -> list[tuple[Change, Change]]:
        """Its speeds' changes."""
        places = [numbers[k : k + 12] for k in range(0, len(numbers), 12)]
        pairs = zip(base.motions(), places, strict=True)
        return [(Change(motion_of(x[:6]), ZERO), Change(motion_of(x[6:]), S.angular)) for S, x in pairs]

    def couples(row: Any, base_changes: Any, effort: Any, felt: Any, span: Any) -> Any:
        own, by = _effort(effort), by_each(base_changes)
        wrenches = {"d_q": wrench_of(felt[:6]), "d_v": wrench_of(felt[6:]), "d_a": own.F}
        columns = {"d_q": [own.of(by_q) for by_q, _ in by], "d_v": [own.of(by_v) for _, by_v in by]}
        parts = [*(base.kind.effort(wrenches[name]) for name in names), *(columns[name] for name in names_of_columns)]
        return [[where(span[0] <= row[-1], x, 0) for x in part] for part in parts]

    def among(carried: Any, base_changes: Any) -> Any:
        cloud, by, motions = _cloud(carried)[0], by_each(base_changes), base.motions()
        efforts = [cloud.effort(S) for S in motions]
        d_q, d_v = ([own.of(changes[k]) for own in efforts for changes in by] for k in (0, 1))
        blocks = {"d_q": d_q, "d_v": d_v, "d_a": [S.power(own.F) for own in efforts for S in motions]}
        found = [blocks[name] for name in names]
        return found if len(found) > 1 else found[0]

    names_of_columns = [name for name in names if name != "d_a"]  # which is symmetric
    shared = [*(f"{x}_rows" for x in names.values()), *(f"{names[name]}_columns" for name in names_of_columns)]
    apart = {f"base.{name}": base.axes**2 for name in names.values()}
    reads = ("base.body", "base.changes", "effort", "felt", "span")
    blocks = Stage(among, ("base.carried", "base.changes"), [*apart])
    passes = [Pass("alone", Stage(couples, reads, shared)), Pass("once", blocks)]
    return BasePart(passes, dict.fromkeys(shared, base.axes), apart)
