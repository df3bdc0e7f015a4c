"""LLVM IR of a graph for one element of a batch."""

import math
from collections.abc import Sequence

from cutpoint.kernels.algebra import Operand
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.llvm import Lanes, straight_line
from cutpoint.kernels.llvm_code import Code
from cutpoint.kernels.ports import Port

FUNCTION = "element"


def element(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port]) -> str:
    """The function's text: void element(const real *input, ..., real *output, ...), each C-contiguous.

    Outputs must not overlap inputs.  The ports are the graph's own, less those of size 0; more inputs at the end are
    not read.
    """
    code, lanes, count = Code(), Lanes(1, graph.precision), len(inputs) + len(outputs)
    memory = [f"%argument{k}" for k in range(count)]
    read, write = _slots(inputs, memory), _slots(outputs, memory[len(inputs) :])
    for port, pointer in zip(outputs, memory[len(inputs) :], strict=True):
        if any(_is_zero(x) for x in graph.output(port.name)):
            code.zero(pointer, port.size * graph.precision.item)
    for slot, x in enumerate(graph.results):
        if isinstance(x, float) and not _is_zero(x):
            code.store(lanes.constant(x), *write[slot], lanes.real)
    # each result leaves as soon as it is there, so that few must be held at a time
    straight_line(
        code, graph, lambda slot: code.load(*read[slot], lanes.real),
        lambda slot, value: code.store(value, *write[slot], lanes.real), lanes,
    )  # fmt: skip
    head = f"define void @{FUNCTION}({', '.join(f'ptr {pointer}' for pointer in memory)}) {{\nentry:"
    return "\n".join([head, *code.lines, "ret void", "}", ""])


def _is_zero(x: Operand) -> bool:
    """Whether a result is zero, all bits of it."""
    return isinstance(x, float) and x == 0 and math.copysign(1, x) > 0


def _slots(ports: Sequence[Port], memory: list[str]) -> list[tuple[str, int]]:
    """Pointer and index of every slot."""
    return [(pointer, k) for port, pointer in zip(ports, memory, strict=False) for k in range(port.size)]
