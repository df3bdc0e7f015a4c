"""Equations with a long tree's mass matrix, solved through its bodies: time per column is linear in their number."""

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from cutpoint.kernels import LaneLoop, Loop, Region, Stage, View, compile_program
from cutpoint.mechanics.bodies.joints import dot
from cutpoint.mechanics.bodies.spatial import IDENTITY, STILL, Motion, Pose, Vec3, Wrench
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.algorithms.base import base_in
from cutpoint.rolled.bodies import BASE, columns_of, parents_of
from cutpoint.rolled.equations.elimination import elimination
from cutpoint.rolled.equations.solver import EQUATIONS, Room
from cutpoint.rolled.memory import Task, aligned
from cutpoint.rolled.packing import motion_of, wrench_of
from cutpoint.rolled.passes import Kept, Rolled, one_by_one
from cutpoint.rolled.recipes import Recipe
from cutpoint.rolled.runs import memory_of
from cutpoint.scalars import Scalar, where

Scalars = Sequence[Scalar]

BODIES_AT_ONCE = 8
"""Where each is computed alone."""


class ArticulatedBodies:
    """By articulated bodies: torques inward, then accelerations outward.

    Featherstone (2008) section 7.3, for a robot at rest without gravity.
    """

    reads: Literal["M", "q"] = "q"
    lanes = 16

    def __init__(self, system: System) -> None:
        columns = columns_of(system)
        base = base_in(columns)
        self.speeds, self.shape, self.apart = system.nv, (system.nq,), base.axes if base else 0
        self._parents = parents_of(system)
        steps, step = elimination(columns)
        self._task = Task(Recipe(lambda _: steps, ("q",), ("least",), 0), system, columns, "llvm", None)
        bodies = one_by_one(steps, columns, BODIES_AT_ONCE)
        self._rolled = _with_columns(bodies, step, self.lanes, self.apart)
        self.program = compile_program(self._rolled.body, self._rolled.regions, name=EQUATIONS)

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


def _with_columns(rolled: Rolled, step: Kept, lanes: int, axes: int) -> Rolled:
    """Adds the loop over blocks of columns, each through all bodies inward and outward.

    borne: wrenches of what a body carries.  axes: of a base.
    """
    hold = Stage(lambda x: x, ("step of one",), ("held",))
    sweeps = [_inward(step, lanes), *([_at_base(axes, lanes)] if axes else []), _outward(step, lanes)]
    streams, wide = ["given", "found"], {"given": 1, "found": 1, "borne": 6, "added": 6}
    if axes:
        streams, wide = [*streams, "base.given", "base.found"], {**wide, "base.given": axes, "base.found": axes}
    loops = [
        LaneLoop("bodies", [hold], ("held",), views=[View("step of one", "step", "self")]),
        Loop("columns", sweeps, streams),
    ]
    regions = [Region("held", step.size), Region("first", 1), *(Region(k, x * lanes, lanes) for k, x in wide.items())]
    return Rolled(Loop(1, [*rolled.body.body, *loops]), (*rolled.regions, *regions))


def _inward(step: Kept, lanes: int) -> Loop:
    """Torques left for joints to accelerate with, and the wrench that each transmits to its carrier.

    first: whether a body is the first to do so, and finds there what the previous block has left.
    """

    def inward(held: Any, first: Any, b: Any, own: Any, carrier: Any) -> Any:
        z, share, gain, X = _step(step.all(held))
        P = wrench_of(own)
        left = 0 - b[0] - z.power(P)
        there = wrench_of([where(first[0] > 0, 0, x) for x in carrier])
        handed = there + X.inward(P) + Wrench(share.force * left, share.moment * left)
        return [gain * left], [*handed]

    bears = View("carrier's borne", "borne", "carrier")
    back = Stage(inward, ("held", "first", "given", "borne", bears.name), ("found", bears.name), lanes)
    return Loop("bodies", [back], ("held", "first", "given", "found", "borne"), backward=True, views=[bears])


def _outward(step: Kept, lanes: int) -> Loop:
    """Each joint's acceleration from its carrier's."""

    def outward(held: Any, own: Any, carrier: Any) -> Any:
        z, share, _, X = _step(step.all(held))
        A = motion_of(carrier)
        x = own[0] - A.power(share)
        return [x], [*(X.outward(A) + z * x)]

    leads = View("carrier's added", "added", "carrier")
    forth = Stage(outward, ("held", "found", leads.name), ("found", "added"), lanes)
    return Loop("bodies", [forth], ("held", "found", "added"), views=[leads])


def _at_base(axes: int, lanes: int) -> Loop:
    """A base's accelerations, and what they add to those of the bodies on it."""

    def at_base(held: Any, b: Any, own: Any) -> Any:
        gains, P = [held[k : k + axes] for k in range(0, axes**2, axes)], wrench_of(own)
        S = [motion_of(held[k : k + 6]) for k in range(axes**2, len(held), 6)]
        left = [0 - torque - z.power(P) for torque, z in zip(b, S, strict=True)]
        x = [dot(row, left) for row in gains]
        return x, [*sum((z * a for z, a in zip(S, x, strict=True)), STILL)]

    views = [View(f"base's {name}", name, "of base") for name in ("borne", "added")]
    reads, writes = ("base.step", "base.given", views[0].name), ("base.found", views[1].name)
    return Loop(1, [Stage(at_base, reads, writes, lanes)], views=views)


def _step(numbers: Scalars) -> tuple[Motion, Wrench, Scalar, Pose]:
    """What is kept of one: see `elimination`."""
    return motion_of(numbers[:6]), wrench_of(numbers[6:12]), numbers[12], Pose(IDENTITY, Vec3(*numbers[13:]))
