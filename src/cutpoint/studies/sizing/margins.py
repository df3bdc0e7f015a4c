"""Limits against demands: a margin for every stated limit, a name for every one that is not stated."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from cutpoint.arrays import Array
from cutpoint.model import Drive, Limits, Motor, Ratings
from cutpoint.model.units import joint_unit
from cutpoint.studies.sizing.demand import Demand, Peak

ROUNDING = 1e-9
"""A margin that falls short of 1 by less is one that is met exactly."""


OPEN = np.pi
"""rad (m): half of a travel that has no limit on one side."""


@dataclass(frozen=True)
class Margin:
    """A limit and what is asked of it, in `unit`.

    at: the worst instant, None for what is reckoned over the cycle; its value has the same unit, at the same side, and
    is a position where demanded is the distance from the middle of a joint's travel.
    """

    limit: str
    unit: str
    allowed: float
    demanded: float
    at: Peak | None = None

    @property
    def value(self) -> float:
        """allowed / demanded; infinite where nothing is asked."""
        return self.allowed / self.demanded if self.demanded > 0 else np.inf

    @property
    def holds(self) -> bool:
        return self.value >= 1 - ROUNDING


def told(margin: Margin) -> str:
    """Its value in words for a table or a picture, which never round to 1.00 one that fails."""
    words = f"{margin.value:.2f}"
    if words == "1.00" and not margin.holds:
        return "< 1"
    return "> 100" if margin.value > 100 else words


def margins_of(
    drive: Drive, demand: Demand, limits: Limits, travel: tuple[float, float], slides: bool
) -> tuple[list[Margin], list[str]]:
    """Margins against all that is stated, and the names of the ratings that are not.

    limits: of drive and joint together, at the joint's side.  travel: see `travel_of`.
    """
    ratings = drive.ratings or Ratings()
    torque = joint_unit("N m", slides)
    rated = [
        ("average torque", torque, ratings.average_torque, demand.average_torque),
        ("repeated peak torque", torque, ratings.repeated_peak_torque, demand.output_torque),
        ("momentary peak torque", torque, ratings.momentary_peak_torque, demand.output_torque),
        ("average speed", "rad/s", ratings.average_speed, demand.mean_motor_speed),
        ("maximum speed", "rad/s", ratings.maximum_speed, demand.motor_speed),
    ]
    found = [_margin(name, unit, allowed, asked) for name, unit, allowed, asked in rated if allowed is not None]
    found += [*_of_limits(limits, demand, drive.ratio, travel, slides), *_of_motor(drive.motor, demand)]
    missing = [name for name, _, allowed, _ in rated if allowed is None]
    if demand.current_rms is not None:
        if ratings.continuous_current is None:
            missing.append("continuous current")
        else:
            found.append(_margin("continuous current", "A", ratings.continuous_current, demand.current_rms))
    needed = ("life", "rated_torque", "rated_speed")
    return found, missing + [name.replace("_", " ") for name in needed if getattr(ratings, name) is None]


def travel_of(limits: Limits, reached: Array) -> tuple[float, float]:
    """The middle of a joint's travel and half of its length, rad (m); infinite where there is no limit.

    Towards a side without limit it goes OPEN beyond the middle, or so far that positions reached (N,) never come there.
    """
    lower, upper = limits.lower, limits.upper
    if np.isfinite(lower) and np.isinf(upper):
        upper = lower + 2.0 * max(OPEN, float(reached.max()) - lower)
    elif np.isfinite(upper) and np.isinf(lower):
        lower = upper - 2.0 * max(OPEN, upper - float(reached.min()))
    return ((lower + upper) / 2.0, (upper - lower) / 2.0) if np.isfinite(upper - lower) else (0.0, np.inf)


def _of_limits(
    limits: Limits, demand: Demand, ratio: float, travel: tuple[float, float], slides: bool
) -> Iterator[Margin]:
    if np.isfinite(limits.effort):
        at = demand.motor_torque
        at_joint = replace(at, value=at.value * ratio)
        yield _margin("motor torque", joint_unit("N m", slides), limits.effort, at_joint)
    if np.isfinite(limits.velocity):
        yield _margin("joint speed", joint_unit("rad/s", slides), limits.velocity, demand.joint_speed)
    middle, half = travel
    if np.isfinite(half):
        at = demand.position
        yield Margin("joint travel", joint_unit("rad", slides), half, abs(at.value - middle), at)


def _of_motor(motor: Motor | None, demand: Demand) -> Iterator[Margin]:
    if motor is None:
        return
    if motor.current_limit is not None and demand.current is not None:
        yield _margin("motor current", "A", motor.current_limit, demand.current)
    if motor.voltage_limit is not None and demand.voltage is not None:
        yield _margin("motor voltage", "V", motor.voltage_limit, demand.voltage)


def _margin(limit: str, unit: str, allowed: float, demanded: Peak | float) -> Margin:
    if isinstance(demanded, Peak):
        return Margin(limit, unit, allowed, abs(demanded.value), demanded)
    return Margin(limit, unit, allowed, demanded)
