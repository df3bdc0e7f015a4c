"""Backends that run a graph on arrays: LLVM where it is installed, NumPy everywhere."""

from collections.abc import Iterable
from functools import cache

from cutpoint.errors import InputError, unknown_name
from cutpoint.kernels.arrays.function import Function
from cutpoint.kernels.arrays.numpy_backend import NumpyFunction
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import ELEMENTARY
from cutpoint.kernels.graphs.ports import Port, with_numbers

MOST_COMPILED = 200_000
"""Operations: so many took minutes to compile."""

AS_MANY = 50
"""Operations that an elementary function counts for: 1000 sines, each of what the one before gave, took 22 s to compile
and 500 took 4, where 60,000 sums and products took 3."""

MOST_NUMBERS = 2**15
"""In all arguments of a compiled function together: scratch memory for strided ones lies on the stack."""


def chosen(backend: str) -> str:
    """The backend that a name stands for: "llvm" or "numpy".

    Raises:
        InputError: there is no such backend, or it is not installed.
    """
    if backend not in ("auto", "llvm", "numpy"):
        raise unknown_name("backend", backend, ("auto", "llvm", "numpy"))
    if backend == "llvm" and not llvm_is_installed():
        raise InputError("backend 'llvm' needs llvmlite, which cannot be imported: pip install llvmlite")
    return "numpy" if backend == "numpy" or not llvm_is_installed() else "llvm"


def array_function(graph: Graph, name: str, backend: str) -> Function:
    """The graph as a function of arrays.

    Raises:
        InputError: it is too long to compile, or has too many inputs and outputs.
    """
    if backend == "numpy":
        return NumpyFunction(graph)
    check_size(name, (*graph.inputs, *graph.outputs))
    check_length(name, [graph])
    if not (with_numbers(graph.inputs) and with_numbers(graph.outputs)):
        return NumpyFunction(graph)
    from cutpoint.kernels.arrays.gufunc import Gufunc

    return Gufunc(graph, name)


def check_length(name: str, graphs: Iterable[Graph]) -> None:
    """Raises InputError if compiling would take many minutes."""
    operations = sum(AS_MANY if x.op in ELEMENTARY else 1 for graph in graphs for x in graph.nodes)
    if operations > MOST_COMPILED:
        told = (
            f"{name}: {operations} operations per call, at most {MOST_COMPILED} compile (a sine counts for {AS_MANY})"
        )
        remedy = "use backend='numpy' to call it from Python, or a smaller model"
        raise InputError(f"{told}; {remedy}", operations=operations)


def check_size(name: str, ports: Iterable[Port]) -> None:
    """Raises InputError for a function with more inputs and outputs than machine code supports."""
    numbers = sum(p.size for p in ports)
    if numbers > MOST_NUMBERS:
        told = f"{name}: {numbers} numbers in and out, at most {MOST_NUMBERS} compile"
        raise InputError(f"{told}; use backend='numpy' to call it from Python, or a smaller model", numbers=numbers)


def numbers_at_once(backend: str) -> int:
    """The best number of float64 lanes for a program; more would spill from the processor's registers."""
    if chosen(backend) != "llvm":
        return 8  # NumPy takes any number; call overhead dominates its computation
    from cutpoint.kernels.machine.jit import vector_width

    return max(4, vector_width())


@cache
def llvm_is_installed() -> bool:
    try:
        from cutpoint.kernels.machine import jit  # noqa: F401
    except (ImportError, OSError):
        return False
    return True
