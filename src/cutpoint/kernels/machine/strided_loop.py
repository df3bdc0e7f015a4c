"""LLVM IR of a graph over a batch with any strides, in packs, in the calling convention of NumPy's gufuncs."""

from collections.abc import Sequence

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port, slots_of
from cutpoint.kernels.machine.lane_memory import LaneMemory
from cutpoint.kernels.machine.llvm import Lanes, straight_line
from cutpoint.kernels.machine.llvm_code import ON_LINES, Code
from cutpoint.kernels.machine.tuning import for_divisions
from cutpoint.kernels.machine.ufunc_loop import ufunc_loop

FUNCTION = "strided_loop"


def strided_loop(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], width: int) -> str:
    """The module's text.  A pack is read completely before any of it is written, so an output may be an input."""
    code, lanes = Code(), Lanes(width, graph.precision)
    arguments, first_stride = [], len(inputs) + len(outputs)
    for number, port in enumerate((*inputs, *outputs)):
        arguments.append(LaneMemory(code, lanes, port, number, first_stride))
        first_stride += len(port.shape)
    sources, targets = arguments[: len(inputs)], arguments[len(inputs) :]
    read, write = slots_of(inputs, [a.scratch for a in sources]), slots_of(outputs, [a.scratch for a in targets])
    for argument in arguments:
        argument.prepare(code)
    for x, place in zip(graph.results, write, strict=True):
        if isinstance(x, float):
            code.store(lanes.constant(x), *place, lanes.real)
    count = code.load("%dimensions", 0, "i64")
    packs = code.let(f"sdiv i64 {code.let(f'add i64 {count}, {width - 1}')}, {width}")
    with code.loop(packs) as loop:
        first = code.let(f"mul i64 {loop.iteration}, {width}")
        for argument in sources:
            argument.fetch(code, first, count)
        straight_line(
            code, graph, lanes, lambda slot: code.load(*read[slot], lanes.real),
            lambda slot, value: code.store(value, *write[slot], lanes.real),
        )  # fmt: skip
        for argument in targets:
            argument.deliver(code, first, count)
    return lanes.declarations + ufunc_loop(FUNCTION, code, f"{ON_LINES} {for_divisions([graph])}")
