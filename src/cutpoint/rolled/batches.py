"""Runs of a function's loops on several configurations: side by side in machine code, what is left one by one."""

from functools import cached_property

import numpy as np

from cutpoint.kernels import Program, compile_program
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.programs.compiled import BoundProgram
from cutpoint.kernels.programs.front import ProgramElement
from cutpoint.kernels.programs.outputs import Output, Part
from cutpoint.kernels.programs.rows import ProgramRows, SideBySide
from cutpoint.rolled.memory import Spare, Task, aligned
from cutpoint.rolled.passes import side_by_side
from cutpoint.rolled.runs import One

MOST_MEMORY = 2**25
"""Bytes for configurations side by side.

Caches hold them: 24 MB saved 20 % of a chain's forward dynamics against one by one, 48 MB cost 25 % more.
"""


class Batches:
    """Memory for a function's calls with rows of configurations.

    Matrices go one by one, whose entries are many at once already, and so does what needs much memory.
    """

    def __init__(self, task: Task, one: One, largest: float) -> None:
        self._task, self._one, self._largest = task, one, largest
        self._loops = side_by_side(task.steps, task.columns, one.lanes)
        memory = 8 * task.bodies * sum(region.size for region in self._loops.regions)
        self._least = None if task.is_in_parts or memory > MOST_MEMORY else one.lanes
        self._few, self._many = Spare(self._one_by_one), Spare(self._side_by_side)

    @cached_property
    def _program(self) -> Program:
        return compile_program(self._loops.body, self._loops.regions, self._task.backend)

    def of(self, configurations: int) -> Spare[ProgramRows]:
        """For calls with so many."""
        is_many = self._least is not None and configurations >= self._least
        return self._many if is_many else self._few

    def _one_by_one(self, several: SideBySide | None = None) -> ProgramRows:
        task, memory = self._task, self._one.memory()
        element = ProgramElement(memory.run, [*memory.inputs.values()], [*memory.outputs.values()])
        inputs = [Port(name, (task.size(name),)) for name in task.recipe.inputs]
        outputs = [Port(name, task.shape(name)) for name in task.recipe.outputs]
        return ProgramRows(element, inputs, outputs, several, self._largest)

    def _side_by_side(self) -> ProgramRows:
        task, lanes = self._task, self._one.lanes
        n = task.bodies
        rows = {**dict.fromkeys((*task.steps.numbers, "body"), n), **dict.fromkeys(task.steps.kept, n + 2)}
        arrays = {r.name: aligned(rows.get(r.name, 1) * r.size).reshape(-1, r.size) for r in self._loops.regions}
        arrays["body"][:] = task.columns.read
        for name, numbers in task.world.items():
            arrays[name][n].reshape(-1, lanes)[: len(numbers)] = numbers[:, None]
        arrays |= task.constants | task.rows(n)
        run = self._program.bound({"bodies": n}, **arrays)
        assert isinstance(run, BoundProgram), "there is machine code"

        def of(name: str) -> Output:
            """The bodies' and before them a base's; or those of no body."""
            shape, head = task.shape(name) if name in task.recipe.outputs else (task.size(name),), task.of_base(name)
            rest = arrays[name].reshape(*(shape if name in task.steps.shapes else (n,)), lanes)
            base = [Part(arrays[f"base.{name}"].reshape(head, lanes), np.s_[:head])] if head else []
            return Output(shape, [*base, Part(rest, np.s_[head:] if shape else ...)])

        inputs, outputs = ([*map(of, names)] for names in (task.recipe.inputs, task.recipe.outputs))
        return self._one_by_one(SideBySide(run, lanes, inputs, outputs))
