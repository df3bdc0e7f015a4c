"""LLVM IR of a graph for one element of a batch."""

import math
from collections.abc import Mapping, Sequence
from itertools import groupby

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port, slots_of
from cutpoint.kernels.lowering.side_by_side import side_by_side
from cutpoint.kernels.machine.llvm import Lanes, StraightLine, straight_line
from cutpoint.kernels.machine.llvm_code import Code
from cutpoint.kernels.machine.tuning import claims_results, for_divisions, for_one_element

FUNCTION = "element"


def element(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], width: int) -> str:
    """The function's text: void element(const real *input, ..., real *output, ...), each C-contiguous.

    Outputs must not overlap inputs.  The ports are the graph's own, less those of size 0.  width: the processor's
    vector width.  The graph is not yet lowered.
    """
    code, count, parts = Code(), len(inputs) + len(outputs), side_by_side(graph, width)
    lanes, wide = (Lanes(x, graph.precision) for x in (1, width))
    memory = [f"%argument{k}" for k in range(count)]
    read, write = slots_of(inputs, memory[: len(inputs)]), slots_of(outputs, memory[len(inputs) :])
    places = dict(zip(memory[len(inputs) :], outputs, strict=True))
    if claims_results(parts.rest):
        for pointer, port in places.items():
            code.claim(pointer, port.size * graph.precision.item)
    _constants(code, parts.rest, lanes, places)
    in_vectors: dict[int, tuple[str, int]] = {}

    def load(slot: int) -> str:
        return wide.one_of(code, *in_vectors[slot]) if slot in in_vectors else code.load(*read[slot], lanes.real)

    def ready(slot: int, value: str) -> None:
        # each result is stored as soon as it is computed, to keep register pressure low
        if slot < len(write):
            code.store(value, *write[slot], lanes.real)

    rest = StraightLine(code, parts.rest, lanes, load, ready)
    for group in parts.groups:
        arguments = wide.joined(code, rest.written(group.arguments))
        found = straight_line(code, group.graph, wide, lambda _, x=arguments: x)
        for vector, slots in zip(found, group.values, strict=True):
            in_vectors |= {slot: (vector, k) for k, slot in enumerate(slots)}
    rest.written(range(len(graph.results)))
    pointers = ", ".join(f"ptr noalias {pointer}" for pointer in memory)
    head = f"define void @{FUNCTION}({pointers}) {for_one_element()} {for_divisions([graph])} {{\nentry:"
    return "\n".join([head, *code.lines, "ret void", "}", ""])


def _constants(code: Code, graph: Graph, lanes: Lanes, outputs: Mapping[str, Port]) -> None:
    """Stores constant results to the outputs; consecutive zeros by as few stores as possible."""
    for pointer, port in outputs.items():
        slot = 0
        for is_zero, some in groupby(graph.output(port.name), _is_zero):
            values = [*some]
            if is_zero:
                code.zero(code.at(pointer, slot, lanes.real), len(values) * graph.precision.item)
            for k, x in enumerate(values):
                if isinstance(x, float) and not is_zero:
                    code.store(lanes.constant(x), pointer, slot + k, lanes.real)
            slot += len(values)


def _is_zero(x: Operand) -> bool:
    """Whether all bits of a result are zero."""
    return isinstance(x, float) and x == 0 and math.copysign(1, x) > 0
