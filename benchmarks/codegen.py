"""CasADi's generated C, compiled by gcc with a loop around it, called on whole arrays."""

import ctypes
from collections.abc import Callable

import casadi as ca
import compilers
import numpy as np

_LOOP = """
void loop(long items, {inputs}, double* out) {{
  static const casadi_real* arg[{sz_arg}]; static casadi_real* res[{sz_res}];
  static casadi_int iw[{sz_iw}]; static casadi_real w[{sz_w}];
  for (long i = 0; i < items; ++i) {{
    {reads} res[0] = out + i * {out};
    f(arg, res, iw, w, 0);
  }}
}}
"""


def function(symbols: list[ca.SX], *matrices: ca.SX) -> ca.Function:
    """The matrices as one vector of numbers, row by row, with common subexpressions shared."""
    found = ca.vertcat(*(ca.vec(ca.densify(M).T) for M in matrices))
    return ca.Function("f", symbols, [ca.cse(found)])


def source(function: ca.Function) -> str:
    generator = ca.CodeGenerator("f.c")
    generator.add(function)
    return generator.dump()


def compiled(function: ca.Function) -> Callable[..., np.ndarray]:
    """The function on C-contiguous arrays (N, n), one an input; called with out= (N, ...)."""
    loop = compilers.library(source(function) + _loop(function), linked=("-lm",)).loop
    loop.argtypes, loop.restype = [ctypes.c_long, *[ctypes.c_void_p] * (function.n_in() + 1)], None

    def call(*arrays: np.ndarray, out: np.ndarray) -> np.ndarray:
        loop(len(out), *(x.ctypes.data for x in arrays), out.ctypes.data)
        return out

    return call


def _loop(f: ca.Function) -> str:
    sizes = {"sz_arg": f.sz_arg(), "sz_res": f.sz_res(), "sz_iw": f.sz_iw() + 1, "sz_w": f.sz_w() + 1}
    inputs = ", ".join(f"const double* in{k}" for k in range(f.n_in()))
    reads = " ".join(f"arg[{k}] = in{k} + i * {f.numel_in(k)};" for k in range(f.n_in()))
    return _LOOP.format(inputs=inputs, reads=reads, out=f.numel_out(0), **sizes)
