"""Tuning attributes for LLVM, beside the processor's name: measured where vectors have 512 bits."""

from collections.abc import Iterable
from functools import cache

from llvmlite import binding

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.lowering.scheduling import waits_for_stores
from cutpoint.kernels.machine.jit import vector_width

_HALVES = '"min-legal-vector-width"="0" "prefer-vector-width"="256"'

_MOST_CLAIMED = 2**14
"""Bytes of results: more would drive each other out of the nearest memory, of 32 or 48 kB."""


def beside_numbers() -> str:
    """Attributes of a function that mixes vector and scalar code.

    Calls were measured to take up to 2.7 times as long next to 512-bit vectors; two of 256 bits each do no harm.
    """
    return _HALVES if _is_wide() else ""


def for_one_element() -> str:
    """Attributes of a function of one element, whose vectors are vectorised elementary functions.

    Zen 4 splits 512-bit vectors into halves anyway: as two of 256 bits, inverse dynamics was measured to take 8 % less
    time (UR10) and 5 % (Panda), Jacobians 10 %, mass matrices 15 and 5 %, forward dynamics 2 % more.
    """
    return _HALVES if _is_wide() or _processor() == "znver4" else ""


def for_divisions(graphs: Iterable[Graph]) -> str:
    """Attributes of a function in which divisors are computed.

    LLVM then schedules for an in-order processor: what a divisor depends on comes first, users of the quotient last.
    That was measured to save 4 to 16 % of forward dynamics; where no divisor is computed, up to 8 % is lost.
    """
    divides = any(x.op == "div" and _is_computed(x.args[1]) for graph in graphs for x in graph.nodes)
    return '"tune-cpu"="atom"' if divides and _is_wide() else ""


def for_blocks(graph: Graph) -> str:
    """Attributes of a function of a graph over blocks.

    LLVM's scheduling model of AMD's Zen defers results to the end, where their stores queue up.  That of AMD's Jaguar
    stores them as they come: on Zen 4 that was measured to save 17 to 20 % of mass matrices, 2 % of an arm's forward
    dynamics, and to cost nothing elsewhere.
    """
    return '"tune-cpu"="btver2"' if vector_width() == 8 and not _is_wide() else for_divisions([graph])


def claims_results(graph: Graph) -> bool:
    """Whether a function of one element, of a lowered graph, should prefetch its results' memory at the start.

    Where it is bound by stores, that was measured on Intel's Emerald Rapids to save 5 to 20 % of an arm's regressor, in
    successive calls that fill 1 MB, and nothing elsewhere.
    """
    few = len(graph.results) * graph.precision.item <= _MOST_CLAIMED
    return few and _is_wide() and waits_for_stores(graph.nodes, graph.results)


def _is_computed(x: Node | float) -> bool:
    return isinstance(x, Node) and x.op != "input"


@cache
def _is_wide() -> bool:
    """Whether vectors have 512 bits, on a processor not from AMD."""
    return vector_width() == 8 and not _processor().startswith("znver")


@cache
def _processor() -> str:
    """The processor's name in LLVM."""
    return binding.get_host_cpu_name()
