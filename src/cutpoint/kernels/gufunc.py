"""A NumPy generalised ufunc over a loop in machine code.

NumPy's own machinery then broadcasts, casts, walks strides, releases the GIL and writes to `out`.
"""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

from cutpoint.errors import InputError
from cutpoint.kernels import element
from cutpoint.kernels.batch_loop import FUNCTION, batch_loop
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.jit import Compiled
from cutpoint.kernels.numpy_api import MOST_OPERANDS, new_gufunc
from cutpoint.kernels.packs import Packs, lanes_of
from cutpoint.kernels.ports import Port

_NO_IDENTITY = -1


class Gufunc:
    """A compiled graph as a NumPy generalised ufunc; owns the code and tables that NumPy only points to.

    Attributes:
        call: the generalised ufunc.
        element: the address of the code for one element.
    """

    def __init__(self, graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], name: str) -> None:
        """Raises InputError for more arrays than NumPy takes."""
        if (count := len(inputs) + len(outputs)) > MOST_OPERANDS:
            told = f"{name}: {count} inputs and outputs, at most {MOST_OPERANDS} compile"
            raise InputError(f"{told}; gather numbers into vectors, or use backend='numpy'", arrays=count)
        self._packs = Packs(graph, inputs, outputs, name)
        text = batch_loop(graph, inputs, outputs, lanes_of(graph.precision), self._packs.width)
        self._code = Compiled(text, FUNCTION, element.FUNCTION)
        self.element: int | None = self._code.addresses[element.FUNCTION]
        self._loops = (ctypes.c_void_p * 1)(self._code.address)
        self._data = (ctypes.c_void_p * 1)(ctypes.addressof(self._packs.table))
        self._types = bytes([graph.precision.dtype.num] * (len(inputs) + len(outputs)))
        self._name = name.encode()
        self._signature = signature(inputs, outputs).encode()
        self.call: Callable[..., Any] = new_gufunc(
            self._loops, self._data, self._types, 1, len(inputs), len(outputs), _NO_IDENTITY, self._name, b"", 0,
            self._signature,
        )  # fmt: skip


def signature(inputs: Sequence[Port], outputs: Sequence[Port]) -> str:
    """NumPy's text of core dimensions, all of them frozen: (6),(3,4)->()."""
    left, right = (",".join(f"({','.join(map(str, p.shape))})" for p in ports) for ports in (inputs, outputs))
    return f"{left}->{right}"
