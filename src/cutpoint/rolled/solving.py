"""Equations with one tree's mass matrix, in machine code: columns of their right-hand sides side by side.

Where neither of two bodies carries the other the matrix is zero, and so are its factors: on trees with short branches
little is left to compute.
"""

from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np

from cutpoint.kernels import Loop, Program, Region, Stage, compile_program
from cutpoint.kernels.arrays.fastcall import Front, fastcall
from cutpoint.kernels.arrays.plain_arguments import is_possible
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.programs.front import ProgramElement
from cutpoint.kernels.programs.outputs import Fixed, Output, Part, whole
from cutpoint.kernels.programs.rows import ProgramRows
from cutpoint.kernels.targets.c99 import Source
from cutpoint.kernels.targets.c99_program import source_of
from cutpoint.mechanics.forward_dynamics import Factors, factors_of, solve
from cutpoint.mechanics.system import System
from cutpoint.rolled.memory import Spare, aligned
from cutpoint.scalars import Scalar, minimum

Array = np.ndarray
Scalars = Sequence[Scalar]

LANES = 8
"""Columns at once."""

MOST_PRODUCTS = 5000
"""In the factors: so many were measured to compile in 1.4 to 1.7 s, 11,000 in 3 to 4."""


class TreeSolver:
    """X with M X + B = 0 for several B, and the inverse of M.  Featherstone (2008) sections 6.4 and 6.5."""

    def __init__(self, system: System, widths: Sequence[int]) -> None:
        """widths: columns of each B."""
        self._n, self._widths = system.nv, [*widths, system.nv]
        self._program = _program(_related(system))
        self._spare = Spare(self._rows)
        self._solve = self._shortcut()

    def __call__(self, M: Array, *given: Array) -> Sequence[Array] | None:
        """M: (..., n, n).  given: each B, (..., n, width).  Each X, and the inverse; None if some M has none."""
        least, *found = self.solutions(M, *given)
        exist = least > 0 if M.ndim == 2 else (least > 0).all()
        return found if exist else None

    def solutions(self, M: Array, *given: Array) -> Sequence[Array]:
        """The same of any M, after the least number of its D: it is above 0 where there is an inverse."""
        return self._solve(M, *given)

    def to_c(self, name: str, M: str, given: Sequence[str], found: Sequence[str]) -> Source:
        """The same in C, without the least number; with these names for what it reads and finds.

        name: what errors call it.
        """
        arrays, inputs, (_, *outputs) = self._memory()
        named = dict(zip((M, *given), inputs, strict=True)), dict(zip(found, outputs, strict=True))
        return source_of(Fixed(self._program.plan, self._counts, arrays, *named), name)

    def _shortcut(self) -> Any:
        """For single matrices."""
        if not is_possible():
            return self._batch
        element, (inputs, outputs) = self._element(), self._ports
        return fastcall(element, "tree_solver", inputs, outputs, Front(self._batch))

    def _batch(self, M: Array, *given: Array) -> list[Array]:
        flat = [np.ascontiguousarray(x).reshape(-1, *x.shape[-2:]) for x in (M, *given)]
        found = [np.empty((len(flat[0]), *port.shape)) for port in self._ports[1]]
        with self._spare.lent() as rows:
            rows(flat, found)
        return [x.reshape(*M.shape[:-2], *x.shape[1:]) for x in found]

    @property
    def _ports(self) -> tuple[list[Port], list[Port]]:
        matrices = [Port(f"X{k}", (self._n, width)) for k, width in enumerate(self._widths)]
        return [Port("M", (self._n, self._n)), *matrices[:-1]], [Port("least", ()), *matrices]

    def _rows(self) -> ProgramRows:
        return ProgramRows(self._element(), *self._ports)

    def _element(self) -> ProgramElement:
        """With memory of its own."""
        arrays, inputs, outputs = self._memory()
        return ProgramElement(self._program.bound(self._counts, **arrays), inputs, outputs)

    @property
    def _counts(self) -> dict[str, int]:
        return {"blocks": sum(-(-width // LANES) for width in self._widths)}

    def _memory(self) -> tuple[dict[str, Array], list[Output], list[Output]]:
        """Arrays, and where in them M and each B stand, and the least number, each X and the inverse."""
        n, blocks = self._n, [-(-width // LANES) for width in self._widths]
        sizes = {r.name: r.room for r in self._program.plan.regions.values()}
        rows: dict[str, int] = dict.fromkeys(("given", "found"), self._counts["blocks"])
        arrays = {name: aligned(rows.get(name, 1) * size).reshape(-1, size) for name, size in sizes.items()}
        starts = [sum(blocks[:k]) for k in range(len(blocks))]
        given, found = (
            [_in_blocks(arrays[name][start:], n, width) for start, width in zip(starts, self._widths, strict=True)]
            for name in rows
        )
        for part in given.pop().parts:  # what has the inverse for its X
            part.own[...] = part.place(-np.eye(n))
        least = whole(arrays["least"].reshape(()))
        return arrays, [whole(arrays["M"].reshape(n, n)), *given], [least, *found]


def is_sparse(system: System) -> bool:
    """Whether the mass matrix has factors of so few numbers that they are worth code of their own."""
    return sum(k * (k + 1) // 2 for k in map(len, _related(system))) <= MOST_PRODUCTS


def _related(system: System) -> list[list[int]]:
    """For each speed those before it, and itself, that move the same bodies."""
    related: list[list[int]] = []
    for i, body in enumerate(system.segments):
        before = [k for j in system.chain_to(i) if j != i for k in range(system.nv)[system.segments[j].v]]
        own = range(system.nv)[body.v]
        related += [sorted([*before, *own[: k + 1]]) for k in range(len(own))]
    return related


def _program(related: Sequence[Sequence[int]]) -> Program:
    """Factors of a matrix, then blocks of columns in turn."""
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

    columns = Loop("blocks", [Stage(solved, ("factors", "given"), ("found",), LANES)], ("given", "found"))
    body = Loop(1, [Stage(factor, ("M",), ("factors", "least")), columns])
    wide = [Region(name, n * LANES, LANES) for name in ("given", "found")]
    return compile_program(body, [Region("M", n * n), Region("factors", count), Region("least", 1), *wide])


def _in_blocks(kept: Array, n: int, width: int) -> Output:
    """A matrix (n, width), of which blocks of columns are kept."""
    count, rest = divmod(width, LANES)
    blocks = kept[: count + 1].reshape(-1, n, LANES).swapaxes(0, 1)
    parts = [Part(blocks[:, :count], np.s_[:, : count * LANES])] if count else []
    parts += [Part(blocks[:, count, :rest], np.s_[:, count * LANES :])] if rest else []
    return Output((n, width), parts)
