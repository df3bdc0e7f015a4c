"""A NumPy generalised ufunc over a loop that is one function in machine code: see `Gufunc` for the kernels' own."""

from collections.abc import Sequence

from cutpoint.kernels.arrays.numpy_api import new_gufunc
from cutpoint.kernels.arrays.whole_batches import WholeBatches
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.jit import Compiled


class LoopGufunc:
    """Owns the code and tables that NumPy only points to.

    Attributes:
        call: the generalised ufunc.
        whole: the same for batches given whole.
    """

    def __init__(
        self, ir: str, function: str, precision: Precision, inputs: Sequence[Port], outputs: Sequence[Port], name: str
    ) -> None:
        self._code = Compiled(ir, function)
        self.call, self._tables = new_gufunc(self._code.address, None, precision.dtype, inputs, outputs, name)
        self.whole = WholeBatches((self._code.address, None), precision, inputs, outputs, self._code).call
