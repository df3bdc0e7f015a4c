"""A smooth motion near given samples, such as a planner's output or a recording."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.door import checked_names, number
from cutpoint.errors import InputError
from cutpoint.trajectories.arrays import Array, joint_name, timed_positions
from cutpoint.trajectories.penalty import smoothing_spline
from cutpoint.trajectories.spline import Spline, check_swing

DEFAULT_BANDWIDTH = 10.0
"""Hz: above what an arm's motion holds, below most of what its encoders' noise holds."""

FEWEST_SAMPLES = 4


@dataclass(frozen=True)
class Deviation:
    """How far a smoothed motion lies from its samples, per joint (n,), rad (m): largest absolute value and RMS."""

    max: Array
    rms: Array


@dataclass(frozen=True, eq=False)
class Smoothed(Spline):
    """A spline near samples.  `bandwidth` in Hz; `joints` holds their names, and is empty where none were given."""

    bandwidth: float
    joints: tuple[str, ...]
    deviation: Deviation

    def __str__(self) -> str:
        worst = int(np.argmax(self.deviation.max))
        rms = float(self.deviation.rms[worst])
        return (
            f"smoothed to {self.bandwidth:.3g} Hz: deviates from its samples by at most "
            f"{self.deviation.max[worst]:.3g} rad (m), {rms:.3g} RMS, at {joint_name(self.joints, worst)}"
        )


def from_samples(
    t: ArrayLike,
    q: ArrayLike,
    *,
    bandwidth: float | None = None,
    at_rest: bool = True,
    joints: Sequence[str] | None = None,
) -> Smoothed:
    """A motion with six continuous derivatives near the positions q (N, n), rad (m), at the times t (N,), s.

    Prints one line with its deviation from the samples, which `.deviation` holds per joint.

    Args:
        t: strictly increasing, evenly spaced or not; the motion's time counts from the first.
        q: at least 4 samples.
        bandwidth: Hz.  A component of this frequency is halved, one of a quarter of it keeps all but 2e-5, and noise
            above it fades.  By default 10 Hz, or a quarter of the mean sampling rate where that is lower.
        at_rest: whether the motion starts and ends at rest, its first four derivatives zero there.  Otherwise it may
            start and end with a jump to the standstill that every trajectory holds outside its duration.
        joints: names, for messages.

    Raises:
        InputError: too few samples, times that do not increase, numbers that are not finite, shapes that do not match,
            a bandwidth above half of the mean sampling rate or below half a period in the whole duration, or a pause in
            which the motion would leave the range of its samples by more than that range.
    """
    names = None if joints is None else checked_names("from_samples", joints)
    times, samples = timed_positions(t, q, FEWEST_SAMPLES, names)
    chosen = _bandwidth(bandwidth, times)
    moved = samples - samples[0]
    try:
        spline, spacing = smoothing_spline(times, moved, chosen, at_rest)
    except np.linalg.LinAlgError as error:
        raise InputError(f"from_samples: no one motion is near all samples; {_pause(times)}") from error
    check_swing(spline, times / spacing, samples, _pause(times))
    errors = spline(times / spacing) - moved
    deviation = Deviation(np.abs(errors).max(axis=0), np.sqrt(np.mean(errors**2, axis=0)))
    smoothed = Smoothed(float(times[-1]), samples[0], spline, spacing, chosen, names or (), deviation)
    print(smoothed)
    return smoothed


def _pause(times: Array) -> str:
    """Where samples are farthest apart, and what to do."""
    steps = np.diff(times)
    k = int(np.argmax(steps))
    found = f"between {times[k]:.6g} and {times[k + 1]:.6g} s there are none, elsewhere one in {np.median(steps):.3g} s"
    return f"{found}: cut them there, or add some between"


def _bandwidth(wanted: float | None, times: Array) -> float:
    duration = float(times[-1])
    lowest, highest = 0.5 / duration, 0.5 * (times.size - 1) / duration
    if wanted is None:
        return float(np.clip(DEFAULT_BANDWIDTH, lowest, highest / 2.0))
    wanted = number("from_samples", "bandwidth", wanted, "Hz")
    if not lowest <= wanted <= highest:
        raise InputError(
            f"bandwidth {wanted} Hz must lie between {lowest:.3g} Hz, half a period in {duration:.6g} s, "
            f"and {highest:.6g} Hz, half of the sampling rate",
            bandwidth=wanted,
        )
    return wanted
