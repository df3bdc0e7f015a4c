"""A stepping program as machine code: all its stages and loops in one function."""

import ctypes
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from cutpoint.kernels.machine.jit import Compiled, Unwritten
from cutpoint.kernels.machine.llvm import Lanes
from cutpoint.kernels.machine.llvm_code import ON_LINES, Code, Running, in_turn
from cutpoint.kernels.machine.tuning import beside_numbers, for_divisions
from cutpoint.kernels.programs.plan import Plan
from cutpoint.kernels.programs.stage import AT_ONCE, Place
from cutpoint.kernels.programs.stepping import LaneLoop, Loop, Stage, number_of
from cutpoint.kernels.programs.superword_line import WIDE
from cutpoint.kernels.programs.triples import stage_code

_FUNCTION = "program"


class LlvmProgram:
    """A plan's machine code: i64 program(i64 *counts, double **regions)."""

    def __init__(self, plan: Plan) -> None:
        self._names, self._counts = plan.names, plan.counts
        self._code = Compiled(Unwritten((_FUNCTION, *plan.key), lambda: program_ir(plan)), _FUNCTION)
        self._call = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)(self._code.address)

    @property
    def address(self) -> int:
        return self._code.address

    def bound(self, counts: Mapping[str, int], arrays: Mapping[str, np.ndarray]) -> Callable[[], int]:
        """A run on checked arrays; each call returns the iterations of the outermost loop."""
        numbers = (ctypes.c_int64 * len(self._counts))(*[counts[name] for name in self._counts])
        pointers = (ctypes.c_void_p * len(self._names))(*[arrays[name].ctypes.data for name in self._names])
        return BoundProgram(self, self._call, numbers, pointers, [*arrays.values()])


class BoundProgram(NamedTuple):
    """A call with its arguments, and the owners of the code and memory that they point to."""

    program: LlvmProgram
    call: Callable[..., int]
    numbers: Any
    pointers: Any
    arrays: list[np.ndarray]

    @property
    def symbols(self) -> dict[str, int]:
        """Addresses of code and arguments, for other code that calls it."""
        places = {"counts": ctypes.addressof(self.numbers), "regions": ctypes.addressof(self.pointers)}
        return {_FUNCTION: self.program.address, **places}

    def __call__(self) -> int:
        return self.call(self.numbers, self.pointers)


def program_ir(plan: Plan) -> str:
    """The module's text."""
    writer = _Writer(plan)
    done = writer.loop(plan.body, writer.starts)
    widths = {stage.lanes for stage in plan.graphs}
    declarations = "".join(Lanes(width).declarations for width in sorted({*widths, 1, WIDE.width, AT_ONCE}))
    attributes = f"{ON_LINES} {beside_numbers() if 1 in widths else ''} {for_divisions(plan.graphs.values())}"
    head = f"{declarations}define i64 @{_FUNCTION}(ptr %counts, ptr %regions) {attributes} {{\nentry:"
    return "\n".join([head, *writer.code.lines, f"ret i64 {done}", "}", ""])


class _Writer:
    """Writes a plan's loops, one inside another.

    counts: loop counts by name.  starts: pointers to the arrays by name.  stages: with their numbers that no loop
    changes computed.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan, self.code = plan, Code()
        self.counts = {name: self.code.load("%counts", k, "i64") for k, name in enumerate(plan.counts)}
        self.starts = {name: self.code.load("%regions", k, "ptr") for k, name in enumerate(plan.names)}
        self.stages = {stage: stage_code(self.code, plan, stage, self.starts) for stage in plan.graphs}

    def loop(self, this: Loop, regions: dict[str, str]) -> str:
        """Writes a loop; returns its iterations done.  regions: pointers to rows of the enclosing iterations."""
        count = number_of(this.count, self.counts)
        with self.code.loop(count, regions.get(this.until or "")) as running:
            inside = regions | self._rows(this, running.iteration, regions)
            for item in this.body:
                if isinstance(item, Stage):
                    inside |= self.stages[item].look_ahead(self.code, inside, running.iteration, count)
            self._body(this, inside, running)
        return running.done

    def _body(self, this: Loop, inside: dict[str, str], running: Running) -> None:
        """Writes an iteration.  inside: pointers to its rows."""
        at_hand: dict[Place, str] = {}
        for item, following in zip(this.body, [*this.body[1:], None], strict=True):
            if isinstance(item, Loop):
                self.loop(item, inside)
                at_hand.clear()
            elif len(this.body) == 1 and self.stages[item].hands_on:
                self.stages[item].write_on(self.code, inside, running)
            elif item.lanes > 1 and isinstance(following, Stage) and following.lanes in (1, item.lanes):
                with self.code.aside() as wide:
                    self.stages[item].write(self.code, inside, at_hand)
                with self.code.aside() as narrow:
                    self.stages[following].begin(self.code, inside, item.writes)
                self.code.lines += in_turn(wide, narrow)
            else:
                self.stages[item].write(self.code, inside, at_hand)

    def _rows(self, this: Loop, row: str, outer: Mapping[str, str]) -> dict[str, str]:
        """Pointers to an iteration's rows, by name.  outer: those of the enclosing iterations."""
        code, starts = self.code, self.starts
        if this.backward:
            row = code.let(f"sub i64 {code.let(f'sub i64 {number_of(this.count, self.counts)}, 1')}, {row}")
        rows = {name: self._at(this, outer[name], name, self._first_within(this, name, row)) for name in this.streams}
        indices = dict.fromkeys(view.index for view in this.views)
        named = {index: code.load(starts[index], row, "i64") for index in indices}
        return rows | {view.name: self._at(this, starts[view.of], view.of, named[view.index]) for view in this.views}

    def _first_within(self, this: Loop, name: str, row: str) -> str:
        """The number of a region's first row in an iteration, in which loops inside may take several."""
        for inner in this.within(name):
            row = self.code.let(f"mul i64 {row}, {number_of(inner, self.counts)}")
        return row

    def _at(self, this: Loop, start: str, region: str, row: str) -> str:
        """Pointer to a row; in a loop over lanes, to a lane of a row."""
        code, size, lanes = self.code, self.plan.sizes[region], self.plan.regions[region].lanes
        if not isinstance(this, LaneLoop):
            return code.at(start, code.let(f"mul i64 {row}, {size}"))
        block = code.let(f"mul i64 {code.let(f'udiv i64 {row}, {lanes}')}, {size}")
        return code.at(start, code.let(f"add i64 {block}, {code.let(f'urem i64 {row}, {lanes}')}"))
