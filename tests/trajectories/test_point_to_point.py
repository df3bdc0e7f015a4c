"""The cycloid, the quintic and the septic."""

from collections.abc import Callable

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from cutpoint.errors import InputError
from cutpoint.trajectories import Trajectory, cycloid, quintic, septic

x = sympy.Symbol("x")
PROFILES = {
    cycloid: x - sympy.sin(2 * sympy.pi * x) / (2 * sympy.pi),
    quintic: 10 * x**3 - 15 * x**4 + 6 * x**5,
    septic: 35 * x**4 - 84 * x**5 + 70 * x**6 - 20 * x**7,
}
STILL = {cycloid: 2, quintic: 2, septic: 3}
kinds = pytest.mark.parametrize("kind", PROFILES)
Kind = Callable[..., Trajectory]


@kinds
def test_derivatives_of_any_order_are_those_of_the_formula(kind: Kind):
    start, end, duration = np.array([0.3, -1.0]), np.array([-0.5, 2.0]), 0.7
    times = duration * np.array([0.0, 1e-9, 0.1, 0.5, 0.83, 1.0])
    found = kind(end, duration, start=start).derivatives(times, 14)
    for k in range(15):
        slope = sympy.lambdify(x, sympy.diff(PROFILES[kind], x, k), "mpmath")
        profile = np.array([float(slope(u)) for u in times / duration]) / duration**k
        expected = profile[:, None] * (end - start) + (start if k == 0 else 0.0)
        assert np.allclose(found[k], expected, rtol=1e-12, atol=1e-13 * 7.0**k / duration**k)


@kinds
def test_it_starts_and_ends_where_told_and_at_rest(kind: Kind):
    found = kind([1.0, -2.0], 3.0, start=[0.5, 0.0]).derivatives([0.0, 3.0], 5)
    assert np.array_equal(found[0], [[0.5, 0.0], [1.0, -2.0]])
    still = STILL[kind]
    assert np.abs(found[1 : still + 1]).max() < 1e-14
    assert np.abs(found[still + 1]).min() > 0.1


@kinds
@given(u=st.floats(0.0, 1.0))
def test_the_way_back_is_the_way_there_in_reverse(kind: Kind, u: float):
    there, back = kind([1.0], 2.0), kind([0.0], 2.0, start=[1.0])
    # the septic's coefficients add up to 209 in absolute value, and as many eps is what its terms leave
    assert np.allclose(there(2.0 * u).q, back(2.0 - 2.0 * u).q, rtol=0.0, atol=1e-13)


@kinds
def test_without_a_start_it_starts_at_zero(kind: Kind):
    assert np.array_equal(kind([1.0, 2.0], 1.0)(0.0).q, [0.0, 0.0])


@kinds
def test_the_callers_array_may_change_afterwards(kind: Kind):
    end = np.array([1.0])
    trajectory = kind(end, 1.0)
    end[0] = 5.0
    assert trajectory(1.0).q == [1.0]


@kinds
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([1.0], 0.0), r"duration 0.0 s must be positive and finite"),
        (([1.0], -1.0), r"duration -1.0 s must be positive and finite"),
        (([1.0], np.nan), r"duration nan s must be positive and finite"),
        (([1.0, np.inf], 1.0), r"end of joint 1 is inf: it must be finite"),
        (([1.0], 1.0, [np.nan]), r"start of joint 0 is nan: it must be finite"),
        (([1.0], 1.0, [1.0, 2.0]), r"start has 2 joints and end has 1: the numbers must match"),
        ((1.0, 1.0), r"end has shape \(\): it must be a list of one position per joint"),
        (([], 1.0), r"end has shape \(0,\)"),
        (([[1.0]], 1.0), r"end has shape \(1, 1\)"),
        (([1.0], "10"), r"(cycloid|quintic|septic): duration must be one number, s, got '10'"),
        (([1.0], None), r"duration must be one number, s"),
        (([1.0], [1.0, 2.0]), r"duration must be one number, s"),
        ((["near"], 1.0), r"end must be an array of numbers"),
    ],
)
def test_what_cannot_be_a_motion_is_refused(kind: Kind, arguments: tuple, message: str):
    with pytest.raises(InputError, match=message):
        kind(*arguments)
