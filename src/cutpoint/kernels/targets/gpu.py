"""A graph on the GPU: its CUDA C, compiled and launched through CuPy."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.arguments import in_order
from cutpoint.kernels.arrays.rows import as_reals, as_rows, batch_of
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.targets import cuda

BLOCK = 128
"""Threads that start together."""


def gpu_function(graph: Graph, name: str, record: type[tuple[Any, ...]] | None) -> Callable[..., Any]:
    """The graph as a function of CuPy's arrays that is called as a kernel is: see `Kernel.on_gpu`."""
    cupy = _cupy()
    (_, outputs), dtype = cuda.full(graph), graph.precision.dtype
    # CuPy compiles at the first launch, for the GPU that there is
    launch = cupy.RawModule(code=cuda.code(name, graph), options=("--std=c++17",)).get_function(name)

    def call(*arguments: Any, **named: Any) -> Any:
        ordered = in_order(name, graph.inputs, arguments, named)
        given = as_reals(cupy, name, graph.inputs, ordered, dtype)
        batch = batch_of(name, graph.inputs, given)
        length = math.prod(batch)
        rows = [(p, as_rows(cupy, p, x, batch)) for p, x in zip(graph.inputs, given, strict=True) if p.size]
        made = {p.name: cupy.empty((length, *p.shape), dtype=dtype) for p in graph.outputs}
        if length and outputs:
            read = [part for p, x in rows for part in (cupy.ascontiguousarray(x), np.int64(_step(x, p.size)))]
            blocks = -(-length // BLOCK)
            launch((blocks,), (BLOCK,), (np.int64(length), *read, *(made[p.name] for p in outputs)))
        results = [cupy.reshape(made[p.name], (*batch, *p.shape)) for p in graph.outputs]
        return record._make(results) if record else results[0]  # type: ignore[attr-defined]

    call.__name__ = call.__qualname__ = name
    return call


def _step(rows: Any, size: int) -> int:
    return 0 if rows.shape[0] == 1 else size


def _cupy() -> Any:
    try:
        import cupy  # pyright: ignore[reportMissingImports]
    except ImportError as problem:
        raise InputError('on_gpu needs CuPy: pip install "cutpoint[cuda]"') from problem
    return cupy
