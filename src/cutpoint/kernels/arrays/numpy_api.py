"""NumPy's C API and the layout of its arrays: everything that the package assumes about them is in this file.

Indices in NumPy's function tables are fixed by its ABI.  The fields of an array have kept their order since
NumPy 1.7; machine code reads them only where `arrays_are_as_expected`.
"""

import ctypes
from collections.abc import Callable, Sequence
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from cutpoint.kernels.graphs.ports import Port

DOUBLE = 12
"""The number of float64 among NumPy's types."""

MOST_OPERANDS = 64 if hasattr(np, "_core") else 32
"""Of a ufunc, inputs and outputs together: in NumPy 2, and in 1.26."""

_HEADER = object.__basicsize__
DATA, RANK, SHAPE, TYPE, FLAGS = _HEADER, _HEADER + 8, _HEADER + 16, _HEADER + 40, _HEADER + 48
"""Where an array's fields are, in bytes: void *data, int nd, npy_intp *dimensions, PyArray_Descr *descr, int flags."""

TIDY = 0x0001 | 0x0100
"""The flags of an array that is C-contiguous and aligned."""

WRITEABLE = 0x0400
"""The flag of one that may be written to."""

DECLARATIONS = """declare ptr @PyArray_New(ptr, i32, ptr, i32, ptr, ptr, i32, i32, ptr)
declare ptr @PyArray_Scalar(ptr, ptr, ptr)
declare i32 @PyArray_SetBaseObject(ptr, ptr)
"""

_VERSIONS = (0x01000009, 0x02000000)
"""Of the ABI: NumPy 1 and NumPy 2."""
_GET_VERSION, _SCALAR, _NEW, _SET_BASE = 0, 60, 93, 282
_FROM_FUNC_AND_DATA_AND_SIGNATURE = 31
_NO_IDENTITY = -1


def new_gufunc(
    loop: int, data: int | None, dtype: np.dtype[Any], inputs: Sequence[Port], outputs: Sequence[Port], name: str
) -> tuple[Callable[..., Any], Any]:
    """A generalised ufunc around a loop in machine code, and the tables that it points to, which must outlive it.

    loop, data: addresses of the loop and of the data that NumPy passes to it.  dtype: of all arrays.
    """
    pointer, text, number = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int
    prototype = ctypes.PYFUNCTYPE(
        ctypes.py_object, pointer, pointer, text, number, number, number, number, text, text, number, text
    )
    make = prototype(_table("umath", "_UFUNC_API")[_FROM_FUNC_AND_DATA_AND_SIGNATURE])
    types, signature = bytes([dtype.num] * (len(inputs) + len(outputs))), _signature(inputs, outputs).encode()
    tables = (pointer * 1)(loop), (pointer * 1)(data), types
    named = name.encode()
    made = make(*tables, 1, len(inputs), len(outputs), _NO_IDENTITY, named, b"", 0, signature)
    return made, (*tables, named, signature)


def _signature(inputs: Sequence[Port], outputs: Sequence[Port]) -> str:
    """NumPy's gufunc signature, with all core dimensions frozen: (6),(3,4)->()."""
    left, right = (",".join(f"({','.join(map(str, p.shape))})" for p in ports) for ports in (inputs, outputs))
    return f"{left}->{right}"


def new_array(rank: int, shape: str, kind: int, memory: str | None = None) -> str:
    """The call that creates an array.  shape: a pointer to the lengths of its axes; kind: its type number.

    memory: address of its data, if another object owns it: see `owned`.
    """
    given = f"ptr {memory}, i32 0, i32 {TIDY | WRITEABLE}" if memory else "ptr null, i32 0, i32 0"
    return f"PyArray_New(ptr @array_type, i32 {rank}, ptr {shape}, i32 {kind}, ptr null, {given}, ptr null)"


def owned(array: str, owner: str) -> str:
    """The call that makes an object, whose reference it steals, the owner of an array's data."""
    return f"i32 @PyArray_SetBaseObject(ptr {array}, ptr {owner})"


def new_scalar(place: str) -> str:
    """The call that creates an np.float64 from the number at an address."""
    return f"PyArray_Scalar(ptr {place}, ptr @float64, ptr null)"


@cache
def symbols() -> dict[str, int]:
    """Addresses, by their names in machine code."""
    table = _table("multiarray", "_ARRAY_API")
    dtypes = {name: np.dtype(name) for name in ("float64", "float32")}
    objects = {"array_type": np.ndarray, "float64_type": np.float64} | dtypes
    functions = {"PyArray_New": _NEW, "PyArray_Scalar": _SCALAR, "PyArray_SetBaseObject": _SET_BASE}
    return {name: table[place] for name, place in functions.items()} | {k: id(x) for k, x in objects.items()}


@cache
def arrays_are_as_expected() -> bool:
    """Whether this NumPy's arrays have the layout, and are created in the way, that machine code assumes."""
    if ctypes.sizeof(ctypes.c_void_p) != 8 or np.ndarray.__basicsize__ < FLAGS + 4:
        return False
    version = ctypes.CFUNCTYPE(ctypes.c_uint)(_table("multiarray", "_ARRAY_API")[_GET_VERSION])()
    return version in _VERSIONS and all(map(_lies_as_expected, _specimens())) and _new_ones_are_right()


def _specimens() -> list[np.ndarray]:
    """Arrays that differ in every field."""
    fixed = np.arange(30.0).reshape(5, 6)
    fixed.flags.writeable = False
    odd = np.frombuffer(bytes(41), np.uint8)[1:].view(np.float64)
    return [np.array(1.5), np.zeros(7), fixed, fixed[1:, ::2], fixed.T, odd, np.zeros((2, 3, 4), np.float32),
            np.zeros(3, ">f8"), np.zeros(3, "<f8")]  # fmt: skip


def _lies_as_expected(a: np.ndarray) -> bool:
    def read(offset: int, kind: Any) -> Any:
        return kind.from_address(id(a) + offset).value

    flags = 0x0001 * a.flags.c_contiguous | 0x0100 * a.flags.aligned | 0x0400 * a.flags.writeable
    if (read(DATA, ctypes.c_void_p), read(RANK, ctypes.c_int)) != (a.ctypes.data, a.ndim):
        return False
    if (read(TYPE, ctypes.c_void_p), read(FLAGS, ctypes.c_int) & (TIDY | WRITEABLE)) != (id(a.dtype), flags):
        return False
    return not a.ndim or tuple((ctypes.c_int64 * a.ndim).from_address(read(SHAPE, ctypes.c_void_p))) == a.shape


def _new_ones_are_right() -> bool:
    pointer, number, thing, at = ctypes.c_void_p, ctypes.c_int, ctypes.py_object, symbols()
    new = ctypes.PYFUNCTYPE(thing, pointer, number, pointer, number, pointer, pointer, number, number, pointer)
    shape = (ctypes.c_int64 * 2)(2, 3)
    array = new(at["PyArray_New"])(at["array_type"], 2, ctypes.addressof(shape), DOUBLE, None, None, 0, 0, None)
    value = ctypes.c_double(1.5)
    scalar = ctypes.PYFUNCTYPE(thing, pointer, pointer, pointer)(at["PyArray_Scalar"])
    float64 = scalar(ctypes.addressof(value), at["float64"], None)
    memory = np.zeros(8)
    place, flags = memory[1:].ctypes.data, TIDY | WRITEABLE
    view = new(at["PyArray_New"])(at["array_type"], 2, ctypes.addressof(shape), DOUBLE, None, place, 0, flags, None)
    ctypes.pythonapi.Py_IncRef(thing(memory))
    ctypes.PYFUNCTYPE(number, thing, thing)(at["PyArray_SetBaseObject"])(view, memory)
    view[1, 2] = 1
    right = all(type(x) is np.ndarray and x.dtype is np.dtype(np.float64) and x.shape == (2, 3) for x in (array, view))
    right = right and view.flags.carray and view.base is memory and memory[6] == 1
    lies = np.float64.__basicsize__ >= _HEADER + 8 and ctypes.c_double.from_address(id(float64) + _HEADER).value == 1.5
    return right and array.flags.carray and type(float64) is np.float64 and float64 == 1.5 and lies


def _table(module: str, name: str) -> Any:
    """One of the function tables that NumPy exports to extension modules."""
    inside = import_module(f"numpy.{'_core' if hasattr(np, '_core') else 'core'}.{module}")  # NumPy 2 or 1.26
    get = ctypes.pythonapi.PyCapsule_GetPointer
    get.restype, get.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    return ctypes.cast(get(getattr(inside, name), None), ctypes.POINTER(ctypes.c_void_p))
