"""Whole batches: one axis of elements, or none; contiguous, with no result sharing memory with anything else.

NumPy takes a microsecond or two to find that there is nothing to broadcast, cast or copy.  Machine code finds it in
some fifty nanoseconds, and then runs the same loop.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from cutpoint.kernels.arrays import numpy_api, python_api
from cutpoint.kernels.arrays.batch_arrays import BatchArrays, items, targets_of
from cutpoint.kernels.arrays.function import Whole
from cutpoint.kernels.arrays.numpy_api import TIDY
from cutpoint.kernels.arrays.plain_arguments import ELSEWHERE, are_within, is_possible, require
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.jit import OPTIMISATION, Compiled, vector_width
from cutpoint.kernels.machine.lane_memory import row_lengths
from cutpoint.kernels.machine.llvm_code import Code

_FUNCTION, _REFUSED = "whole", "%refused"

_CHUNK = 256
"""Elements whose numbers are looked at before they are worked on, few enough to be in the cache still."""


def whole_batches(
    loop: tuple[int, int | None],
    precision: Precision,
    inputs: Sequence[Port],
    outputs: Sequence[Port],
    owner: Any,
    bound: Sequence[np.ndarray] = (),
    largest: float | None = None,
) -> Whole | None:
    """The built-in function around a loop; None where Python or NumPy is not as machine code assumes.

    loop: addresses of the code and of its data; owner: of both.
    bound: arrays for the last inputs, shared by all elements, which callers then omit.
    largest: magnitude of a number beyond which, as with NaN, it does no work; None for any.  Only for float64.
    """
    if not is_possible():
        return None
    symbols = python_api.symbols() | numpy_api.symbols() | {"loop": loop[0], "data": loop[1] or id(None)}
    symbols |= {f"bound{k}": x.ctypes.data for k, x in enumerate(bound)}
    text = _ir(precision, inputs[: len(inputs) - len(bound)], inputs[len(inputs) - len(bound) :], outputs, largest)
    # the check of all numbers must be fast; the rest is negligible beside a batch, so it is compiled for compile time
    code = Compiled(text, _FUNCTION, symbols=symbols, optimisation=0 if largest is None else OPTIMISATION)
    return python_api.builtin(code.address, _FUNCTION, "whole(arguments, out)", (code, owner, bound))


class _Work:
    """Runs of the loop: memory for its array pointers, counts and strides."""

    def __init__(
        self, code: Code, precision: Precision, ports: Sequence[Port], starts: Sequence[str], steps: Sequence[str]
    ) -> None:
        self._starts, self._steps = starts, steps
        own_strides = [precision.item * n for port in ports for n in row_lengths(port.shape)]
        self._places, self._count = code.let(f"alloca [{len(starts)} x ptr]"), code.let("alloca i64")
        self._strides = code.let(f"alloca [{len(steps) + len(own_strides)} x i64]")
        for k, step in enumerate((*steps, *own_strides)):
            code.store(str(step), self._strides, k, "i64")

    def run(self, code: Code, first: str, count: str) -> None:
        """Runs the loop on so many elements."""
        for k, (start, step) in enumerate(zip(self._starts, self._steps, strict=True)):
            code.store(code.at(start, code.let(f"mul i64 {first}, {step}"), "i8"), self._places, k, "ptr")
        code.store(count, self._count, 0, "i64")
        code.lines.append(f"call void @loop(ptr {self._places}, ptr {self._count}, ptr {self._strides}, ptr @data)")


def _ir(
    precision: Precision,
    inputs: Sequence[Port],
    bound: Sequence[Port],
    outputs: Sequence[Port],
    largest: float | None,
) -> str:
    """Text of the function, which takes a tuple of arguments and `out`."""
    code = Code()
    given, out = (code.load("%arguments", k, "ptr") for k in range(2))
    sources = BatchArrays(precision, inputs)
    sources.require(code, items(code, given, len(inputs)), TIDY, may_be_shared=True)
    targets, answer = targets_of(code, precision, outputs, sources, out)
    names = [f"bound{k}" for k in range(len(bound))]
    starts = [*sources.starts, *(f"@{name}" for name in names), *targets]
    steps = [*sources.steps, *["0"] * len(bound), *(str(precision.item * port.size) for port in outputs)]
    # the loop ignores ports of size 0
    parts = [x for x in zip((*inputs, *bound, *outputs), starts, steps, strict=True) if x[0].size]
    work = _Work(code, precision, *zip(*parts, strict=True))
    # without the GIL
    thread = code.let("call ptr @PyEval_SaveThread()")
    if largest is None:
        work.run(code, "0", sources.count)
    else:
        _run_in_chunks(code, work, sources, largest)
    code.lines += [f"call void @PyEval_RestoreThread(ptr {thread})", f"ret ptr {answer}"]
    if largest is not None:
        code.open(_REFUSED)
        code.lines += [f"call void @PyEval_RestoreThread(ptr {thread})", f"call void @Py_DecRef(ptr {answer})"]
        code.lines.append(f"br label {ELSEWHERE}")
    code.open(ELSEWHERE)
    code.lines += ["call void @Py_IncRef(ptr @none)", "ret ptr @none"]
    kinds = ("array_type", "float_type", "float64_type", "tuple_type")
    objects = (*kinds, "none", precision.dtype.name, "data", *names)
    externals = [f"@{name} = external global i8" for name in objects]
    declarations = [python_api.DECLARATIONS, numpy_api.DECLARATIONS, "declare void @loop(ptr, ptr, ptr, ptr)"]
    head = f"define ptr @{_FUNCTION}(ptr %self, ptr %arguments, i64 %count, ptr %names) {{\nentry:"
    return "\n".join([*declarations, *externals, head, *code.lines, "}", ""])


def _run_in_chunks(code: Code, work: _Work, sources: BatchArrays, largest: float) -> None:
    """Runs chunks of elements in sequence, each after a check of its numbers."""
    chunks = code.let(f"udiv i64 {code.let(f'add i64 {sources.count}, {_CHUNK - 1}')}, {_CHUNK}")
    with code.loop(chunks) as loop:
        first = code.let(f"mul i64 {loop.iteration}, {_CHUNK}")
        left = code.let(f"sub i64 {sources.count}, {first}")
        count = code.let(f"select i1 {code.let(f'icmp slt i64 {left}, {_CHUNK}')}, i64 {left}, i64 {_CHUNK}")
        for k, (start, step) in enumerate(zip(sources.starts, sources.steps, strict=True)):
            here = code.at(start, code.let(f"mul i64 {first}, {step}"), "i8")
            _require_within(code, here, sources.numbers(code, k, count), largest)
        work.run(code, first, count)


def _require_within(code: Code, start: str, numbers: str, largest: float) -> None:
    width = vector_width()
    vectors = code.let(f"udiv i64 {numbers}, {width}")
    done = code.let(f"mul i64 {vectors}, {width}")
    for count, first, size in ((vectors, "0", width), (code.let(f"sub i64 {numbers}, {done}"), done, 1)):
        begin = code.at(start, first)
        with code.loop(count) as loop:
            here = code.at(begin, code.let(f"mul i64 {loop.iteration}, {size}"))
            require(code, are_within(code, here, size, largest), otherwise=_REFUSED)
