"""Runs of a function's loops on one configuration."""

from collections.abc import Mapping, Sequence
from math import prod

import numpy as np

from cutpoint.kernels import Program, compile_program
from cutpoint.kernels.programs.outputs import Fixed, Output, Part, whole
from cutpoint.rolled.memory import COLUMN, Spare, Task, aligned
from cutpoint.rolled.passes import Rolled, one_by_one

Arrays = dict[str, np.ndarray]


class One:
    """A function of one configuration: steps of bodies alone run on `lanes` bodies at once."""

    def __init__(self, task: Task, lanes: int, name: str) -> None:
        """name: used in progress messages."""
        self._task, self.lanes, self.name = task, lanes, name
        self._rolled = one_by_one(task.steps, task.columns, lanes)
        self.program = compile_program(self._rolled.body, self._rolled.regions, task.backend, name=name)
        self.spare = Spare(self.memory)

    def memory(self) -> "OneMemory":
        """Memory for calls that do not run concurrently."""
        arrays, vectors, counts = memory_of(self._task, self._rolled, self.lanes)
        stated = {k: counts[k] for k in self.program.counts}
        return OneMemory(self._task, self.program, stated, arrays, vectors)


def memory_of(task: Task, rolled: Rolled, lanes: int) -> tuple[Arrays, Arrays, dict[str, int]]:
    """Arrays by region or list of rows; those of which inputs and outputs are parts; and counts."""
    n, blocks = task.bodies, -(-task.bodies // lanes)
    rows = dict.fromkeys((*task.columns.read, *task.steps.kept), blocks + 1)
    rows |= {**dict.fromkeys(task.steps.matrices, n * blocks), "held": n}
    rows |= dict.fromkeys(set(task.steps.threes) & task.steps.kept.keys(), blocks * lanes + 2)
    rows |= dict.fromkeys(task.steps.sums, task.sums.rows)
    sizes = {r.name: r.room for r in rolled.regions}
    arrays: Arrays = {k: aligned(rows.get(k, 1) * x).reshape(rows.get(k, 1), x) for k, x in sizes.items()}
    vectors = {name: aligned((blocks + 1) * lanes, task.of_base(name)) for name in task.steps.numbers}
    for name, vector in vectors.items():
        head = task.of_base(name)
        arrays[name] = vector[head:].reshape(-1, lanes)
        arrays |= {f"base.{name}": vector[:head]} if head else {}
    for name, numbers in task.columns.read.items():
        own = arrays[name].reshape(blocks + 1, numbers.shape[1], lanes).swapaxes(1, 2)
        for k in range(n):
            own[k // lanes, k % lanes] = numbers[k]
    for name, numbers in task.world.items():
        if name in task.steps.threes:
            arrays[name][blocks * lanes].reshape(-1, 4)[:, :3].flat = numbers
        else:
            arrays[name][blocks].reshape(-1, lanes)[: len(numbers), 0] = numbers
    arrays |= task.constants | task.rows(blocks * lanes)
    counts = {"bodies": n, "blocks": blocks}
    if task.steps.matrices:
        lists, of_pairs = task.pairs(lanes)
        arrays |= {"self": np.arange(n), **lists}
        counts |= of_pairs
    return arrays, vectors, counts


class OneMemory:
    """Memory that the loops of one call read and write.

    inputs, outputs: by name, parts of arrays, and the parts that outputs are assembled from.
    """

    def __init__(
        self,
        task: Task,
        program: Program,
        counts: Mapping[str, int],
        arrays: Arrays,
        vectors: Arrays,
    ) -> None:
        self._task, self._program, self._counts, self._arrays = task, program, counts, arrays
        self.run = program.bound(counts, **arrays)
        self.inputs = {k: vectors[k][: task.size(k)] for k in task.recipe.inputs}
        self.outputs = {k: self._output(k, vectors.get(k)) for k in task.recipe.outputs}

    def __call__(self, given: Sequence[np.ndarray], found: Sequence[np.ndarray]) -> None:
        """Arrays (m, n) in, results into others (m, ...): one configuration after another."""
        for k in range(len(found[0])):
            for own, x in zip(self.inputs.values(), given, strict=True):
                own[:] = x[k]
            self.run()
            for output, x in zip(self.outputs.values(), found, strict=True):
                output.put(x[k, ...])

    def fixed(self, outputs: Sequence[str]) -> Fixed:
        """Everything that runs share.  outputs: their names."""
        inputs = {name: whole(own) for name, own in self.inputs.items()}
        named = dict(zip(outputs, self.outputs.values(), strict=True))
        return Fixed(self._program.plan, self._counts, self._arrays, inputs, named)

    def _output(self, name: str, vector: np.ndarray | None) -> Output:
        shape = self._task.shape(name)
        if name in self._task.steps.entries:
            return Output(shape, self._columns_by_body(name, shape[0] - self._task.bodies))
        if name in self._task.steps.matrices:
            return Output(shape, self._matrix(name, shape[1] - self._task.bodies))
        if name == COLUMN:
            return Output(shape, self._columns(shape[1] - self._task.bodies))
        own = self._arrays[name].reshape(-1) if vector is None else vector
        return whole(own[: prod(shape)].reshape(shape))

    def _matrix(self, name: str, k: int) -> list[Part]:
        """Parts of a matrix: of pairs of bodies, without padding, and of a base's k speeds with them."""
        n, arrays = self._task.bodies, self._arrays
        pairs = Part(arrays[name].reshape(n, -1)[:, :n], np.s_[k:, k:])
        if not k:
            return [pairs]
        rows, columns = f"{name}_rows", f"{name}_columns"
        across = self._by_number(columns if columns in arrays else rows, k, k)
        turned = [Part(np.moveaxis(own, 0, -1), index[::-1]) for own, index in across]
        own = Part(arrays[f"base.{name}"].reshape(k, k), np.s_[:k, :k])
        return [pairs, own, *self._by_number(rows, k, k), *turned]

    def _columns_by_body(self, name: str, k: int) -> list[Part]:
        """Parts of a matrix with several columns for each body, those of a base with k speeds first."""
        n, size, kept = self._task.bodies, self._task.steps.entries[name], self._arrays[name]
        lanes, first = kept.shape[1] // size, size * (k > 0)
        pairs = self._by_body(kept.reshape(n, -1, size, lanes), np.s_[k:], first)
        if not k:
            return pairs
        rows = self._by_body(self._arrays[f"{name}_rows"].reshape(-1, k, size, lanes).swapaxes(0, 1), np.s_[:k], first)
        own, none = self._arrays[f"base.{name}"].reshape(k, size), np.zeros((n, size))
        return [Part(own, np.s_[:k, :size]), Part(none, np.s_[k:, :size]), *rows, *pairs]

    def _by_body(self, kept: np.ndarray, rows: slice, first: int) -> list[Part]:
        """Parts stored as (rows, blocks, columns, lanes), from a column on: whole blocks, and the remainder."""
        *_, size, lanes = kept.shape
        n, by_body = self._task.bodies, kept.swapaxes(2, 3)
        whole, last = n // lanes, first + n // lanes * lanes * size
        parts = [
            Part(by_body[:, :whole], np.s_[rows, first:last]),
            Part(by_body[:, whole : whole + 1, : n % lanes], np.s_[rows, last:]),
        ]
        return [part for part in parts if part.own.size]

    def _columns(self, k: int) -> list[Part]:
        """Parts of a Jacobian: of the k speeds of a base and of all bodies."""
        base = [Part(self._arrays["base.columns"].reshape(k, 6).T, np.s_[:, :k])] if k else []
        return [*base, *self._by_number(COLUMN, 6, k)]

    def _by_number(self, name: str, size: int, first: int) -> list[Part]:
        """Parts stored for each body, one row per number, from a column on: whole blocks, and the remainder."""
        kept = self._arrays[name]
        by_row = kept.reshape(len(kept), size, -1).swapaxes(0, 1)
        lanes, n = by_row.shape[-1], self._task.bodies
        last = first + n // lanes * lanes
        parts = [
            Part(by_row[:, : n // lanes], np.s_[:size, first:last]),
            Part(by_row[:, n // lanes, : n % lanes], np.s_[:size, last : first + n]),
        ]
        return [part for part in parts if part.own.size]
