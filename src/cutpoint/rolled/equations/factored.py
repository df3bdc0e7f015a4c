"""Equations with one tree's mass matrix, solved by its factors.

Where neither of two bodies carries the other the matrix is zero, and so are its factors: on trees with short branches
they are sparse.
"""

from collections.abc import Sequence
from functools import reduce
from typing import Any, Literal

from cutpoint.kernels import Loop, Program, Region, Stage, compile_program
from cutpoint.mechanics.factors import Factors, factors_of, solve
from cutpoint.mechanics.system import System
from cutpoint.rolled.equations.solver import EQUATIONS, Room
from cutpoint.rolled.memory import aligned
from cutpoint.scalars import Scalar, minimum

Scalars = Sequence[Scalar]

MOST_PRODUCTS = 5000
"""In the factors: so many were measured to compile in 1.4 to 1.7 s, 11,000 in 3 to 4."""


class Factored:
    """Solution by factorising the matrix.  Featherstone (2008) sections 6.4 and 6.5."""

    reads: Literal["M", "q"] = "M"
    apart, lanes = 0, 8

    def __init__(self, system: System) -> None:
        self.speeds, self.shape = system.nv, (system.nv,) * 2
        self.program = _program(_related(system), self.lanes)

    def room(self) -> Room:
        regions = self.program.plan.regions.values()
        arrays = {r.name: aligned(r.room) for r in regions if r.name not in ("given", "found")}
        return Room(arrays, arrays["M"].reshape(self.speeds, -1), arrays["least"].reshape(()))

    def counts(self, blocks: int) -> dict[str, int]:
        return {"blocks": blocks}


def is_sparse(system: System) -> bool:
    """Whether the mass matrix has factors sparse enough to be worth their own code."""
    return sum(k * (k + 1) // 2 for k in map(len, _related(system))) <= MOST_PRODUCTS


def _related(system: System) -> list[list[int]]:
    """For each speed the earlier ones, and itself, that move the same bodies."""
    related: list[list[int]] = []
    for i, body in enumerate(system.segments):
        before = [k for j in system.chain_to(i) if j != i for k in range(system.nv)[system.segments[j].v]]
        own = range(system.nv)[body.v]
        related += [sorted([*before, *own[: k + 1]]) for k in range(len(own))]
    return related


def _program(related: Sequence[Sequence[int]], lanes: int) -> Program:
    """Factorises a matrix, then solves for blocks of columns in turn."""
    n, count = len(related), sum(map(len, related))

    def factor(M: Scalars) -> Any:
        lower = [[M[k * n + i] if i in row else 0 for i in range(n)] for k, row in enumerate(related)]
        L, inverse = factors_of(lower)
        kept = [inverse[k] if i == k else L[k][i] for k, row in enumerate(related) for i in row]
        return kept, [reduce(minimum, [L[k][k] for k in range(n)])]

    def solved(kept: Scalars, b: Scalars) -> Any:
        numbers = iter(kept)
        L: list[list[Scalar]] = [[0] * n for _ in range(n)]
        for k, row in enumerate(related):
            for i in row:
                L[k][i] = next(numbers)
        return solve(Factors(L, [L[k][k] for k in range(n)]), [0 - x for x in b])

    columns = Loop("blocks", [Stage(solved, ("factors", "given"), ("found",), lanes)], ("given", "found"))
    body = Loop(1, [Stage(factor, ("M",), ("factors", "least")), columns])
    wide = [Region(name, n * lanes, lanes) for name in ("given", "found")]
    return compile_program(
        body, [Region("M", n * n), Region("factors", count), Region("least", 1), *wide], name=EQUATIONS
    )
