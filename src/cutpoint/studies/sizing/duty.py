"""Averages over a cycle, and the life that goes with them, as makers of strain wave gears reckon them.

A cycle is a list of samples; each stands for a duration, s, so that phases of a load diagram serve as well as instants.
Harmonic Drive AG, engineering data of component sets CSD-2A, 1019659 (11/2014), page 20, with equations 18.2 and 18.5
to which it refers; Harmonic Drive LLC, CSF CSG, page 14 of the viewer, equation 8.
"""

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array

MOST_PEAKS = 1e4
"""Load changes that a flexspline survives at its momentary peak torque; each turn of the wave generator makes two."""


def mean(duration: Array, x: Array) -> float:
    """Of |x|, pauses included; of a speed, the n_av of the life."""
    return float(duration @ np.abs(x) / duration.sum())


def rms(duration: Array, x: Array) -> float:
    return float(np.sqrt(duration @ (x * x) / duration.sum()))


def average_torque(duration: Array, torque: Array, speed: Array) -> float:
    """T_av = cube root of the mean of |T|^3, weighted by |speed|: what loads the bearing while it turns.

    Equation 18.2 of the engineering data.  A drive that stands still all the time is weighted by time alone.
    """
    turned = duration * np.abs(speed)
    weight = turned if turned.sum() > 0 else duration
    largest = np.abs(torque).max()
    if largest == 0:
        return 0.0
    # of shares of the largest, whose cubes neither overflow nor vanish together
    return float(largest * np.cbrt(weight @ (np.abs(torque) / largest) ** 3 / weight.sum()))


def life(rated: tuple[float, float, float], torque: float, speed: float) -> float:
    """L_n (T_r / T_av)^3 (n_r / n_av), h, for rated = (L_n, T_r, n_r); infinite for a drive that stands still.

    Equation 20.2 of the engineering data; equation 8 of the catalogue.  As many gears reach it as reach L_n.
    """
    hours, rated_torque, rated_speed = rated
    if torque == 0 or speed == 0:
        return np.inf
    return hours * (rated_torque / torque) ** 3 * (rated_speed / speed)


def permitted_peaks(duration: Array, torque: Array, speed: Array, allowed: float) -> float | None:
    """How often the longest stay above `allowed`, the repeated peak torque, may occur; None if there is none.

    The cycle is repeated: a stay may go on over its end.
    N = 10^4 / (2 turns of the wave generator in it), as harmonic-drive-selector (harmonic_designer.py) transcribes the
    makers' selection procedure; speed in rad/s.
    """
    above = np.abs(torque) > allowed
    if not above.any():
        return None
    first = int(np.argmin(above))  # that is not, if there is one
    turns, above = np.roll(duration * np.abs(speed) / (2 * np.pi), -first), np.roll(above, -first)
    starts = np.flatnonzero(above & ~np.r_[False, above[:-1]])
    longest = max(_until_below(turns[k:], above[k:]) for k in starts)
    return MOST_PEAKS / (2 * longest) if longest > 0 else np.inf


def _until_below(turns: Array, above: NDArray[np.bool_]) -> float:
    end = len(above) if above.all() else int(np.argmin(above))
    return float(turns[:end].sum())
