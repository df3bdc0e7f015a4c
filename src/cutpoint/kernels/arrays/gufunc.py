"""NumPy generalised ufuncs around loops in machine code.

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
from cutpoint.kernels.graphs.ports import Port, with_numbers
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine import element
from cutpoint.kernels.machine.batch_loop import FUNCTION, batch_loop
from cutpoint.kernels.machine.jit import Compiled, Unwritten
from cutpoint.kernels.machine.ufunc_loop import bare


class LoopGufunc:
    """A loop that `ufunc_loop` wrote, as a generalised ufunc; owns the code and tables that NumPy only points to.

    Attributes:
        call: the generalised ufunc, also for ports of size 0, which the loop ignores.
    """

    def __init__(
        self,
        ir: str | Unwritten,
        function: str,
        precision: Precision,
        inputs: Sequence[Port],
        outputs: Sequence[Port],
        name: str,
        data: int | None = None,
        others: Sequence[str] = (),
    ) -> None:
        """function: the loop's name in `ir`; others: of functions beside it.  data: address of what the loop reads."""
        self._code = Compiled(ir, function, bare(function), *others)
        sides = with_numbers(inputs), with_numbers(outputs)
        ufunc, self._tables = new_gufunc(self._code.address, data, precision.dtype, *sides, name)
        self.call = around_empty_ports(ufunc, precision, inputs, outputs)
        self._loop = ((self._code.addresses[bare(function)], data), precision, inputs, outputs)

    def whole(self, bound: Sequence[np.ndarray] = (), largest: float | None = None) -> Whole | None:
        """The same for whole batches, compiled now."""
        return whole_batches(*self._loop, self, bound, largest)


class Gufunc(LoopGufunc):
    """A graph as a generalised ufunc: packs take most of a long batch.

    Attributes:
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
        data = ctypes.addressof(self._packs.table)
        ports = graph.inputs, graph.outputs
        super().__init__(text, FUNCTION, graph.precision, *ports, name, data, [element.FUNCTION])
        self.element: int | None = self._code.addresses[element.FUNCTION]
