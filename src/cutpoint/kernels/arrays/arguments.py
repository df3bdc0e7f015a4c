"""Arguments of a kernel: put in order, with explanations of those that do not fit."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cutpoint.errors import InputError, unknown_name
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port, Shape
from cutpoint.kernels.graphs.precision import FLOAT64, Precision


def in_order(kernel: str, ports: Sequence[Port], arguments: Sequence[Any], named: Mapping[str, Any]) -> list[Any]:
    """The arguments in the order of the ports.

    Raises:
        InputError: one is missing, unknown or given twice.
    """
    if len(arguments) == len(ports) and not named:
        return [*arguments]
    names = [p.name for p in ports]
    if len(arguments) > len(names):
        raise InputError(f"{kernel}: {len(arguments)} arguments given, but it takes {len(names)}: {', '.join(names)}")
    for key in named:
        if key not in names:
            raise unknown_name(f"input of {kernel}", key, names)
        if key in names[: len(arguments)]:
            raise InputError(f"{kernel}: {key} is given twice, by position and by name", name=key)
    missing = [key for key in names[len(arguments) :] if key not in named]
    if missing:
        raise InputError(f"{kernel}: {', '.join(missing)} missing; it takes {', '.join(names)}", missing=missing)
    return [*arguments, *(named[key] for key in names[len(arguments) :])]


def as_numbers(argument: Any, precision: Precision) -> np.ndarray:
    """The argument as an array of this precision; other real numbers are rounded without a warning.

    Raises:
        TypeError: it holds anything but real numbers.
    """
    array = np.asarray(argument)
    if array.dtype is precision.dtype:
        return array
    if not np.can_cast(array.dtype, precision.dtype, "same_kind"):
        raise TypeError(f"{array.dtype} is not a real number")
    with np.errstate(all="ignore"):
        return array.astype(precision.dtype, copy=False)


def as_plain(kernel: str, port: Port, argument: Any) -> Any:
    """The argument without a mask, and as an array if it would compute universal functions in its own way.

    pandas, for one, would apply them to the transpose of a table.

    Raises:
        InputError: some of its numbers are masked, or it cannot be an array.
    """
    if not isinstance(argument, np.ndarray) and hasattr(type(argument), "__array_ufunc__"):
        try:
            return np.asarray(argument)
        except (TypeError, ValueError) as error:
            told = f"{kernel}: {port.name}, a {type(argument).__name__}, cannot be an array: {error}"
            raise InputError(told, name=port.name) from None
    if not isinstance(argument, np.ma.MaskedArray):
        return argument
    if np.ma.is_masked(argument):
        raise InputError(f"{kernel}: {port.name} has masked numbers: fill them in, or leave these out", name=port.name)
    return argument.data


def batch_shape(port: Port, array: np.ndarray) -> Shape:
    """The leading axes of an argument.

    Raises:
        ValueError: the last axes are not the port's.
    """
    split = array.ndim - len(port.shape)
    if split < 0 or array.shape[split:] != port.shape:
        axes = f"axis must be {port.shape[0]}" if len(port.shape) == 1 else f"axes must be {port.shape}"
        raise ValueError(f"has shape {array.shape}: its last {axes}")
    return array.shape[:split]


def common_batch(function: str, batches: Mapping[str, Shape]) -> Shape:
    """The broadcast leading axes of arguments, from those of each by name.

    Raises:
        InputError: they do not broadcast.
    """
    first, *others = batches.values() or [()]
    if all(x == first for x in others):  # for speed: saves some microseconds
        return first
    try:
        return np.broadcast_shapes(*batches.values())
    except ValueError:
        found = ", ".join(f"{name} {shape}" for name, shape in batches.items())
        raise InputError(f"{function}: leading axes do not broadcast: {found}", batches=batches) from None


def explained(kernel: str, graph: Graph, arguments: Sequence[Any], out: Any, error: Exception) -> InputError:
    """Why a call failed, found by examining its arguments again."""
    batches = {}
    for port, argument in zip(graph.inputs, arguments, strict=True):
        try:
            batches[port.name] = batch_shape(port, as_numbers(argument, graph.precision))
        except (TypeError, ValueError, OverflowError) as problem:
            return InputError(f"{kernel}: {port.name} {phrase(argument, problem)}", name=port.name)
        kind = np.asarray(argument).dtype
        if graph.precision is FLOAT64 and not np.can_cast(kind, np.float64):  # in single precision results are rounded
            told = f"holds {kind}, more precise than float64; pass np.asarray(..., float)"
            return InputError(f"{kernel}: {port.name} {told}", name=port.name)
    try:
        batch = common_batch(kernel, batches)
    except InputError as problem:
        return problem
    return InputError(f"{kernel}: {_out_problem(graph.outputs, batch, out) or error}")


def phrase(argument: Any, problem: Exception) -> str:
    """What is wrong with an argument that `as_numbers` rejects."""
    if isinstance(problem, TypeError):
        return f"holds {_content(argument)}, but must hold real numbers"
    if isinstance(problem, OverflowError):
        return "holds a whole number that is larger than any float"
    text = str(problem)
    return text if text.startswith("has shape") else f"is not an array: {text}"


def _content(argument: Any) -> str:
    array = np.asarray(argument)
    if array.dtype != object:
        return f"{array.dtype}"
    kinds = sorted({type(x).__name__ for x in array.flat})
    if set(kinds) <= {"int", "float"}:
        return f"Python objects ({' and '.join(kinds)}), not floats (np.asarray(..., float) may convert them)"
    traced = "; a kernel cannot be traced; call the function that it was made from" if "Traced" in kinds else ""
    return f"{', '.join(kinds)}{traced}"


def _out_problem(outputs: Sequence[Port], batch: Shape, out: Any) -> str | None:
    if out is None:
        return None
    given = out if isinstance(out, tuple) else (out,)
    if isinstance(out, list) and len(outputs) > 1:
        return f"out is a list, but must be a tuple of {len(outputs)} arrays: {', '.join(p.name for p in outputs)}"
    if len(given) != len(outputs):
        return f"out holds {len(given)} arrays, but must hold {len(outputs)}: {', '.join(p.name for p in outputs)}"
    for port, target in zip(outputs, given, strict=True):
        expected = (*batch, *port.shape)
        if not isinstance(target, np.ndarray) or target.shape != expected:
            found = f"has shape {target.shape}" if isinstance(target, np.ndarray) else f"is a {type(target).__name__}"
            return f"out for {port.name} {found}, but must be an array of shape {expected}"
        if not np.can_cast(np.float32, target.dtype, "same_kind"):
            return f"out for {port.name} is of {target.dtype}, but must be of floats"
    return None
