"""Equations with a robot's mass matrix, in machine code: columns of their right-hand sides in vector lanes."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np

from cutpoint.kernels import Program
from cutpoint.kernels.arrays.fastcall import Front, fastcall
from cutpoint.kernels.arrays.plain_arguments import is_possible
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.programs.front import ProgramElement
from cutpoint.kernels.programs.outputs import Fixed, Output, Part, whole
from cutpoint.kernels.programs.rows import ProgramRows
from cutpoint.kernels.targets.c99 import Source
from cutpoint.kernels.targets.c99_program import source_of
from cutpoint.rolled.memory import Spare, aligned

EQUATIONS = "equations with the mass matrix"
"""As those are told who wait for their code."""


class Room(NamedTuple):
    """Working memory of a program beside columns: arrays by region, and of these the one that it reads first and the
    least number by which it divides."""

    arrays: dict[str, np.ndarray]
    state: np.ndarray
    least: np.ndarray


class Equations(Protocol):
    """How a program solves them, for "blocks" of columns.

    It reads columns from its region "given", block by block, each with a row for each speed, and writes solutions to
    "found"; those of a base, which come first, may be in "base.given" and "base.found".

    reads: its first input, the mass matrix or the robot's position, of this shape.  speeds: how many there are, and how
    many separate ones of a base.  lanes: columns of a block.
    """

    reads: Literal["M", "q"]
    shape: tuple[int, ...]
    speeds: int
    apart: int
    lanes: int
    program: Program

    def room(self) -> Room:
        """Memory for calls that do not run concurrently."""
        ...

    def counts(self, blocks: int) -> dict[str, int]: ...


class Solver:
    """X with M X + B = 0 for several B, and the inverse of M."""

    def __init__(self, equations: Equations, widths: Sequence[int]) -> None:
        """widths: columns of each B."""
        self.reads: Literal["M", "q"] = equations.reads
        self._equations, self._n, self._widths = equations, equations.speeds, [*widths, equations.speeds]
        self._spare = Spare(self._rows)
        self._solve = self._shortcut()

    def __call__(self, state: np.ndarray, *given: np.ndarray) -> Sequence[np.ndarray] | None:
        """state: what it reads, M (..., n, n) or q (..., n).  given: each B, (..., n, width).

        Each X, and the inverse; None if some M has none.
        """
        least, *found = self.solutions(state, *given)
        exist = least > 0 if isinstance(least, float) else (least > 0).all()
        return found if exist else None

    def state(self, q: np.ndarray, M: np.ndarray) -> np.ndarray:
        """The one of these that it reads, q with all of M's leading axes."""
        if self.reads == "M":
            return M
        return q if q.shape[:-1] == M.shape[:-2] else np.broadcast_to(q, (*M.shape[:-2], q.shape[-1]))

    def solutions(self, state: np.ndarray, *given: np.ndarray) -> Sequence[Any]:
        """The same for any M, after the least number that it divides by: positive where there is an inverse."""
        return self._solve(state, *given)

    def to_c(self, name: str, given: Sequence[str], found: Sequence[str]) -> Source:
        """The same in C, without the least number; with these names for each B and each result.

        name: used in errors.
        """
        arrays, inputs, (_, *outputs) = self._memory()
        named = dict(zip((self.reads, *given), inputs, strict=True)), dict(zip(found, outputs, strict=True))
        return source_of(Fixed(self._equations.program.plan, self._counts, arrays, *named), name)

    def _shortcut(self) -> Any:
        """The built-in function for single states."""
        if not is_possible():
            return self._batch
        element, (inputs, outputs) = self._element(), self._ports
        return fastcall(element, "solver", inputs, outputs, Front(self._batch))

    def _batch(self, state: np.ndarray, *given: np.ndarray) -> Sequence[np.ndarray]:
        with self._spare.lent() as rows:
            found = rows.whole((state, *given), None) if rows.whole else None
            return self._any_batch(rows, state, *given) if found is None else found

    def _any_batch(self, rows: ProgramRows, state: np.ndarray, *given: np.ndarray) -> list[np.ndarray]:
        """The same of any number of axes."""
        shapes = [port.shape for port in self._ports[0]]
        pairs = zip((state, *given), shapes, strict=True)
        flat = [np.ascontiguousarray(x).reshape(-1, *shape) for x, shape in pairs]
        found = [np.empty((len(flat[0]), *port.shape)) for port in self._ports[1]]
        rows(flat, found)
        batch = state.shape[: state.ndim - len(shapes[0])]
        return [x.reshape(*batch, *x.shape[1:]) for x in found]

    @cached_property
    def _ports(self) -> tuple[list[Port], list[Port]]:
        state = Port(self.reads, self._equations.shape)
        matrices = [Port(f"X{k}", (self._n, width)) for k, width in enumerate(self._widths)]
        return [state, *matrices[:-1]], [Port("least", ()), *matrices]

    def _rows(self) -> ProgramRows:
        return ProgramRows(self._element(), *self._ports)

    def _element(self) -> ProgramElement:
        """Code for one element, with its own memory."""
        arrays, inputs, outputs = self._memory()
        return ProgramElement(self._equations.program.bound(self._counts, **arrays), inputs, outputs)

    @property
    def _counts(self) -> dict[str, int]:
        return self._equations.counts(sum(self._blocks))

    @property
    def _blocks(self) -> list[int]:
        """Number of blocks of each B, and of the one whose X is the inverse."""
        return [-(-width // self._equations.lanes) for width in self._widths]

    def _memory(self) -> tuple[dict[str, np.ndarray], list[Output], list[Output]]:
        """Arrays, and where in them the state and each B stand, and the least number, each X and the inverse."""
        room, sizes = self._equations.room(), self._equations.program.plan.sizes
        arrays = dict(room.arrays)

        def matrices(name: str) -> list[Output]:
            """Of each B, or X."""
            n, first, lanes = self._n, self._equations.apart, self._equations.lanes
            every = {f"base.{name}": range(first), name: range(first, n)} if first else {name: range(n)}
            parts: list[list[Part]] = [[] for _ in self._widths]
            for region, rows in every.items():
                blocks = aligned(sum(self._blocks) * len(rows) * lanes).reshape(-1, len(rows), lanes)
                arrays[region] = blocks.reshape(-1, sizes[region])
                for k, width in enumerate(self._widths):
                    parts[k] += _in_blocks(blocks[sum(self._blocks[:k]) :], width, rows)
            return [Output((n, width), x) for width, x in zip(self._widths, parts, strict=True)]

        given, found = matrices("given"), matrices("found")
        for part in given.pop().parts:  # the one whose X is the inverse
            part.own[...] = part.place(-np.eye(self._n))
        return arrays, [whole(room.state), *given], [whole(room.least), *found]


def _in_blocks(kept: np.ndarray, width: int, rows: range) -> list[Part]:
    """Rows of a matrix (n, width), of which blocks of columns are kept (blocks, rows, lanes)."""
    lanes, at = kept.shape[-1], slice(rows.start, rows.stop)
    count, rest = divmod(width, lanes)
    blocks = kept[: count + 1].swapaxes(0, 1)
    parts = [Part(blocks[:, :count], np.s_[at, : count * lanes])] if count else []
    return parts + ([Part(blocks[:, count, :rest], np.s_[at, count * lanes :])] if rest else [])
