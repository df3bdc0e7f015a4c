"""Whether torques come later than the motion that they belong to: what a model leaves over then follows their rate."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from cutpoint.identification.rigid.least_squares import least_squares
from cutpoint.identification.rigid.regression import Regression

Array = NDArray[np.float64]

GAP = 1.5
"""Times the usual step: rows farther apart tell no rate."""

CERTAIN = 4.0
"""Standard deviations from which on a delay is said."""

WORTH = 1.5e-3
"""s, from which on it is said: springs and dampers that were not modelled make torques early or late by less."""


def lateness_note(found: Regression, values: Array) -> list[str]:
    """A sentence if torques are clearly late or early against the motion.  values: the parameters (c,)."""
    delay, deviation = lateness(found, values)
    if abs(delay) < max(WORTH, CERTAIN * deviation):
        return []
    when = "later" if delay > 0.0 else "earlier"
    told = f"torques come {1e3 * abs(delay):.2g} +- {1e3 * deviation:.1g} ms {when} than the motion that they belong to"
    return [f"{told}: check the clocks, or align them with torque_delay={-delay:.2g}, --delay {-delay:.2g}"]


def lateness(found: Regression, values: Array) -> tuple[float, float]:
    """s by which all torques are late, and its standard deviation: sought beside all else, to first order."""
    times, told = found.times, found.columns @ values
    rate = np.asarray(CubicSpline(times, told).derivative()(times))
    far = np.diff(times) > GAP * float(np.median(np.diff(times)))
    rate[np.append(far, False) | np.append(False, far)] = 0.0
    columns = np.concatenate([found.columns, -rate[..., None]], axis=2)
    again = least_squares(replace(found, names=(*found.names, "late"), columns=columns), "huber")
    return float(again.values[-1]), float(again.spread.deviations()[-1])
