"""A kernel as a built-in function of Python, in machine code: for single calls, which then cost little but the work.

It takes what is cheap to recognise: plain arrays of float64, tidy in memory and of exactly the inputs' shapes, and
floats for scalars.  It makes new outputs and runs the kernel's code on their memory.  Anything else - batches, lists,
views, keywords, numbers that are not finite where that matters, mistakes - it hands on as it came to a general
function, which converts, broadcasts and explains.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels import numpy_api, python_api
from cutpoint.kernels.backends import Function
from cutpoint.kernels.jit import Compiled, vector_width
from cutpoint.kernels.llvm_code import Code
from cutpoint.kernels.numpy_api import DATA, DOUBLE, FLAGS, RANK, SHAPE, TIDY, TYPE
from cutpoint.kernels.ports import Port
from cutpoint.kernels.python_api import KIND, VALUE

_FUNCTION = "call"
_OPTIMISATION = 0  # compiles in a third of the time that 2 takes, and was measured to cost 2 ns a call
_OBJECTS = ("array_type", "float64_type", "float64", "float_type", "new_tuple", "general", "record")
_DECLARATIONS = f"""{python_api.DECLARATIONS}declare ptr @PyArray_New(ptr, i32, ptr, i32, ptr, ptr, i32, i32, ptr)
declare ptr @PyArray_Scalar(ptr, ptr, ptr)
"""


class Front(NamedTuple):
    """What stands before a kernel: see `Kernel.shortcut`."""

    general: Callable[..., Any]
    bound: Sequence[np.ndarray] = ()
    finite: bool = False
    record: type[tuple[Any, ...]] | None = None


def is_possible() -> bool:
    """Whether Python's and NumPy's objects are as machine code takes for granted."""
    return python_api.objects_are_as_expected() and numpy_api.arrays_are_as_expected()


def fastcall(function: Function, name: str, inputs: Sequence[Port], outputs: Sequence[Port], front: Front) -> Any:
    """The built-in function around a function's code for one element.

    Raises:
        InputError: a bound array is not what the kernel's code may read.
    """
    given = inputs[: len(inputs) - len(front.bound)]
    for port, x in zip(inputs[len(given) :], front.bound, strict=True):
        if x.shape != port.shape or x.dtype != np.float64 or not (x.flags.c_contiguous and x.flags.aligned):
            raise InputError(f"{name}: what is bound to {port.name} must be a tidy float64 array of shape {port.shape}")
    own = {"element": function.element or 0, "general": id(front.general), "record": id(front.record)}
    symbols = python_api.symbols() | numpy_api.symbols() | own
    symbols |= {f"bound{k}": x.ctypes.data for k, x in enumerate(front.bound)}
    code = Compiled(_ir(given, outputs, front), _FUNCTION, symbols=symbols, optimisation=_OPTIMISATION)
    doc = f"{name}({', '.join(p.name for p in given)})"
    return python_api.builtin(code.address, name, doc, (code, function, front))


def _ir(given: Sequence[Port], outputs: Sequence[Port], front: Front) -> str:
    """The module's text."""
    bound = [f"@bound{k}" for k in range(len(front.bound))]
    shapes = [f"[{len(p.shape)} x i64] [{', '.join(f'i64 {n}' for n in p.shape)}]" for p in outputs]
    constants = [f"@shape{k} = private constant {shape}" for k, shape in enumerate(shapes)]
    externals = [f"@{name} = external global i8" for name in (*_OBJECTS, *(x[1:] for x in bound))]
    pointers = ", ".join(["ptr"] * (len(given) + len(bound) + len(outputs)))
    head = f"define ptr @{_FUNCTION}(ptr %self, ptr %arguments, i64 %count, ptr %names) {{\nentry:"
    code = Code()
    sources = [*_recognised(code, given, finite=front.finite), *bound]
    _answer(code, sources, outputs, recorded=front.record is not None)
    code.open("%general")
    found = code.let("call ptr @PyObject_Vectorcall(ptr @general, ptr %arguments, i64 %count, ptr %names)")
    body = [*code.lines, f"ret ptr {found}", "}", ""]
    return "\n".join([_DECLARATIONS, f"declare void @element({pointers})", *externals, *constants, head, *body])


def _recognised(code: Code, ports: Sequence[Port], *, finite: bool) -> list[str]:
    """Pointers to the arguments' numbers; what is not recognised leaves for `general`."""
    _require(code, code.let(f"icmp eq i64 %count, {len(ports)}"), code.let("icmp eq ptr %names, null"))
    objects = [code.load("%arguments", k, "ptr") for k in range(len(ports))]
    found = [(_array if p.shape else _scalar)(code, x, p) for x, p in zip(objects, ports, strict=True)]
    if finite:
        _require_finite(code, [(pointer, port.size) for pointer, port in zip(found, ports, strict=True)])
    return found


def _array(code: Code, x: str, port: Port) -> str:
    _require(code, code.let(f"icmp eq ptr {_field(code, x, KIND, 'ptr')}, @array_type"))
    tidy = code.let(f"and i32 {_field(code, x, FLAGS, 'i32')}, {TIDY}")
    _require(
        code,
        code.let(f"icmp eq i32 {_field(code, x, RANK, 'i32')}, {len(port.shape)}"),
        code.let(f"icmp eq ptr {_field(code, x, TYPE, 'ptr')}, @float64"),
        code.let(f"icmp eq i32 {tidy}, {TIDY}"),
    )
    if port.shape:
        shape = _field(code, x, SHAPE, "ptr")
        _require(code, *(code.let(f"icmp eq i64 {code.load(shape, k, 'i64')}, {n}") for k, n in enumerate(port.shape)))
    return _field(code, x, DATA, "ptr")


def _scalar(code: Code, x: str, port: Port) -> str:
    """A float, an np.float64, whose value lies where a float's does, or an array without axes."""
    number, other, array, end = (code.name(x) for x in ("number", "other", "array", "end"))
    kind = _field(code, x, KIND, "ptr")
    kinds = [code.let(f"icmp eq ptr {kind}, @{name}") for name in ("float_type", "float64_type")]
    code.branch(code.let(f"or i1 {', '.join(kinds)}"), number, other)
    code.open(other)
    inside = _array(code, x, port)
    code.label(array)
    code.lines.append(f"br label {end}")
    code.open(number)
    value = code.at(x, VALUE, "i8")
    code.label(end)
    return code.let(f"phi ptr [ {inside}, {array} ], [ {value}, {number} ]")


def _require_finite(code: Code, arguments: list[tuple[str, int]]) -> None:
    """x - x is zero unless x is infinite or no number."""
    width, conditions = vector_width(), []
    for pointer, size in arguments:
        if size >= width:
            with code.loop(size // width) as loop:
                block = code.at(pointer, code.let(f"mul i64 {loop.iteration}, {width}"))
                _require(code, _are_finite(code, block, width))
        if size % width:
            conditions.append(_are_finite(code, code.at(pointer, size // width * width), size % width))
    if conditions:
        _require(code, *conditions)


def _are_finite(code: Code, pointer: str, size: int) -> str:
    kind = f"<{size} x double>"
    x = code.load(pointer, 0, kind, align=8)
    odd = code.let(f"fcmp une {kind} {code.let(f'fsub {kind} {x}, {x}')}, zeroinitializer")
    return code.let(f"icmp eq i{size} {code.let(f'bitcast <{size} x i1> {odd} to i{size}')}, 0")


def _answer(code: Code, sources: list[str], outputs: Sequence[Port], *, recorded: bool) -> None:
    """Makes the outputs, fills them and returns them."""
    alone = len(outputs) == 1 and not recorded
    owner = None if alone else _made(code, f"PyTuple_New(i64 {len(outputs)})")
    arrays = [_made(code, _new_array(p, k), owner, k) if p.shape else None for k, p in enumerate(outputs)]
    places = [_field(code, x, DATA, "ptr") if x else code.let("alloca double") for x in arrays]
    code.lines.append(f"call void @element({', '.join(f'ptr {p}' for p in (*sources, *places))})")
    results = [
        x or _made(code, f"PyArray_Scalar(ptr {place}, ptr @float64, ptr null)", owner, k)
        for k, (x, place) in enumerate(zip(arrays, places, strict=True))
    ]
    answer = results[0] if owner is None else _recorded(code, owner) if recorded else owner
    code.lines.append(f"ret ptr {answer}")


def _new_array(port: Port, k: int) -> str:
    shape = f"i32 {len(port.shape)}, ptr @shape{k}, i32 {DOUBLE}"
    return f"PyArray_New(ptr @array_type, {shape}, ptr null, ptr null, i32 0, i32 0, ptr null)"


def _made(code: Code, expression: str, owner: str | None = None, k: int = 0) -> str:
    """A new object, the k-th of its owner if it has one.  If there is no memory for it the call fails."""
    made, failed = code.name("made"), code.name("failed")
    x = code.let(f"call ptr @{expression}")
    code.branch(code.let(f"icmp ne ptr {x}, null"), made, failed)
    code.open(failed)
    if owner:
        code.lines.append(f"call void @Py_DecRef(ptr {owner})")
    code.lines.append("ret ptr null")
    code.open(made)
    if owner:
        code.let(f"call i32 @PyTuple_SetItem(ptr {owner}, i64 {k}, ptr {x})")
    return x


def _recorded(code: Code, plain: str) -> str:
    """What tuple.__new__(record, plain) makes, null if it fails."""
    pair = code.let("alloca [2 x ptr]")
    code.store("@record", pair, 0, "ptr")
    code.store(plain, pair, 1, "ptr")
    x = code.let(f"call ptr @PyObject_Vectorcall(ptr @new_tuple, ptr {pair}, i64 2, ptr null)")
    code.lines.append(f"call void @Py_DecRef(ptr {plain})")
    return x


def _field(code: Code, x: str, offset: int, kind: str) -> str:
    return code.let(f"load {kind}, ptr {code.at(x, offset, 'i8')}")


def _require(code: Code, *conditions: str) -> None:
    """All conditions hold from here on; otherwise `general` takes the call."""
    all_hold, then = conditions[0], code.name("then")
    for condition in conditions[1:]:
        all_hold = code.let(f"and i1 {all_hold}, {condition}")
    code.branch(all_hold, then, "%general")
    code.open(then)
