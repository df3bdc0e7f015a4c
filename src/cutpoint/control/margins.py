"""How far the loops of a law are from ringing: gain, phase and delay margins, joint by joint."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.control.sampled_loop import sampled_loop
from cutpoint.control.sensors import Sensors
from cutpoint.errors import InputError
from cutpoint.robot import Robot

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

LEAST = 1e-6
"""The lowest frequency that is looked at, rad a sample; the highest is half of sampling's."""

EVERYWHERE = np.concatenate([np.geomspace(LEAST, np.pi, 400), np.linspace(LEAST, np.pi, 800)])
AROUND_POLES = np.geomspace(1e-8, 0.3, 24)
"""Frequencies, and distances from those of a loop's poles, where it turns fast, rad a sample."""

FAST = 0.5
"""Poles that are smaller make nothing turn fast: what they hold is gone in a few samples."""

LARGEST = 1e6
"""Of L: where it is larger there is a pole of the open loop, and nothing crosses."""

HALVES = 50
"""Of the distance between two frequencies, to find a crossing."""

REAL = 1e-3
"""Of L, the most that is imaginary at the lowest frequency where L is real at rest."""


class Margins(NamedTuple):
    """Of each joint (n,): its own loop is cut at its motor's command, the others stay closed.

    gain: factor by which the command may grow until the robot rings; inf if by any.  least_gain: down to which it may
    shrink; 0 if to nothing.  phase: by which it may lag, deg; delay: by which it may come late, s; both inf if by any.
    sensitivity: max |1 / (1 + L)|, by how much the loop makes what disturbs it larger where it does so most.
    """

    gain: Array
    least_gain: Array
    phase: Array
    delay: Array
    sensitivity: Array


def margins(robot: Robot, law: Any, q: ArrayLike, period: float, *, sensors: Sensors | None = None) -> Margins:
    """How much the loops of a law with this period (s) may change before the robot at rest at q rings.

    Astrom and Murray (2021), Feedback Systems, section 10.3, of the sampled loop that `slowest_pole` judges, with the
    same arguments and errors.  A delay turns L by its share of a period at each frequency: exact for whole periods.

    Raises:
        InputError: also where the law does not hold the robot as it is.
    """
    loop = sampled_loop("margins", robot, law, q, period, sensors)
    size = float(np.abs(np.linalg.eigvals(loop.closed)).max())
    if not size < 1:
        told = "margins: the law does not hold the robot there, whose friction is left out"
        growth = f"what is moved grows to {size:.6g} times in a sample; damping of the springs helps, or other gains"
        raise InputError(f"{told}: {growth}", size=size)
    cuts = [_Cut(loop.closed, b, -c) for b, c in zip(loop.into.T, loop.command, strict=True)]
    return Margins(*np.array([_of_joint(cut, period) for cut in cuts]).T)


class _Cut:
    """One loop cut at its command: L(z) = c (z - A)^-1 b, with z = exp(i turn), rings where it is -1.

    turns: frequencies at which it has been looked at, rad a sample; L: what it was there.
    """

    def __init__(self, closed: Array, b: Array, c: Array) -> None:
        from scipy.linalg import schur  # slow to import

        triangular: Any = schur(closed + np.outer(b, c), output="complex")
        self._A, Q = triangular
        self._b, self._c = Q.conj().T @ b, c @ Q
        poles = np.diag(self._A)
        at_poles = np.abs(np.angle(poles[np.abs(poles) > FAST]))[:, None]
        every = np.concatenate([EVERYWHERE, *(at_poles - AROUND_POLES), *(at_poles + AROUND_POLES)])
        self.turns = np.unique(every[(every >= LEAST) & (every <= np.pi)])
        self.L = self.at(self.turns)

    def at(self, turns: Array) -> Complex:
        """Of a triangular A: from the last state to the first, for all turns at once."""
        z, x = np.exp(1j * turns), np.zeros((len(self._b), len(turns)), complex)
        for k in reversed(range(len(x))):
            x[k] = (self._b[k] + self._A[k, k + 1 :] @ x[k + 1 :]) / (z - self._A[k, k])
        return self._c @ x

    def crossings(self, height: Callable[[Complex], Any]) -> Array:
        """Turns where this of L passes zero, by halves."""
        heights = height(self.L)
        (before,) = np.nonzero(heights[:-1] * heights[1:] < 0)
        low, high, sign = self.turns[before], self.turns[before + 1], heights[before]
        for _ in range(HALVES):
            middle = (low + high) / 2
            is_before = height(self.at(middle)) * sign > 0
            low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
        return (low + high) / 2


def _of_joint(cut: _Cut, period: float) -> tuple[float, ...]:
    """As in Margins."""
    ends = cut.L[[0, -1]]  # at rest and at half of sampling's frequency L is real, unless it is infinite
    real = np.append(cut.at(cut.crossings(np.imag)), ends[np.abs(ends.imag) < REAL * np.abs(ends)]).real
    gains = -1 / real[(real < 0) & (real > -LARGEST)]
    of_one = cut.crossings(lambda L: np.abs(L) - 1)
    lags = (np.angle(cut.at(of_one)) + np.pi) % (2 * np.pi)
    return (
        min(gains[gains > 1], default=np.inf),
        max(gains[gains < 1], default=0.0),
        float(np.rad2deg(min(lags, default=np.inf))),
        min(lags / of_one * period, default=np.inf),
        float((1 / np.abs(1 + cut.L)).max()),
    )
