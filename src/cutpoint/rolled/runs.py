"""Runs of a function's loops: on one configuration, or on several side by side."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from cutpoint.kernels import Program, compile_program
from cutpoint.rolled.memory import MATRIX, Spare, Task, aligned
from cutpoint.rolled.passes import one_by_one, side_by_side
from cutpoint.rolled.recipes import Recipe

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
        rows = {**dict.fromkeys(("body", *task.steps.sizes), blocks + 1), MATRIX: n * blocks}
        arrays = {r.name: aligned(rows.get(r.name, 1), r.size) for r in self._rolled.regions}
        by_body = {k: arrays[k].reshape(blocks + 1, -1, lanes).swapaxes(1, 2) for k in ("body", *task.steps.kept)}
        for k in range(n):
            by_body["body"][k // lanes, k % lanes] = task.columns.read[k]
        for name, numbers in task.world.items():
            by_body[name][blocks, 0, : len(numbers)] = numbers
        arrays["parent"] = task.parents(blocks * lanes)
        if MATRIX in arrays:
            arrays["self"] = np.arange(n)
        run = self.program.bound({"bodies": n, "blocks": blocks}, **arrays)
        return OneMemory(task.recipe, arrays, run, n)


class OneMemory:
    """What the loops of one call read and write."""

    def __init__(self, recipe: Recipe, arrays: dict[str, Array], run: Callable[[], int], n: int) -> None:
        self.run = run
        self.inputs = {k: arrays[k].reshape(-1)[:n] for k in recipe.inputs}
        self.outputs = {k: _without_padding(arrays[k], k, n) for k in recipe.outputs}

    def __call__(self, given: Iterable[Array], found: Iterable[Array]) -> None:
        """Checked arrays (n,) in, results into others."""
        for own, x in zip(self.inputs.values(), given, strict=True):
            own[:] = x
        self.run()
        for own, x in zip(self.outputs.values(), found, strict=True):
            x[:] = own


def _without_padding(array: Array, name: str, n: int) -> Array:
    return array.reshape(n, -1)[:, :n] if name == MATRIX else array.reshape(-1)[:n]


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
        arrays = {r.name: aligned(rows.get(r.name, n + 1), r.size) for r in self._rolled.regions}
        arrays["body"][:] = task.columns.read
        for name, numbers in task.world.items():
            arrays[name][n].reshape(-1, self._lanes)[: len(numbers)] = numbers[:, None]
        arrays["parent"] = task.parents(n)
        return ManyMemory(self.program, task.recipe, arrays, n, self._lanes)


class ManyMemory:
    """The same for several configurations."""

    def __init__(self, program: Program, recipe: Recipe, arrays: dict[str, Array], n: int, lanes: int) -> None:
        self._program, self._arrays, self._n, self._lanes = program, arrays, n, lanes
        # by group, lane, body
        seen = {k: arrays[k].reshape(-1, n, lanes).swapaxes(1, 2) for k in (*recipe.inputs, *recipe.outputs)}
        self._inputs, self._outputs = ([seen[k] for k in names] for names in (recipe.inputs, recipe.outputs))
        self._runs: dict[int, Callable[[], int]] = {}

    def __call__(self, given: Sequence[Array], found: Sequence[Array]) -> None:
        lanes, n = self._lanes, self._n
        groups = len(found[0]) // lanes
        for own, x in zip(self._inputs, given, strict=True):
            own[:groups] = x.reshape(groups, lanes, n)
        if groups not in self._runs:
            self._runs[groups] = self._program.bound({"groups": groups, "bodies": n}, **self._arrays)
        self._runs[groups]()
        for own, x in zip(self._outputs, found, strict=True):
            x.reshape(groups, lanes, n)[:] = own[:groups]
