"""Validation of arguments, done once: arrays, numbers, kinds, names."""

from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from inspect import signature
from operator import index
from os import PathLike
from pathlib import Path
from reprlib import repr as shortened
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.errors import InputError, listed, unknown_name

FLOAT64 = np.dtype(np.float64)

LARGEST = 1e15
"""Of an argument, in SI: an angle beyond it is known to an eighth of a turn at best, and no machine has the rest."""

_REAL = (int, float, np.integer, np.floating)


def are_plain_vectors(values: Iterable[Any]) -> bool:
    """Whether all are arrays (n,) of float64, finite and none beyond LARGEST: the fast check of one call's arguments.

    A small sum of squares implies that every number is small; otherwise `checked_array` decides.
    """
    squares = 0.0
    with np.errstate(over="ignore"):
        for x in values:
            if type(x) is not np.ndarray or x.dtype is not FLOAT64 or x.ndim != 1:
                return False
            squares += x.dot(x)
    return squares < LARGEST * LARGEST


def checked_array(function: str, name: str, value: ArrayLike, size: int | tuple[()]) -> Array:
    """The value as float64 with a last axis of this size, every number finite, none beyond LARGEST.

    Raises InputError.
    """
    rule = f"numbers of shape (..., {size})" if isinstance(size, int) else "numbers"
    array = checked_numbers(function, name, value, rule)
    if isinstance(size, int) and (not array.ndim or array.shape[-1] != size):
        raise InputError(
            f"{function}: {name} has shape {array.shape}: its last axis must be {size}", name=name, shape=array.shape
        )
    if array.size and not (array.min() >= -LARGEST and array.max() <= LARGEST):
        where = tuple(int(i) for i in np.argwhere(~(np.abs(array) <= LARGEST))[0])
        place = f"{name}[{', '.join(map(str, where))}]" if where else name
        rule = "every number must be finite" + (f" and within {LARGEST:g}" if np.isfinite(array[where]) else "")
        raise InputError(f"{function}: {place} is {array[where]}: {rule}", name=name, index=where)
    return array


def checked_numbers(function: str, name: str, value: ArrayLike, rule: str = "numbers") -> Array:
    """The value as float64 of any shape; NaN and infinity are allowed.  Raises InputError.  rule: what it must be."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        remedy = "fill them in, or leave these rows out"
        raise InputError(f"{function}: {name} has masked entries, but needs every number: {remedy}", name=name)
    if labels := _labels_of(value):
        remedy = "put them in the required order, as in robot.joints, and pass .to_numpy()"
        raise InputError(f"{function}: {name} has labels ({listed(labels)}), which are not read: {remedy}", name=name)
    try:
        return np.asarray(value).astype(np.float64, casting="same_kind", copy=False)
    except (TypeError, ValueError, OverflowError):
        raise refused(function, name, value, rule) from None


def channels(function: str, **given: ArrayLike) -> list[Array]:
    """Channels (N,) on one time as float64; NaN where not known.  Raises InputError."""
    found = [checked_numbers(function, name, value) for name, value in given.items()]
    if len({x.shape for x in found}) > 1 or found[0].ndim != 1:
        shapes = ", ".join(f"{name} {x.shape}" for name, x in zip(given, found, strict=True))
        raise InputError(f"{function}: channels must be (N,), with one N; shapes are {shapes}")
    return found


def _labels_of(value: Any) -> list[str]:
    """Labels of a table's columns, or of a series' numbers."""
    labels = getattr(value, "columns", getattr(value, "index", ())) if hasattr(value, "to_numpy") else ()
    return [str(label) for label in labels if isinstance(label, str | tuple)] if isinstance(labels, Iterable) else []


def refused(function: str, name: str, value: Any, rule: str) -> InputError:
    """An error for an argument of the wrong kind: what it must be, and what it is."""
    found = f"an array {value.shape} of {value.dtype}" if isinstance(value, np.ndarray) else shortened(value)
    return InputError(f"{function}: {name} must be {rule}, got {found}", name=name)


def check_kind(function: str, name: str, value: Any, kind: type | tuple[type, ...], rule: str) -> None:
    """Raises InputError for an argument that is not of a kind.  rule: what it must be, in words."""
    if not isinstance(value, kind):
        raise refused(function, name, value, rule)


def check_takes(who: str, function: Any, *arguments: str) -> None:
    """Raises InputError for what is no function of these arguments, in this order.  who: what it is, as 'f: step'."""
    wanted = f"({', '.join(arguments)})"
    if not callable(function):
        raise InputError(f"{who} must be a function of {wanted}, got {shortened(function)}")
    try:
        parameters = signature(function)
    except ValueError:  # no signature to check
        return
    try:
        parameters.bind(*arguments)
    except TypeError:
        raise InputError(f"{who} must take {wanted}, but takes {parameters}") from None


@contextmanager
def given_times(who: str, times: Array) -> Iterator[None]:
    """Errors of a user's own function of time say that it is given many at once.  who: what it is."""
    try:
        yield
    except (TypeError, ValueError) as error:
        if not isinstance(error, InputError):
            rule = "write it with NumPy's functions, and np.where for an if"
            error.add_note(f"{who} is given all times at once, an array of shape {times.shape}: {rule}")
        raise


def check_truths(function: str, **given: Any) -> None:
    """Raises InputError for an argument that is not True or False; a text would be taken as True."""
    for name, value in given.items():
        check_kind(function, name, value, (bool, np.bool_), "True or False")


def path_of(function: str, value: Any, of: str = "a file") -> Path:
    """The argument as a path.  Raises InputError for anything else.  of: what it is the path of."""
    check_kind(function, "path", value, (str, PathLike), f"the path of {of}")
    if isinstance(value, str) and value.lstrip().startswith("<"):
        rule = f"the path of {of}, not its text: write that to a file"
        raise refused(function, "path", value, rule)
    return Path(value)


def number(function: str, name: str, value: Any, unit: str = "") -> float:
    """The argument as a float.  Raises InputError for anything but one real number."""
    is_one = isinstance(value, _REAL) and not isinstance(value, bool)
    if not (is_one or (isinstance(value, np.ndarray) and not value.ndim and value.dtype.kind in "iuf")):
        raise refused(function, name, value, f"one number{unit and f', {unit}'}")
    try:
        return float(value)
    except OverflowError:
        raise refused(function, name, value, f"within {LARGEST:g}") from None


def positive(function: str, name: str, value: Any, unit: str = "") -> float:
    """The argument as a float above zero, not beyond LARGEST.  Raises InputError for anything else."""
    found = number(function, name, value, unit)
    if not 0 < found <= LARGEST:
        rule = f"within {LARGEST:g}" if found > 0 and np.isfinite(found) else "finite"
        raise InputError(f"{function}: {name} {found}{unit and f' {unit}'} must be positive and {rule}", name=name)
    return found


def turns_per_turn(function: str, ratio: Any) -> float:
    """A gear's ratio as a float that is not zero.  Raises InputError for anything else."""
    found = number(function, "ratio", ratio, "motor turns per joint turn")
    if not (np.isfinite(found) and found):
        raise InputError(f"{function}: ratio {found} must be finite and not zero", name="ratio")
    return found


def whole(function: str, name: str, value: Any, least: int = 1) -> int:
    """The argument as a whole number from `least` on.  Raises InputError for anything else."""
    if isinstance(value, bool) or not (isinstance(value, _REAL) and value >= least and value % 1 == 0):
        raise InputError(f"{function}: {name} {value!r} must be a whole number, at least {least}", name=name)
    return int(value)


def checked_name(kind: str, name: Any, known: Collection[str]) -> str:
    """One of the names that are known.  Raises InputError that lists them."""
    if not isinstance(name, str) or name not in known:
        raise unknown_name(kind, name, known)
    return name


def check_choice(function: str, name: str, value: Any, choices: Collection[str]) -> None:
    """Raises InputError for an argument that is none of a few texts."""
    if not isinstance(value, str) or value not in choices:
        *others, last = map(repr, choices)
        raise InputError(f"{function}: {name} {value!r} must be {', '.join(others)} or {last}", name=name)


def checked_names(
    function: str, names: Any, name: str = "joints", rule: str = "names, such as robot.joints"
) -> tuple[str, ...]:
    """The names as a tuple.  Raises InputError for anything else.  name: the argument's; rule: what it must be."""
    try:
        found = tuple(names)
    except TypeError:
        found = (names,)
    if isinstance(names, str) or not all(isinstance(each, str) for each in found):
        raise refused(function, name, names, rule)
    return found


def checked_shape(function: str, name: str, value: Any) -> tuple[int, ...]:
    """The shape of a batch, from a length or several.  Raises InputError."""
    try:
        shape = tuple(map(index, value if isinstance(value, Iterable) else [value]))
    except TypeError:
        shape = (-1,)
    if any(length < 0 for length in shape):
        raise refused(function, name, value, "a whole number from 0, or a tuple of them")
    return shape
