"""LLVM IR of a graph over a batch, in the calling convention of NumPy's generalised ufuncs.

The loop receives a pointer for each argument, the batch length, and strides in bytes: first each argument's stride
along the batch, then those along its own axes.  If one is not C-contiguous, or an output is an input, all go through
scratch memory.  Otherwise packs take most of a long batch, and the loop the remainder: see Packs.
"""

from collections.abc import Sequence

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine import element
from cutpoint.kernels.machine.lane_memory import row_lengths
from cutpoint.kernels.machine.llvm import Lanes
from cutpoint.kernels.machine.llvm_code import PREFETCH, Code
from cutpoint.kernels.machine.ufunc_loop import ufunc_loop

FUNCTION = "batch_loop"

_MEMSET = "declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)\n"

WORTH_MAKING_PACKS = 64
"""The shortest batch for which packs are compiled."""

_FEW_ARE_LEFT = 4
"""One part in so many of a pack goes as quickly one by one; of more, a last pack takes others a second time."""


class _Argument:
    """One port's pointers and strides inside the loop."""

    def __init__(self, code: Code, precision: Precision, port: Port, number: int, first_stride: int) -> None:
        self.port, self._precision = port, precision
        self.start = code.load("%arguments", number, "ptr")
        self.step = code.load("%steps", number, "i64")
        self.strides = [code.load("%steps", first_stride + axis, "i64") for axis in range(len(port.shape))]
        self.scratch = code.let(f"alloca {precision.real}, i64 {port.size}")
        self.here = ""

    def is_tidy(self, code: Code) -> list[str]:
        """Conditions whose conjunction is that the argument's own axes are C-contiguous."""
        sizes = [self._precision.item * n for n in row_lengths(self.port.shape)]
        return [code.let(f"icmp eq i64 {s}, {n}") for s, n in zip(self.strides, sizes, strict=True)]

    def advance(self, code: Code, index: str) -> None:
        self.here = code.at(self.start, code.let(f"mul i64 {self.step}, {index}"), "i8")

    def copy(self, code: Code, *, inward: bool) -> None:
        """Copies between the argument and its scratch memory, element by element."""
        kind = self._precision.real
        with code.loop(self.port.size) as loop:
            outside = self.here
            for n, length, stride in zip(row_lengths(self.port.shape), self.port.shape, self.strides, strict=True):
                index = code.let(f"urem i64 {code.let(f'udiv i64 {loop.iteration}, {n}')}, {length}")
                outside = code.at(outside, code.let(f"mul i64 {index}, {stride}"), "i8")
            source, target = (outside, self.scratch) if inward else (self.scratch, outside)
            value = code.load(source, 0 if inward else loop.iteration, kind)
            code.store(value, target, loop.iteration if inward else 0, kind)


def batch_loop(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], lanes: int, width: int | None) -> str:
    """The module's text.  The ports are the graph's own, less those of size 0.

    lanes: the processor's vector width.  width: elements in a pack; None without packs.  The graph is not yet lowered.
    """
    code = Code()
    arguments, first_stride = [], len(inputs) + len(outputs)
    for number, port in enumerate((*inputs, *outputs)):
        arguments.append(_Argument(code, graph.precision, port, number, first_stride))
        first_stride += len(port.shape)
    tidy = "true"
    for condition in [*_is_apart(code, arguments, len(inputs)), *(c for a in arguments for c in a.is_tidy(code))]:
        tidy = code.let(f"and i1 {tidy}, {condition}")
    count = code.load("%dimensions", 0, "i64")
    done = _packed(code, arguments, count, tidy, width) if width else "0"
    with code.loop(code.let(f"sub i64 {count}, {done}")) as loop:
        index = code.let(f"add i64 {loop.iteration}, {done}")
        for argument in arguments:
            argument.advance(code, index)
        _one(code, arguments[: len(inputs)], arguments[len(inputs) :], tidy)
    head = "".join(Lanes(x, graph.precision).declarations for x in (1, lanes)) + _MEMSET + PREFETCH
    return element.element(graph, inputs, outputs, lanes) + head + ufunc_loop(FUNCTION, code)


def _is_apart(code: Code, arguments: list[_Argument], inputs: int) -> list[str]:
    """Conditions whose conjunction is that no result overwrites data still to be read.

    NumPy hands over copies where memory overlaps, except where an output is an input itself.
    """
    pairs = [(a.start, b.start) for a in arguments[:inputs] for b in arguments[inputs:]]
    return [code.let(f"icmp ne ptr {a}, {b}") for a, b in pairs]


def _packed(code: Code, arguments: list[_Argument], count: str, tidy: str, width: int) -> str:
    """Runs the packs, compiled when a batch is first worth it; returns how many elements they took."""
    names = ("check", "wanted", "make", "made", "run", "again", "rest")
    check, wanted, make, made, run, again, rest = map(code.name, names)
    pointers = code.let(f"alloca [{len(arguments)} x ptr]")
    code.label(check)
    there = code.let(f"icmp ne ptr {_loop_over_packs(code)}, null")
    enough = code.let(f"icmp sge i64 {count}, {code.let(f'select i1 {there}, i64 {width}, i64 {WORTH_MAKING_PACKS}')}")
    code.branch(code.let(f"and i1 {enough}, {tidy}"), wanted, rest)
    code.open(wanted)
    code.branch(there, run, make)
    code.open(make)
    code.lines.append(f"call void {code.load('%data', 1, 'ptr')}()")
    code.label(made)
    code.branch(code.let(f"icmp ne ptr {_loop_over_packs(code)}, null"), run, rest)
    code.open(run)
    packs = code.let(f"sdiv i64 {count}, {width}")
    loop = _loop_over_packs(code)
    code.lines.append(f"call void {loop}(ptr %arguments, ptr %steps, i64 {packs})")
    taken = code.let(f"mul i64 {packs}, {width}")
    left = code.let(f"sub i64 {count}, {taken}")
    code.branch(code.let(f"icmp sgt i64 {left}, {width // _FEW_ARE_LEFT}"), again, rest)
    code.open(again)
    behind = code.let(f"sub i64 {count}, {width}")
    for k, argument in enumerate(arguments):
        argument.advance(code, behind)
        code.store(argument.here, pointers, k, "ptr")
    code.lines.append(f"call void {loop}(ptr {pointers}, ptr %steps, i64 1)")
    code.label(rest)
    return code.let(f"phi i64 [ 0, {check} ], [ 0, {made} ], [ {taken}, {run} ], [ {count}, {again} ]")


def _loop_over_packs(code: Code) -> str:
    """Its address, null before it is compiled; another thread may be compiling it."""
    return code.let("load atomic ptr, ptr %data acquire, align 8")


def _one(code: Code, inputs: list[_Argument], outputs: list[_Argument], tidy: str) -> None:
    """Runs one element of the batch."""
    gather, compute, scatter, end = (code.name(x) for x in ("gather", "compute", "scatter", "end"))
    code.branch(tidy, compute, gather)
    code.open(gather)
    for argument in inputs:
        argument.copy(code, inward=True)
    code.label(compute)
    memory = [code.let(f"select i1 {tidy}, ptr {a.here}, ptr {a.scratch}") for a in (*inputs, *outputs)]
    code.lines.append(f"call void @{element.FUNCTION}({', '.join(f'ptr {x}' for x in memory)})")
    code.branch(tidy, end, scatter)
    code.open(scatter)
    for argument in outputs:
        argument.copy(code, inward=False)
    code.label(end)
