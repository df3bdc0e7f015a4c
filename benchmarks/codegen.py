"""CasADi's generated C, compiled by gcc with a loop around it, called on whole arrays."""

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np

FLAGS = ("-O3", "-march=native", "-fPIC", "-shared")

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


def compiled(function: ca.Function, folder: Path, name: str) -> Callable[..., np.ndarray]:
    """The function on C-contiguous arrays (N, n), one an input; called with out= (N, numbers of the result)."""
    generator = ca.CodeGenerator(f"{name}.c")
    generator.add(function)
    generator.generate(f"{folder}/")
    source, library = folder / f"{name}.c", folder / f"{name}.so"
    source.write_text(source.read_text() + _loop(function))
    subprocess.run(["gcc", *FLAGS, str(source), "-o", str(library), "-lm"], check=True)
    loop = ctypes.CDLL(str(library)).loop
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
