"""A program's runs on rows of arrays: so many rows side by side, what is left one by one.

Their code has the calling convention of NumPy's generalised ufuncs; rows are tidy in memory.
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
from cutpoint.kernels.machine.llvm_code import Code
from cutpoint.kernels.machine.transposition import blocks, lanes_of_rows, lanes_to_rows
from cutpoint.kernels.programs.compiled import BoundProgram
from cutpoint.kernels.programs.front import ProgramElement

_LOOP = "rows"
_PROTOTYPE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)


class Stretch(NamedTuple):
    """Memory (numbers, lanes) of a program, and the column of the rows where its first number stands."""

    own: np.ndarray
    column: int


class SideBySide(NamedTuple):
    """A run on several rows at once, and where it has what of each input and output."""

    run: BoundProgram
    lanes: int
    inputs: Sequence[Sequence[Stretch]]
    outputs: Sequence[Sequence[Stretch]]

    @property
    def stretches(self) -> list[Stretch]:
        return [x for one in (*self.inputs, *self.outputs) for x in one]


class ProgramRows:
    """Runs in memory that is one call's at a time."""

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
        self._owned = one, several
        symbols = {FUNCTION: one.element}
        if several:
            symbols |= {f"own{k}": x.own.ctypes.data for k, x in enumerate(several.stretches)} | several.run.symbols
        self._code = Compiled(_ir([port.size for port in (*inputs, *outputs)], several), _LOOP, symbols=symbols)

    def __call__(self, given: Sequence[np.ndarray], found: Sequence[np.ndarray]) -> None:
        """One run for each row; what is found is tidy in memory."""
        arrays = [*map(np.ascontiguousarray, given), *found]
        places = (ctypes.c_void_p * len(arrays))(*[x.ctypes.data for x in arrays])
        steps = (ctypes.c_int64 * len(arrays))(*[FLOAT64.item * p.size for p in (*self._inputs, *self._outputs)])
        _PROTOTYPE(self._code.address)(places, ctypes.byref(ctypes.c_int64(len(found[0]))), steps, None)

    @cached_property
    def whole(self) -> Whole | None:
        """The same for arrays as users give them, where they are tidy: see `whole_batches`.

        It does no work where a number is NaN or beyond the largest.
        """
        loop = self._code.address, None
        return whole_batches(loop, FLOAT64, self._inputs, self._outputs, self._code, largest=self._largest)


def _ir(sizes: Sequence[int], several: SideBySide | None) -> str:
    """The module's text.  sizes: numbers in a row of each argument."""
    code = Code()
    starts, steps = ([code.load(x, k, kind) for k in range(len(sizes))] for x, kind in (_PLACES, _STEPS))
    rows, done, lines = code.load("%dimensions", 0, "i64"), "0", list[str]()
    if several:
        done = _packs(code, several, rows, starts, steps)
        lines += [f"@own{k} = external global i8" for k in range(len(several.stretches))]
        lines += ["@counts = external global i8", "@regions = external global i8", "declare i64 @program(ptr, ptr)"]
    with code.loop(code.let(f"sub i64 {rows}, {done}")) as loop:
        row = code.let(f"add i64 {loop.iteration}, {done}")
        here = [_row(code, start, step, row) for start, step in zip(starts, steps, strict=True)]
        code.lines.append(f"call void @{FUNCTION}({', '.join(f'ptr {place}' for place in here)})")
    lines.append(f"declare void @{FUNCTION}({', '.join(['ptr'] * len(sizes))})")
    head = f"define void @{_LOOP}(ptr %arguments, ptr %dimensions, ptr %steps, ptr %data) {{\nentry:"
    return "\n".join([*lines, head, *code.lines, "ret void", "}", ""])


_PLACES, _STEPS = ("%arguments", "ptr"), ("%steps", "i64")


def _row(code: Code, start: str, step: str, number: str) -> str:
    return code.at(start, code.let(f"mul i64 {number}, {step}"), "i8")


def _packs(code: Code, several: SideBySide, rows: str, starts: Sequence[str], steps: Sequence[str]) -> str:
    """As many rows as possible, several at once; how many those are."""
    lanes, numbers = several.lanes, count()
    packs = code.let(f"udiv i64 {rows}, {lanes}")
    with code.loop(packs) as loop:
        first = code.let(f"mul i64 {loop.iteration}, {lanes}")
        each = [code.let(f"add i64 {first}, {lane}") for lane in range(lanes)]
        here = [[_row(code, start, step, k) for k in each] for start, step in zip(starts, steps, strict=True)]
        for some, stretches in zip(here, several.inputs, strict=False):
            _turn(code, some, stretches, numbers, inward=True)
        code.let("call i64 @program(ptr @counts, ptr @regions)")
        for some, stretches in zip(here[len(several.inputs) :], several.outputs, strict=True):
            _turn(code, some, stretches, numbers, inward=False)
    return code.let(f"mul i64 {packs}, {lanes}")


def _turn(
    code: Code, rows: Sequence[str], stretches: Sequence[Stretch], numbers: "count[int]", *, inward: bool
) -> None:
    """Rows into the program's memory, or out of it."""
    for own, column in stretches:
        there, begin = f"@own{next(numbers)}", [code.at(row, column) for row in rows]
        _, most = next(blocks(len(rows), len(rows), FLOAT64.item))
        whole = len(own) // most
        with code.loop(whole) as loop:
            offset = code.let(f"mul i64 {loop.iteration}, {most}")
            _turn_block(code, [code.at(row, offset) for row in begin], there, offset, most, inward=inward)
        for first, size in blocks(len(own) - whole * most, len(rows), FLOAT64.item):
            offset = whole * most + first
            _turn_block(code, [code.at(row, offset) for row in begin], there, str(offset), size, inward=inward)


def _turn_block(code: Code, rows: Sequence[str], own: str, first: str, size: int, *, inward: bool) -> None:
    """So many columns, which begin at the rows' pointers; their numbers' place is the first from `own` on."""
    kind, item = f"<{len(rows)} x {FLOAT64.real}>", FLOAT64.item
    here = code.at(own, first, kind)
    if inward:
        for k, vector in enumerate(lanes_of_rows(code, FLOAT64, rows, 0, size)):
            code.store(vector, here, k, kind, align=item)
    else:
        vectors = [code.load(here, k, kind, align=item) for k in range(size)]
        lanes_to_rows(code, FLOAT64, vectors, rows, 0)
