"""Derivatives of traced functions, as functions that can themselves be traced and compiled."""

import itertools
from collections import namedtuple
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import wraps
from typing import Any

from cutpoint.errors import InputError, TraceError, unknown_name
from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.elimination import Order, jacobian
from cutpoint.kernels.graphs.graph import reach
from cutpoint.kernels.graphs.nodes import Node, Trace
from cutpoint.kernels.graphs.ports import Shape, flatten, nest, record_fields
from cutpoint.kernels.graphs.replay import OPERATORS
from cutpoint.kernels.graphs.specialise import checked, name_of
from cutpoint.kernels.graphs.tracing import Traced

Flat = tuple[Shape, list[Any]]
"""An array as its shape and its numbers."""

_serials = itertools.count()


def jacobian_of(
    function: Callable[..., Any],
    /,
    *,
    of: Sequence[str] | None = None,
    with_respect_to: Sequence[str] | None = None,
    orders: Sequence[Order] | None = None,
) -> Callable[..., Any]:
    """The derivatives of a function of scalars, exact to rounding, as a function of the same inputs.

    It is traced like the function: pass it to `compile` in the function's place, or call it, by keyword, within a
    traced function.  It returns a NamedTuple of d_<output>_d_<input>, each of the output's shape followed by the
    input's; the output of a function that returns an array is named "result".  At a comparison only the chosen branch
    counts; the other never contaminates it.  Applied twice it gives second derivatives.  That of tanh is computed from
    its value, so where that is nearly 1 it is exact only to the rounding of the value.

    Args:
        of: names of the outputs, default all.
        with_respect_to: names of the inputs, default all.
        orders: elimination orders of the chain rule to try, functions of `kernels.graphs.elimination` such as
            `forward`; the one with the fewest operations wins.

    Raises:
        InputError: names are not names, or orders not functions.  While tracing, like the function's own errors: there
            is no such output or input, or two derivatives would have the same name.
        TraceError: it is called outside a trace.
    """

    if not callable(function):
        raise InputError(f"jacobian_of: function must be a function, got {function!r}")
    _check_names("of", of)
    _check_names("with_respect_to", with_respect_to)
    if orders is not None and not (isinstance(orders, Sequence) and all(map(callable, orders))):
        rule = "orders must be functions of kernels.graphs.elimination, such as [forward, reverse]"
        raise InputError(f"jacobian_of: {rule}, got {orders!r}")

    @wraps(function)
    def derivatives(**inputs: Any) -> Any:
        arrays = {name: flatten(value) for name, value in inputs.items()}
        moving = {name: arrays[name] for name in _chosen("input", with_respect_to, arrays)}
        numbers = [x for _, flat in moving.values() for x in flat]
        free = [_trace_of(function, arrays).node("independent", next(_serials)) for _ in numbers]
        outputs = _outputs(function, {**inputs, **_arrays(iter(free), moving)})
        moved = {name: outputs[name] for name in _chosen("output", of, outputs)}
        found = jacobian(_results(function, moved, free), free, orders)
        values = {x.serial: number for x, number in zip(free, numbers, strict=True)}
        return _blocks(_replaced(found, values), moved, moving)

    derivatives.__name__ = f"jacobian_of_{name_of(function)}"
    return derivatives


def _check_names(what: str, names: Any) -> None:
    """Raises InputError unless this is a list of names."""
    is_list = isinstance(names, Sequence) and not isinstance(names, str)
    if names is not None and not (is_list and all(isinstance(name, str) for name in names)):
        raise InputError(f"jacobian_of: {what} must be a list of names, got {names!r}")


def _trace_of(function: Callable[..., Any], arrays: Mapping[str, Flat]) -> Trace:
    """The current trace."""
    for _, flat in arrays.values():
        for x in flat:
            if isinstance(x, Traced):
                return x.trace
    raise TraceError(f"jacobian_of {name_of(function)} is called without a traced number; compile it, then call that")


def _chosen(kind: str, names: Sequence[str] | None, known: Mapping[str, Any]) -> list[str]:
    if names is not None and not names:
        told = f"jacobian_of: names no {kind}; leave out the argument for all of them"
        raise InputError(f"{told}: {', '.join(known)}", known=[*known])
    for name in names or ():
        if name not in known:
            raise unknown_name(kind, name, known)
    return [*(known if names is None else names)]


def _arrays(numbers: Iterator[Any], like: Mapping[str, Flat]) -> dict[str, Any]:
    """The next numbers, as arrays of these names and shapes."""
    return {name: nest(numbers, shape) for name, (shape, _) in like.items()}


def _outputs(function: Callable[..., Any], inputs: Mapping[str, Any]) -> dict[str, Flat]:
    result = function(**inputs)
    parts = record_fields(result)
    try:
        return {name: flatten(value) for name, value in ({"result": result} if parts is None else parts).items()}
    except ValueError as error:
        raise TraceError(f"{name_of(function)}: an output is ragged: {error}") from None


def _results(function: Callable[..., Any], outputs: Mapping[str, Flat], free: Sequence[Node]) -> list[Operand]:
    """The numbers to differentiate; none where there is nothing to differentiate with respect to."""
    numbers = [(name, x) for name, (_, flat) in outputs.items() for x in flat] if free else []
    return [checked(function, name, x, free[0].trace) for name, x in numbers]


def _replaced(results: Sequence[Operand], values: Mapping[int, Operand]) -> list[Operand]:
    """Results with nodes replaced by values, by serial; all their users are simplified again."""
    done = {**values}

    def new(x: Any) -> Any:
        return done.get(x.serial, x) if isinstance(x, Node) else x

    for x in reach(results):
        if any(isinstance(y, Node) and y.serial in done for y in x.args):
            done[x.serial] = OPERATORS[x.op](*map(new, x.args))
    return [new(x) for x in results]


def _blocks(numbers: list[Operand], outputs: Mapping[str, Flat], inputs: Mapping[str, Flat]) -> Any:
    """The Jacobian, row by row, split into a block for each pair of output and input."""
    width = sum(len(flat) for _, flat in inputs.values())
    rows = [numbers[k : k + width] for k in range(0, len(numbers), width)] if width else []
    blocks, row = {}, 0
    for output, (shape, flat) in outputs.items():
        column = 0
        for name, (own, columns) in inputs.items():
            block = [x for r in rows[row : row + len(flat)] for x in r[column : column + len(columns)]]
            key = f"d_{output}_d_{name}"
            if key in blocks:
                raise InputError(f"jacobian_of: two derivatives would be named {key!r}; rename an input", name=key)
            blocks[key] = nest(iter(block), shape + own)
            column += len(columns)
        row += len(flat)
    return namedtuple("Jacobian", blocks)(**blocks)
