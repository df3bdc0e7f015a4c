"""A graph as a function of JAX: machine code called from XLA, differentiated by machine code for its Jacobian.

JAX gets no scalar expressions: XLA can compile those, but the dynamics of arms with two to six joints were measured to
run 8 to 114 times as long as our rows (JAX 0.10.2, 4096 configurations, two cores).
"""

import ctypes
import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.arguments import in_order
from cutpoint.kernels.arrays.backends import check_length, check_size
from cutpoint.kernels.arrays.packs import Packs, lanes_of
from cutpoint.kernels.arrays.rows import as_reals, as_rows, batch_of
from cutpoint.kernels.graphs.derivatives import jacobian_of
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port, with_numbers
from cutpoint.kernels.graphs.precision import FLOAT64
from cutpoint.kernels.graphs.replay import as_function
from cutpoint.kernels.graphs.specialise import graph_of
from cutpoint.kernels.machine import batch_loop
from cutpoint.kernels.machine.jit import Compiled
from cutpoint.kernels.targets import xla_call

Rows = Callable[..., tuple[Any, ...]]
"""A function of arrays with a leading axis each: the batch's length, or 1 of an input that the whole batch shares."""

_serials = itertools.count()
_kept: list[Any] = []
"""Machine code that XLA has been told of lives as long as the process: XLA cannot be told to forget it."""


def jax_function(graph: Graph, name: str, record: type[tuple[Any, ...]] | None) -> Callable[..., Any]:
    """The graph as a function of JAX arrays, called like a kernel: see `Kernel.to_jax`."""
    rows, dtype = _differentiable(graph, name), graph.precision.dtype

    def call(*arguments: Any, **named: Any) -> Any:
        if graph.precision is FLOAT64:
            _check_precision(name)
        ordered = in_order(name, graph.inputs, arguments, named)
        given = as_reals(jnp, name, graph.inputs, ordered, dtype)
        batch = batch_of(name, graph.inputs, given)
        found = rows(*[as_rows(jnp, p, x, batch) for p, x in zip(graph.inputs, given, strict=True)])
        shaped = [jnp.reshape(x, (*batch, *p.shape)) for p, x in zip(graph.outputs, found, strict=True)]
        return record._make(shaped) if record else shaped[0]  # type: ignore[attr-defined]

    call.__name__ = call.__qualname__ = name
    return jax.jit(call)


def _differentiable(graph: Graph, name: str) -> Rows:
    """The graph on rows, with derivatives by the inputs that have tangents, compiled when JAX first needs them."""
    rows = jax.custom_jvp(_vectorisable(graph, name))

    @cache
    def derivatives(moving: tuple[str, ...]) -> Rows:
        jacobian = jacobian_of(as_function(graph), with_respect_to=moving)
        found = graph_of(jacobian, **{p.name: p.shape for p in graph.inputs})
        return _differentiable(replace(found, precision=graph.precision), f"derivatives of {name}")

    def jvp(given: Sequence[Any], tangents: Sequence[Any]) -> Any:
        pairs = zip(graph.inputs, tangents, strict=True)
        moving = [(p, x) for p, x in pairs if not isinstance(x, jax.custom_derivatives.SymbolicZero)]
        blocks = iter(derivatives(tuple(p.name for p, _ in moving))(*given))
        rates = [sum(_times(next(blocks), output, p, x) for p, x in moving) for output in graph.outputs]
        return rows(*given), tuple(rates)

    rows.defjvp(jvp, symbolic_zeros=True)
    return rows


def _times(block: Any, output: Port, port: Port, tangent: Any) -> Any:
    """A Jacobian's block (N, *output, *input) times a tangent (N or 1, *input)."""
    length = block.shape[0]
    matrix = jnp.reshape(block, (length, output.size, port.size))
    moves = jnp.broadcast_to(jnp.reshape(tangent, (tangent.shape[0], port.size)), (length, port.size))
    return jnp.reshape(jnp.einsum("nij,nj->ni", matrix, moves), (length, *output.shape))


def _vectorisable(graph: Graph, name: str) -> Rows:
    """The graph on rows; vmap gives it more rows."""
    target = _registered(graph, name) if graph.results else ""

    def once(*given: Any) -> tuple[Any, ...]:
        (length,) = np.broadcast_shapes((1,), *(x.shape[:1] for x in given))
        kinds = [jax.ShapeDtypeStruct((length, *p.shape), graph.precision.dtype) for p in graph.outputs]
        read = [x for p, x in zip(graph.inputs, given, strict=True) if p.size]
        call = jax.ffi.ffi_call(target, [k for k, p in zip(kinds, graph.outputs, strict=True) if p.size])
        found = iter(call(*read) if graph.results else ())
        pairs = zip(kinds, graph.outputs, strict=True)
        return tuple(next(found) if p.size else jnp.zeros(k.shape, k.dtype) for k, p in pairs)

    def more_rows(size: int, moves: Sequence[bool], *given: Any) -> Any:
        (length,) = np.broadcast_shapes((1,), *(x.shape[m : m + 1] for x, m in zip(given, moves, strict=True)))
        found = rows(*[_merged(x, m, size, length) for x, m in zip(given, moves, strict=True)])
        return tuple(jnp.reshape(x, (size, length, *x.shape[1:])) for x in found), (True,) * len(found)

    rows = jax.custom_batching.custom_vmap(once)
    rows.def_vmap(more_rows)
    return rows


def _merged(x: Any, moves: bool, size: int, length: int) -> Any:
    """Rows along a new axis and an old one, merged into one; those that vary along neither stay shared."""
    if not moves and x.shape[0] == 1:
        return x
    own = x.shape[1 + moves :]
    return jnp.reshape(jnp.broadcast_to(x if moves else x[None], (size, length, *own)), (size * length, *own))


def _registered(graph: Graph, name: str) -> str:
    """The name under which the graph's machine code is registered with XLA."""
    inputs, outputs = map(with_numbers, (graph.inputs, graph.outputs))
    check_size(name, (*inputs, *outputs))
    check_length(name, [graph])
    target, lanes = f"cutpoint {next(_serials)}: {name}", lanes_of(graph.precision)
    packs = Packs(graph, inputs, outputs, name)
    loop = Compiled(batch_loop.batch_loop(graph, inputs, outputs, lanes, packs.width), batch_loop.FUNCTION)
    floats = _ways_of_floats()
    symbols = {
        xla_call.LOOP: loop.address, xla_call.PACKS: ctypes.addressof(packs.table),
        xla_call.FLOATS: ctypes.addressof(floats),
    }  # fmt: skip
    code = Compiled(xla_call.xla_call(inputs, outputs, graph.precision), xla_call.FUNCTION, symbols=symbols)
    jax.ffi.register_ffi_target(target, jax.ffi.pycapsule(code.address), platform="cpu")
    _kept.append((packs, loop, floats, code))
    return target


def _ways_of_floats() -> Any:
    """This thread's floating-point environment (rounding, subnormals), as the C library's fenv_t."""
    floats = ctypes.create_string_buffer(xla_call.FENV_BYTES)
    ctypes.CDLL(None).fegetenv(floats)
    return floats


def _check_precision(name: str) -> None:
    if jnp.result_type(float) != jnp.float64:
        remedy = 'jax.config.update("jax_enable_x64", True)'
        rule = f"JAX computes in float32, but this in float64; run {remedy} first, or use kernel.float32.to_jax()"
        raise InputError(f"{name}: {rule}")
