"""LLVM IR that gathers numbers of arrays with any strides into lanes in scratch memory, and scatters them back."""

from collections.abc import Callable

from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.machine.llvm import Lanes
from cutpoint.kernels.machine.llvm_code import Code
from cutpoint.kernels.machine.transposition import blocks, lanes_of_rows, lanes_to_rows


class LaneMemory:
    """One port's array, with any strides, and its lanes in scratch memory.

    Three paths between them: elements adjacent in memory already form lanes; C-contiguous elements are rows that are
    transposed; everything else, and the end of a batch, goes number by number.
    """

    def __init__(self, code: Code, lanes: Lanes, port: Port, number: int, first_stride: int) -> None:
        self._lanes, self._port = lanes, port
        self.scratch = code.let(f"alloca {lanes.real}, i64 {port.size}")
        self._offsets = code.let(f"alloca i64, i64 {port.size}")
        self._start = code.load("%arguments", number, "ptr")
        self._step = code.load("%steps", number, "i64")
        self._strides = [code.load("%steps", first_stride + axis, "i64") for axis in range(len(port.shape))]
        self._beside = code.let(f"icmp eq i64 {self._step}, {lanes.item}")
        self._tidy = "true"
        for stride, n, length in zip(self._strides, row_lengths(port.shape), port.shape, strict=True):
            if length == 1:  # NumPy gives 0
                continue
            self._tidy = code.let(f"and i1 {self._tidy}, {code.let(f'icmp eq i64 {stride}, {lanes.item * n}')}")

    def prepare(self, code: Code) -> None:
        """Once before the batch: the byte offset of each number from its element's first."""
        with code.loop(self._port.size) as loop:
            offset = "0"
            for n, length, stride in zip(row_lengths(self._port.shape), self._port.shape, self._strides, strict=True):
                index = code.let(f"urem i64 {code.let(f'udiv i64 {loop.iteration}, {n}')}, {length}")
                offset = code.let(f"add i64 {offset}, {code.let(f'mul i64 {index}, {stride}')}")
            code.store(offset, self._offsets, loop.iteration, "i64")

    def fetch(self, code: Code, first: str, count: str) -> None:
        """Gathers a pack into lanes, from its first element on; numbers shared by the whole batch are fetched once."""
        fetch, end = code.name("fetch"), code.name("fetched")
        begins, moves = code.let(f"icmp eq i64 {first}, 0"), code.let(f"icmp ne i64 {self._step}, 0")
        code.branch(code.let(f"or i1 {begins}, {moves}"), fetch, end)
        code.open(fetch)
        self._by_the_best_way(code, first, count, self._fetch_beside, self._fetch_rows, self._fetch_numbers)
        code.label(end)

    def deliver(self, code: Code, first: str, count: str) -> None:
        """Scatters lanes to the array."""
        self._by_the_best_way(code, first, count, self._deliver_beside, self._deliver_rows, self._deliver_numbers)

    def _by_the_best_way(self, code: Code, first: str, count: str, *ways: Callable[[Code, list[str]], None]) -> None:
        beside, rows, numbers, whole, end = (code.name(x) for x in ("beside", "rows", "numbers", "whole", "end"))
        behind = code.let(f"add i64 {first}, {self._lanes.width}")
        elements = self._elements(code, first, count)
        code.branch(code.let(f"icmp sle i64 {behind}, {count}"), whole, numbers)
        code.open(whole)
        not_beside = code.name("notbeside")
        code.branch(self._beside, beside, not_beside)
        code.open(not_beside)
        code.branch(self._tidy, rows, numbers)
        for label, way in zip((beside, rows, numbers), ways, strict=True):
            code.open(label)
            way(code, elements)
            code.lines.append(f"br label {end}")
        code.open(end)

    def _elements(self, code: Code, first: str, count: str) -> list[str]:
        """Pointers to a pack's elements; past the end of the batch its last one is repeated."""
        last, found = code.let(f"sub i64 {count}, 1"), []
        for lane in range(self._lanes.width):
            index = code.let(f"add i64 {first}, {lane}")
            inside = code.let(f"icmp slt i64 {index}, {last}")
            index = code.let(f"select i1 {inside}, i64 {index}, i64 {last}")
            found.append(code.at(self._start, code.let(f"mul i64 {self._step}, {index}"), "i8"))
        return found

    def _number(self, code: Code, element: str, k: str) -> str:
        return code.at(element, code.load(self._offsets, k, "i64"), "i8")

    def _fetch_beside(self, code: Code, elements: list[str]) -> None:
        with code.loop(self._port.size) as loop:
            place = self._number(code, elements[0], loop.iteration)
            vector = code.load(place, 0, self._lanes.real, align=self._lanes.item)
            code.store(vector, self.scratch, loop.iteration, self._lanes.real)

    def _deliver_beside(self, code: Code, elements: list[str]) -> None:
        with code.loop(self._port.size) as loop:
            vector = code.load(self.scratch, loop.iteration, self._lanes.real)
            place = self._number(code, elements[0], loop.iteration)
            code.store(vector, place, 0, self._lanes.real, align=self._lanes.item)

    def _fetch_rows(self, code: Code, elements: list[str]) -> None:
        for column, size in blocks(self._port.size, self._lanes.width, self._lanes.item):
            for k, vector in enumerate(lanes_of_rows(code, self._lanes.precision, elements, column, size)):
                code.store(vector, self.scratch, column + k, self._lanes.real)

    def _deliver_rows(self, code: Code, elements: list[str]) -> None:
        for column, size in blocks(self._port.size, self._lanes.width, self._lanes.item):
            vectors = [code.load(self.scratch, column + k, self._lanes.real) for k in range(size)]
            lanes_to_rows(code, self._lanes.precision, vectors, elements, column)

    def _fetch_numbers(self, code: Code, elements: list[str]) -> None:
        with code.loop(self._port.size) as loop:
            numbers = [code.load(self._number(code, x, loop.iteration), 0, self._lanes.one) for x in elements]
            code.store(self._lanes.joined(code, numbers), self.scratch, loop.iteration, self._lanes.real)

    def _deliver_numbers(self, code: Code, elements: list[str]) -> None:
        with code.loop(self._port.size) as loop:
            vector = code.load(self.scratch, loop.iteration, self._lanes.real)
            for lane, element in enumerate(elements):
                number = self._lanes.one_of(code, vector, lane)
                code.store(number, self._number(code, element, loop.iteration), 0, self._lanes.one)


def row_lengths(shape: tuple[int, ...]) -> list[int]:
    """Strides, in numbers, of a C-contiguous array."""
    lengths = [1]
    for n in reversed(shape[1:]):
        lengths.insert(0, n * lengths[0])
    return lengths[: len(shape)]
