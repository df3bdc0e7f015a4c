"""LLVM IR of a graph over blocks: arrays that interleave as many elements as the processor has lanes.

A block is (*shape, width) in C order, so every number of a port is one vector in memory and nothing is transposed.
"""

from collections.abc import Sequence

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port, slots_of
from cutpoint.kernels.machine.llvm import Lanes, straight_line
from cutpoint.kernels.machine.llvm_code import PREFETCH, Code, in_turn
from cutpoint.kernels.machine.tuning import for_blocks
from cutpoint.kernels.machine.ufunc_loop import ufunc_loop

FUNCTION = "block_loop"

BEYOND_CACHES = 2**25
"""Bytes, of all blocks of a call: results of more are written past the caches, which would not keep them anyway.

Measured for inverse dynamics of a 6R arm, 190 MB: 10 to 25 % less time.  For arrays of rows it gained nothing.
"""


class _Memory:
    """One port's blocks."""

    def __init__(self, code: Code, number: int) -> None:
        self.start = code.load("%arguments", number, "ptr")
        self.step = code.load("%steps", number, "i64")
        self.here = ""

    def advance(self, code: Code, block: str) -> None:
        self.here = code.at(self.start, code.let(f"mul i64 {self.step}, {block}"), "i8")


def block_loop(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], width: int) -> str:
    """The module's text, in the calling convention of NumPy's generalised ufuncs; blocks are C-contiguous.

    The ports are the graph's own.  An output may be an input: results are then buffered in scratch memory.
    """
    code, lanes = Code(), Lanes(width, graph.precision)
    scratch = [code.let(f"alloca {lanes.real}, i64 {port.size}") for port in outputs]
    arguments = [_Memory(code, number) for number in range(len(inputs) + len(outputs))]
    sources, targets = arguments[: len(inputs)], arguments[len(inputs) :]
    count = code.load("%dimensions", 0, "i64")
    streams = _streams(code, arguments, targets, count, lanes)
    direct = code.let(f"xor i1 {streams}, true")
    for a, b in ((a, b) for a in sources for b in targets):
        direct = code.let(f"and i1 {direct}, {code.let(f'icmp ne ptr {a.start}, {b.start}')}")
    with code.loop(count) as loop:
        for argument in arguments:
            argument.advance(code, loop.iteration)
        places = [code.let(f"select i1 {direct}, ptr {a.here}, ptr {x}") for a, x in zip(targets, scratch, strict=True)]
        with code.aside() as asked:
            for argument, port in zip(sources, inputs, strict=True):
                code.ask(argument.here, port.size * lanes.item * lanes.width)
        with code.aside() as block:
            _block(code, graph, lanes, slots_of(inputs, [a.here for a in sources]), slots_of(outputs, places))
        code.lines += in_turn(block, asked)
        move, end = code.name("move"), code.name("moved")
        code.branch(direct, end, move)
        code.open(move)
        for port, source, target in zip(outputs, scratch, targets, strict=True):
            _move(code, lanes, port.size, source, target.here, streams)
        code.label(end)
    # non-temporal stores are weakly ordered; the fence makes them visible to readers of the results
    code.lines.append("fence seq_cst")
    return "\n".join([lanes.declarations, PREFETCH, ufunc_loop(FUNCTION, code, for_blocks(graph)), "!0 = !{i32 1}", ""])


def _block(code: Code, graph: Graph, lanes: Lanes, read: list[tuple[str, int]], write: list[tuple[str, int]]) -> None:
    """One block from memory to memory; stores of constants are spread over it, since store bandwidth is limited."""

    def store(slot: int, value: str) -> None:
        code.store(value, *write[slot], lanes.real, align=lanes.item)  # all that NumPy promises

    with code.aside() as constants:
        for slot, x in enumerate(graph.results):
            if isinstance(x, float):
                store(slot, lanes.constant(x))
    with code.aside() as computed:
        straight_line(code, graph, lanes, lambda slot: code.load(*read[slot], lanes.real, align=lanes.item), store)
    code.lines += in_turn(computed, constants)


def _streams(code: Code, arguments: list[_Memory], targets: list[_Memory], count: str, lanes: Lanes) -> str:
    """Whether stores are non-temporal: the call is long enough, and results are aligned to vectors."""
    total, places = "0", "0"
    for argument in arguments:
        total = code.let(f"add i64 {total}, {argument.step}")
    for target in targets:
        start = code.let(f"ptrtoint ptr {target.start} to i64")
        places = code.let(f"or i64 {places}, {code.let(f'or i64 {start}, {target.step}')}")
    is_long = code.let(f"icmp sgt i64 {code.let(f'mul i64 {total}, {count}')}, {BEYOND_CACHES}")
    odd = code.let(f"and i64 {places}, {lanes.item * lanes.width - 1}")
    return code.let(f"and i1 {is_long}, {code.let(f'icmp eq i64 {odd}, 0')}")


def _move(code: Code, lanes: Lanes, size: int, source: str, target: str, streams: str) -> None:
    """Moves results that were buffered in scratch memory."""
    past, through, end = code.name("past"), code.name("through"), code.name("end")
    code.branch(streams, past, through)
    whole = lanes.item * lanes.width
    for label, suffix in ((past, f"align {whole}, !nontemporal !0"), (through, f"align {lanes.item}")):
        code.open(label)
        with code.loop(size) as loop:
            value = code.load(source, loop.iteration, lanes.real)
            place = code.at(target, loop.iteration, lanes.real)
            code.lines.append(f"store {lanes.real} {value}, ptr {place}, {suffix}")
        code.lines.append(f"br label {end}")
    code.open(end)
