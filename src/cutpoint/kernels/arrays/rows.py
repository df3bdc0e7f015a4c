"""Batches as rows: arguments whose leading axes broadcast become arrays with one leading axis."""

import math
from collections.abc import Sequence
from typing import Any

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.arguments import batch_shape, common_batch
from cutpoint.kernels.graphs.ports import Port, Shape


def as_reals(arrays: Any, name: str, ports: Sequence[Port], given: Sequence[Any], dtype: Any) -> list[Any]:
    """The arguments as arrays of this type.

    arrays: the module that creates them, such as jax.numpy.
    Raises InputError where one is complex, of which that module would take the real part.
    """
    made = [arrays.asarray(x) for x in given]
    for port, x in zip(ports, made, strict=True):
        if x.dtype.kind == "c":
            raise InputError(f"{name}: {port.name} holds {x.dtype}, but must hold real numbers", name=port.name)
    return [x if x.dtype == dtype else arrays.asarray(x, dtype=dtype) for x in made]


def batch_of(name: str, ports: Sequence[Port], given: Sequence[Any]) -> Shape:
    """The broadcast leading axes of the arguments.

    Raises InputError where an argument's last axes are not its port's, or the leading ones do not broadcast.
    """
    shapes = {}
    for port, x in zip(ports, given, strict=True):
        try:
            shapes[port.name] = batch_shape(port, x)
        except ValueError as problem:
            raise InputError(f"{name}: {port.name} {problem}", name=port.name) from None
    return common_batch(name, shapes)


def as_rows(arrays: Any, port: Port, x: Any, batch: Shape) -> Any:
    """The argument as (N, *shape), N the size of the batch, or as (1, *shape) if the whole batch shares it.

    arrays: the argument's array module, such as jax.numpy.
    """
    if len(batch) == 1 and x.shape == (*batch, *port.shape):
        return x
    if all(n == 1 for n in x.shape[: x.ndim - len(port.shape)]):
        return arrays.reshape(x, (1, *port.shape))
    whole = arrays.broadcast_to(x, (*batch, *port.shape))
    return arrays.reshape(whole, (math.prod(batch), *port.shape))
