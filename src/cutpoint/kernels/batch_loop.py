"""LLVM IR of a graph over a batch, in the calling convention of NumPy's generalised ufuncs.

The loop receives a pointer for each argument, the batch length, and strides in bytes: first each argument's step
through the batch, then its steps through its own axes.  If one is not C-contiguous all go through scratch memory.
"""

import math
from collections.abc import Sequence

from cutpoint.kernels.algebra import Operand
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.llvm import DECLARATIONS, constant, straight_line
from cutpoint.kernels.llvm_code import Code
from cutpoint.kernels.ports import Port

FUNCTION = "batch_loop"

_HEADER = f"""{DECLARATIONS}declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)
declare i32 @feclearexcept(i32)
define void @{FUNCTION}(ptr %arguments, ptr %dimensions, ptr %steps, ptr %unused) {{
entry:"""
_ALL_EXCEPTIONS = 0x3F  # a superset of every platform's FE_ALL_EXCEPT


class _Argument:
    """One port's pointers and strides inside the loop."""

    def __init__(self, code: Code, port: Port, number: int, first_stride: int) -> None:
        self.port = port
        self.start = code.load("%arguments", number, "ptr")
        self.step = code.load("%steps", number, "i64")
        self.strides = [code.load("%steps", first_stride + axis, "i64") for axis in range(len(port.shape))]
        self.scratch = code.let(f"alloca double, i64 {port.size}")
        self.here = ""

    def is_tidy(self, code: Code) -> list[str]:
        """Conditions that together say that the argument's own axes are C-contiguous."""
        items = _row_lengths(self.port.shape)
        return [code.let(f"icmp eq i64 {s}, {8 * n}") for s, n in zip(self.strides, items, strict=True)]

    def advance(self, code: Code, index: str) -> None:
        self.here = code.at(self.start, code.let(f"mul i64 {self.step}, {index}"), "i8")

    def copy(self, code: Code, *, inward: bool) -> None:
        """Between the argument and its scratch memory, element by element."""
        with code.loop(self.port.size) as loop:
            outside = self.here
            for n, length, stride in zip(_row_lengths(self.port.shape), self.port.shape, self.strides, strict=True):
                index = code.let(f"urem i64 {code.let(f'udiv i64 {loop.iteration}, {n}')}, {length}")
                outside = code.at(outside, code.let(f"mul i64 {index}, {stride}"), "i8")
            source, target = (outside, self.scratch) if inward else (self.scratch, outside)
            code.store(code.load(source, 0 if inward else loop.iteration), target, loop.iteration if inward else 0)


def batch_loop(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port]) -> str:
    """The module's text.  The ports are the graph's own, less those of size 0; more inputs at the end are not read."""
    code = Code()
    arguments, first_stride = [], len(inputs) + len(outputs)
    for number, port in enumerate((*inputs, *outputs)):
        arguments.append(_Argument(code, port, number, first_stride))
        first_stride += len(port.shape)
    tidy = "true"
    for condition in [c for argument in arguments for c in argument.is_tidy(code)]:
        tidy = code.let(f"and i1 {tidy}, {condition}")
    with code.loop(code.load("%dimensions", 0, "i64")) as loop:
        for argument in arguments:
            argument.advance(code, loop.iteration)
        _one(code, graph, arguments[: len(inputs)], arguments[len(inputs) :], tidy)
    # results, not processor flags, tell of overflow and NaN: both sides of a select are computed
    code.let(f"call i32 @feclearexcept(i32 {_ALL_EXCEPTIONS})")
    return "\n".join([_HEADER, *code.lines, "ret void", "}", ""])


def _one(code: Code, graph: Graph, inputs: list[_Argument], outputs: list[_Argument], tidy: str) -> None:
    """One element of the batch."""
    gather, compute, scatter, end = (code.name(x) for x in ("gather", "compute", "scatter", "end"))
    code.branch(tidy, compute, gather)
    code.open(gather)
    for argument in inputs:
        argument.copy(code, inward=True)
    code.label(compute)
    memory = [code.let(f"select i1 {tidy}, ptr {a.here}, ptr {a.scratch}") for a in (*inputs, *outputs)]
    read = _slots([a.port for a in inputs], memory)
    write = _slots([a.port for a in outputs], memory[len(inputs) :])
    for argument, pointer in zip(outputs, memory[len(inputs) :], strict=True):
        if any(_is_zero(x) for x in graph.output(argument.port.name)):
            code.zero(pointer, argument.port.size)
    for slot, x in enumerate(graph.results):
        if isinstance(x, float) and not _is_zero(x):
            code.store(constant(x), *write[slot])
    # each result leaves as soon as it is there, so that few must be held at a time
    straight_line(
        code, graph, lambda slot: code.load(*read[slot]), lambda slot, value: code.store(value, *write[slot])
    )
    code.branch(tidy, end, scatter)
    code.open(scatter)
    for argument in outputs:
        argument.copy(code, inward=False)
    code.label(end)


def _is_zero(x: Operand) -> bool:
    """Whether a result is zero, all bits of it."""
    return isinstance(x, float) and x == 0 and math.copysign(1, x) > 0


def _slots(ports: list[Port], memory: list[str]) -> list[tuple[str, int]]:
    """Pointer and index of every slot."""
    return [(pointer, k) for port, pointer in zip(ports, memory, strict=False) for k in range(port.size)]


def _row_lengths(shape: tuple[int, ...]) -> list[int]:
    """How many elements apart neighbours along each axis are in a C-contiguous array."""
    lengths = [1]
    for n in reversed(shape[1:]):
        lengths.insert(0, n * lengths[0])
    return lengths[: len(shape)]
