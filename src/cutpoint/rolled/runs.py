"""Runs of a function's loops: on one configuration, or on several side by side."""

from collections.abc import Callable, Sequence
from functools import cached_property
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from cutpoint.kernels import Program, compile_program
from cutpoint.kernels.arrays.backends import chosen
from cutpoint.kernels.programs.outputs import Output, Part, whole
from cutpoint.rolled.memory import COLUMN, Spare, Task, aligned
from cutpoint.rolled.passes import one_by_one, side_by_side

if TYPE_CHECKING:
    from cutpoint.kernels.programs.front import ProgramElement

Array = np.ndarray

CHUNK = 4096
"""Numbers of one input that are handed over at a time: a batch's memory stays in the cache."""


class One:
    """A function of one configuration: what bodies do alone, they do `lanes` at once."""

    def __init__(self, task: Task, lanes: int) -> None:
        self._task, self._lanes = task, lanes
        self._rolled = one_by_one(task.steps, task.columns, lanes)
        self.program = compile_program(self._rolled.body, self._rolled.regions, task.backend)
        self.spare = Spare(self._memory)

    def _memory(self) -> "OneMemory":
        task, lanes = self._task, self._lanes
        n, blocks = task.bodies, -(-task.bodies // lanes)
        rows = dict.fromkeys(("body", *task.steps.kept), blocks + 1)
        rows |= {**dict.fromkeys(task.steps.matrices, n * blocks), "held": n}
        rows |= dict.fromkeys(task.steps.threes, blocks * lanes + 2)
        sizes = {r.name: r.room for r in self._rolled.regions}
        arrays: dict[str, Array] = {k: aligned(rows.get(k, 1) * x).reshape(-1, x) for k, x in sizes.items()}
        vectors = {name: aligned((blocks + 1) * lanes, task.of_base(name)) for name in task.steps.numbers}
        for name, vector in vectors.items():
            head = task.of_base(name)
            arrays[name] = vector[head:].reshape(-1, lanes)
            arrays |= {f"base.{name}": vector[:head]} if head else {}
        body = arrays["body"].reshape(blocks + 1, -1, lanes).swapaxes(1, 2)
        for k in range(n):
            body[k // lanes, k % lanes] = task.columns.read[k]
        for name, numbers in task.world.items():
            if name in task.steps.threes:
                arrays[name][blocks * lanes].reshape(-1, 4)[:, :3].flat = numbers
            else:
                arrays[name][blocks].reshape(-1, lanes)[: len(numbers), 0] = numbers
        arrays |= task.constants | task.rows(blocks * lanes)
        counts = {"bodies": n, "blocks": blocks}
        if task.steps.matrices:
            pairs = task.pairs(lanes)
            arrays |= {"self": np.arange(n), **pairs}
            counts["pairs"] = len(pairs["pair.body"])
        run = self.program.bound({k: counts[k] for k in self.program.counts}, **arrays)
        return OneMemory(task, arrays, vectors, run)


class OneMemory:
    """What the loops of one call read and write.

    inputs, outputs: by name, stretches of arrays, and what outputs are put together from.
    """

    def __init__(self, task: Task, arrays: dict[str, Array], vectors: dict[str, Array], run: Callable[[], int]) -> None:
        self.run, self._task, self._arrays = run, task, arrays
        self.inputs = {k: vectors[k][: task.size(k)] for k in task.recipe.inputs}
        self.outputs = {k: self._output(k, vectors.get(k)) for k in task.recipe.outputs}

    def __call__(self, given: Sequence[Array], found: Sequence[Array]) -> None:
        """Checked arrays (m, n) in, results into others (m, ...): one configuration after another."""
        if self._element:
            self._element.rows(given, found)
            return
        for k in range(len(found[0])):
            for own, x in zip(self.inputs.values(), given, strict=True):
                own[:] = x[k]
            self.run()
            for output, x in zip(self.outputs.values(), found, strict=True):
                output.put(x[k, ...])

    @cached_property
    def _element(self) -> "ProgramElement | None":
        """In machine code, where there is some."""
        if chosen(self._task.backend) != "llvm":
            return None
        from cutpoint.kernels.programs.front import ProgramElement

        return ProgramElement(self.run, [*self.inputs.values()], [*self.outputs.values()])

    def _output(self, name: str, vector: Array | None) -> Output:
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
        """Of pairs of bodies without the padding, and of what the k speeds of a base share with them."""
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
        """Of a matrix with several columns for each body, those of a base with k speeds first."""
        n, size, kept = self._task.bodies, self._task.steps.entries[name], self._arrays[name]
        lanes, first = kept.shape[1] // size, size * (k > 0)
        pairs = self._by_body(kept.reshape(n, -1, size, lanes), np.s_[k:], first)
        if not k:
            return pairs
        rows = self._by_body(self._arrays[f"{name}_rows"].reshape(-1, k, size, lanes).swapaxes(0, 1), np.s_[:k], first)
        own, none = self._arrays[f"base.{name}"].reshape(k, size), np.zeros((n, size))
        return [Part(own, np.s_[:k, :size]), Part(none, np.s_[k:, :size]), *rows, *pairs]

    def _by_body(self, kept: Array, rows: slice, first: int) -> list[Part]:
        """What is kept as (rows, blocks, columns, lanes), from a column on: whole blocks, and the rest."""
        *_, size, lanes = kept.shape
        n, by_body = self._task.bodies, kept.swapaxes(2, 3)
        whole, last = n // lanes, first + n // lanes * lanes * size
        parts = [
            Part(by_body[:, :whole], np.s_[rows, first:last]),
            Part(by_body[:, whole : whole + 1, : n % lanes], np.s_[rows, last:]),
        ]
        return [part for part in parts if part.own.size]

    def _columns(self, k: int) -> list[Part]:
        """A Jacobian's, of the k speeds of a base and of all bodies."""
        base = [Part(self._arrays["base.columns"].reshape(k, 6).T, np.s_[:, :k])] if k else []
        return [*base, *self._by_number(COLUMN, 6, k)]

    def _by_number(self, name: str, size: int, first: int) -> list[Part]:
        """What is kept of each body, so many numbers in as many rows, from a column on: whole blocks, and the rest."""
        kept = self._arrays[name]
        by_row = kept.reshape(len(kept), size, -1).swapaxes(0, 1)
        lanes, n = by_row.shape[-1], self._task.bodies
        last = first + n // lanes * lanes
        parts = [
            Part(by_row[:, : n // lanes], np.s_[:size, first:last]),
            Part(by_row[:, n // lanes, : n % lanes], np.s_[:size, last : first + n]),
        ]
        return [part for part in parts if part.own.size]


class Many:
    """A function of configurations (m, n), m whole in lanes."""

    def __init__(self, task: Task, lanes: int) -> None:
        self._task, self._lanes = task, lanes
        self._rolled = side_by_side(task.steps, task.columns, lanes)
        self.program = compile_program(self._rolled.body, self._rolled.regions, task.backend)
        self._groups = max(1, CHUNK // (lanes * task.bodies))
        self._spare = Spare(self._memory)

    def __call__(self, given: Sequence[Array], found: Sequence[Array]) -> None:
        memory, step = self._spare.take(), self._groups * self._lanes
        for first in range(0, len(found[0]), step):
            memory([x[first : first + step] for x in given], [x[first : first + step] for x in found])
        self._spare.give_back(memory)

    def _memory(self) -> "ManyMemory":
        task, n = self._task, self._task.bodies
        rows = {**dict.fromkeys(task.steps.numbers, self._groups * n), "body": n}
        rows |= dict.fromkeys(task.steps.kept, n + 2) | dict.fromkeys(task.steps.apart, self._groups)
        arrays = {r.name: aligned(rows.get(r.name, 1) * r.size).reshape(-1, r.size) for r in self._rolled.regions}
        arrays["body"][:] = task.columns.read
        for name, numbers in task.world.items():
            arrays[name][n].reshape(-1, self._lanes)[: len(numbers)] = numbers[:, None]
        arrays |= task.constants | task.rows(n)
        return ManyMemory(self.program, task, arrays, self._lanes)


class ManyMemory:
    """The same for several configurations."""

    def __init__(self, program: Program, task: Task, arrays: dict[str, Array], lanes: int) -> None:
        self._program, self._arrays, self._n, self._lanes = program, arrays, task.bodies, lanes
        self._inputs = [self._parts(task, name) for name in task.recipe.inputs]
        self._outputs = [self._parts(task, name) for name in task.recipe.outputs]
        self._runs: dict[int, Callable[[], int]] = {}

    def _parts(self, task: Task, name: str) -> list[tuple[slice, Array]]:
        """By group, lane, number: the bodies' and before them a base's; or those of no body."""
        head, n = task.of_base(name), prod(task.steps.shapes.get(name, (task.bodies,)))
        parts = [(slice(head, None), self._arrays[name], n), (slice(head), self._arrays.get(f"base.{name}"), head)]
        return [(s, x.reshape(-1, size, self._lanes).swapaxes(1, 2)) for s, x, size in parts if x is not None]

    def __call__(self, given: Sequence[Array], found: Sequence[Array]) -> None:
        groups = len(found[0]) // self._lanes
        for parts, x in zip(self._inputs, given, strict=True):
            whole = x.reshape(groups, self._lanes, -1)
            for some, own in parts:
                own[:groups] = whole[..., some]
        if groups not in self._runs:
            self._runs[groups] = self._program.bound({"groups": groups, "bodies": self._n}, **self._arrays)
        self._runs[groups]()
        for parts, x in zip(self._outputs, found, strict=True):
            whole = x.reshape(groups, self._lanes, -1)
            for some, own in parts:
                whole[..., some] = own[:groups]
