"""Equations with a long tree's mass matrix, solved through its bodies: each column in time that grows with their number
alone.
"""

from collections.abc import Sequence
from functools import reduce
from typing import Any, Literal

import numpy as np

from cutpoint.kernels import LaneLoop, Loop, Region, Stage, View, compile_program
from cutpoint.mechanics.articulated import Articulated
from cutpoint.mechanics.forward_dynamics import factors_of, solve
from cutpoint.mechanics.joints import dot
from cutpoint.mechanics.spatial import IDENTITY, STILL, ZERO, Motion, Pose, Vec3, Wrench
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.base import Base, base_in, sizes_apart
from cutpoint.rolled.bodies import BASE, Columns, columns_of, parents_of
from cutpoint.rolled.equations.solver import Room
from cutpoint.rolled.forward import give_way, turned_pose
from cutpoint.rolled.memory import Task, aligned
from cutpoint.rolled.packing import (
    INERTIA,
    articulated_of,
    by_columns,
    flat,
    motion_of,
    packed_inertia,
    pose_by_columns,
    pose_of,
    wrench_of,
)
from cutpoint.rolled.passes import PLAIN, Kept, Pass, Rolled, Steps, one_by_one
from cutpoint.rolled.recipes import Recipe
from cutpoint.rolled.runs import memory_of
from cutpoint.rolled.steps import placing
from cutpoint.scalars import Scalar, minimum, where

Array = np.ndarray
Scalars = Sequence[Scalar]

BODIES_AT_ONCE = 8
"""Where each is computed alone."""

UNLIMITED = 1e300
"""More than any inertia."""

NOTHING = Wrench(ZERO, ZERO)


class Yielding:
    """By articulated bodies: torques inward, to which joints give way, then accelerations outward.

    Featherstone (2008) section 7.3, of a robot that neither moves nor weighs anything.
    """

    reads: Literal["M", "q"] = "q"
    lanes = 16

    def __init__(self, system: System) -> None:
        columns = columns_of(system)
        base = base_in(columns)
        self.speeds, self.shape, self.apart = system.nv, (system.nq,), base.axes if base else 0
        self._parents = parents_of(system)
        steps, step = _articulated(columns)
        self._task = Task(Recipe(lambda _: steps, ("q",), ("least",), 0), system, columns, "llvm", None)
        bodies = one_by_one(steps, columns, BODIES_AT_ONCE)
        self._rolled = _with_columns(bodies, step, self.lanes, self.apart)
        self.program = compile_program(self._rolled.body, self._rolled.regions)

    def room(self) -> Room:
        n, names = len(self._parents), self.program.plan.names
        arrays, vectors, _ = memory_of(self._task, self._rolled, BODIES_AT_ONCE)
        sizes, rows = self.program.plan.sizes, {"first": n, "borne": n + 2, "added": n + 2}  # the world's, the base's
        arrays |= {name: aligned(count * sizes[name]).reshape(count, -1) for name, count in rows.items()}
        last_children = {parent: k for k, parent in enumerate(self._parents)}
        arrays["first"][[*last_children.values()]] = 1
        carrier = np.select([self._parents == WORLD, self._parents == BASE], [n, n + 1], self._parents)
        arrays |= {"self": np.arange(n), "carrier": carrier, "of base": np.array([n + 1])}
        read = {name: x for name, x in arrays.items() if name in names and not name.endswith(("given", "found"))}
        return Room(read, vectors["q"][: self.shape[0]], arrays["least"].reshape(()))

    def counts(self, blocks: int) -> dict[str, int]:
        n = len(self._parents)
        return {"bodies": n, "blocks": -(-n // BODIES_AT_ONCE), "columns": blocks}


def _articulated(columns: Columns) -> tuple[Steps, Kept]:
    """How every joint gives way; and how that is kept, as "step".  Featherstone (2008) eqs. (7.38)-(7.44).

    A step: the joint's axis, the share that it takes of its carrier's acceleration, what a unit of torque accelerates,
    and where the body is in its carrier, along the world's axes.  least: what the softest of all joints resists.
    base.step: what units of its torques accelerate, and its axes along the world's.
    """
    (place, pose), base = placing(columns, PLAIN, ("q",)), base_in(columns)

    def turns(row: Any, at: Any, above: Any) -> Any:
        return by_columns(turned_pose(pose_by_columns(above), pose_of(pose.all(at))))

    def stands(row: Any, turned: Any) -> Any:
        return packed_inertia(Articulated.of(along(row, turned).body.inertia).T)

    def yields(row: Any, turned: Any, inertia: Any, carrier: Any) -> tuple[list[Scalar], Scalar, list[Scalar]]:
        own = along(row, turned)
        left, _, step = give_way(own, articulated_of(inertia), NOTHING, 1, articulated_of(carrier), NOTHING)
        numbers = [*step.axis, *step.share, step.own, *own.body.placement.position]
        return numbers, 1 / step.own, packed_inertia(left)

    def inward(row: Any, turned: Any, inertia: Any, carrier: Any, least: Any) -> Any:
        numbers, D, left = yields(row, turned, inertia, carrier)
        return step.some(numbers), left, [minimum(least[0], D)]

    def along(row: Any, turned: Any) -> Any:
        return columns.subsystem(row).along_the_world(pose_by_columns(turned))

    sizes = {"row": columns.width, "turned": 12, "inertia": INERTIA, "carrier": INERTIA}
    step, reads = Kept(lambda **x: yields(**x)[0], **sizes), ("body", "turned", "inertia", "resisted")
    passes = [
        Pass("alone", place),
        Pass("once", Stage(lambda: [UNLIMITED], (), ("least",))),
        *([_stands(base)] if base else []),
        Pass("outward", Stage(turns, ("body", "pose", "above"), ("turned",))),
        Pass("outward", Stage(stands, ("body", "turned"), ("inertia",))),
        Pass("inward", Stage(inward, (*reads, "least"), ("step", "resisted", "least"))),
        *([_gives_way(base)] if base else []),
    ]
    kept = {"pose": pose.size, "turned": 12, "inertia": INERTIA, "step": step.size}
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


def _gives_way(base: Base) -> Pass:
    """How a base gives way, all its axes at once."""

    def gives_way(turned: Any, inertia: Any, least: Any) -> Any:
        turn, M, n = Pose(pose_by_columns(turned).rotation, ZERO), articulated_of(inertia), base.axes
        axes = [S.seen_from_parent(turn) for S in base.motions()]
        lower = [[dot([*S], [dot(row, [*z]) for row in M.rows]) for S in axes] for z in axes]
        factors = factors_of(lower)
        gains = [x for k in range(n) for x in solve(factors, [int(j == k) for j in range(n)])]
        return [*gains, *(x for S in axes for x in S)], [reduce(minimum, [factors.L[k][k] for k in range(n)], least[0])]

    return Pass("once", Stage(gives_way, ("base.turned", "base.inertia", "least"), ("base.step", "least")))


def _with_columns(rolled: Rolled, step: Kept, lanes: int, axes: int) -> Rolled:
    """Then blocks of columns in turn, each through all bodies inward and outward.

    borne: wrenches of what a body carries; the first that it is handed finds there what the block before has left.
    axes: of a base.
    """

    def inward(held: Any, first: Any, b: Any, own: Any, carrier: Any) -> Any:
        z, share, gain, X = _step(step.all(held))
        P = wrench_of(own)
        left = 0 - b[0] - z.power(P)
        there = wrench_of([where(first[0] > 0, 0, x) for x in carrier])
        handed = there + X.inward(P) + Wrench(share.force * left, share.moment * left)
        return [gain * left], [*handed]

    def outward(held: Any, own: Any, carrier: Any) -> Any:
        z, share, _, X = _step(step.all(held))
        A = motion_of(carrier)
        x = own[0] - A.power(share)
        return [x], [*(X.outward(A) + z * x)]

    def of_base(held: Any, b: Any, own: Any) -> Any:
        gains, P = [held[k : k + axes] for k in range(0, axes**2, axes)], wrench_of(own)
        S = [motion_of(held[k : k + 6]) for k in range(axes**2, len(held), 6)]
        left = [0 - torque - z.power(P) for torque, z in zip(b, S, strict=True)]
        x = [dot(row, left) for row in gains]
        return x, [*sum((z * a for z, a in zip(S, x, strict=True)), STILL)]

    hold = Stage(lambda x: x, ("step of one",), ("held",))
    bears, leads = (View(f"carrier's {name}", name, "carrier") for name in ("borne", "added"))
    back = Stage(inward, ("held", "first", "given", "borne", bears.name), ("found", bears.name), lanes)
    forth = Stage(outward, ("held", "found", leads.name), ("found", "added"), lanes)
    sweeps = [
        Loop("bodies", [back], ("held", "first", "given", "found", "borne"), backward=True, views=[bears]),
        Loop("bodies", [forth], ("held", "found", "added"), views=[leads]),
    ]
    streams, wide = ["given", "found"], {"given": 1, "found": 1, "borne": 6, "added": 6}
    if axes:
        views = [View(f"base's {name}", name, "of base") for name in ("borne", "added")]
        stage = Stage(of_base, ("base.step", "base.given", views[0].name), ("base.found", views[1].name), lanes)
        sweeps.insert(1, Loop(1, [stage], views=views))
        streams, wide = [*streams, "base.given", "base.found"], {**wide, "base.given": axes, "base.found": axes}
    loops = [
        LaneLoop("bodies", [hold], ("held",), views=[View("step of one", "step", "self")]),
        Loop("columns", sweeps, streams),
    ]
    regions = [Region("held", step.size), Region("first", 1), *(Region(k, x * lanes, lanes) for k, x in wide.items())]
    return Rolled(Loop(1, [*rolled.body.body, *loops]), (*rolled.regions, *regions))


def _step(numbers: Scalars) -> tuple[Motion, Wrench, Scalar, Pose]:
    """What is kept of one: see `_articulated`."""
    return motion_of(numbers[:6]), wrench_of(numbers[6:12]), numbers[12], Pose(IDENTITY, Vec3(*numbers[13:]))
