"""A graph as a function of JAX: machine code called from XLA, differentiated by machine code for its Jacobian.

JAX is given no scalar expressions: XLA compiles those, but recomputes what they share, and was measured to run
thousands of times slower.
"""

import ctypes
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels import batch_loop, xla_call
from cutpoint.kernels.arguments import batch_shape, in_order
from cutpoint.kernels.derivatives import jacobian_of
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.jit import Compiled
from cutpoint.kernels.lowering import lower
from cutpoint.kernels.packs import Packs
from cutpoint.kernels.ports import Port
from cutpoint.kernels.replay import as_function
from cutpoint.kernels.specialise import graph_of

Rows = Callable[..., tuple[Any, ...]]
"""A function of arrays with a leading axis each: the batch's length, or 1 of an input that the whole batch shares."""

_kept: list[Any] = []
"""Machine code that XLA has been told of lives as long as the process: XLA cannot be told to forget it."""


def jax_function(graph: Graph, name: str, record: type[tuple[Any, ...]] | None) -> Callable[..., Any]:
    """The graph as a function of JAX's arrays that is called as a `Kernel` is: see `Kernel.to_jax`."""
    rows = differentiable(graph, name)

    def call(*arguments: Any, **named: Any) -> Any:
        _check_precision(name)
        given = [jnp.asarray(x, float) for x in in_order(name, graph.inputs, arguments, named)]
        batch = _batch(name, graph.inputs, given)
        pairs = zip(graph.inputs, given, strict=True)
        found = rows(*[_as_rows(p, x, batch) for p, x in pairs])
        shaped = [jnp.reshape(x, (*batch, *p.shape)) for p, x in zip(graph.outputs, found, strict=True)]
        return record._make(shaped) if record else shaped[0]  # type: ignore[attr-defined]

    call.__name__ = call.__qualname__ = name
    return call


def differentiable(graph: Graph, name: str) -> Rows:
    """The graph on rows, with its derivatives.  They are compiled for the inputs that move when JAX first asks."""
    rows = jax.custom_jvp(_vectorisable(graph, name))

    @cache
    def derivatives(moving: tuple[str, ...]) -> Rows:
        shapes = {p.name: p.shape for p in graph.inputs}
        jacobian = graph_of(jacobian_of(as_function(graph), with_respect_to=moving), **shapes)
        return differentiable(jacobian, f"derivatives of {name}")

    def jvp(primals: Sequence[Any], tangents: Sequence[Any]) -> Any:
        pairs = zip(graph.inputs, tangents, strict=True)
        moving = {p.name: (p, x) for p, x in pairs if not isinstance(x, jax.custom_derivatives.SymbolicZero)}
        blocks = iter(derivatives(tuple(moving))(*primals))
        results = rows(*primals)
        rates = [sum(_times(next(blocks), p, *m) for m in moving.values()) for p in graph.outputs]
        return results, tuple(jnp.reshape(r, x.shape) for r, x in zip(rates, results, strict=True))

    rows.defjvp(jvp, symbolic_zeros=True)
    return rows


def _times(block: Any, output: Port, port: Port, tangent: Any) -> Any:
    """A Jacobian's block (N, outputs, inputs) times a tangent (N or 1, inputs)."""
    matrix = jnp.reshape(block, (-1, output.size, port.size))
    return jnp.sum(matrix * jnp.reshape(tangent, (-1, 1, port.size)), axis=-1)


def _vectorisable(graph: Graph, name: str) -> Rows:
    """The graph on rows; under vmap they become more rows."""
    target = _target(graph, name)
    full = [k for k, p in enumerate(graph.inputs) if p.size]

    @jax.custom_batching.custom_vmap
    def rows(*given: Any) -> tuple[Any, ...]:
        (length,) = np.broadcast_shapes((1,), *(x.shape[:1] for x in given))
        kinds = [jax.ShapeDtypeStruct((length, *p.shape), jnp.float64) for p in graph.outputs]
        found = iter(jax.ffi.ffi_call(target, [k for k in kinds if k.size])(*[given[k] for k in full]))
        return tuple(next(found) if k.size else jnp.zeros(k.shape) for k in kinds)

    @rows.def_vmap
    def more_rows(size: int, moves: Sequence[bool], *given: Any) -> Any:
        axes = [x.shape[moved : moved + 1] for x, moved in zip(given, moves, strict=True)]
        (length,) = np.broadcast_shapes((1,), *axes)
        found = rows(*[_merged(x, moved, size, length) for x, moved in zip(given, moves, strict=True)])
        return tuple(jnp.reshape(x, (size, length, *x.shape[1:])) for x in found), (True,) * len(found)

    return rows


def _merged(x: Any, moved: bool, size: int, length: int) -> Any:
    """Rows of a new axis and an old one as rows of one axis; what neither moves stays shared."""
    if not moved and x.shape[0] == 1:
        return x
    own = x.shape[1 + moved :]
    whole = jnp.broadcast_to(x if moved else x[None], (size, length, *own))
    return jnp.reshape(whole, (size * length, *own))


def _as_rows(port: Port, x: Any, batch: tuple[int, ...]) -> Any:
    if x.size == port.size:
        return jnp.reshape(x, (1, *port.shape))
    return jnp.reshape(jnp.broadcast_to(x, (*batch, *port.shape)), (-1, *port.shape))


def _target(graph: Graph, name: str) -> str:
    """What XLA calls the machine code of a graph."""
    return _registered(graph, name)


def _registered(graph: Graph, name: str) -> str:
    inputs, outputs = ([p for p in ports if p.size] for ports in (graph.inputs, graph.outputs))
    target = f"cutpoint {name} {len(_kept)}"
    lowered = lower(graph)
    packs = Packs(lowered, inputs, outputs, name)
    loop = Compiled(batch_loop.batch_loop(lowered, inputs, outputs, packs.width), batch_loop.FUNCTION)
    symbols = {xla_call.LOOP: loop.address, xla_call.PACKS: ctypes.addressof(packs.table)}
    code = Compiled(xla_call.xla_call(inputs, outputs), xla_call.FUNCTION, symbols=symbols)
    jax.ffi.register_ffi_target(target, jax.ffi.pycapsule(code.address), platform="cpu")
    _kept.append((packs, loop, code))
    return target


def _batch(name: str, ports: Sequence[Port], given: Sequence[Any]) -> tuple[int, ...]:
    return np.broadcast_shapes(*(batch_shape(p, x) for p, x in zip(ports, given, strict=True)))


def _check_precision(name: str) -> None:
    if jnp.result_type(float) != jnp.float64:
        remedy = 'jax.config.update("jax_enable_x64", True)'
        raise InputError(f"{name}: JAX computes with float32, our machine code with float64; say {remedy} first")
