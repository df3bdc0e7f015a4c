"""A smooth motion near given samples, such as a planner's output or a recording."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.callers import warn
from cutpoint.door import check_truths, checked_names, number
from cutpoint.errors import InputError
from cutpoint.trajectories.arrays import joint_name, timed_positions
from cutpoint.trajectories.spline import Spline, check_swing

DEFAULT_BANDWIDTH = 10.0
"""Hz: above what an arm's motion holds, below most of what its encoders' noise holds."""

FEWEST_SAMPLES = 4

COARSE_SHARE = 0.05
"""Share of a joint's range: samples so coarse that the motion leaves them by more are no samples of it."""

NOISE_SHARE = 0.01
"""Share of the largest range of all joints: what moves by less may be noise."""

LEAST = 1e-4
"""rad (m): by so much noise may be smoothed away."""

HOLE = 5.0
"""Times as long as between most samples: what is not sampled for longer is a gap."""

HURRIED = 1.2
"""Times the peak acceleration that a motion may take to start and end at rest, without being told of."""


@dataclass(frozen=True)
class Deviation:
    """Deviation of a smoothed motion from its samples, per joint (n,), rad (m): largest absolute value and RMS."""

    max: Array
    rms: Array


@dataclass(frozen=True, eq=False)
class Smoothed(Spline):
    """A spline near samples.

    Attributes:
        bandwidth: Hz.
        joints: their names; empty if none were given.
        deviation: from the samples.
        hurry: (n,) peak accelerations relative to a motion that need not start and end at rest; 1 for joints that
            hardly move.
        gap: start and end, s, of the longest time without samples, if the motion could oscillate in it; else None.
    """

    bandwidth: float
    joints: tuple[str, ...]
    deviation: Deviation
    hurry: Array
    gap: tuple[float, float] | None = None

    def __str__(self) -> str:
        worst = int(np.argmax(self.deviation.max))
        rms = float(self.deviation.rms[worst])
        return (
            f"motion of {self.duration:.6g} s, smoothed to {self.bandwidth:.3g} Hz: deviates from its samples by at "
            f"most {self.deviation.max[worst]:.3g} rad (m), {rms:.3g} RMS, at {joint_name(self.joints, worst)}"
        )


def from_samples(
    times: ArrayLike,
    q: ArrayLike,
    *,
    bandwidth: float | None = None,
    at_rest: bool = True,
    joints: Sequence[str] | None = None,
) -> Smoothed:
    """A motion with six continuous derivatives near the positions q (N, n), rad (m), at these times (N,), s.

    Printing it shows the deviation from the samples, `.deviation` gives it for each joint.  Warnings report an abrupt
    start or end that raises accelerations, and a gap among the samples in which the motion is a guess.

    Args:
        times: strictly increasing, evenly spaced or not; the motion's time counts from the first.
        q: at least 4 samples.
        bandwidth: Hz.  A component of this frequency is halved, one of a quarter of it keeps all but 2e-5, and noise
            above it fades.  By default 10 Hz, or a quarter of the mean sampling rate where that is lower.
        at_rest: whether the motion starts and ends at rest, its first four derivatives zero there.  If samples start
            abruptly, it has to catch up with them.  Otherwise it may jump in velocity at start and end, since every
            trajectory stands still outside its duration.
        joints: names, for messages.

    Raises:
        InputError: too few samples, times that do not increase, numbers that are not finite, shapes that do not match,
            a bandwidth above half of the mean sampling rate or below half a period in the whole duration, samples that
            are too coarse for the default one (the motion leaves them by more than 5 % of a joint's range), or a pause
            in which the motion would leave the range of its samples by more than that range.
    """
    from cutpoint.trajectories.penalty import peak_accelerations, smoothing_spline  # with SciPy slow to import

    check_truths("from_samples", at_rest=at_rest)
    names = None if joints is None else checked_names("from_samples", joints)
    t, samples = timed_positions(times, q, FEWEST_SAMPLES, names)
    chosen = _bandwidth(bandwidth, t)
    moved = samples - samples[0]
    try:
        spline, spacing = smoothing_spline(t, moved, chosen, at_rest)
        free = smoothing_spline(t, moved, chosen, at_rest=False)[0] if at_rest else spline
    except np.linalg.LinAlgError as error:
        raise InputError(f"from_samples: no single motion is near all samples; {_pause(t)}") from error
    check_swing(spline, t / spacing, samples, _pause(t), names)
    errors = spline(t / spacing) - moved
    deviation = Deviation(np.abs(errors).max(axis=0), np.sqrt(np.mean(errors**2, axis=0)))
    ranges = np.ptp(samples, axis=0)
    if bandwidth is None:
        _check_near(deviation.max, ranges, chosen, names)
    peaks, least = peak_accelerations(spline), np.maximum(peak_accelerations(free), 1e-300)
    hurry = np.where(ranges > NOISE_SHARE * ranges.max(), peaks / least, 1.0)
    parts = (spline, spacing, chosen, names or (), deviation, hurry, _gap(t, chosen))
    smoothed = Smoothed(float(t[-1]), samples[0], *parts)
    _warn_of(smoothed)
    return smoothed


def _warn_of(found: Smoothed) -> None:
    """Warns of abrupt starts and ends, and of gaps among the samples."""
    hurried = int(np.argmax(found.hurry))
    if found.hurry[hurried] > HURRIED:
        cost = f"takes {found.hurry[hurried]:.3g} times the acceleration at {joint_name(found.joints, hurried)}"
        remedy = f"begin and end with samples at rest for {1.0 / found.bandwidth:.3g} s"
        warn(f"to start and end at rest the smoothed motion {cost}: {remedy}")
    if found.gap is not None:
        start, end = found.gap
        warn(f"there are no samples from {start:.6g} to {end:.6g} s: the smoothed motion is a guess there")


def _check_near(deviation: Array, ranges: Array, bandwidth: float, names: Sequence[str] | None) -> None:
    """Raises InputError if the motion is far from its samples at the default bandwidth."""
    far = deviation > np.maximum(COARSE_SHARE * ranges, max(NOISE_SHARE * ranges.max(), LEAST))
    if not far.any():
        return
    joint = int(np.argmax(np.where(far, deviation / np.maximum(ranges, 1e-300), 0.0)))
    raise InputError(
        f"smoothed to {bandwidth:.3g} Hz the motion leaves its samples by {deviation[joint]:.3g} rad (m), where "
        f"{joint_name(names, joint)} moves by {ranges[joint]:.3g}: give samples closer in time, or a bandwidth "
        "(--smoothing); in Python, at_rest=False for a motion cut out of a longer one, or `waypoints` to pass through",
        joint=joint,
        deviation=float(deviation[joint]),
    )


def _gap(times: Array, bandwidth: float) -> tuple[float, float] | None:
    """The longest time without samples, s, if it is exceptional and longer than a period of the bandwidth."""
    steps = np.diff(times)
    k = int(np.argmax(steps))
    if steps[k] <= max(HOLE * float(np.median(steps)), 1.0 / bandwidth):
        return None
    return float(times[k]), float(times[k + 1])


def _pause(times: Array) -> str:
    """Text about where samples are farthest apart, and what to do."""
    steps = np.diff(times)
    k = int(np.argmax(steps))
    found = (
        f"there are none between {times[k]:.6g} and {times[k + 1]:.6g} s, elsewhere one every {np.median(steps):.3g} s"
    )
    return f"{found}: cut them there, or add some"


def _bandwidth(wanted: float | None, times: Array) -> float:
    duration = float(times[-1])
    lowest, highest = 0.5 / duration, 0.5 * (times.size - 1) / duration
    if wanted is None:
        return float(np.clip(DEFAULT_BANDWIDTH, lowest, highest / 2.0))
    wanted = number("from_samples", "bandwidth", wanted, "Hz")
    if not lowest <= wanted <= highest:
        raise InputError(
            f"bandwidth {wanted} Hz (--smoothing) must lie between {lowest:.3g} Hz, half a period in {duration:.6g} s, "
            f"and {highest:.6g} Hz, half of the sampling rate",
            bandwidth=wanted,
        )
    return wanted
