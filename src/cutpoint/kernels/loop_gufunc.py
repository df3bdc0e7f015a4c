"""A NumPy generalised ufunc over a loop that is one function in machine code: see `Gufunc` for the kernels' own."""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

from cutpoint.kernels.gufunc import signature
from cutpoint.kernels.jit import Compiled
from cutpoint.kernels.numpy_api import new_gufunc
from cutpoint.kernels.ports import Port
from cutpoint.kernels.precision import Precision

_NO_IDENTITY = -1


class LoopGufunc:
    """Owns the code and tables that NumPy only points to.

    Attributes:
        call: the generalised ufunc.
    """

    def __init__(
        self, ir: str, function: str, precision: Precision, inputs: Sequence[Port], outputs: Sequence[Port], name: str
    ) -> None:
        self._code = Compiled(ir, function)
        self._loops, self._data = (ctypes.c_void_p * 1)(self._code.address), (ctypes.c_void_p * 1)(None)
        self._types = bytes([precision.dtype.num] * (len(inputs) + len(outputs)))
        self._name, self._signature = name.encode(), signature(inputs, outputs).encode()
        self.call: Callable[..., Any] = new_gufunc(
            self._loops, self._data, self._types, 1, len(inputs), len(outputs), _NO_IDENTITY, self._name, b"", 0,
            self._signature,
        )  # fmt: skip
