"""Packs: machine code for long batches, compiled at the first one.

It takes as long to compile as the loop for single elements, so callers without long batches never pay for it.
"""

import _thread
import ctypes
import threading
from collections.abc import Sequence

from cutpoint.callers import warn
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import FLOAT64, Precision
from cutpoint.kernels.lowering.lower import lower
from cutpoint.kernels.machine.forks import new_lock
from cutpoint.kernels.machine.jit import Compiled, vector_width
from cutpoint.kernels.machine.pack_loop import FUNCTION, pack_loop
from cutpoint.kernels.machine.waiting import shown

_MOST_NODES = 2**14
"""Of a graph that is yet to be lowered.  More would take seconds to compile; packs of 12,000 operations were measured
to be six times as fast as single elements."""

_MOST_NUMBERS = 2**12
"""In all arguments together: those of a whole pack lie on the stack."""

_SOON = 0.05
"""Long enough to return to machine code, s."""


class Packs:
    """Compiles a graph's loop over packs.

    Attributes:
        width: elements in a pack; None if the graph is too large for packs.
        table: the target of the batch loop's data pointer: the loop over packs, null until it is compiled, and the
        function that compiles it.
    """

    def __init__(self, graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port], name: str) -> None:
        self.width = width_of_packs(graph, inputs, outputs)
        self._parts, self._name = (graph, inputs, outputs), name
        self._lock = new_lock()
        self._code: Compiled | None = None
        self._maker = ctypes.CFUNCTYPE(None)(self._make)
        self.table = (ctypes.c_void_p * 2)(None, ctypes.cast(self._maker, ctypes.c_void_p))

    def _make(self) -> None:
        """Called from machine code, possibly by several threads.  If it fails, the scalar loop does the work."""
        try:
            with self._lock, shown(f"{self._name} for batches"):
                if self._code is None and self.width is not None:
                    graph, inputs, outputs = self._parts
                    self._code = Compiled(pack_loop(lower(graph), inputs, outputs, self.width), FUNCTION)
                    self.table[0] = self._code.address
        except KeyboardInterrupt:
            # exceptions cannot pass through machine code: raised again when that has returned
            threading.Timer(_SOON, _thread.interrupt_main).start()
        except Exception as error:
            self.width = None
            warn(f"{self._name}: batches run element by element, as their code cannot be compiled: {error}")


def width_of_packs(graph: Graph, inputs: Sequence[Port], outputs: Sequence[Port]) -> int | None:
    """Elements in a pack of a graph; None if the graph is too large for packs."""
    fits = len(graph.nodes) <= _MOST_NODES and sum(p.size for p in (*inputs, *outputs)) <= _MOST_NUMBERS
    return lanes_of(graph.precision) if fits else None


def lanes_of(precision: Precision) -> int:
    """The processor's vector width in this precision."""
    return vector_width() * FLOAT64.item // precision.item
