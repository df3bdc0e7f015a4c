"""Gain, phase and delay margins of a control law, joint by joint."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array, ComplexArray
from cutpoint.control.interface import Control
from cutpoint.control.sensors import Sensors
from cutpoint.control.stability.sampled_loop import STEADY, SampledLoop, sampled_loop
from cutpoint.errors import InputError
from cutpoint.resolvent import resolvent
from cutpoint.robot import Robot

LEAST = 1e-6
"""The lowest frequency that is looked at, rad a sample; the highest is half of sampling's."""

EVERYWHERE = np.geomspace(LEAST, np.pi, 800)
AROUND_POLES = np.geomspace(1e-8, 0.3, 24)
"""Frequencies, and distances from those of a loop's poles, open and closed, where it turns fast; rad a sample."""

AT_REST = np.array([1e-8, 1e-7])
"""Two frequencies so low that L is as at rest, unless it is infinite there."""

COARSE = np.geomspace(1e-4, np.pi, 100)
"""Frequencies at which a peak is sought quickly, with those of the closed loop's poles; rad a sample."""

LEAST_GAIN = 1e-6
"""Where a gain is less, L is infinite."""

FAST = 0.5
"""Poles that are smaller make nothing turn fast: what they hold is gone in a few samples."""

NEAR_CIRCLE = 1e-3
"""Distance from the unit circle of what may be a crossing."""

HALVES = 60
"""Of the distance between two frequencies, to find a crossing; thirds, to find where L is nearest to -1."""

NEAREST = 32
"""Frequencies about which that is sought."""

MOST_STATES = 300
"""Crossings are eigenvalues of twice as many, which take seconds."""


class Margins(NamedTuple):
    """Margins of each joint (n,), its loop cut at the motor's command and the others closed.

    gain: largest factor on the command that stays stable; inf if any does.  least_gain: the smallest; 0 if the loop may
    be opened.  phase: admissible phase lag of the command, deg; delay: admissible delay, s; both inf if unbounded.
    sensitivity: max |1 / (1 + L)|, the largest amplification of disturbances by the loop.  joints: their names.
    """

    gain: Array
    least_gain: Array
    phase: Array
    delay: Array
    sensitivity: Array
    joints: tuple[str, ...]

    def __repr__(self) -> str:
        """A line for each joint."""
        rows = zip(self.gain, self.least_gain, self.phase, 1e3 * self.delay, self.sensitivity, strict=True)
        heads = ("gain", "least gain", "phase, deg", "delay, ms", "sensitivity")
        width = max(map(len, ("joint", *self.joints)))
        lines = [
            f"{joint:{width}} " + "".join(f"{x:>13.3g}" for x in row)
            for joint, row in zip(self.joints, rows, strict=True)
        ]
        return "\n".join([f"{'joint':{width}} " + "".join(f"{head:>13}" for head in heads), *lines])


def margins(
    robot: Robot, law: Control, q: ArrayLike, control_period: float, *, sensors: Sensors | None = None
) -> Margins:
    """Stability margins of the loops of a sampled law, for the robot at rest at q (nq,).

    Astrom and Murray (2021), Feedback Systems, section 10.3, of the sampled loop that `slowest_pole` judges.  A
    fractional delay turns the phase of L in proportion to frequency.
    control_period: s.  sensors: as in `slowest_pole`.

    Raises:
        InputError: as `slowest_pole`; or the loop is not stable to begin with, or has too many states.
        ModelError, TraceError: as `slowest_pole`.
    """
    loop = sampled_loop("margins", robot, law, q, control_period, sensors)
    if (count := len(loop.alone)) > MOST_STATES:
        rule = f"robot, law and sensors have {count} states, more than {MOST_STATES}; use shorter delays"
        raise InputError(f"margins: {rule}", states=count)
    size = float(np.abs(np.linalg.eigvals(loop.closed)).max())
    if not size <= STEADY:
        told = "margins: the law does not hold the robot there (friction is not counted)"
        growth = f"a deviation grows by a factor of {size:.6g} per sample; damping of the springs"
        raise InputError(f"{told}: {growth}, or other gains, may help", size=size)
    cuts = [_Cut(loop.closed, b, -c) for b, c in zip(loop.into.T, loop.command, strict=True)]
    return Margins(*np.array([_of_joint(cut, control_period) for cut in cuts]).T, joints=tuple(robot.joints))


def peak_sensitivity(loop: SampledLoop) -> Array:
    """`Margins.sensitivity` (n,) of a stable loop, to some per cent, in a hundredth of the time.

    By the matrix inversion lemma, 1 / (1 + L) is 1 + command (z - closed)^-1 into.
    """
    from scipy.linalg import schur  # slow to import

    triangular: Any = schur(loop.closed, output="complex")
    A, Q = triangular
    at_poles = np.maximum(np.abs(np.angle(np.diag(A))), COARSE[0])
    turns = np.concatenate([COARSE, at_poles])
    into, command = Q.conj().T @ loop.into, loop.command @ Q
    columns = zip(into.T, command, strict=True)
    return np.array([np.abs(1 + c @ resolvent(A, b, np.exp(1j * turns))).max() for b, c in columns])


class _Cut:
    """One loop cut at its command: L(z) = c (z - A)^-1 b, with z = exp(i turn); marginally stable where L = -1.

    turns: frequencies at which L has been evaluated, rad per sample; L: its values there.
    """

    def __init__(self, closed: Array, b: Array, c: Array) -> None:
        from scipy.linalg import schur  # slow to import

        A = closed + np.outer(b, c)
        triangular: Any = schur(A, output="complex")
        self._A, Q = triangular
        self._b, self._c = Q.conj().T @ b, c @ Q
        poles = np.concatenate([np.diag(self._A), np.linalg.eigvals(closed)])
        at_poles = np.abs(np.angle(poles[np.abs(poles) > FAST]))[:, None]
        between = np.convolve(_crossings(A, b, c), [0.5, 0.5], "valid")
        every = [EVERYWHERE, between, at_poles.ravel(), *(at_poles - AROUND_POLES), *(at_poles + AROUND_POLES)]
        turns = np.unique(np.concatenate(every))
        self.turns = turns[(turns >= LEAST) & (turns <= np.pi)]
        self.L = self.at(self.turns)

    def at(self, turns: Array) -> ComplexArray:
        """L at all turns at once."""
        with np.errstate(invalid="ignore"):
            return self._c @ resolvent(self._A, self._b, np.exp(1j * turns))

    def crossings(self, height: Callable[[ComplexArray], Any]) -> Array:
        """Turns where this function of L changes sign, by bisection."""
        with np.errstate(invalid="ignore", over="ignore"):
            heights = height(self.L)
            (before,) = np.nonzero(heights[:-1] * heights[1:] < 0)
            low, high, sign = self.turns[before], self.turns[before + 1], heights[before]
            for _ in range(HALVES):
                middle = (low + high) / 2
                is_before = height(self.at(middle)) * sign > 0
                low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
        return (low + high) / 2

    def nearest(self) -> float:
        """The least distance of L from -1 at any turn, by ternary search around the smallest values on the grid."""
        with np.errstate(invalid="ignore"):
            distances = np.nan_to_num(np.abs(1 + self.L), nan=np.inf)
            k = np.clip(np.argsort(distances)[:NEAREST], 1, len(distances) - 2)
            low, high = self.turns[k - 1], self.turns[k + 1]
            for _ in range(HALVES):
                third = (high - low) / 3
                falls = np.abs(1 + self.at(low + third)) > np.abs(1 + self.at(high - third))
                low, high = np.where(falls, low + third, low), np.where(falls, high, high - third)
            return float(np.nanmin([*np.abs(1 + self.at((low + high) / 2)), distances.min()]))


def _crossings(A: Array, b: Array, c: Array) -> Array:
    """Approximate turns where L is real or |L| = 1, in order, both ends included.

    On the unit circle the conjugate of L(z) is L(1/z), so these are zeros of L(z) - L(1/z) and of 1 - L(z) L(1/z).
    """
    from scipy.linalg import eigvals  # slow to import

    n, bc = len(b), np.outer(b, c)
    I, O, column = np.eye(n), np.zeros((n, n)), b[:, None]
    nothing = 0 * column
    real = (
        np.block([[A, O, column], [O, I, nothing], [c[None], -c[None], np.zeros((1, 1))]]),
        np.block([[I, O, nothing], [O, A, column], [0 * c[None], 0 * c[None], np.zeros((1, 1))]]),
    )
    of_one = np.block([[A, bc], [O, I]]), np.block([[I, O], [bc, A]])
    with np.errstate(all="ignore"):
        z = np.concatenate([np.asarray(eigvals(*pencil)) for pencil in (real, of_one)])
        turns = np.abs(np.angle(z[np.abs(np.abs(z) - 1) < NEAR_CIRCLE]))
    return np.sort(np.concatenate([[0.0], turns, [np.pi]]))


def _of_joint(cut: _Cut, period: float) -> tuple[float, ...]:
    """As in Margins."""
    real = cut.at(np.append(cut.crossings(np.imag), np.pi)).real  # at the Nyquist frequency L is real
    rest, beside = cut.at(AT_REST)
    if np.abs(rest - beside) < 0.1 * np.abs(beside):
        real = np.append(real, rest.real)
    gains = -1 / real[real < 0]
    of_one = cut.crossings(lambda L: np.abs(L) - 1)
    lags = (np.angle(cut.at(of_one)) + np.pi) % (2 * np.pi)
    return (
        min(gains[gains > 1], default=np.inf),
        max(gains[(gains < 1) & (gains > LEAST_GAIN)], default=0.0),
        float(np.rad2deg(min(lags, default=np.inf))),
        min(lags / of_one * period, default=np.inf),
        1 / cut.nearest(),
    )
