"""A kernel as a built-in function of Python, in machine code: single calls with hardly any overhead.

It takes what is cheap to recognise: plain float64 arrays, contiguous and of exactly the inputs' shapes, and floats for
scalars.  It allocates outputs and runs the kernel's code on their memory.  Anything else - batches, lists, views,
keywords, numbers that are too large or NaN where that matters, mistakes - it passes on unchanged to a general function,
which converts, broadcasts and explains.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from cutpoint.kernels.arrays import numpy_api, python_api
from cutpoint.kernels.arrays.function import Element
from cutpoint.kernels.arrays.numpy_api import DATA, DOUBLE, new_array, new_scalar
from cutpoint.kernels.arrays.plain_arguments import ELSEWHERE, check_bound, recognised
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.machine.jit import OPTIMISATION, Compiled
from cutpoint.kernels.machine.llvm_code import Code

_FUNCTION = "call"
_OPTIMISATION = 0  # compiles in a third of the time of 2, and was measured to cost 2 ns a call
_MANY = 64
"""Numbers whose checks, a loop then, are worth the usual optimisation: 60 ns of an inverse dynamics of 192 joints."""
_OBJECTS = ("array_type", "float64_type", "float64", "float_type", "new_tuple", "general", "record")


class Front(NamedTuple):
    """Options of a kernel's built-in function: see `Kernel.shortcut`."""

    general: Callable[..., Any]
    bound: Sequence[np.ndarray] = ()
    largest: float | None = None
    record: type[tuple[Any, ...]] | None = None


def fastcall(function: Element, name: str, inputs: Sequence[Port], outputs: Sequence[Port], front: Front) -> Any:
    """The built-in function around a function's code for one element.

    Raises:
        InputError: the kernel's code cannot read a bound array.
    """
    given = inputs[: len(inputs) - len(front.bound)]
    check_bound(name, inputs, front.bound)
    own = {"element": function.element or 0, "general": id(front.general), "record": id(front.record)}
    symbols = python_api.symbols() | numpy_api.symbols() | own
    symbols |= {f"bound{k}": x.ctypes.data for k, x in enumerate(front.bound)}
    optimisation = _OPTIMISATION if sum(port.size for port in given) <= _MANY else OPTIMISATION
    code = Compiled(_ir(given, outputs, front), _FUNCTION, symbols=symbols, optimisation=optimisation)
    doc = f"{name}({', '.join(p.name for p in given)})"
    return python_api.builtin(code.address, name, doc, (code, function, front))


def _ir(given: Sequence[Port], outputs: Sequence[Port], front: Front) -> str:
    """The module's text."""
    bound = [f"@bound{k}" for k in range(len(front.bound))]
    shapes = [f"[{len(p.shape)} x i64] [{', '.join(f'i64 {n}' for n in p.shape)}]" for p in outputs]
    constants = [f"@shape{k} = private constant {shape}" for k, shape in enumerate(shapes)]
    externals = [f"@{name} = external global i8" for name in (*_OBJECTS, *(x[1:] for x in bound))]
    head = f"define ptr @{_FUNCTION}(ptr %self, ptr %arguments, i64 %count, ptr %names) {{\nentry:"
    code = Code()
    found = [x for x, port in zip(recognised(code, given, front.largest), given, strict=True) if port.size]
    sources = [*found, *bound]
    _answer(code, sources, outputs, recorded=front.record is not None)
    pointers = ", ".join(["ptr"] * (len(sources) + sum(port.size > 0 for port in outputs)))
    code.open(ELSEWHERE)
    found = code.let("call ptr @PyObject_Vectorcall(ptr @general, ptr %arguments, i64 %count, ptr %names)")
    body = [*code.lines, f"ret ptr {found}", "}", ""]
    declarations = [python_api.DECLARATIONS, numpy_api.DECLARATIONS, f"declare void @element({pointers})"]
    return "\n".join([*declarations, *externals, *constants, head, *body])


def _answer(code: Code, sources: list[str], outputs: Sequence[Port], *, recorded: bool) -> None:
    """Allocates the outputs, fills them and returns them."""
    alone = len(outputs) == 1 and not recorded
    owner = None if alone else python_api.new(code, python_api.new_tuple(len(outputs)))
    kinds = [new_array(len(p.shape), f"@shape{k}", DOUBLE) for k, p in enumerate(outputs)]
    arrays = [python_api.new(code, kinds[k], owner, k) if p.shape else None for k, p in enumerate(outputs)]
    places = [code.field(x, DATA) if x else code.let("alloca double") for x in arrays]
    filled = [place for place, port in zip(places, outputs, strict=True) if port.size]
    code.lines.append(f"call void @element({', '.join(f'ptr {p}' for p in (*sources, *filled))})")
    results = [
        x or python_api.new(code, new_scalar(place), owner, k)
        for k, (x, place) in enumerate(zip(arrays, places, strict=True))
    ]
    answer = results[0] if owner is None else _recorded(code, owner) if recorded else owner
    code.lines.append(f"ret ptr {answer}")


def _recorded(code: Code, plain: str) -> str:
    """The result of tuple.__new__(record, plain), null if it fails."""
    pair = code.let("alloca [2 x ptr]")
    code.store("@record", pair, 0, "ptr")
    code.store(plain, pair, 1, "ptr")
    x = code.let(f"call ptr @PyObject_Vectorcall(ptr @new_tuple, ptr {pair}, i64 2, ptr null)")
    code.lines.append(f"call void @Py_DecRef(ptr {plain})")
    return x
