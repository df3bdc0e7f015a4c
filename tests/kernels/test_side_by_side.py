"""Elementary functions of one call in vectors: the bits of those that are computed alone."""

from typing import Any

import numpy as np
import pytest

from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.lowering.lower import lower
from cutpoint.kernels.lowering.side_by_side import side_by_side
from cutpoint.scalars import atan, cos, exp, log, sin, tanh


def nested(x: Any, w: Any) -> Any:
    """Functions of functions, products that sums would take in, and one argument of several functions."""
    turned = [sin(a) * w + cos(a + 1) for a in x]
    grown = [exp(a) * b + tanh(b) for a, b in zip(turned, x, strict=True)]
    return [*turned, *(atan(a * w) + a * w for a in grown), log(abs(w) + 1), sin(w)]


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return compile(nested, x=11, w=())


def test_one_call_gives_the_bits_of_a_batch(kernel: Kernel) -> None:
    rng = np.random.default_rng(1)
    x = rng.uniform(-5, 5, (500, 11)) * 10.0 ** rng.integers(-300, 15, (500, 11))
    x[::7, 3], x[::5, 4], x[::3, 5] = np.nan, np.inf, -0.0
    w = rng.uniform(-3, 3, 500)
    single = [kernel(a, float(b)) for a, b in zip(x, w, strict=True)]
    assert _bits(np.array(single)) == _bits(kernel(x, w))


@pytest.mark.parametrize("width", [2, 4, 8, 16])
def test_every_function_is_in_a_vector_or_in_what_is_left(kernel: Kernel, width: int) -> None:
    parts = side_by_side(kernel.graph, width)
    assert all(2 <= len(group.arguments) <= width for group in parts.groups)
    values = [slot for group in parts.groups for slots in group.values for slot in slots]
    read = {x.args[0] for x in parts.rest.nodes if x.op == "input"}
    assert len(values) == len({*values}) and read - {*range(12)} <= {*values}
    alone = sum(lower(kernel.graph).operations.values())
    assert sum(parts.rest.operations.values()) < 0.5 * alone


def test_arguments_of_a_group_need_no_later_group(kernel: Kernel) -> None:
    parts = side_by_side(kernel.graph, 8)
    known = {*range(12)}
    for group in parts.groups:
        for k in group.arguments:
            assert _slots_under(parts.rest.results[k]) <= known
        known |= {slot for slots in group.values for slot in slots}


def _bits(x: np.ndarray) -> bytes:
    """All NaN are one."""
    return np.where(np.isnan(x), np.nan, x).tobytes()


def _slots_under(x: Any) -> set[int]:
    if x.op == "input":
        return {x.args[0]}
    return set().union(*(_slots_under(y) for y in x.args if hasattr(y, "op")))
