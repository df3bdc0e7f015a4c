"""Derivatives of a command by a filter, for when no model gives them.

The filter z'' = w^2 (u - z) - 2 w z' is critically damped; between samples u is held and the step is exact, so no
bandwidth makes it unstable.  z lags u by 2 / w.  Farrell, Polycarpou, Sharma and Dong (2009).
"""

from typing import Any, NamedTuple

from cutpoint.scalars import Jet, Scalar, exp, where


class FilterState(NamedTuple):
    """z and z' of each command; started is 0 until the first sample, which sets z."""

    value: Any
    rate: Any
    started: Any


def start(size: int) -> FilterState:
    return FilterState([0.0] * size, [0.0] * size, 0.0)


def step(state: FilterState, commands: list[Scalar], omega: Scalar, period: Scalar) -> tuple[FilterState, list[Jet]]:
    """The state a period later, and each filtered command with two derivatives.  omega: rad/s; period: s."""
    decay, x = exp(-omega * period), omega * period
    found, values, rates = [], [], []
    for u, z_before, rate in zip(commands, state.value, state.rate, strict=True):
        z = where(state.started > 0, z_before, u)
        found.append(Jet(z, rate, omega * omega * (u - z) - 2 * omega * rate))
        values.append(u + ((z - u) * (1 + x) + rate * period) * decay)
        rates.append((rate * (1 - x) - omega * x * (z - u)) * decay)
    return FilterState(values, rates, 1.0), found
