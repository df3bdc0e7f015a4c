"""Kernel: a function compiled for arrays, and `compile`, which makes one."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.array_call import ArrayCall
from cutpoint.kernels.arrays.backends import array_function, check_size, chosen
from cutpoint.kernels.arrays.blocks import Blocks
from cutpoint.kernels.arrays.function import Whole
from cutpoint.kernels.arrays.record import record_class
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import port
from cutpoint.kernels.graphs.precision import FLOAT32, FLOAT64
from cutpoint.kernels.graphs.specialise import name_of, traced
from cutpoint.kernels.machine.waiting import shown


def compile(
    function: Callable[..., Any], /, *, name: str | None = None, backend: str = "auto", **inputs: int | tuple[int, ...]
) -> "Kernel":
    """Compiles a function of scalars into a kernel of arrays.

    The function is called once, by keyword, with traced scalars: a scalar for an input of shape (), a NumPy array of
    them for any other, so that q[0], q + v and M @ q all work.  It returns a scalar, an array or (nested) list of
    scalars, or a dataclass or NamedTuple of them, whose fields become the kernel's outputs; ints and floats may stand
    anywhere.

    Args:
        name: what errors call the kernel; the function's own name if not given.
        backend: "llvm" for machine code, "numpy", or "auto": LLVM where llvmlite is installed.
        inputs: name=shape of each input, in the order of the kernel's arguments.

    Raises:
        TraceError: the function needs a number's value while it is traced, as in `if x > 0`.
        InputError: a shape, the backend, or the function's parameters do not fit, or it is too large to compile.
    """
    if name is not None and not isinstance(name, str):
        told = "must be a string: it is the kernel's name in errors, so no input can be named 'name'"
        raise InputError(f"compile: name={name!r} {told}")
    start, label = time.perf_counter(), name or name_of(function)
    taken = inputs.keys() & {"self", "out", "threads"}
    if taken:
        raise InputError(f"{label}: calls of a kernel have their own {min(taken)}=; rename the input")
    ports = [port(key, shape) for key, shape in inputs.items()]
    if chosen(backend) == "llvm":
        check_size(label, ports)  # with the outputs once more, when they are known
    with shown(label):
        graph, record = traced(function, ports)
        return Kernel(graph, label, backend, record, start)


class Kernel:
    """A function on arrays with NumPy's gufunc semantics: leading axes are a batch and broadcast; `out=` is filled.

    It never warns: overflow and numbers that are not finite show in the results.

    Attributes:
        name: used in error messages.
        graph: the computation as a graph.
        backend: "llvm" or "numpy".
        general: the call without the fast path for plain single arguments.
        compile_seconds: time for tracing, and for compiling or loading the code from disk, s.
    """

    def __init__(self, graph: Graph, name: str, backend: str, record: str | None, start: float) -> None:
        self.graph, self.name, self.backend = graph, name, chosen(backend)
        self._function = array_function(graph, name, self.backend)
        self._record = record_class(record, tuple(p.name for p in graph.outputs)) if record else None
        self.general = ArrayCall(name, graph, self._function, self._record)
        self.compile_seconds = time.perf_counter() - start

    @property
    def operations(self) -> dict[str, int]:
        """How many operations of each kind one call takes, elementary functions counted as one."""
        return self.graph.operations

    def __call__(self, *arguments: Any, out: Any = None, threads: int | None = None, **named: Any) -> Any:
        """The outputs for arrays in the order of the inputs, or by name: an array, or a NamedTuple of them.

        threads: how many share a long batch, only this one if not given; results do not depend on it, to the last bit.

        Raises:
            InputError: an argument is missing, unknown, or of a shape or kind that does not fit.
        """
        if out is None and threads is None and not named:
            return self.call(*arguments)
        return self.general(*arguments, out=out, threads=threads, **named)

    @cached_property
    def float32(self) -> "Kernel":
        """The same graph in single precision: constants, inputs and every operation are rounded to float32.

        Compiled at its first use.  It offers everything that a kernel does; arguments in another precision, such as
        float64 arrays and Python's numbers, are rounded; `out=` may hold float32 or float64.
        """
        if self.graph.precision is FLOAT32:
            return self
        single, record = replace(self.graph, precision=FLOAT32), self._record and self._record.__name__
        with shown(f"{self.name} in float32"):
            return _of_graph(single, self.name, self.backend, record)

    @cached_property
    def blocks(self) -> Blocks:
        """The kernel for batches stored as (blocks, *shape, width), compiled at its first use: see `Blocks`."""
        return Blocks(self.name, self.graph, self._function, self._record)

    @cached_property
    def call(self) -> Callable[..., Any]:
        """The kernel as a function with less call overhead, for single calls in a loop."""
        return self.shortcut(self.general, record=self._record)

    def shortcut(
        self,
        general: Callable[..., Any],
        *,
        bound: Sequence[np.ndarray] = (),
        largest: float | None = None,
        record: type[tuple[Any, ...]] | None = None,
    ) -> Callable[..., Any]:
        """A built-in function that runs the kernel on plain single arguments and delegates all others: see `fastcall`.

        Args:
            general: the function for other calls, or for all if this backend, Python or NumPy has no shortcut.
            bound: arrays for the last inputs, which callers then omit.
            largest: magnitude of a number beyond which, as with NaN, `general` is called; None for any.
            record: the NamedTuple that holds the outputs.
        """
        if self._function.element is None or self.graph.precision is not FLOAT64:
            return general
        from cutpoint.kernels.arrays.fastcall import Front, fastcall
        from cutpoint.kernels.arrays.plain_arguments import is_possible

        if not is_possible():
            return general
        front = Front(general, bound, largest, record)
        return fastcall(self._function, self.name, self.graph.inputs, self.graph.outputs, front)

    def whole(self, *, bound: Sequence[np.ndarray] = (), largest: float | None = None) -> Whole | None:
        """A function that runs the kernel on contiguous batches; None if unavailable.

        It takes a tuple of arguments and `out`, and returns an array, or a tuple of them for several outputs; None if
        the general call is needed.  bound, largest: as for `shortcut`.
        """
        if self.graph.precision is not FLOAT64:
            return None
        from cutpoint.kernels.arrays.plain_arguments import check_bound

        check_bound(self.name, self.graph.inputs, bound)
        return self._function.whole(bound, largest)

    def to_c(self, folder: str | Path, *, force: bool = False) -> tuple[Path, ...]:
        """Writes the kernel as a package of C99, equal to machine code to the last bit; returns the files' paths.

        The folder gets `<name>.c` and `.h`, `<name>.hpp` for C++17, CMakeLists.txt, and a check with recorded inputs
        and outputs.  force: overwrite files that cutpoint has not written.

        Raises:
            InputError: C cannot take a name, files are in the way, or llvmlite is not installed.
        """
        from cutpoint.kernels.targets.c99_package import write_package

        return write_package(self.graph, self.name, folder, force=force)

    def to_cuda(self, folder: str | Path, *, force: bool = False) -> tuple[Path, ...]:
        """Writes the kernel as CUDA C, one thread a configuration; returns the files' paths.

        The folder gets `<name>.cu`, for nvcc and NVRTC, and `<name>.cuh`, which says what its arguments are.  It
        performs the same operations as the machine code, each rounded as IEEE 754 says.
        force: overwrite files that cutpoint has not written.

        Raises:
            InputError: CUDA C cannot take a name, or files are in the way.
        """
        from cutpoint.kernels.targets.cuda_package import write_package

        return write_package(self.graph, self.name, folder, force=force)

    def on_gpu(self) -> Callable[..., Any]:
        """The kernel as a function of CuPy arrays, called like the kernel: inputs and outputs stay on the GPU.

        Needs the extra `cuda`; `to_cuda` says how it computes.  PyTorch tensors on the GPU are accepted directly.  The
        first call compiles, and caches the result on disk for the next start.

        Raises:
            InputError: CuPy is not installed, or CUDA C cannot take a name.
        """
        from cutpoint.kernels.targets.gpu import gpu_function

        return gpu_function(self.graph, self.name, self._record)

    def to_jax(self) -> Callable[..., Any]:
        """The kernel as a function of JAX arrays on the CPU, called like the kernel; supports jit, vmap, grad and jvp.

        It calls this kernel's machine code, and for derivatives machine code for its Jacobian, compiled when JAX first
        needs it.  JAX keeps the code for the life of the process: make the function once.  Needs the extra `jax`.

        Raises:
            InputError: JAX or llvmlite is not installed; when called, also if JAX computes in float32 and the kernel
                does not.
        """
        chosen("llvm")
        _check_installed("to_jax", "jax")
        from cutpoint.kernels.targets.jax import jax_function

        return jax_function(self.graph, self.name, self._record)

    def to_sympy(self, *, steps: bool = False) -> Any:
        """The outputs as SymPy expressions, to read: a Matrix of them where there is an axis (a vector is a column).

        The number q[0] is Symbol("q_0"), M[1][2] is Symbol("M_1_2"), a scalar input k is Symbol("k").  Needs the extra
        `sympy`.

        Args:
            steps: return, as `sympy.cse` does, a list of (symbol, expression) for what is used more than once, and the
                outputs in terms of these symbols.  For large kernels, and where one choice feeds another.

        Raises:
            InputError: SymPy is not installed, or two numbers would have one symbol.
        """
        _check_installed("to_sympy", "sympy")
        from cutpoint.kernels.targets.symbolic import expressions

        before, found = expressions(self.graph, self.name, steps)
        outputs = self._record._make(found) if self._record else found[0]
        return (before, outputs) if steps else outputs

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles the graph without machine code, which is loaded from disk or compiled anew after unpickling."""
        return _of_graph, (self.graph, self.name, self.backend, self._record and self._record.__name__)

    def __repr__(self) -> str:
        sides = (self.graph.inputs, self.graph.outputs)
        inputs, outputs = (", ".join(f"{p.name}{p.shape}" for p in side) for side in sides)
        count = sum(self.operations.values())
        precision = "" if self.graph.precision is FLOAT64 else f" in {self.graph.precision.dtype}"
        return f"<Kernel {self.name}: {inputs} -> {outputs}, {count} operations, {self.backend}{precision}>"


def _of_graph(graph: Graph, name: str, backend: str, record: str | None) -> Kernel:
    start = time.perf_counter()
    with shown(name):
        return Kernel(graph, name, backend, record, start)


def _check_installed(method: str, package: str) -> None:
    """Raises InputError if an extra, named as its package is, is missing."""
    try:
        import_module(package)
    except ImportError as problem:
        raise InputError(f'{method} needs {package}: pip install "cutpoint[{package}]"') from problem
