"""The required velocity, which pulls the actual motion towards the desired one.  Xia (2019) eq. (12)."""

from collections.abc import Sequence
from typing import Any

from cutpoint.scalars import Jet


def required_rates(position_gain: Any, desired: Sequence[Any], actual: Sequence[Any]) -> list[Any]:
    """v_r = v_d + Lambda (q_d - q) and its derivatives, (n,) each, as many as `actual` has.  Xia (2019) eq. (12).

    position_gain: Lambda, 1/s.  desired: q_d, v_d and its derivatives, one more than actual: q, v and its derivatives;
    (n,) each.
    """
    return [d_next + position_gain * (d - x) for d, d_next, x in zip(desired, desired[1:], actual, strict=False)]


def required_velocity(position_gain: Any, desired: Sequence[Any], actual: Sequence[Any]) -> list[Jet]:
    """The same, with its derivatives in a jet for each joint."""
    return [Jet(*x) for x in zip(*required_rates(position_gain, desired, actual), strict=True)]
