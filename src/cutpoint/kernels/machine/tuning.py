"""What functions tell LLVM about the processor, beside its name: measured where vectors have 512 bits."""

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
    """Attributes of a function that computes with vectors and with numbers alone.

    Calls were measured to take up to 2.7 times as long beside vectors of 512 bits; two of 256 bits each do no harm.
    """
    return _HALVES if _is_wide() else ""


def for_one_element() -> str:
    """Attributes of a function of one element, whose vectors are elementary functions side by side.

    Zen 4 takes vectors of 512 bits in halves anyway: in two of 256 inverse dynamics were measured to take 8 % less time
    (UR10) and 5 % (Panda), Jacobians 10 %, mass matrices 15 and 5 %, forward dynamics 2 % more.
    """
    return _HALVES if _is_wide() or _processor() == "znver4" else ""


def for_divisions(graphs: Iterable[Graph]) -> str:
    """Attributes of a function in which divisors are computed.

    LLVM then orders operations for a processor that waits for every result: what a divisor needs comes first, and what
    needs the quotient last.  That was measured to save 4 to 16 % of forward dynamics; where nothing is divided by what
    has been computed, up to 8 % are lost.
    """
    divides = any(x.op == "div" and _is_computed(x.args[1]) for graph in graphs for x in graph.nodes)
    return '"tune-cpu"="atom"' if divides and _is_wide() else ""


def for_blocks(graph: Graph) -> str:
    """Attributes of a function of a graph over blocks.

    LLVM's model of AMD's Zen keeps results for the end, where their stores wait for each other.  That of AMD's Jaguar
    lets them go as they come: on Zen 4 that was measured to save 17 to 20 % of mass matrices, 2 % of an arm's forward
    dynamics, and to cost nothing elsewhere.
    """
    return '"tune-cpu"="btver2"' if vector_width() == 8 and not _is_wide() else for_divisions([graph])


def claims_results(graph: Graph) -> bool:
    """Whether a function of one element, of a lowered graph, should ask memory for its results' place at once.

    Where stores are waited for, Intel's Emerald Rapids was measured to save 5 to 20 % of an arm's regressor by that,
    in calls that fill 1 MB one after another, and nothing where they are not.
    """
    few = len(graph.results) * graph.precision.item <= _MOST_CLAIMED
    return few and _is_wide() and waits_for_stores(graph.nodes, graph.results)


def _is_computed(x: Node | float) -> bool:
    return isinstance(x, Node) and x.op != "input"


@cache
def _is_wide() -> bool:
    """Whether vectors have 512 bits, on a processor that is not AMD's."""
    return vector_width() == 8 and not _processor().startswith("znver")


@cache
def _processor() -> str:
    """As LLVM names it."""
    return binding.get_host_cpu_name()
