"""LLVM IR that recognises a batch's arrays, and finds or allocates those of its results."""

from collections.abc import Sequence
from functools import partial

from cutpoint.kernels.arrays.numpy_api import DATA, RANK, SHAPE, TIDY, WRITEABLE, new_array, owned
from cutpoint.kernels.arrays.plain_arguments import number_or_array, require, require_array
from cutpoint.kernels.arrays.python_api import ITEMS, KIND, LENGTH, new, new_tuple
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import FLOAT64, Precision
from cutpoint.kernels.machine.llvm_code import LINE, Code

_TOGETHER = 2**16
"""Bytes of results that get one stretch of memory.

Of three arrays that are made and freed call after call, glibc gives the memory back to the system each time, and the
faults of fetching it again took four times as long as derivatives of a 6R arm.  Where a line of the cache begins, rows
of results are written in up to 27 % less time than where NumPy lets them begin.
"""


class BatchArrays:
    """Arrays of a batch, by port: start of each, and its stride from element to element, bytes.

    count: of elements; unknown before the first array.  Arrays shared by all elements have stride 0.
    """

    def __init__(self, precision: Precision, ports: Sequence[Port], count: str = "") -> None:
        self._precision, self._ports = precision, ports
        self.count, self.starts, self.steps = count, list[str](), list[str]()

    def require(self, code: Code, objects: Sequence[str], flags: int, *, may_be_shared: bool = False) -> None:
        """Requires every object to be an array of as many elements as the first, or of one, of its port's shape."""
        for x, port in zip(objects, self._ports, strict=True):
            shared = may_be_shared and bool(self.count)
            if shared and not port.shape and self._precision is FLOAT64:
                array = partial(self._array, code, x, port, flags, may_be_shared=False)
                start, step = number_or_array(code, x, ("ptr", "i64"), ["0"], array)
            else:
                start, step = self._array(code, x, port, flags, may_be_shared=shared and bool(port.shape))
            self.starts.append(start)
            self.steps.append(step)

    def _array(self, code: Code, x: str, port: Port, flags: int, *, may_be_shared: bool) -> tuple[str, str]:
        """Its start and its stride."""
        require_array(code, x, self._precision.dtype.name, flags)
        shape, alone = code.field(x, SHAPE), "false"
        axes = code.let(f"sub i32 {code.field(x, RANK, 'i32')}, {len(port.shape)}")
        if may_be_shared:
            alone = code.let(f"icmp eq i32 {axes}, 0")
        require(code, code.let(f"or i1 {alone}, {code.let(f'icmp eq i32 {axes}, 1')}"))
        first, axes = code.load(shape, 0, "i64"), code.let(f"zext i32 {axes} to i64")
        self.count = self.count or first
        own, fits = code.at(shape, axes, "i64"), code.let(f"icmp eq i64 {first}, {self.count}")
        lengths = [code.let(f"icmp eq i64 {code.load(own, k, 'i64')}, {n}") for k, n in enumerate(port.shape)]
        require(code, code.let(f"or i1 {alone}, {fits}"), *lengths)
        return code.field(x, DATA), code.let(f"mul i64 {axes}, {port.size * self._precision.item}")

    def numbers(self, code: Code, k: int, count: str) -> str:
        """How many numbers the k-th array holds for so many elements."""
        one = self._ports[k].size
        alone, all_own = code.let(f"icmp eq i64 {self.steps[k]}, 0"), code.let(f"mul i64 {count}, {one}")
        return code.let(f"select i1 {alone}, i64 {one}, i64 {all_own}")

    def ranges(self, code: Code) -> list[tuple[str, str]]:
        """The start and end addresses of each array."""
        found: list[tuple[str, str]] = []
        for k, start in enumerate(self.starts):
            size = code.let(f"mul i64 {self.numbers(code, k, self.count)}, {self._precision.item}")
            begin = code.let(f"ptrtoint ptr {start} to i64")
            found.append((begin, code.let(f"add i64 {begin}, {size}")))
        return found


def items(code: Code, x: str, count: int) -> list[str]:
    """The objects in a tuple, which must have this length."""
    require(code, code.let(f"icmp eq i64 {code.field(x, LENGTH, 'i64')}, {count}"))
    return [code.field(x, ITEMS + 8 * k) for k in range(count)]


def targets_of(
    code: Code, precision: Precision, outputs: Sequence[Port], sources: BatchArrays, out: str
) -> tuple[list[str], str]:
    """Where results are stored, and what the call returns: new arrays, or those given."""
    fresh, apart, together, take, end = (code.name(x) for x in ("fresh", "apart", "together", "take", "end"))
    code.branch(code.let(f"icmp eq ptr {out}, @none"), fresh, take)
    code.open(fresh)
    sizes = [code.let(f"mul i64 {sources.count}, {port.size * precision.item}") for port in outputs]
    total = "0"
    for size in sizes:
        total = code.let(f"add i64 {total}, {size}")
    code.branch(code.let(f"icmp ult i64 {total}, {_TOGETHER}"), apart, together)
    ways = {
        apart: lambda: _apart(code, precision, outputs, sources.count),
        together: lambda: _together(code, precision, outputs, sources.count, sizes),
        take: lambda: _taken(code, precision, outputs, sources, out),
    }
    found: list[list[str]] = []
    for label, way in ways.items():
        code.open(label)
        starts, answer = way()
        done = code.name("done")
        code.label(done)
        code.lines.append(f"br label {end}")
        found.append([f"[ {x}, {done} ]" for x in (*starts, answer)])
    code.open(end)
    *starts, answer = [code.let(f"phi ptr {', '.join(each)}") for each in zip(*found, strict=True)]
    return starts, answer


def _apart(code: Code, precision: Precision, outputs: Sequence[Port], count: str) -> tuple[list[str], str]:
    """New arrays, allocated by NumPy."""
    owner = new(code, new_tuple(len(outputs))) if len(outputs) > 1 else None
    arrays: list[str] = []
    for k, port in enumerate(outputs):
        shape = _shape(code, (count, *port.shape))
        arrays.append(new(code, new_array(len(port.shape) + 1, shape, precision.dtype.num), owner, k))
    return [code.field(x, DATA) for x in arrays], owner or arrays[0]


def _together(
    code: Code, precision: Precision, outputs: Sequence[Port], count: str, sizes: Sequence[str]
) -> tuple[list[str], str]:
    """New arrays in one allocation, each aligned to a cache line.  sizes: in bytes."""
    offsets = ["0"]
    for size in sizes:
        lines = code.let(f"and i64 {code.let(f'add i64 {size}, {LINE - 1}')}, {-LINE}")
        offsets.append(code.let(f"add i64 {offsets[-1]}, {lines}"))
    *offsets, end = offsets
    numbers = code.let(f"udiv i64 {code.let(f'add i64 {end}, {LINE}')}, {precision.item}")
    owner = new(code, new_tuple(len(outputs))) if len(outputs) > 1 else None
    memory = new(code, new_array(1, _shape(code, (numbers,)), precision.dtype.num), held=owner)
    begin = code.let(f"ptrtoint ptr {code.field(memory, DATA)} to i64")
    skipped = code.let(f"and i64 {code.let(f'sub i64 0, {begin}')}, {LINE - 1}")
    first = code.at(code.field(memory, DATA), skipped, "i8")
    starts, arrays = [code.at(first, offset, "i8") for offset in offsets], list[str]()
    for k, (port, start) in enumerate(zip(outputs, starts, strict=True)):
        made = new_array(len(port.shape) + 1, _shape(code, (count, *port.shape)), precision.dtype.num, start)
        arrays.append(new(code, made, owner, k, held=memory))
        code.lines.append(f"call void @Py_IncRef(ptr {memory})")
        code.let(f"call {owned(arrays[k], memory)}")
    code.lines.append(f"call void @Py_DecRef(ptr {memory})")
    return starts, owner or arrays[0]


def _shape(code: Code, lengths: Sequence[str | int]) -> str:
    """A pointer to the lengths of axes."""
    shape = code.let(f"alloca [{len(lengths)} x i64]")
    for axis, n in enumerate(lengths):
        code.store(str(n), shape, axis, "i64")
    return shape


def _taken(
    code: Code, precision: Precision, outputs: Sequence[Port], sources: BatchArrays, out: str
) -> tuple[list[str], str]:
    """The arrays in `out`: a tuple, or an array if there is one result."""
    if len(outputs) > 1:
        require(code, code.let(f"icmp eq ptr {code.field(out, KIND)}, @tuple_type"))
    arrays = items(code, out, len(outputs)) if len(outputs) > 1 else [out]
    targets = BatchArrays(precision, outputs, sources.count)
    targets.require(code, arrays, TIDY | WRITEABLE)
    others = sources.ranges(code)
    for target in targets.ranges(code):
        for other in others:
            pairs = (target, other), (other, target)
            before, behind = (code.let(f"icmp ule i64 {end}, {begin}") for (_, end), (begin, _) in pairs)
            require(code, code.let(f"or i1 {before}, {behind}"))
        others.append(target)
    code.lines.append(f"call void @Py_IncRef(ptr {out})")
    return targets.starts, out
