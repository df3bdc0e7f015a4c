"""Random expressions that any scalar can evaluate: finite for finite inputs, continuous where results are compared."""

from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import strategies as st

from cutpoint.scalars import atan, clip, cos, exp, log, maximum, minimum, sin, sqrt, tan, tanh, where

Step = tuple[str, int, int, float]

ONE: dict[str, Callable[[Any], Any]] = {
    "sin": sin, "cos": cos, "atan": atan, "tanh": tanh, "negated": lambda x: -x, "square": lambda x: x * x,
    "tan": lambda x: tan(atan(x) / 2), "exp": lambda x: exp(clip(x, -3.0, 3.0)), "log": lambda x: log(x * x + 0.5),
    "sqrt": lambda x: sqrt(x * x + 1), "inverse": lambda x: 1 / (x * x + 1),
}  # fmt: skip
TWO: dict[str, Callable[[Any, Any], Any]] = {
    "plus": lambda x, y: x + y, "minus": lambda x, y: x - y, "times": lambda x, y: x * y, "least": minimum,
    "most": maximum, "over": lambda x, y: x / (y * y + 1),
}  # fmt: skip
CONSTANT: dict[str, Callable[[Any, float], Any]] = {
    "scaled": lambda x, c: c * x, "shifted": lambda x, c: x + c, "from": lambda x, c: c - x,
    "limited": lambda x, c: clip(x, -abs(c), abs(c)),
}  # fmt: skip
constants = st.sampled_from([0.0, 1.0, -1.0, 2.0, 0.5, -3.25, 0.1]) | st.floats(-4, 4)
steps = st.tuples(st.sampled_from([*ONE, *TWO, *CONSTANT, "where"]), st.integers(0, 60), st.integers(0, 60), constants)


def cook(recipe: list[Step], inputs: list[Any]) -> list[Any]:
    """The last values of a recipe; `where` compares inputs only, which all evaluations agree on."""
    values = [*inputs]
    for op, i, j, c in recipe:
        x, y = values[i % len(values)], values[j % len(values)]
        if op == "where":
            a, b = inputs[i % len(inputs)], inputs[j % len(inputs)]
            values.append(where((~(a <= b) & (a <= c)) | (b > 1), x, y))
        else:
            values.append(ONE[op](x) if op in ONE else TWO[op](x, y) if op in TWO else CONSTANT[op](x, c))
        values[-1] = clip(values[-1], -50.0, 50.0)
    return values[-3:]


UNBOUNDED: dict[str, Callable[[Any, Any, float], Any]] = {
    "root": lambda x, y, c: sqrt(x), "logarithm": lambda x, y, c: log(x), "power": lambda x, y, c: exp(x),
    "tangent": lambda x, y, c: tan(x), "quotient": lambda x, y, c: x / y, "inverted": lambda x, y, c: c / y,
    "chosen": lambda x, y, c: where((x < y) & (y <= c) | ~(x <= c), x * c, y - x),
    "size": lambda x, y, c: abs(x), "cube": lambda x, y, c: x**3,
}  # fmt: skip
unbounded_steps = st.tuples(
    st.sampled_from([*ONE, *TWO, *CONSTANT, *UNBOUNDED]), st.integers(0, 60), st.integers(0, 60), constants
)


def cook_unbounded(recipe: list[Step], inputs: list[Any]) -> list[Any]:
    """The last values of a recipe on traced numbers, where overflow and what is not a number come about and go on."""
    values = [*inputs]
    for op, i, j, c in recipe:
        x, y = values[i % len(values)], values[j % len(values)]
        if op in UNBOUNDED:
            found = UNBOUNDED[op](x, y, c)
        else:
            found = ONE[op](x) if op in ONE else TWO[op](x, y) if op in TWO else CONSTANT[op](x, c)
        # x - x is a plain float already; Python's own functions would refuse some of those
        values.append(x if isinstance(found, float) else found)
    return values[-3:]


def every_turned_sign(x: Any) -> Any:
    """A fused result whose sign is changed, alone and wherever a fused operation changes one; used once each."""
    fused = [a * b + c for a, b, c in zip(x[0:5], x[1:6], x[2:7], strict=True)]
    return [-fused[0], x[7] * x[8] - fused[1], x[7] - fused[2] * x[8], x[8] - fused[3] * fused[4]]


def choices_between_zeros(x: Any) -> Any:
    """Minima, maxima and bounds, which compilers recognise, and zeros of either sign, which they may confuse."""
    q, p = x
    low = [where(q < 0, -0.0, q), where(q <= 0, p, -0.0), where(q > 0, q, -0.0)]
    bounds = [
        maximum(q, -0.0),
        minimum(-0.0, q),
        -maximum(-q, 0.0),
        minimum(0.0, -q),
    ]
    both = [clip(q, -0.0, p), where(-p < q, -p, q), where(q < 0, -q, q)]
    return [*low, *bounds, *both, 1 / where(q < 0, -0.0, q)]


def signed_ones_and_zeros(size: int) -> np.ndarray:
    """Rows for the two functions above, where exact zeros of either sign come about."""
    return np.random.default_rng(2).choice([0.0, -0.0, 1.0, -1.0], (400, size))
