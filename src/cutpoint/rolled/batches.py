"""Runs a function's loops on several configurations: side by side in machine code, the remainder one by one."""

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from cutpoint.kernels import Program, compile_program
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.programs.compiled import BoundProgram
from cutpoint.kernels.programs.front import ProgramElement
from cutpoint.kernels.programs.outputs import Output, Part, whole
from cutpoint.kernels.programs.rows import ProgramRows, SideBySide
from cutpoint.rolled.memory import COLUMN, Spare, Task, aligned
from cutpoint.rolled.passes import side_by_side
from cutpoint.rolled.runs import One

MOST_MEMORY = 2**25
"""Bytes for configurations side by side.

Caches hold them: 24 MB saved 20 % of a chain's forward dynamics against one by one, 48 MB cost 25 % more.
"""

MOST_OF_PAIRS = 2**20
"""Bytes of these for pairs of bodies, which are in vector lanes one by one as well: near caches hold them.

0.6 MB saved 12 % of a chain's mass matrix against one by one, 2.4 MB cost 30 % more, 1.8 MB of derivatives 25 %.
"""


class Batches:
    """Memory for a function's calls with rows of configurations."""

    def __init__(self, task: Task, one: One, largest: float) -> None:
        self._task, self._one, self._largest = task, one, largest
        self._loops = side_by_side(task.steps, task.columns, one.lanes)
        memory = {x.name: 8 * self._rows(x.name) * x.size for x in self._loops.regions}
        of_pairs = sum(memory[name] for name in task.steps.matrices)
        fits = sum(memory.values()) <= MOST_MEMORY and of_pairs <= MOST_OF_PAIRS
        self._least = one.lanes if fits else None
        self._few, self._many = Spare(self._one_by_one), Spare(self._side_by_side)

    def _rows(self, name: str) -> int:
        """Of a region's array."""
        n, steps = self._task.bodies, self._task.steps
        if name in steps.sums:
            return self._task.sums.rows
        if name in steps.matrices:
            return n * n
        return n + 2 if name in steps.kept else n if name in (*steps.numbers, *self._task.columns.read) else 1

    @cached_property
    def _program(self) -> Program:
        name = f"{self._one.name} for batches"
        return compile_program(self._loops.body, self._loops.regions, self._task.backend, name=name)

    def of(self, configurations: int) -> Spare[ProgramRows]:
        """For calls with so many."""
        is_many = self._least is not None and configurations >= self._least
        return self._many if is_many else self._few

    def _one_by_one(self, several: SideBySide | None = None) -> ProgramRows:
        task, memory = self._task, self._one.memory()
        element = ProgramElement(memory.run, [*map(whole, memory.inputs.values())], [*memory.outputs.values()])
        inputs = [Port(name, (task.size(name),)) for name in task.recipe.inputs]
        outputs = [Port(name, task.shape(name)) for name in task.recipe.outputs]
        return ProgramRows(element, inputs, outputs, several, self._largest)

    def _side_by_side(self) -> ProgramRows:
        task, lanes = self._task, self._one.lanes
        arrays = {
            r.name: aligned(self._rows(r.name) * r.size).reshape(self._rows(r.name), r.size)
            for r in self._loops.regions
        }
        for name, numbers in task.columns.read.items():
            arrays[name][:] = numbers
        for name, numbers in task.world.items():
            arrays[name][task.bodies].reshape(-1, lanes)[: len(numbers)] = numbers[:, None]
        lists, of_pairs = task.pairs(1) if task.steps.matrices else ({}, {})
        known = arrays | task.constants | task.rows(task.bodies) | lists
        counts = {"bodies": task.bodies, **of_pairs}
        run = self._program.bound({k: counts[k] for k in self._program.counts}, **known)
        assert isinstance(run, BoundProgram), "there is machine code"
        places = Places(task, arrays, lanes)
        inputs, outputs = ([*map(places.of, names)] for names in (task.recipe.inputs, task.recipe.outputs))
        return self._one_by_one(SideBySide(run, lanes, inputs, outputs))


class Places:
    """Where inputs and outputs of several configurations stand in their memory, whose last axis is that of the lanes.

    Like `OneMemory`, which has bodies side by side in place of configurations.
    """

    def __init__(self, task: Task, arrays: Mapping[str, np.ndarray], lanes: int) -> None:
        self._task, self._arrays, self._lanes = task, arrays, lanes

    def of(self, name: str) -> Output:
        task = self._task
        shape = (task.size(name),) if name in task.recipe.inputs else task.shape(name)
        if name in task.steps.entries:
            return Output(shape, self._columns_by_body(name, shape[0] - task.bodies))
        if name in task.steps.matrices:
            return Output(shape, self._matrix(name, shape[0] - task.bodies))
        if name == COLUMN:
            return Output(shape, self._columns(shape[-1] - task.bodies))
        if name in task.steps.shapes:
            return Output(shape, [Part(self._in_shape(name, *shape))])
        head = task.of_base(name)
        base = [Part(self._in_shape(f"base.{name}", head), np.s_[:head])] if head else []
        return Output(shape, [*base, Part(self._by_body(name), np.s_[head:])])

    def _in_shape(self, name: str, *shape: int) -> np.ndarray:
        return self._arrays[name].reshape(*shape, self._lanes)

    def _by_body(self, name: str, *shape: int) -> np.ndarray:
        """Parts stored for each body, without the rows of base, world and tip."""
        return self._arrays[name][: self._task.bodies].reshape(self._task.bodies, *shape, self._lanes)

    def _matrix(self, name: str, k: int) -> list[Part]:
        """Parts of a matrix: of pairs of bodies, and of a base's k speeds with them."""
        n = self._task.bodies
        pairs = Part(self._in_shape(name, n, n), np.s_[k:, k:])
        if not k:
            return [pairs]
        rows, columns = f"{name}_rows", f"{name}_columns"
        across = self._by_body(columns if columns in self._arrays else rows, k)
        return [
            pairs,
            Part(self._in_shape(f"base.{name}", k, k), np.s_[:k, :k]),
            Part(self._by_body(rows, k).swapaxes(0, 1), np.s_[:k, k:]),
            Part(across, np.s_[k:, :k]),
        ]

    def _columns_by_body(self, name: str, k: int) -> list[Part]:
        """Parts of a matrix with several columns for each body, those of a base with k speeds first."""
        n, size = self._task.bodies, self._task.steps.entries[name]
        first = size * (k > 0)
        pairs = Part(self._in_shape(name, n, n, size), np.s_[k:, first:])
        if not k:
            return [pairs]
        return [
            pairs,
            Part(self._in_shape(f"base.{name}", k, size), np.s_[:k, :size]),
            Part(np.zeros((n, size, self._lanes)), np.s_[k:, :size]),
            Part(self._by_body(f"{name}_rows", k, size).swapaxes(0, 1), np.s_[:k, first:]),
        ]

    def _columns(self, k: int) -> list[Part]:
        """Parts of a Jacobian: of the k speeds of a base and of all bodies."""
        base = [Part(self._in_shape("base.columns", k, 6).swapaxes(0, 1), np.s_[:, :k])] if k else []
        return [*base, Part(self._by_body(COLUMN, 6).swapaxes(0, 1), np.s_[:, k:])]
