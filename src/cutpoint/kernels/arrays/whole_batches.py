"""Batches given whole: one axis of elements in every array, tidy in memory, no result sharing memory with anything.

NumPy's machinery takes a microsecond or two to find that there is nothing to broadcast, to cast or to copy.  Machine
code finds it in some fifty nanoseconds, and then runs the same loop.
"""

from collections.abc import Sequence
from typing import Any

from cutpoint.kernels.arrays import new_objects, numpy_api, python_api
from cutpoint.kernels.arrays.backends import Whole
from cutpoint.kernels.arrays.new_objects import new, new_array, new_tuple
from cutpoint.kernels.arrays.numpy_api import DATA, TIDY, WRITEABLE
from cutpoint.kernels.arrays.plain_arguments import ELSEWHERE, is_possible, require, shape_of
from cutpoint.kernels.arrays.python_api import ITEMS, KIND, LENGTH
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.jit import Compiled
from cutpoint.kernels.machine.lane_memory import row_lengths
from cutpoint.kernels.machine.llvm_code import Code

_FUNCTION = "whole"
_OPTIMISATION = 0  # compiles soonest; what it costs a call is not to be seen beside a batch


def whole_batches(
    loop: tuple[int, int | None], precision: Precision, inputs: Sequence[Port], outputs: Sequence[Port], owner: Any
) -> Whole | None:
    """The built-in function around a loop; None where Python or NumPy is not as machine code takes for granted.

    loop: addresses of the code and of what it finds behind its data pointer; owner: of both.
    """
    if not is_possible():
        return None
    symbols = python_api.symbols() | numpy_api.symbols() | {"loop": loop[0], "data": loop[1] or id(None)}
    code = Compiled(_ir(precision, inputs, outputs), _FUNCTION, symbols=symbols, optimisation=_OPTIMISATION)
    return python_api.builtin(code.address, _FUNCTION, "whole(arguments, out)", (code, owner))


class _Batch:
    """Arrays of a batch whose length is known: their ports, and where the numbers of each begin."""

    def __init__(self, precision: Precision, ports: Sequence[Port], count: str = "") -> None:
        self._precision, self._ports = precision, ports
        self.count, self.starts = count, list[str]()

    def require(self, code: Code, objects: Sequence[str], flags: int) -> None:
        """Every object is an array of the length of the first, of its port's shape, with these flags."""
        for x, port in zip(objects, self._ports, strict=True):
            shape = shape_of(code, x, len(port.shape) + 1, self._precision.dtype.name, flags)
            lengths = [code.load(shape, axis, "i64") for axis in range(len(port.shape) + 1)]
            self.count = self.count or lengths[0]
            pairs = zip(lengths, (self.count, *port.shape), strict=True)
            require(code, *(code.let(f"icmp eq i64 {found}, {wanted}") for found, wanted in pairs))
            self.starts.append(code.field(x, DATA))

    def ranges(self, code: Code) -> list[tuple[str, str]]:
        """The addresses where each array begins and ends."""
        begins = [code.let(f"ptrtoint ptr {start} to i64") for start in self.starts]
        sizes = [code.let(f"mul i64 {self.count}, {port.size * self._precision.item}") for port in self._ports]
        return [(x, code.let(f"add i64 {x}, {size}")) for x, size in zip(begins, sizes, strict=True)]


def _ir(precision: Precision, inputs: Sequence[Port], outputs: Sequence[Port]) -> str:
    """Text of the function that is given a tuple of arguments and `out`."""
    code, ports = Code(), (*inputs, *outputs)
    given, out = (code.load("%arguments", k, "ptr") for k in range(2))
    sources = _Batch(precision, inputs)
    sources.require(code, _items(code, given, len(inputs)), TIDY)
    targets, answer = _targets(code, precision, outputs, sources, out)
    places = code.let(f"alloca [{len(ports)} x ptr]")
    for k, start in enumerate((*sources.starts, *targets)):
        code.store(start, places, k, "ptr")
    dimensions = code.let("alloca i64")
    code.store(sources.count, dimensions, 0, "i64")
    # other threads of Python's run meanwhile
    thread = code.let("call ptr @PyEval_SaveThread()")
    code.lines.append(f"call void @loop(ptr {places}, ptr {dimensions}, ptr @steps, ptr @data)")
    code.lines.append(f"call void @PyEval_RestoreThread(ptr {thread})")
    code.lines.append(f"ret ptr {answer}")
    code.open(ELSEWHERE)
    code.lines += ["call void @Py_IncRef(ptr @none)", "ret ptr @none"]
    steps = [precision.item * port.size for port in ports]
    steps += [precision.item * n for port in ports for n in row_lengths(port.shape)]
    constant = f"@steps = private constant [{len(steps)} x i64] [{', '.join(f'i64 {n}' for n in steps)}]"
    objects = ("array_type", "tuple_type", "none", precision.dtype.name, "data")
    externals = [f"@{name} = external global i8" for name in objects]
    declarations = [python_api.DECLARATIONS, new_objects.DECLARATIONS, "declare void @loop(ptr, ptr, ptr, ptr)"]
    head = f"define ptr @{_FUNCTION}(ptr %self, ptr %arguments, i64 %count, ptr %names) {{\nentry:"
    return "\n".join([*declarations, *externals, constant, head, *code.lines, "}", ""])


def _items(code: Code, x: str, count: int) -> list[str]:
    """The objects in a tuple, which must be so many."""
    require(code, code.let(f"icmp eq i64 {code.field(x, LENGTH, 'i64')}, {count}"))
    return [code.field(x, ITEMS + 8 * k) for k in range(count)]


def _targets(
    code: Code, precision: Precision, outputs: Sequence[Port], sources: _Batch, out: str
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
    code: Code, precision: Precision, outputs: Sequence[Port], sources: _Batch, out: str
) -> tuple[list[str], str]:
    """What is in `out`: a tuple, or an array where there is one result."""
    if len(outputs) > 1:
        require(code, code.let(f"icmp eq ptr {code.field(out, KIND)}, @tuple_type"))
    arrays = _items(code, out, len(outputs)) if len(outputs) > 1 else [out]
    targets = _Batch(precision, outputs, sources.count)
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
