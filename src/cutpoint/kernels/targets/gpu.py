"""A graph on the GPU: its CUDA C, compiled by NVRTC and launched through CuPy."""

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.arguments import as_numbers, as_plain, in_order, phrase
from cutpoint.kernels.arrays.rows import as_reals, as_rows, batch_of
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.cache import Cache, key_of, user_folder
from cutpoint.kernels.machine.forks import new_lock
from cutpoint.kernels.machine.waiting import shown
from cutpoint.kernels.targets import cuda
from cutpoint.kernels.targets.cuda_results import THREADS

_OPTIONS = ("--std=c++17",)


def gpu_function(graph: Graph, name: str, record: type[tuple[Any, ...]] | None) -> Callable[..., Any]:
    """The graph as a function of CuPy arrays, called like a kernel: see `Kernel.on_gpu`."""
    cupy = _cupy()
    with shown(f"{name} for the GPU"):
        code = cuda.code(name, graph)
    (_, outputs), dtype = cuda.full(graph), graph.precision.dtype
    loaded, lock = dict[int, Any](), new_lock()  # by device: a kernel exists only on the device that loaded it

    def launch(device: int, *arguments: Any) -> None:
        if device not in loaded:
            with lock:
                loaded[device] = loaded.get(device) or _loaded(cupy, code, name)
        loaded[device](*arguments)

    def call(*arguments: Any, **named: Any) -> Any:
        device = cupy.cuda.runtime.getDevice()
        ordered = in_order(name, graph.inputs, arguments, named)
        there = [_there(name, p, x, graph.precision, device) for p, x in zip(graph.inputs, ordered, strict=True)]
        given = as_reals(cupy, name, graph.inputs, there, dtype)
        batch = batch_of(name, graph.inputs, given)
        length = math.prod(batch)
        rows = [(p, as_rows(cupy, p, x, batch)) for p, x in zip(graph.inputs, given, strict=True) if p.size]
        made = {p.name: cupy.empty((length, *p.shape), dtype=dtype) for p in graph.outputs}
        if length and outputs:
            read = [part for p, x in rows for part in (cupy.ascontiguousarray(x), np.int64(_step(x, p.size)))]
            blocks = -(-length // THREADS)
            launch(device, (blocks,), (THREADS,), (np.int64(length), *read, *(made[p.name] for p in outputs)))
        results = [made[p.name].reshape((*batch, *p.shape)) for p in graph.outputs]
        return record._make(results) if record else results[0]  # type: ignore[attr-defined]

    call.__name__ = call.__qualname__ = name
    return call


def _there(name: str, port: Port, argument: Any, precision: Precision, device: int) -> Any:
    """The argument, copied to the current GPU if it is not there.

    Raises InputError for anything but numbers, and for arrays on another GPU.
    """
    if not hasattr(type(argument), "__cuda_array_interface__"):  # on an array itself it would be computed again
        try:
            return as_numbers(as_plain(name, port, argument), precision)
        except (TypeError, ValueError, OverflowError) as problem:
            raise InputError(f"{name}: {port.name} {phrase(argument, problem)}", name=port.name) from None
    there = getattr(getattr(argument, "device", None), "id", device)
    if there != device:
        told = f"is on GPU {there}, but GPU {device} is in use: move it, or call within `cupy.cuda.Device({there})`"
        raise InputError(f"{name}: {port.name} {told}", name=port.name)
    return argument


def _loaded(cupy: Any, code: str, name: str) -> Any:
    """The kernel on the current GPU, from disk if it has been compiled before."""
    version, capability = cupy.cuda.nvrtc.getVersion(), cupy.cuda.Device().compute_capability
    kept, key = Cache(user_folder()), key_of("CUDA", code, capability, str(version), cupy.__version__, *_OPTIONS)

    def function(compiled: bytes) -> Any:
        module = cupy.cuda.Module()
        module.load(compiled)
        return module.get_function(name)

    if compiled := kept.read(key):
        with suppress(Exception):  # the driver rejects it: it is compiled again
            return function(compiled)
    with shown(f"{name} for the GPU"):
        # CuPy's RawModule would flush subnormal float32 numbers to zero
        compiled, _ = cupy.cuda.compiler.compile_using_nvrtc(code, _OPTIONS)
    found = function(compiled)
    kept.write(key, compiled)
    return found


def _step(rows: Any, size: int) -> int:
    return 0 if rows.shape[0] == 1 else size


def _cupy() -> Any:
    try:
        import cupy  # pyright: ignore[reportMissingImports]
    except ImportError as problem:
        raise InputError('on_gpu needs CuPy: pip install "cutpoint[cuda]", or cupy-cuda13x for CUDA 13') from problem
    return cupy
