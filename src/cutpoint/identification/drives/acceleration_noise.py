"""The frequency band in which a rotor's differenced acceleration is motion, not encoder noise."""

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.filtering import derivative, low_pass, noise_cutoff

SHAKEN = 1e-3
"""Noise left in a rotor's acceleration, as a share of power, if its encoder resolves the motion that well."""

BANDS = 12
"""Bands that are tried, down to where the motion falls below the noise."""

SECOND_DERIVATIVE = 0.4
"""RMS of differentiated white noise through a filter of order 4 run both ways, over density omega^2 sqrt(Hz) at its
cut-off: the root of the integral of x^4 / (1 + x^8)^2."""


def clear_acceleration(theta: Array, period: float, widest: float, still: float) -> tuple[float, float]:
    """The widest band, Hz, in which a rotor's acceleration is not noise, and the RMS of the noise there, rad/s2.

    Noise grows with frequency faster than the signal; mistaken for motion, it biases rotor inertias towards zero.
    widest: Hz, to start from.  still: Hz, above which nothing moves.
    """
    density = (2.0 * np.pi) ** 2 * noise_density(theta, period, still)
    narrowest = min(noise_cutoff(theta, period, otherwise=widest), widest)
    band, noise = widest, np.inf
    for band in np.geomspace(widest, narrowest, BANDS).tolist():
        noise = SECOND_DERIVATIVE * density * band**2.5
        acceleration = derivative(low_pass(theta, period, band), period, 2)
        if noise**2 < SHAKEN * float(np.nanmean(acceleration**2)):
            break
    return band, noise


def noise_density(values: Array, period: float, band: float) -> float:
    """Density of white noise in values (N,), per root Hz, from what a low-pass removes above a frequency, Hz."""
    rest = values - low_pass(values, period, band)
    return float(np.nanstd(rest) / np.sqrt(0.5 / period - band))
