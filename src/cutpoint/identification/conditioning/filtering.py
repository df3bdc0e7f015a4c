"""Zero-phase low-pass filtering and differentiation with a stated bandwidth, never across a gap."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import binary_erosion
from scipy.signal import butter, sosfiltfilt, welch

from cutpoint.arrays import Array
from cutpoint.door import checked_numbers, number, positive, whole
from cutpoint.errors import InputError, counted
from cutpoint.identification.logs.recording import Recording, check_recording

ORDER = 4
"""Order of the Butterworth filter, which runs forwards and backwards."""

CUT_PERIODS = 1.5
"""Periods of the cut-off that are cut at each end and beside each gap, where the filter lacks earlier samples.  After
that, the step response has settled to 1 %, at the default order."""

ABOVE_FLOOR = 10.0
"""Times the noise floor's power: lines above this are motion."""

MOTION_ENDS = 4.0
"""Motion ends where nothing exceeds the noise up to this many times the frequency.  Its harmonics are nearer."""

FEWEST = 3
"""Samples of a central difference."""

STILL = 1e-3
"""Share of the liveliest channel's travel: a channel that travels less stands still, and has only noise."""

LITTLE = 0.01
"""rad or m: a channel that travels this far moves, however far others travel."""

CLEAR = 1e3
"""Times the noise floor's power: motion above this must not be attenuated."""

LOSS = 0.1
"""Power of clear lines that the filter may remove, as a share of the noise power that it leaves.  Noise averages out, a
loss does not."""

FINER = 2.0**0.125
"""Ratio of successive cut-offs that are tried."""

WINDOWS = 4
"""Windows over a recording for its spectrum, overlapping by half."""

LOWEST_CYCLES = 4.0
"""Least number of cycles of the default cut-off in a recording."""

HIGHEST = 0.4
"""Largest default cut-off, as a share of the sampling rate."""


def low_pass(values: ArrayLike, period: float, cutoff: float, order: int = ORDER) -> Array:
    """Values (N, ...) low-passed at a cut-off without phase lag; NaN at edges.

    A Butterworth filter forwards and backwards: a component at the cut-off (Hz) is halved, one at frequency f keeps
    1 / (1 + (f / cutoff)^(2 order)).  A stretch between gaps that is shorter than its edge losses is NaN.

    Raises:
        InputError: a cut-off that is not between 0 and half of the sampling rate, or other invalid arguments.
    """
    period, cutoff = positive("low_pass", "period", period, "s"), number("low_pass", "cutoff", cutoff, "Hz")
    values, order = _samples("low_pass", values), whole("low_pass", "order", order)
    if not 0.0 < cutoff < 0.5 / period:
        raise InputError(f"cut-off {cutoff} Hz must lie between 0 and {0.5 / period:g} Hz, half the sampling rate")
    sections = butter(order, cutoff, fs=1.0 / period, output="sos")
    edge = _edge(period, cutoff)
    found = np.full(values.shape, np.nan)
    for column, result in zip(values.reshape(len(values), -1).T, found.reshape(len(found), -1).T, strict=True):
        for part in _parts(column):
            if part.stop - part.start > 2 * edge:
                smooth = sosfiltfilt(sections, column[part], padlen=min(3 * edge, part.stop - part.start - 1))
                result[part.start + edge : part.stop - edge] = smooth[edge:-edge]
    return found


def low_pass_together(channels: Sequence[Array], period: float, cutoff: float) -> list[Array]:
    """Channels (N,) of one linear equation, low-passed together, so that it still holds.

    Samples unknown in one are left out of all, so that all begin and end at the same samples.  Edges are cut by half as
    much again, for channels that are differentiated later.
    """
    columns = np.column_stack(channels)
    columns[~np.isfinite(columns).all(axis=1)] = np.nan
    found = low_pass(columns, period, cutoff)
    inside = binary_erosion(np.isfinite(found[:, 0]), np.ones(2 * (_edge(period, cutoff) // 2) + 1))
    return [*np.where(inside[:, None], found, np.nan).T]


def derivative(values: ArrayLike, period: float, order: int = 1) -> Array:
    """First or second time derivative of values (N, ...) by central differences; NaN at edges and beside gaps.

    period: s between samples.  order: 1 or 2.
    A component at a tenth of the sampling rate is scaled by 0.935 (0.967 for the second derivative), slower ones by
    nearly 1, and noise grows with its frequency: low-pass first.

    Raises:
        InputError: fewer than 3 samples, no numbers, a period that is not positive, or another order.
    """
    if whole("derivative", "order", order) > 2:
        raise InputError(f"derivative: order {order} must be 1 or 2", order=order)
    values, period = _samples("derivative", values), positive("derivative", "period", period, "s")
    if len(values) < FEWEST:
        raise InputError(f"derivative: values has {counted(len(values), 'sample')}; at least {FEWEST} are needed")
    found = np.full(values.shape, np.nan)
    if order == 1:
        found[1:-1] = (values[2:] - values[:-2]) / (2.0 * period)
    else:
        found[1:-1] = (values[2:] - 2.0 * values[1:-1] + values[:-2]) / period**2
    return found


def noise_cutoff(values: ArrayLike, period: float, *, otherwise: float | None = None) -> float:
    """Hz, where the motion in values (N, ...) falls below their noise: the highest of all moving columns.

    The noise floor is the median power density of the upper half of the spectrum, of the longest stretch without gaps;
    lines ten times above it are motion, up to the first gap beyond the strongest one.  The cut-off is there, or higher
    if needed to leave clear lines, a thousand times above the floor, unattenuated.  Motion below the floor is lost.
    otherwise: Hz, result if nothing exceeds the noise; None raises an error instead.

    Raises:
        InputError: no column moves, or none exceeds its noise.
    """
    values, period = _samples("noise_cutoff", values), positive("noise_cutoff", "period", period, "s")
    columns = [column[_longest(column)] for column in values.reshape(len(values), -1).T]
    ways = np.array([np.ptp(x) if x.size >= 16 * WINDOWS else 0.0 for x in columns])
    found = [_cutoff(x, period) for x, way in zip(columns, ways, strict=True) if way > min(STILL * ways.max(), LITTLE)]
    if not any(found) and otherwise is not None:
        return otherwise
    if not any(found):
        rule = f"no column stands out from its noise over {16 * WINDOWS} samples or more without a gap"
        remedy = "did anything move?  Record more, map another channel, or state a cut-off in Hz"
        raise InputError(f"{rule}, of {len(values)}: {remedy}")
    return max(found)


def low_passed(recording: Recording, cutoff: float | None = None) -> Recording:
    """All channels through one filter, so that linear relations between them still hold.

    cutoff: Hz; by default where the positions fall below their noise, see `noise_cutoff`.

    Raises:
        InputError: times that are not uniform, or a cut-off that is out of bounds.
    """
    check_recording("low_passed", recording)
    period = recording.period
    if cutoff is None:
        positions = [values for name, values in recording.channels.items() if name in ("q", "theta")]
        cutoff = noise_cutoff(np.column_stack(positions or [*recording.channels.values()]), period)
    found = recording.with_channels(lambda values: low_pass(values, period, cutoff))
    return found.with_notes([f"low-passed at {cutoff:.4g} Hz, zero phase, order {ORDER} in each direction"])


def _samples(function: str, values: ArrayLike) -> Array:
    """The values as an array (N, ...), N at least 1.  Raises InputError."""
    array = checked_numbers(function, "values", values)
    if not array.ndim or not len(array):
        raise InputError(f"{function}: values have shape {array.shape}: they must be (N, ...)", shape=array.shape)
    return array


def _edge(period: float, cutoff: float) -> int:
    return int(np.ceil(CUT_PERIODS / (cutoff * period)))


def _cutoff(x: Array, period: float) -> float:
    """The cut-off of one channel (N,); 0 if all of it is noise."""
    window = 2 * x.size // (WINDOWS + 1)
    frequencies, power = welch(x, 1.0 / period, window="blackmanharris", nperseg=window, detrend="linear")
    floor = float(np.median(power[power.size // 2 :]))
    loud = power > ABOVE_FLOOR * floor
    if not loud.any():
        return 0.0
    peak, highest = int(np.argmax(power)), HIGHEST / period
    quiet = np.flatnonzero(~loud[peak:])
    cutoff = max(float(frequencies[peak + quiet[0]]), LOWEST_CYCLES / (x.size * period)) if quiet.size else highest
    lines = _lines(loud, power > CLEAR * floor, peak)
    motion, at = power[lines] * frequencies[1], frequencies[lines]
    while cutoff < highest and _lost(motion, at / cutoff) > LOSS * floor * cutoff:
        cutoff *= FINER
    return min(cutoff, highest)


def _lines(loud: NDArray[np.bool_], clear: NDArray[np.bool_], peak: int) -> NDArray[np.intp]:
    """Clear bins of a spectrum up to the end of the motion: from the peak on, each loud bin is at less than MOTION_ENDS
    times the frequency of the one before."""
    found = np.flatnonzero(loud)
    gaps = np.flatnonzero((found[1:] > MOTION_ENDS * (found[:-1] + 1)) & (found[:-1] >= peak))
    end = found[gaps[0]] if gaps.size else found[-1]
    return np.flatnonzero(clear[: end + 1])


def _lost(power: Array, ratios: Array) -> float:
    """Power above the cut-off that the filter removes."""
    return float(np.sum(power * (1.0 - 1.0 / (1.0 + ratios ** (2 * ORDER))) ** 2))


def _longest(column: Array) -> slice:
    return max(_parts(column), key=lambda part: part.stop - part.start, default=slice(0, 0))


def _parts(column: Array) -> list[slice]:
    """The stretches without NaN of values (N,)."""
    return np.ma.clump_unmasked(np.ma.masked_invalid(column))
