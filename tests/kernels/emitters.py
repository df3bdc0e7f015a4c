"""All that computes a kernel's graph, as functions of rows, and what may lie between them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import mpmath
import numpy as np
import sympy
from cuda_builds import CpuKernel, rows_of
from running_error import Bounded

from c_builds import CFunction, compilers
from cutpoint.kernels import Kernel
from cutpoint.kernels.arrays.numpy_backend import NumpyFunction
from cutpoint.kernels.graphs.replay import replay

jax.config.update("jax_enable_x64", True)
mpmath.mp.dps = 60

Rows = list[np.ndarray]
Emitter = Callable[[Kernel, Path], Callable[[Rows], Rows]]


def single(kernel: Kernel, folder: Path) -> Callable[[Rows], Rows]:
    """Machine code, a call a row: what all others are held against."""
    return lambda rows: _stacked([_parts(kernel(*row)) for row in zip(*rows, strict=True)])


def batch(kernel: Kernel, folder: Path) -> Callable[[Rows], Rows]:
    return lambda rows: _parts(kernel(*rows))


def jax_rows(kernel: Kernel, folder: Path) -> Callable[[Rows], Rows]:
    function = kernel.to_jax()
    return lambda rows: [np.asarray(x) for x in _parts(function(*rows))]


def cuda(kernel: Kernel, folder: Path) -> Callable[[Rows], Rows]:
    kernel.to_cuda(folder)
    function = CpuKernel(folder, kernel.name)
    return lambda rows: rows_of(function, kernel.graph, *rows)


def c99(compiler: str) -> Emitter:
    def emitter(kernel: Kernel, folder: Path) -> Callable[[Rows], Rows]:
        kernel.to_c(folder)
        function = CFunction(folder, kernel.name, kernel.graph, compiler, ("-O1",))
        return lambda rows: _stacked([function(*row) for row in zip(*rows, strict=True)])

    return emitter


EXACT: dict[str, Emitter] = {
    "packs": batch, "JAX": jax_rows, "CUDA C, by a C++ compiler": cuda,
    **{f"C99, by {Path(path).name}": c99(path) for path in compilers()},
}  # fmt: skip
"""Emitters that give the bits of single calls of machine code."""


def numpy_rows(kernel: Kernel, rows: Rows) -> Rows:
    found = _parts(NumpyFunction(kernel.graph).call(*rows))
    return [np.broadcast_to(x, (len(rows[0]), *p.shape)) for x, p in zip(found, kernel.graph.outputs, strict=True)]


def sympy_row(kernel: Kernel, row: Rows) -> list[Any]:
    """The results for one row, by SymPy's expressions in 60 digits."""
    steps, outputs = kernel.to_sympy(steps=True)
    names = ["_".join(map(str, (p.name, *index))) for p in kernel.graph.inputs for index in np.ndindex(p.shape)]
    flat = [x for part in _parts(outputs) for x in (part.flat() if isinstance(part, sympy.MatrixBase) else [part])]
    function = sympy.lambdify([sympy.Symbol(n) for n in names], flat, "mpmath", cse=lambda found: (steps, found))
    return function(*(mpmath.mpf(float(x)) for part in row for x in np.ravel(part)))


def bounded_row(kernel: Kernel, row: Rows) -> list[Bounded]:
    """The results for one row, each with a bound on its rounding error in whatever way it is computed."""
    found = replay(kernel.graph, [Bounded(float(x)) for part in row for x in np.ravel(part)])
    return [x if isinstance(x, Bounded) else Bounded(x) for x in found]


def flat(rows: Rows, index: int) -> list[float]:
    """All numbers of one row."""
    return [float(x) for part in rows for x in np.ravel(part[index])]


def _parts(result: Any) -> list[Any]:
    return [*result] if isinstance(result, tuple) else [result]


def _stacked(rows: list[list[Any]]) -> Rows:
    return [np.array(column) for column in zip(*rows, strict=True)]
