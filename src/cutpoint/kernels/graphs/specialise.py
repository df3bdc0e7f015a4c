"""From a function to its graph: it is called once with traced scalars, which record its operations."""

import inspect
import re
from collections.abc import Callable
from numbers import Real
from typing import Any

from cutpoint.errors import InputError, TraceError
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Trace
from cutpoint.kernels.graphs.ports import Port, flatten, nest, port, record_fields
from cutpoint.kernels.graphs.refusals import NO_NUMBER, as_float, instead_of
from cutpoint.kernels.graphs.tracing import Condition, Operand, Traced, tracing

SEVERAL = "several outputs are the fields of a NamedTuple or dataclass"


def graph_of(function: Callable[..., Any], /, **inputs: int | tuple[int, ...]) -> Graph:
    """The graph of a function, without compiling it.  Inputs as in `compile`.

    Raises TraceError and InputError as `compile` does.
    """
    return traced(function, [port(name, shape) for name, shape in inputs.items()])[0]


def traced(function: Callable[..., Any], inputs: list[Port]) -> tuple[Graph, str | None]:
    """The graph of a function of these inputs, and the name of the record that it returns; None for one array."""
    with tracing() as trace:
        slots = iter([trace.node("input", k) for k in range(sum(p.size for p in inputs))])
        arguments = _bound(function, {p.name: nest(slots, p.shape) for p in inputs})
        try:
            result = function(**arguments)
        except (TypeError, AttributeError) as error:
            if isinstance(error, TraceError) or not _is_of_traced_numbers(error):
                raise
            asked = "".join(re.findall(r"ufunc '(\w+)'", str(error))[:1])
            told = f"this cannot be computed with traced numbers ({error}); {instead_of(asked)}"
            raise TraceError(f"{name_of(function)}: {told}") from error
        named = record_fields(result)
        if named is not None:
            _check_record(function, type(result).__name__, named)
        ports, numbers = [], []
        for name, value in ({"result": result} if named is None else named).items():
            shape, flat = _flat(function, name, value)
            ports.append(Port(name, shape))
            numbers += [checked(function, name, x, trace) for x in flat]
    return Graph(tuple(inputs), tuple(ports), tuple(numbers)), None if named is None else type(result).__name__


def name_of(function: Callable[..., Any]) -> str:
    return getattr(function, "__name__", type(function).__name__).replace("<lambda>", "lambda")


def _is_of_traced_numbers(error: Exception) -> bool:
    """Whether NumPy or Python rejects an operation because its operands are traced."""
    text = str(error)
    return type(error).__module__.startswith("numpy") or any(x in text for x in ("Traced", "Condition", "Jet", "ufunc"))


def _bound(function: Callable[..., Any], arguments: dict[str, Any]) -> dict[str, Any]:
    try:
        inspect.signature(function).bind(**arguments)
    except ValueError:
        wrapped = f"lambda {', '.join(arguments)}: {name_of(function)}(...)"
        raise InputError(f"{name_of(function)}: its parameters are not known; compile {wrapped}") from None
    except TypeError as error:
        remedy = "give each parameter's shape by its name, as in compile(function, q=6, k=())"
        told = f"{name_of(function)}: its parameters are not the inputs {[*arguments]}: {error}; {remedy}"
        raise InputError(told) from None
    return arguments


def _check_record(function: Callable[..., Any], record: str, fields: dict[str, Any]) -> None:
    """Raises TraceError for a record that cannot become the NamedTuple of a kernel's outputs."""
    if not fields:
        raise TraceError(f"{name_of(function)}: the {record} that it returns has no fields; a kernel needs an output")
    for name in fields:
        if name.startswith("_"):
            rule = "outputs are fields of a NamedTuple, whose names must not begin with an underscore"
            raise TraceError(f"{name_of(function)}: output {name!r} needs another name: {rule}")


def _flat(function: Callable[..., Any], name: str, value: Any) -> tuple[tuple[int, ...], list[Any]]:
    try:
        return flatten(value)
    except ValueError as error:
        raise TraceError(f"{name_of(function)}: output {name!r} is ragged: {error}; {SEVERAL}") from None


def checked(function: Callable[..., Any], name: str, x: Any, trace: Trace) -> Operand:
    """The number, checked to be a valid output of a kernel."""
    if isinstance(x, Traced) and x.trace is trace:
        return x
    if isinstance(x, Real):
        return as_float(x)
    what = "a number of another trace" if isinstance(x, Traced) else f"a {type(x).__name__}"
    rule = "it must hold traced numbers, ints and floats" + (f"; {SEVERAL}" if isinstance(x, dict) else "")
    rule = NO_NUMBER if isinstance(x, Condition) else rule
    raise TraceError(f"{name_of(function)}: output {name!r} holds {what}; {rule}")
