"""LLVM IR that recognises the arrays of a batch, and finds or makes those for its results."""

from collections.abc import Sequence

from cutpoint.kernels.arrays.numpy_api import DATA, RANK, SHAPE, TIDY, WRITEABLE, new_array
from cutpoint.kernels.arrays.plain_arguments import require, require_array
from cutpoint.kernels.arrays.python_api import ITEMS, KIND, LENGTH, new, new_tuple
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.llvm_code import Code


class BatchArrays:
    """Arrays of a batch, by port: where the numbers of each begin, and its step from element to element, bytes.

    count: of elements; not known before the first array is.  Arrays that all elements share have step 0.
    """

    def __init__(self, precision: Precision, ports: Sequence[Port], count: str = "") -> None:
        self._precision, self._ports = precision, ports
        self.count, self.starts, self.steps = count, list[str](), list[str]()

    def require(self, code: Code, objects: Sequence[str], flags: int, *, may_be_shared: bool = False) -> None:
        """Every object is an array of as many elements as the first, or a single one, of its port's shape."""
        for x, port in zip(objects, self._ports, strict=True):
            require_array(code, x, self._precision.dtype.name, flags)
            shape, rank = code.field(x, SHAPE), len(port.shape)
            axes = code.let(f"sub i32 {code.field(x, RANK, 'i32')}, {rank}")
            alone = "false"
            if may_be_shared and self.count and rank:
                alone = code.let(f"icmp eq i32 {axes}, 0")
            require(code, code.let(f"or i1 {alone}, {code.let(f'icmp eq i32 {axes}, 1')}"))
            first, axes = code.load(shape, 0, "i64"), code.let(f"zext i32 {axes} to i64")
            self.count = self.count or first
            own, fits = code.at(shape, axes, "i64"), code.let(f"icmp eq i64 {first}, {self.count}")
            lengths = [code.let(f"icmp eq i64 {code.load(own, k, 'i64')}, {n}") for k, n in enumerate(port.shape)]
            require(code, code.let(f"or i1 {alone}, {fits}"), *lengths)
            self.starts.append(code.field(x, DATA))
            self.steps.append(code.let(f"mul i64 {axes}, {port.size * self._precision.item}"))

    def numbers(self, code: Code, k: int, count: str) -> str:
        """How many the k-th array holds for so many elements."""
        one = self._ports[k].size
        alone, all_own = code.let(f"icmp eq i64 {self.steps[k]}, 0"), code.let(f"mul i64 {count}, {one}")
        return code.let(f"select i1 {alone}, i64 {one}, i64 {all_own}")

    def ranges(self, code: Code) -> list[tuple[str, str]]:
        """The addresses where each array begins and ends."""
        found: list[tuple[str, str]] = []
        for k, start in enumerate(self.starts):
            size = code.let(f"mul i64 {self.numbers(code, k, self.count)}, {self._precision.item}")
            begin = code.let(f"ptrtoint ptr {start} to i64")
            found.append((begin, code.let(f"add i64 {begin}, {size}")))
        return found


def items(code: Code, x: str, count: int) -> list[str]:
    """The objects in a tuple, which must be so many."""
    require(code, code.let(f"icmp eq i64 {code.field(x, LENGTH, 'i64')}, {count}"))
    return [code.field(x, ITEMS + 8 * k) for k in range(count)]


def targets_of(
    code: Code, precision: Precision, outputs: Sequence[Port], sources: BatchArrays, out: str
) -> tuple[list[str], str]:
    """Where the results go, and what the call returns: new arrays, or those that were given."""
    make, made, take, taken, end = (code.name(x) for x in ("make", "made", "take", "taken", "end"))
    code.branch(code.let(f"icmp eq ptr {out}, @none"), make, take)
    code.open(make)
    fresh, new_answer = _made(code, precision, outputs, sources.count)
    code.label(made)
    code.lines.append(f"br label {end}")
    code.open(take)
    found, own_answer = _taken(code, precision, outputs, sources, out)
    code.label(taken)
    code.label(end)
    pairs = zip((*fresh, new_answer), (*found, own_answer), strict=True)
    *starts, answer = [code.let(f"phi ptr [ {x}, {made} ], [ {y}, {taken} ]") for x, y in pairs]
    return starts, answer


def _made(code: Code, precision: Precision, outputs: Sequence[Port], count: str) -> tuple[list[str], str]:
    owner = new(code, new_tuple(len(outputs))) if len(outputs) > 1 else None
    arrays: list[str] = []
    for k, port in enumerate(outputs):
        shape = code.let(f"alloca [{len(port.shape) + 1} x i64]")
        for axis, n in enumerate((count, *port.shape)):
            code.store(str(n), shape, axis, "i64")
        arrays.append(new(code, new_array(len(port.shape) + 1, shape, precision.dtype.num), owner, k))
    return [code.field(x, DATA) for x in arrays], owner or arrays[0]


def _taken(
    code: Code, precision: Precision, outputs: Sequence[Port], sources: BatchArrays, out: str
) -> tuple[list[str], str]:
    """What is in `out`: a tuple, or an array where there is one result."""
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
