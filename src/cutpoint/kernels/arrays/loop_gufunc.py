"""A NumPy generalised ufunc around a loop that is one machine-code function: see `Gufunc` for the kernels' own."""

from collections.abc import Sequence

from cutpoint.kernels.arrays.empty_ports import around_empty_ports
from cutpoint.kernels.arrays.function import Whole
from cutpoint.kernels.arrays.numpy_api import new_gufunc
from cutpoint.kernels.arrays.whole_batches import whole_batches
from cutpoint.kernels.graphs.ports import Port, with_numbers
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.jit import Compiled
from cutpoint.kernels.machine.ufunc_loop import bare


class LoopGufunc:
    """Owns the code and tables that NumPy only points to.

    Attributes:
        call: the generalised ufunc, also for ports of size 0, which the loop ignores.
    """

    def __init__(
        self, ir: str, function: str, precision: Precision, inputs: Sequence[Port], outputs: Sequence[Port], name: str
    ) -> None:
        """function: the loop's name in `ir`, as `ufunc_loop` wrote it."""
        self._code = Compiled(ir, function, bare(function))
        sides = with_numbers(inputs), with_numbers(outputs)
        ufunc, self._tables = new_gufunc(self._code.address, None, precision.dtype, *sides, name)
        self.call = around_empty_ports(ufunc, precision, inputs, outputs)
        self._loop = ((self._code.addresses[bare(function)], None), precision, inputs, outputs)

    def whole(self) -> Whole | None:
        """The same for whole batches, compiled now."""
        return whole_batches(*self._loop, self._code)
