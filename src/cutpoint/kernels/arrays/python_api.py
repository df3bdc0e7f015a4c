"""Python's C API, as far as machine code called as a built-in function needs it, and the creation of one."""

import ctypes
import sys
import sysconfig
from collections.abc import Callable
from functools import cache
from typing import Any

from cutpoint.kernels.machine.llvm_code import Code

_HEADER = object.__basicsize__
KIND, VALUE, LENGTH, ITEMS = _HEADER - 8, _HEADER, _HEADER, tuple.__basicsize__
"""Where any object's type is, a float's value, and a tuple's length and items, in bytes."""

_NEW_TUPLE = tuple.__new__
_FASTCALL_WITH_KEYWORDS = 0x0080 | 0x0002
_FUNCTIONS = (
    "PyObject_Vectorcall", "PyTuple_New", "PyTuple_SetItem", "Py_IncRef", "Py_DecRef",
    "PyEval_SaveThread", "PyEval_RestoreThread",
)  # fmt: skip

DECLARATIONS = """declare ptr @PyObject_Vectorcall(ptr, ptr, i64, ptr)
declare ptr @PyTuple_New(i64)
declare i32 @PyTuple_SetItem(ptr, i64, ptr)
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare ptr @PyEval_SaveThread()
declare void @PyEval_RestoreThread(ptr)
"""


def new(code: Code, expression: str, owner: str | None = None, k: int = 0, held: str | None = None) -> str:
    """The new object that a C API call returns; the k-th item of its owner, a tuple, if it has one.

    If out of memory the function fails, and releases all that it holds.
    """
    made, failed = code.name("made"), code.name("failed")
    x = code.let(f"call ptr @{expression}")
    code.branch(code.let(f"icmp ne ptr {x}, null"), made, failed)
    code.open(failed)
    code.lines += [f"call void @Py_DecRef(ptr {x})" for x in (owner, held) if x]
    code.lines.append("ret ptr null")
    code.open(made)
    if owner:
        code.let(f"call i32 @PyTuple_SetItem(ptr {owner}, i64 {k}, ptr {x})")
    return x


def new_tuple(size: int) -> str:
    """The call that creates a tuple, to be filled."""
    return f"PyTuple_New(i64 {size})"


@cache
def objects_are_as_expected() -> bool:
    """Whether this Python's objects have the layout that machine code assumes, and there is a GIL."""
    one_at_a_time = sys.implementation.name == "cpython" and not sysconfig.get_config_var("Py_GIL_DISABLED")
    if not one_at_a_time or ctypes.sizeof(ctypes.c_void_p) != 8 or float.__basicsize__ != VALUE + 8:
        return False
    kinds = all(ctypes.c_void_p.from_address(id(x) + KIND).value == id(type(x)) for x in (1.5, "", [], print, int))
    numbers = all(ctypes.c_double.from_address(id(x) + VALUE).value == x for x in (1.5, -0.1))
    several = (1.5, "", [])
    items = (ctypes.c_void_p * 3).from_address(id(several) + ITEMS)
    tuples = ctypes.c_ssize_t.from_address(id(several) + LENGTH).value == 3 and [*items] == [*map(id, several)]
    return kinds and numbers and tuples


@cache
def symbols() -> dict[str, int]:
    """Addresses, by their names in machine code."""
    functions = {name: ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value or 0 for name in _FUNCTIONS}
    return functions | {"float_type": id(float), "new_tuple": id(_NEW_TUPLE), "none": id(None), "tuple_type": id(tuple)}


def builtin(address: int, name: str, doc: str, owner: Any) -> Callable[..., Any]:
    """The machine code at an address, PyObject *(PyObject *, PyObject **, Py_ssize_t, PyObject *), as a function.

    owner: an object that must live as long as the function.
    """
    definition = _Definition(name.encode(), address, _FASTCALL_WITH_KEYWORDS, doc.encode())
    make, pointer = ctypes.pythonapi.PyCMethod_New, ctypes.c_void_p
    make.restype, make.argtypes = ctypes.py_object, [pointer, ctypes.py_object, pointer, pointer]
    return make(ctypes.addressof(definition), (owner, definition), None, None)


class _Definition(ctypes.Structure):
    """PyMethodDef."""

    _fields_ = (
        ("name", ctypes.c_char_p), ("function", ctypes.c_void_p), ("flags", ctypes.c_int), ("doc", ctypes.c_char_p),
    )  # fmt: skip
