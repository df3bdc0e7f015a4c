"""Confidence interval for the ratio of two models' errors, with serially correlated errors.

Squared errors of both models are resampled together, in blocks around a circle: Politis and Romano (1992), in
Exploring the Limits of Bootstrap.  A block's length: Politis and White (2004), Econometric Reviews 23(1), as corrected
by Patton, Politis and White (2009), Econometric Reviews 28(4).
"""

from typing import NamedTuple

import numpy as np
from scipy.stats import t

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.correlated_noise import autocorrelations

DRAWS = 1000

LONGER = 3.0
"""Times the block length that is best for the spread: longer blocks improve coverage.  For two equally good models with
errors correlated over up to 20 of 200 or 600 samples, 95 % intervals then contain 1 in 89 to 96 cases of 100."""

FEWEST_BLOCKS = 4

FEWEST = 16
"""Least number of samples for an interval."""

QUIET = 2.0
"""Standard deviations of white noise's correlations: smaller correlations count as zero."""

LEVEL = 0.95
"""Of intervals."""

SEED = 0
"""Of the draws, the same in every run."""

QUIET_LAGS = 5
"""Consecutive correlations of zero that end the errors' memory."""


class Ratio(NamedTuple):
    """Ratio of one model's RMS error to another's, with its interval; NaN if there are too few samples."""

    value: float
    low: float
    high: float

    @property
    def is_less(self) -> bool:
        """Whether the first model's error is significantly smaller."""
        return self.high < 1.0

    @property
    def is_more(self) -> bool:
        """Whether the first model's error is significantly larger."""
        return self.low > 1.0


def error_ratio(first: Array, second: Array) -> Ratio:
    """RMS ratio of two models, from squared errors (N,) at the same ordered times, with its interval.

    The logarithm of the ratio is assumed to follow Student's t, with one degree of freedom less than there are blocks.
    """
    both = np.column_stack([first, second])
    count, (a, b) = len(both), both.sum(axis=0)
    if count < FEWEST or not min(a, b) > 0.0:
        return Ratio(*3 * [float("nan")])
    # how the ratio changes with each sample, to first order
    length = min(int(np.ceil(LONGER * block_length(first - a / b * second))), count // FEWEST_BLOCKS)
    # means of few blocks scatter less about the mean of all than about the truth
    spread = _spread(both, length) / np.sqrt(1.0 - length / count)
    reach = float(t.ppf(0.5 + 0.5 * LEVEL, count / length - 1.0)) * spread
    value = np.sqrt(a / b)
    return Ratio(float(value), float(value * np.exp(-reach)), float(value * np.exp(reach)))


def _spread(both: Array, length: int) -> float:
    """Standard deviation of the logarithm of the ratio, for squares (N, 2) resampled in blocks of a length."""
    count = len(both)
    sums = np.cumsum(np.concatenate([np.zeros((1, 2)), both, both[:length]]), axis=0)
    blocks = sums[length:] - sums[:-length]
    starts = np.random.default_rng(SEED).integers(0, count, (DRAWS, -(-count // length)))
    drawn = np.maximum(blocks[starts].sum(axis=1), np.finfo(float).tiny)
    return float(np.std(0.5 * np.log(drawn[:, 0] / drawn[:, 1])))


def block_length(x: Array) -> float:
    """Block length, in samples, that is best for the spread of the mean of x (N,), 1 at least."""
    count = x.size
    R = autocorrelations(x - x.mean()) / count
    lags = min(2 * _memory(R), count - 1)
    k = np.arange(1, lags + 1)
    # flat up to half of the lags, then falling to zero
    weighted = 2.0 * np.clip(2.0 * (1.0 - k / lags), 0.0, 1.0) * R[k]
    g, G = R[0] + weighted.sum(), (k * weighted).sum()
    wanted = (1.5 * count) ** (1.0 / 3.0) * np.abs(G / g) ** (2.0 / 3.0) if g else 1.0
    return float(np.clip(wanted, 1.0, min(3.0 * np.sqrt(count), count / 3.0)))


def _memory(R: Array) -> int:
    """The lag, 1 at least, after which the correlations of autocovariances R (N,) are insignificant."""
    count = R.size
    loud = np.abs(R) >= QUIET * np.sqrt(np.log10(count) / count) * R[0]
    most = min(int(np.sqrt(count)) + QUIET_LAGS, count - QUIET_LAGS - 1)
    ends = (m for m in range(1, most) if not loud[m + 1 : m + 1 + QUIET_LAGS].any())
    return next(ends, max(most, 1))
