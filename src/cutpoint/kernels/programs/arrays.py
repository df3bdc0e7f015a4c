"""Arguments of a program's run, checked before machine code sees a pointer."""

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

import numpy as np

from cutpoint.errors import InputError, unknown_name
from cutpoint.kernels.programs.plan import Plan
from cutpoint.kernels.programs.stepping import View, number_of


def check_run(plan: Plan, counts: Mapping[str, int], arrays: Mapping[str, np.ndarray]) -> None:
    """Checks that counts and arrays are complete, without extras, and that arrays fit their regions and don't overlap.

    Raises:
        InputError: naming the count or array, what was found and what it must be.
    """
    _check_names("count", counts, plan.counts)
    for name, count in counts.items():
        if not isinstance(count, (int, np.integer)) or not 0 <= count < 2**63:
            raise InputError(f"count {name!r} is {count!r}, but must be a whole number of 0 or more", name=name)
    _check_names("array", arrays, plan.names)
    for name in plan.regions:
        _check_kind(name, arrays[name], written=name in plan.written)
        _check_size(name, arrays[name], plan, counts)
    for view in plan.views.values():
        rows = len(arrays[view.of]) * (plan.regions[view.of].lanes if view.name in plan.single_views else 1)
        _check_rows(view, arrays[view.index], rows, _most(plan.indices[view.index], counts))
    _check_apart(plan, arrays)


def _check_names(kind: str, given: Mapping[str, Any], expected: Any) -> None:
    for name in given:
        if name not in expected:
            raise unknown_name(kind, name, expected)
    for name in expected:
        if name not in given:
            raise InputError(f"{kind} {name!r} is missing", name=name)


def _check_kind(name: str, array: Any, *, written: bool) -> None:
    if not isinstance(array, np.ndarray) or array.dtype != np.float64 or not array.dtype.isnative:
        found = array.dtype if isinstance(array, np.ndarray) else type(array).__name__
        raise InputError(f"region {name!r} must be an array of float64, not {found}", name=name)
    if not (array.flags.c_contiguous and array.flags.aligned):
        raise InputError(f"region {name!r} must be C-contiguous and aligned; see np.ascontiguousarray", name=name)
    if written and not array.flags.writeable:
        raise InputError(f"region {name!r} is written, but its array is read-only", name=name)


def _check_size(name: str, array: np.ndarray, plan: Plan, counts: Mapping[str, int]) -> None:
    size = plan.sizes[name]
    if name not in plan.streamed:
        if array.size != size:
            raise InputError(f"region {name!r} has {size} slots, but its array holds {array.size} numbers", name=name)
        return
    ways = plan.streamed[name]
    rows = max((-(-prod(number_of(c, counts) for c in way.often) // way.steps) for way in ways), default=0)
    if array.ndim != 2 or array.shape[1] != size or len(array) < rows:
        raise InputError(
            f"region {name!r} streams: its array has shape {array.shape}, but must have at least {rows} rows of {size}",
            name=name,
        )


def _check_rows(view: View, index: Any, rows: int, count: int) -> None:
    """Checks that a list of rows is within bounds."""
    name = view.index
    if not isinstance(index, np.ndarray) or index.dtype != np.int64 or not index.flags.c_contiguous or index.ndim != 1:
        raise InputError(f"list of rows {name!r} must be a contiguous array (n,) of int64", name=name)
    if len(index) < count:
        raise InputError(f"list of rows {name!r} has {len(index)} entries, but must have at least {count}", name=name)
    used = index[:count]
    if count and not (used.min() >= 0 and used.max() < rows):
        wrong = int(used[(used < 0) | (used >= rows)][0])
        raise InputError(f"list of rows {name!r} names row {wrong}; region {view.of!r} has rows 0 to {rows - 1}")


def _most(several: Sequence[int | str], counts: Mapping[str, int]) -> int:
    return max(number_of(c, counts) for c in several)


def _check_apart(plan: Plan, arrays: Mapping[str, np.ndarray]) -> None:
    """Checks that no array overlaps another, unless both are only read."""
    starts = [(a.ctypes.data, a.nbytes, name) for name, a in arrays.items() if a.nbytes]
    spans = sorted((start, start + size, name) for start, size, name in starts)
    reach, owner = 0, ""
    for start, end, name in spans:
        if start < reach and (name in plan.written or owner in plan.written):
            raise InputError(f"regions {owner!r} and {name!r} share memory", names=(owner, name))
        reach, owner = max((reach, owner), (end, name))
