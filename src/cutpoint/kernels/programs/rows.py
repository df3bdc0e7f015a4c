"""A program's runs on rows of arrays: several rows in vector lanes, the remainder one by one.

Their code has the calling convention of NumPy's generalised ufuncs; rows are contiguous.
"""

import ctypes
from collections.abc import Sequence
from functools import cached_property
from itertools import count
from typing import NamedTuple

import numpy as np

from cutpoint.kernels.arrays.function import Whole
from cutpoint.kernels.arrays.whole_batches import whole_batches
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import FLOAT64
from cutpoint.kernels.machine.element import FUNCTION
from cutpoint.kernels.machine.jit import Compiled
from cutpoint.kernels.machine.llvm_code import ON_LINES, Code
from cutpoint.kernels.machine.transposition import blocks, lanes_of_rows, lanes_to_rows
from cutpoint.kernels.programs.compiled import BoundProgram
from cutpoint.kernels.programs.front import ProgramElement
from cutpoint.kernels.programs.outputs import Output, Part

_LOOP = "rows"
_PROTOTYPE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)


class SideBySide(NamedTuple):
    """A run on several rows at once; inputs and outputs are in its memory, whose last axis is the lanes."""

    run: BoundProgram
    lanes: int
    inputs: Sequence[Output]
    outputs: Sequence[Output]

    @property
    def parts(self) -> list[Part]:
        return [part for x in (*self.inputs, *self.outputs) for part in x.parts]


class ProgramRows:
    """Runs in memory that serves one call at a time."""

    def __init__(
        self,
        one: ProgramElement,
        inputs: Sequence[Port],
        outputs: Sequence[Port],
        several: SideBySide | None = None,
        largest: float | None = None,
    ) -> None:
        """largest: see `whole`."""
        self._inputs, self._outputs, self._largest = inputs, outputs, largest
        symbols = {FUNCTION: one.element}
        if several:
            symbols |= {f"own{k}": x.own.ctypes.data for k, x in enumerate(several.parts)} | several.run.symbols
        self._code = Compiled(_ir([port.size for port in (*inputs, *outputs)], several), _LOOP, symbols=symbols)
        self._owned = self._code, one, several

    def __call__(self, given: Sequence[np.ndarray], found: Sequence[np.ndarray]) -> None:
        """One run for each row; results are contiguous."""
        arrays = [*map(np.ascontiguousarray, given), *found]
        places = (ctypes.c_void_p * len(arrays))(*[x.ctypes.data for x in arrays])
        steps = (ctypes.c_int64 * len(arrays))(*[FLOAT64.item * p.size for p in (*self._inputs, *self._outputs)])
        _PROTOTYPE(self._code.address)(places, ctypes.byref(ctypes.c_int64(len(found[0]))), steps, None)

    @cached_property
    def whole(self) -> Whole | None:
        """The same for users' arrays, where they are contiguous: see `whole_batches`.

        It does no work if a number is NaN or beyond the largest.
        """
        loop = self._code.address, None
        return whole_batches(loop, FLOAT64, self._inputs, self._outputs, self._owned, largest=self._largest)


def _ir(sizes: Sequence[int], several: SideBySide | None) -> str:
    """The module's text.  sizes: row size of each argument."""
    code = Code()
    starts = [code.load("%arguments", k, "ptr") for k in range(len(sizes))]
    steps = [code.load("%steps", k, "i64") for k in range(len(sizes))]
    rows, done, lines = code.load("%dimensions", 0, "i64"), "0", list[str]()
    if several:
        done = _packs(code, several, rows, starts, steps)
        lines += [f"@own{k} = external global i8" for k in range(len(several.parts))]
        lines += ["@counts = external global i8", "@regions = external global i8", "declare i64 @program(ptr, ptr)"]
    with code.loop(code.let(f"sub i64 {rows}, {done}")) as loop:
        row = code.let(f"add i64 {loop.iteration}, {done}")
        here = [_row(code, start, step, row) for start, step in zip(starts, steps, strict=True)]
        code.lines.append(f"call void @{FUNCTION}({', '.join(f'ptr {place}' for place in here)})")
    lines.append(f"declare void @{FUNCTION}({', '.join(['ptr'] * len(sizes))})")
    head = f"define void @{_LOOP}(ptr %arguments, ptr %dimensions, ptr %steps, ptr %data) {ON_LINES} {{\nentry:"
    return "\n".join([*lines, head, *code.lines, "ret void", "}", ""])


def _row(code: Code, start: str, step: str, number: str) -> str:
    return code.at(start, code.let(f"mul i64 {number}, {step}"), "i8")


def _packs(code: Code, several: SideBySide, rows: str, starts: Sequence[str], steps: Sequence[str]) -> str:
    """Runs as many rows as possible, several at once; returns how many."""
    lanes, numbers = several.lanes, count()
    packs = code.let(f"udiv i64 {rows}, {lanes}")
    with code.loop(packs) as loop:
        first = code.let(f"mul i64 {loop.iteration}, {lanes}")
        each = [code.let(f"add i64 {first}, {lane}") for lane in range(lanes)]
        here = [[_row(code, start, step, k) for k in each] for start, step in zip(starts, steps, strict=True)]
        for some, x in zip(here, several.inputs, strict=False):
            _turn(code, some, x, numbers, lanes, inward=True)
        code.let("call i64 @program(ptr @counts, ptr @regions)")
        for some, x in zip(here[len(several.inputs) :], several.outputs, strict=True):
            _turn(code, some, x, numbers, lanes, inward=False)
    return code.let(f"mul i64 {packs}, {lanes}")


def _turn(code: Code, rows: Sequence[str], x: Output, numbers: "count[int]", lanes: int, *, inward: bool) -> None:
    """Transposes rows into the program's memory, or out of it."""
    room = np.empty((*x.shape, lanes))
    for part in x.parts:
        there = part.place(room)
        offset = (there.ctypes.data - room.ctypes.data) // lanes
        places = _Places([code.at(row, offset, "i8") for row in rows], f"@own{next(numbers)}")
        axes = [*zip(part.own.shape, (step // lanes for step in there.strides), part.own.strides, strict=True)]
        _turn_axes(code, places, axes[:-1], inward=inward)


class _Places(NamedTuple):
    """Pointers to numbers in rows, and in the program's memory."""

    rows: Sequence[str]
    own: str

    def after(self, code: Code, number: str | int, step: int, own_step: int) -> "_Places":
        """Advanced by so many numbers, with their steps in bytes."""
        offset, own_offset = (code.let(f"mul i64 {number}, {x}") for x in (step, own_step))
        return _Places([code.at(row, offset, "i8") for row in self.rows], code.at(self.own, own_offset, "i8"))


def _turn_axes(code: Code, places: _Places, axes: Sequence[tuple[int, int, int]], *, inward: bool) -> None:
    """axes: length, and steps in rows and in the program's memory, bytes."""
    if not axes:
        _turn_block(code, places, 1, 0, inward=inward)
        return
    length, step, own_step = axes[0]
    if len(axes) > 1 or step != FLOAT64.item:
        with code.loop(length) as loop:
            _turn_axes(code, places.after(code, loop.iteration, step, own_step), axes[1:], inward=inward)
        return
    _, most = next(blocks(len(places.rows), len(places.rows), FLOAT64.item))
    with code.loop(length // most) as loop:
        here = places.after(code, loop.iteration, most * step, most * own_step)
        _turn_block(code, here, most, own_step, inward=inward)
    first = length // most * most
    for column, size in blocks(length - first, len(places.rows), FLOAT64.item):
        _turn_block(code, places.after(code, first + column, step, own_step), size, own_step, inward=inward)


def _turn_block(code: Code, places: _Places, size: int, own_step: int, *, inward: bool) -> None:
    """Transposes a block of adjacent columns."""
    kind, item = f"<{len(places.rows)} x {FLOAT64.real}>", FLOAT64.item
    own = [code.at(places.own, k * own_step, "i8") for k in range(size)]
    if inward:
        for place, vector in zip(own, lanes_of_rows(code, FLOAT64, places.rows, 0, size), strict=True):
            code.store(vector, place, 0, kind, align=item)
    else:
        lanes_to_rows(code, FLOAT64, [code.load(place, 0, kind, align=item) for place in own], places.rows, 0)
