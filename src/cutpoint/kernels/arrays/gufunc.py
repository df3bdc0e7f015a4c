"""A NumPy generalised ufunc around a loop in machine code.

NumPy itself then broadcasts, casts, steps through strides, releases the GIL and writes to `out`.
"""

import ctypes
from collections.abc import Sequence

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.empty_ports import around_empty_ports
from cutpoint.kernels.arrays.function import Whole
from cutpoint.kernels.arrays.numpy_api import MOST_OPERANDS, new_gufunc
from cutpoint.kernels.arrays.packs import Packs, lanes_of
from cutpoint.kernels.arrays.whole_batches import whole_batches
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import with_numbers
from cutpoint.kernels.machine import element
from cutpoint.kernels.machine.batch_loop import FUNCTION, batch_loop
from cutpoint.kernels.machine.jit import Compiled, Unwritten
from cutpoint.kernels.machine.ufunc_loop import bare


class Gufunc:
    """A compiled graph as a NumPy generalised ufunc; owns the code and tables that NumPy only points to.

    Attributes:
        call: the generalised ufunc, also for ports without numbers.
        element: the address of the code for one element.
    """

    def __init__(self, graph: Graph, name: str) -> None:
        """graph: with nonempty inputs and outputs.  Raises InputError for more arrays than NumPy supports."""
        inputs, outputs = with_numbers(graph.inputs), with_numbers(graph.outputs)
        if (count := len(inputs) + len(outputs)) > MOST_OPERANDS:
            told = f"{name}: {count} inputs and outputs, at most {MOST_OPERANDS} compile"
            raise InputError(f"{told}; gather numbers into vectors, or use backend='numpy'", arrays=count)
        self._packs = Packs(graph, inputs, outputs, name)
        lanes, width = lanes_of(graph.precision), self._packs.width
        text = Unwritten(
            (FUNCTION, graph.digest(), inputs, outputs, lanes, width),
            lambda: batch_loop(graph, inputs, outputs, lanes, width),
        )
        self._code = Compiled(text, FUNCTION, bare(FUNCTION), element.FUNCTION)
        self.element: int | None = self._code.addresses[element.FUNCTION]
        data, dtype = ctypes.addressof(self._packs.table), graph.precision.dtype
        ufunc, self._tables = new_gufunc(self._code.address, data, dtype, inputs, outputs, name)
        self.call = around_empty_ports(ufunc, graph.precision, graph.inputs, graph.outputs)
        self._loop = ((self._code.addresses[bare(FUNCTION)], data), graph.precision, graph.inputs, graph.outputs)

    def whole(self, bound: Sequence[np.ndarray] = (), largest: float | None = None) -> Whole | None:
        """The same for whole batches, compiled now."""
        return whole_batches(*self._loop, (self._code, self._packs), bound, largest)
