"""A graph on the GPU: its CUDA C, compiled by NVRTC and launched through CuPy."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.arguments import in_order
from cutpoint.kernels.arrays.rows import as_reals, as_rows, batch_of
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.machine.cache import Cache, key_of, user_folder
from cutpoint.kernels.machine.waiting import shown
from cutpoint.kernels.targets import cuda
from cutpoint.kernels.targets.cuda_results import THREADS


def gpu_function(graph: Graph, name: str, record: type[tuple[Any, ...]] | None) -> Callable[..., Any]:
    """The graph as a function of CuPy's arrays that is called as a kernel is: see `Kernel.on_gpu`."""
    cupy = _cupy()
    (_, outputs), dtype, code = cuda.full(graph), graph.precision.dtype, cuda.code(name, graph)
    loaded: dict[int, Any] = {}  # by device: a kernel is there where it was loaded

    def launch(*arguments: Any) -> None:
        device = cupy.cuda.runtime.getDevice()
        if device not in loaded:
            loaded[device] = _loaded(cupy, code, name)
        loaded[device](*arguments)

    def call(*arguments: Any, **named: Any) -> Any:
        ordered = in_order(name, graph.inputs, arguments, named)
        given = as_reals(cupy, name, graph.inputs, ordered, dtype)
        batch = batch_of(name, graph.inputs, given)
        length = math.prod(batch)
        rows = [(p, as_rows(cupy, p, x, batch)) for p, x in zip(graph.inputs, given, strict=True) if p.size]
        made = {p.name: cupy.empty((length, *p.shape), dtype=dtype) for p in graph.outputs}
        if length and outputs:
            read = [part for p, x in rows for part in (cupy.ascontiguousarray(x), np.int64(_step(x, p.size)))]
            blocks = -(-length // THREADS)
            launch((blocks,), (THREADS,), (np.int64(length), *read, *(made[p.name] for p in outputs)))
        results = [made[p.name].reshape((*batch, *p.shape)) for p in graph.outputs]
        return record._make(results) if record else results[0]  # type: ignore[attr-defined]

    call.__name__ = call.__qualname__ = name
    return call


def _loaded(cupy: Any, code: str, name: str) -> Any:
    """The kernel, on the GPU that is in use."""
    version, capability = cupy.cuda.nvrtc.getVersion(), cupy.cuda.Device().compute_capability
    kept, key = Cache(user_folder()), key_of("CUDA", code, capability, str(version), cupy.__version__)
    compiled = kept.read(key)
    if compiled is None:
        with shown(f"{name} for the GPU"):
            # CuPy's RawModule would flush float32 numbers to zero that are too small for full precision
            compiled, _ = cupy.cuda.compiler.compile_using_nvrtc(code, ("--std=c++17",))
        kept.write(key, compiled)
    module = cupy.cuda.Module()
    module.load(compiled)
    return module.get_function(name)


def _step(rows: Any, size: int) -> int:
    return 0 if rows.shape[0] == 1 else size


def _cupy() -> Any:
    try:
        import cupy  # pyright: ignore[reportMissingImports]
    except ImportError as problem:
        raise InputError('on_gpu needs CuPy: pip install "cutpoint[cuda]"') from problem
    return cupy
