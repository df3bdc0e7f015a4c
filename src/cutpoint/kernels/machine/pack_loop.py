"""LLVM IR of a graph over packs: as many elements of a batch at once as the processor has lanes.

A pack's inputs are transposed into lanes, the straight-line code runs on lanes, and its results are transposed back.
Each lane performs the scalar code's operations, one for one.
"""

from collections.abc import Sequence

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port, slots_of
from cutpoint.kernels.machine.llvm import Lanes, straight_line
from cutpoint.kernels.machine.llvm_code import ON_LINES, PREFETCH, Code, in_turn
from cutpoint.kernels.machine.transposition import blocks, constants_to_rows, lanes_of_rows, lanes_to_rows
from cutpoint.kernels.machine.tuning import for_divisions

FUNCTION = "pack_loop"

_FEW = 16
"""Numbers of an input that is turned for every pack, be it the same for the whole batch: registers take them.

Of an arm's coordinates that was measured to save 2 to 4 % of its dynamics.  What is longer, such as a robot's
parameters, is mostly the same.
"""


class _Rows:
    """One port's memory.  size: of a pack, bytes."""

    def __init__(self, code: Code, lanes: Lanes, port: Port, number: int) -> None:
        self._lanes, self._blocks = lanes, [*blocks(port.size, lanes.width, lanes.item)]
        self._start = code.load("%arguments", number, "ptr")
        self._step = code.load("%steps", number, "i64")
        self._offsets = [code.let(f"mul i64 {self._step}, {lane}") for lane in range(lanes.width)]
        self.size = port.size * lanes.item * lanes.width

    def first(self, code: Code, pack: str) -> str:
        element = code.let(f"mul i64 {pack}, {self._lanes.width}")
        return code.at(self._start, code.let(f"mul i64 {self._step}, {element}"), "i8")

    def _rows(self, code: Code, pack: str) -> list[str]:
        first = self.first(code, pack)
        return [code.at(first, offset, "i8") for offset in self._offsets]


class _Source(_Rows):
    """An input's memory."""

    def __init__(self, code: Code, lanes: Lanes, port: Port, number: int) -> None:
        super().__init__(code, lanes, port, number)
        self._scratch = "" if port.size <= _FEW else code.let(f"alloca {lanes.real}, i64 {port.size}")
        self._vectors: list[str] = []

    def fetch(self, code: Code, pack: str) -> None:
        """From rows to lanes; inputs of many numbers that the whole batch shares are fetched once."""
        if not self._scratch:
            self._vectors = self._turned(code, pack)
            return
        fetch, end = code.name("fetch"), code.name("fetched")
        first, moves = code.let(f"icmp eq i64 {pack}, 0"), code.let(f"icmp ne i64 {self._step}, 0")
        code.branch(code.let(f"or i1 {first}, {moves}"), fetch, end)
        code.open(fetch)
        for k, vector in enumerate(self._turned(code, pack)):
            code.store(vector, self._scratch, k, self._lanes.real)
        code.label(end)

    def number(self, code: Code, k: int) -> str:
        """The lanes of a number that has been fetched."""
        return code.load(self._scratch, k, self._lanes.real) if self._scratch else self._vectors[k]

    def _turned(self, code: Code, pack: str) -> list[str]:
        rows, precision = self._rows(code, pack), self._lanes.precision
        return [x for column, size in self._blocks for x in lanes_of_rows(code, precision, rows, column, size)]


class _Target(_Rows):
    """An output's memory: a block of columns is transposed back as soon as it is complete."""

    def __init__(self, code: Code, lanes: Lanes, port: Port, number: int, results: Sequence[Operand]) -> None:
        super().__init__(code, lanes, port, number)
        self._results, self._block = results, {k: b for b in self._blocks for k in range(b[0], sum(b))}
        self._vectors = {k: lanes.constant(x) for k, x in enumerate(results) if isinstance(x, float)}
        self._here: list[str] = []

    def begin(self, code: Code, pack: str) -> None:
        """Begins a pack."""
        self._here = self._rows(code, pack)

    def put_constants(self, code: Code) -> None:
        """Stores constant results, which need no lanes."""
        for column, size in self._blocks:
            numbers = [x for x in self._results[column : column + size] if isinstance(x, float)]
            if len(numbers) == size:
                constants_to_rows(code, self._lanes.precision, numbers, self._here, column)

    def take(self, code: Code, k: int, vector: str) -> None:
        """Takes the lanes of a number just computed."""
        self._vectors[k] = vector
        column, size = self._block[k]
        vectors = [self._vectors[x] for x in range(column, column + size) if x in self._vectors]
        if len(vectors) == size:
            lanes_to_rows(code, self._lanes.precision, vectors, self._here, column)


def pack_loop(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], width: int) -> str:
    """The module's text: void pack_loop(char **arguments, i64 *steps, i64 packs), steps in bytes; C-contiguous rows."""
    code, lanes = Code(), Lanes(width, graph.precision)
    sources = [_Source(code, lanes, port, number) for number, port in enumerate(inputs)]
    targets = [
        _Target(code, lanes, port, number, graph.output(port.name)) for number, port in enumerate(outputs, len(inputs))
    ]
    read, write = slots_of(inputs, sources), slots_of(outputs, targets)

    def load(slot: int) -> str:
        source, k = read[slot]
        return source.number(code, k)

    def ready(slot: int, vector: str) -> None:
        target, k = write[slot]
        target.take(code, k, vector)

    with code.loop("%packs") as loop:
        for source in sources:
            source.fetch(code, loop.iteration)
        for target in targets:
            target.begin(code, loop.iteration)
        with code.aside() as asked:
            for source in sources:
                code.ask(source.first(code, loop.iteration), source.size)
        with code.aside() as pack:
            straight_line(code, graph, lanes, load, ready)
        with code.aside() as constants:
            for target in targets:
                target.put_constants(code)
        code.lines += in_turn(in_turn(pack, constants), asked)
    head = f"{lanes.declarations}{PREFETCH}define void @{FUNCTION}"
    head += f"(ptr %arguments, ptr %steps, i64 %packs) {ON_LINES} {for_divisions([graph])} {{\nentry:"
    return "\n".join([head, *code.lines, "ret void", "}", ""])
