"""LLVM IR of a graph over blocks: arrays that hold as many elements side by side as the processor has lanes.

A block is (*shape, width) in C order, so every number of a port is one vector in memory and nothing is transposed.
"""

from collections.abc import Sequence

from cutpoint.kernels.graph import Graph
from cutpoint.kernels.llvm import Lanes, straight_line
from cutpoint.kernels.llvm_code import Code
from cutpoint.kernels.ports import Port

FUNCTION = "block_loop"
_ALL_EXCEPTIONS = 0x3F  # a superset of every platform's FE_ALL_EXCEPT
_ITEM = 8  # bytes of a float64, and all the alignment that NumPy promises


class _Memory:
    """One port's blocks."""

    def __init__(self, code: Code, number: int) -> None:
        self.start = code.load("%arguments", number, "ptr")
        self._step = code.load("%steps", number, "i64")
        self.here = ""

    def advance(self, code: Code, block: str) -> None:
        self.here = code.at(self.start, code.let(f"mul i64 {self._step}, {block}"), "i8")


def block_loop(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], width: int) -> str:
    """The module's text, in the calling convention of NumPy's generalised ufuncs; blocks are C-contiguous.

    The ports are the graph's own.  An output may be an input: results wait in scratch memory then.
    """
    code, lanes, count = Code(), Lanes(width), len(inputs)
    scratch = [code.let(f"alloca {lanes.real}, i64 {port.size}") for port in outputs]
    arguments = [_Memory(code, number) for number in range(count + len(outputs))]
    sources, targets = arguments[:count], arguments[count:]
    apart = "true"
    for a, b in ((a, b) for a in sources for b in targets):
        apart = code.let(f"and i1 {apart}, {code.let(f'icmp ne ptr {a.start}, {b.start}')}")
    with code.loop(code.load("%dimensions", 0, "i64")) as loop:
        for argument in arguments:
            argument.advance(code, loop.iteration)
        places = [code.let(f"select i1 {apart}, ptr {a.here}, ptr {x}") for a, x in zip(targets, scratch, strict=True)]
        _block(code, graph, lanes, _slots(inputs, [a.here for a in sources]), _slots(outputs, places))
        _move(code, outputs, width, apart, scratch, [a.here for a in targets])
    # results, not processor flags, tell of overflow and NaN: both sides of a select are computed
    code.let(f"call i32 @feclearexcept(i32 {_ALL_EXCEPTIONS})")
    head = f"{lanes.declarations}declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)\n"
    head += "declare i32 @feclearexcept(i32)\n"
    head += f"define void @{FUNCTION}(ptr %arguments, ptr %dimensions, ptr %steps, ptr %data) {{\nentry:"
    return "\n".join([head, *code.lines, "ret void", "}", ""])


def _block(code: Code, graph: Graph, lanes: Lanes, read: list[tuple[str, int]], write: list[tuple[str, int]]) -> None:
    """One block from memory to memory."""

    def ready(slot: int, value: str) -> None:
        code.store(value, *write[slot], lanes.real, align=_ITEM)

    for slot, x in enumerate(graph.results):
        if isinstance(x, float):
            ready(slot, lanes.constant(x))
    straight_line(code, graph, lambda slot: code.load(*read[slot], lanes.real, align=_ITEM), ready, lanes)


def _move(code: Code, outputs: Sequence[Port], width: int, apart: str, scratch: list[str], targets: list[str]) -> None:
    """Results that waited in scratch memory."""
    move, end = code.name("move"), code.name("moved")
    code.branch(apart, end, move)
    code.open(move)
    for port, source, target in zip(outputs, scratch, targets, strict=True):
        length = _ITEM * width * port.size
        code.lines.append(f"call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {source}, i64 {length}, i1 false)")
    code.label(end)


def _slots(ports: Sequence[Port], memory: list[str]) -> list[tuple[str, int]]:
    """Pointer and index of every vector."""
    return [(pointer, k) for port, pointer in zip(ports, memory, strict=True) for k in range(port.size)]
