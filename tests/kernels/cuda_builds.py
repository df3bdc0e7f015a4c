"""Exported CUDA C, without a GPU: compiled by CUDA's own compiler, and by a C++ compiler to run thread by thread."""

import ctypes
import subprocess
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from importlib.metadata import files
from pathlib import Path
from typing import Any

import numpy as np

from c_builds import cpp_compilers
from cutpoint.kernels import Graph

_WORDS = Path(__file__).parent / "cuda_on_cpu.hpp"
_STRICT = ("-std=c++17", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Wno-unknown-pragmas", "-Werror")


@cache
def _nvrtc() -> ctypes.CDLL:
    """CUDA's compiler as a library, of the package nvidia-cuda-nvrtc-cu12."""
    (path,) = [entry for entry in files("nvidia-cuda-nvrtc-cu12") or () if entry.name == "libnvrtc.so.12"]
    return ctypes.CDLL(str(path.locate()))


def compiled(code: str, architecture: str, *flags: str) -> tuple[str, bytes]:
    """PTX and machine code for an architecture, such as sm_90; a complaint of the compiler is an error."""
    nvrtc, program = _nvrtc(), ctypes.c_void_p()
    assert nvrtc.nvrtcCreateProgram(ctypes.byref(program), code.encode(), b"kernel.cu", 0, None, None) == 0
    options = [f"--gpu-architecture={architecture}".encode(), b"--std=c++17", *map(str.encode, flags)]
    failed = nvrtc.nvrtcCompileProgram(program, len(options), (ctypes.c_char_p * len(options))(*options))
    log = _text(program, "ProgramLog").decode().rstrip("\0\n")
    assert not failed and not log, log
    made = _text(program, "PTX").decode().rstrip("\0"), _text(program, "CUBIN")
    assert nvrtc.nvrtcDestroyProgram(ctypes.byref(program)) == 0
    return made


def _text(program: ctypes.c_void_p, what: str) -> bytes:
    size = ctypes.c_size_t()
    assert _nvrtc()[f"nvrtcGet{what}Size"](program, ctypes.byref(size)) == 0
    buffer = ctypes.create_string_buffer(size.value)
    assert _nvrtc()[f"nvrtcGet{what}"](program, buffer) == 0
    return buffer.raw


class CpuKernel:
    """A CUDA kernel's own text, built by a C++ compiler, launched on this processor: a warp after the other.

    The threads of a warp run at once where they wait for each other, else one after the other.
    """

    def __init__(self, folder: Path, name: str) -> None:
        compiler = cpp_compilers()[0]
        library = folder / f"{name}.so"
        source = ["-include", str(_WORDS), "-x", "c++", str(folder / f"{name}.cu")]
        command = [compiler, *_STRICT, "-shared", "-fPIC", *source, "-o", str(library)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        self._library, self._kernel = ctypes.CDLL(str(library)), ctypes.CDLL(str(library))[name]
        self._waits = "__syncwarp" in (folder / f"{name}.cu").read_text()

    def __call__(self, blocks: tuple[int], threads: tuple[int], arguments: tuple[Any, ...]) -> None:
        """Arrays and numbers of type int64, as CuPy's kernels take them."""
        given = [_passed(x) for x in arguments]

        def run(block: int, thread: int) -> None:
            self._library.cutpoint_stand(block, threads[0], thread)
            self._kernel(*given)

        for block in range(blocks[0]):
            for first in range(0, threads[0], 32):
                warp = [(block, thread) for thread in range(first, min(first + 32, threads[0]))]
                self._library.cutpoint_gather(len(warp))
                with ThreadPoolExecutor(len(warp) if self._waits else 1) as pool:
                    # a thread each: none is free while its warp waits
                    for done in [pool.submit(run, *place) for place in warp]:
                        done.result()


def _passed(x: Any) -> Any:
    if isinstance(x, np.int64):
        return ctypes.c_longlong(int(x))
    assert isinstance(x, np.ndarray) and x.dtype.kind == "f" and x.flags.c_contiguous
    return x.ctypes.data_as(ctypes.c_void_p)


def rows_of(kernel: CpuKernel, graph: Graph, *given: np.ndarray) -> list[np.ndarray]:
    """Every output's rows, for each input's rows; an input that all share has one.  Nothing is written behind them."""
    count = max(len(x) for x in given)
    dtype = graph.precision.dtype
    out = [np.full((count + 33, *p.shape), dtype.type(np.pi)) for p in graph.outputs if p.size]
    steps = [np.int64(0 if len(x) == 1 else x[0].size) for x in given]
    read = [part for x, step in zip(given, steps, strict=True) for part in (np.ascontiguousarray(x, dtype), step)]
    kernel((-(-count // 128),), (128,), (np.int64(count), *read, *out))
    assert all((x[count:] == dtype.type(np.pi)).all() for x in out)
    return [x[:count] for x in out]
