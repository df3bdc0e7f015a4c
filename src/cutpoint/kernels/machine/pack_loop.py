"""LLVM IR of a graph over packs: as many elements of a batch at once as the processor has lanes.

A pack's inputs are turned into lanes in scratch memory on the stack, the straight-line code runs on lanes, and its
results are turned back.  Each lane computes what the scalar code does, operation by operation.
"""

from collections.abc import Sequence

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.machine.llvm import Lanes, straight_line
from cutpoint.kernels.machine.llvm_code import PREFETCH, Code, in_turn
from cutpoint.kernels.machine.transposition import blocks, constants_to_rows, lanes_of_rows, lanes_to_rows
from cutpoint.kernels.machine.tuning import for_divisions

FUNCTION = "pack_loop"


class _Argument:
    """One port's memory: rows outside, lanes in scratch memory.  size: bytes of a pack."""

    def __init__(self, code: Code, lanes: Lanes, port: Port, number: int) -> None:
        self.lanes, self.blocks = lanes, [*blocks(port.size, lanes.width, lanes.item)]
        self.start = code.load("%arguments", number, "ptr")
        self.step = code.load("%steps", number, "i64")
        self.offsets = [code.let(f"mul i64 {self.step}, {lane}") for lane in range(lanes.width)]
        self.scratch = code.let(f"alloca {lanes.real}, i64 {port.size}")
        self.size = port.size * lanes.item * lanes.width

    def first(self, code: Code, pack: str) -> str:
        element = code.let(f"mul i64 {pack}, {self.lanes.width}")
        return code.at(self.start, code.let(f"mul i64 {self.step}, {element}"), "i8")

    def rows(self, code: Code, pack: str) -> list[str]:
        first = self.first(code, pack)
        return [code.at(first, offset, "i8") for offset in self.offsets]

    def fetch(self, code: Code, pack: str) -> None:
        """From rows to lanes; what is the same for the whole batch is fetched once."""
        fetch, end = code.name("fetch"), code.name("fetched")
        first, moves = code.let(f"icmp eq i64 {pack}, 0"), code.let(f"icmp ne i64 {self.step}, 0")
        code.branch(code.let(f"or i1 {first}, {moves}"), fetch, end)
        code.open(fetch)
        rows = self.rows(code, pack)
        for column, size in self.blocks:
            for k, vector in enumerate(lanes_of_rows(code, self.lanes.precision, rows, column, size)):
                code.store(vector, self.scratch, column + k, self.lanes.real)
        code.label(end)

    def deliver(self, code: Code, pack: str, results: Sequence[Operand]) -> None:
        """From lanes to rows; what is known beforehand needs no lanes."""
        rows, precision = self.rows(code, pack), self.lanes.precision
        for column, size in self.blocks:
            numbers = results[column : column + size]
            if all(isinstance(x, float) for x in numbers):
                constants_to_rows(code, precision, numbers, rows, column)
                continue
            vectors = [code.load(self.scratch, column + k, self.lanes.real) for k in range(size)]
            lanes_to_rows(code, precision, vectors, rows, column)


def pack_loop(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], width: int) -> str:
    """The module's text: void pack_loop(char **arguments, i64 *steps, i64 packs), steps in bytes; C-contiguous rows."""
    code, lanes = Code(), Lanes(width, graph.precision)
    arguments = [_Argument(code, lanes, port, number) for number, port in enumerate((*inputs, *outputs))]
    sources, targets = arguments[: len(inputs)], arguments[len(inputs) :]
    read = [(a.scratch, k) for a, port in zip(sources, inputs, strict=True) for k in range(port.size)]
    write = [(a.scratch, k) for a, port in zip(targets, outputs, strict=True) for k in range(port.size)]
    for x, place in zip(graph.results, write, strict=True):
        if isinstance(x, float):
            code.store(lanes.constant(x), *place, lanes.real)
    with code.loop("%packs") as loop:
        for argument in sources:
            argument.fetch(code, loop.iteration)
        with code.aside() as asked:
            for argument in sources:
                code.ask(argument.first(code, loop.iteration), argument.size)
        with code.aside() as pack:
            straight_line(
                code, graph, lanes, lambda slot: code.load(*read[slot], lanes.real),
                lambda slot, value: code.store(value, *write[slot], lanes.real),
            )  # fmt: skip
        code.lines += in_turn(pack, asked)
        for argument, port in zip(targets, outputs, strict=True):
            argument.deliver(code, loop.iteration, graph.output(port.name))
    head = f"{lanes.declarations}{PREFETCH}define void @{FUNCTION}"
    head += f"(ptr %arguments, ptr %steps, i64 %packs) {for_divisions([graph])} {{\nentry:"
    return "\n".join([head, *code.lines, "ret void", "}", ""])
