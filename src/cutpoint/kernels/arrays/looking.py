"""A Python function guarded by a check of some of its arguments' numbers, in machine code: nanoseconds a call."""

from collections.abc import Callable, Sequence
from typing import Any

from cutpoint.kernels.arrays import numpy_api, python_api
from cutpoint.kernels.arrays.numpy_api import DATA, RANK, SHAPE, TIDY
from cutpoint.kernels.arrays.plain_arguments import ELSEWHERE, is_possible, require, require_array
from cutpoint.kernels.machine.jit import Compiled
from cutpoint.kernels.machine.llvm_code import Code, literal

_FUNCTION = "look"
_OPTIMISATION = 0


def looking(
    function: Callable[..., Any],
    otherwise: Callable[..., Any],
    name: str,
    arguments: Sequence[int],
    entries: Sequence[int],
    size: int,
    smallest: float,
) -> Callable[..., Any]:
    """Calls the function if all numbers checked are larger than `smallest`, else `otherwise`.

    arguments, entries: which entries of which arguments; these are plain vectors of that size, or rows of them.  Any
    others go to `otherwise`, as do all calls where the layout of Python's or NumPy's objects is not as expected.
    """
    if not is_possible():
        return otherwise
    symbols = python_api.symbols() | numpy_api.symbols() | {"function": id(function), "general": id(otherwise)}
    code = Compiled(_ir(arguments, entries, size, smallest), _FUNCTION, symbols=symbols, optimisation=_OPTIMISATION)
    doc = getattr(function, "__doc__", None) or name
    return python_api.builtin(code.address, name, doc, (code, function, otherwise))


def _ir(arguments: Sequence[int], entries: Sequence[int], size: int, smallest: float) -> str:
    """The module's text."""
    code = Code()
    enough = code.let(f"icmp sgt i64 %count, {max(arguments)}")
    require(code, enough, code.let("icmp eq ptr %names, null"))
    for argument in arguments:
        first, count = _rows(code, code.load("%arguments", argument, "ptr"), size)
        with code.loop(count) as loop:
            numbers = code.at(first, code.let(f"mul i64 {loop.iteration}, {size}"))
            for entry in entries:
                x = code.load(numbers, entry)
                above = code.let(f"fcmp ogt double {x}, {literal(smallest)}")
                below = code.let(f"fcmp olt double {x}, {literal(-smallest)}")
                require(code, code.let(f"or i1 {above}, {below}"))
    for name in ("function", "general"):
        if name == "general":
            code.open(ELSEWHERE)
        found = code.let(f"call ptr @PyObject_Vectorcall(ptr @{name}, ptr %arguments, i64 %count, ptr %names)")
        code.lines.append(f"ret ptr {found}")
    externals = [f"@{name} = external global i8" for name in ("array_type", "float64", "function", "general")]
    head = f"define ptr @{_FUNCTION}(ptr %self, ptr %arguments, i64 %count, ptr %names) {{\nentry:"
    return "\n".join([python_api.DECLARATIONS, *externals, head, *code.lines, "}", ""])


def _rows(code: Code, x: str, size: int) -> tuple[str, str]:
    """Pointer to an object's numbers, and how many rows of that size they form, if it is a contiguous array of such."""
    require_array(code, x, "float64", TIDY)
    axes = code.let(f"sub i32 {code.field(x, RANK, 'i32')}, 1")
    is_batch = code.let(f"icmp eq i32 {axes}, 1")
    require(code, code.let(f"icmp ult i32 {axes}, 2"))
    shape = code.field(x, SHAPE)
    own = code.load(shape, code.let(f"zext i32 {axes} to i64"), "i64")
    require(code, code.let(f"icmp eq i64 {own}, {size}"))
    return code.field(x, DATA), code.let(f"select i1 {is_batch}, i64 {code.load(shape, 0, 'i64')}, i64 1")
