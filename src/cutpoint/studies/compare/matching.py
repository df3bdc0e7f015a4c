"""Equal stiffness: the bandwidth at which each law is as stiff as the PD, and whether it is stable there."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control.stability.sampled_loop import small_signal
from cutpoint.control.tuning.design import design_of
from cutpoint.control.tuning.holding import check_holds
from cutpoint.errors import InputError
from cutpoint.studies.compare.bench import Bench
from cutpoint.studies.compare.contenders import CONTENDERS, Contender
from cutpoint.studies.compare.runs import DIVERGED, score
from cutpoint.studies.compare.scenarios import as_modelled

TRIES = 20
SLOPES = (0.5, 8.0)
"""Of stiffness over bandwidth, both logarithms; most laws' is 2."""

STEPS = 2 ** (np.arange(1, 9) / 4)
"""Where a law does not hold at equal stiffness: factors of the bandwidth, down and up, that are tried in turn."""

EXACT = 1e-4
"""Of the geometric mean of stiffness, relative."""


class Match(NamedTuple):
    """A law at its bandwidth, Hz.

    law: None where it is refused everywhere.  stiffness and damping (n,): N m/rad, N m s/rad.  share: of the PD's
    stiffness, geometric mean over the joints.  refused: why it is at equal stiffness, "" if it is not.
    """

    contender: Contender
    bandwidth: float
    law: Any
    stiffness: Array
    damping: Array
    share: float
    refused: str = ""

    @property
    def equal(self) -> bool:
        """Whether it runs at equal stiffness."""
        return not self.refused


def matched(bench: Bench, contender: Contender) -> Match:
    """The law as stiff as the PD of the bench's bandwidth; or, if it does not hold there, where it next does."""
    pd = _at(bench, CONTENDERS[0], bench.bandwidth, np.ones(len(bench.home))).stiffness  # its own share is not used
    try:
        at = equal_bandwidth(lambda f: _at(bench, contender, f, pd).share, bench.bandwidth)
    except InputError as error:
        empty = np.full(len(pd), np.nan)
        return Match(contender, np.nan, None, empty, empty, np.nan, str(error))
    try:
        return _held(bench, contender, at, pd)
    except InputError as error:
        why = str(error)
    for factor in (f for step in STEPS for f in (1 / step, step)):
        try:
            return _held(bench, contender, factor * at, pd)._replace(refused=why)
        except InputError:
            continue
    return _at(bench, contender, at, pd)._replace(law=None, refused=why)


def equal_bandwidth(share: Callable[[float], float], guess: float) -> float:
    """Where a share that grows with bandwidth is one, Hz: by secants of logarithms, which are nearly straight.

    Raises:
        InputError: none is found within TRIES.
    """
    x, slope = np.log(guess), 2.0
    y = np.log(share(guess))
    for _ in range(TRIES):
        if abs(y) < EXACT:
            return float(np.exp(x))
        ahead = x - np.clip(y / slope, -1, 1)
        then = np.log(share(float(np.exp(ahead))))
        slope = np.clip((then - y) / (ahead - x), *SLOPES)
        x, y = ahead, then
    raise InputError(f"no bandwidth near {guess:g} Hz makes it as stiff as the PD", guess=guess)


def _held(bench: Bench, contender: Contender, bandwidth: float, pd: Array) -> Match:
    """Raises InputError if the sampled plant does not hold still under the law, or does not complete its move."""
    found = _at(bench, contender, bandwidth, pd)
    check_holds(bench.robot, contender.smooth(found.law), bench.home, bench.control_period)
    if score(bench, found.law, as_modelled(bench)) == DIVERGED:
        raise InputError("it holds at home but diverges during the motion, although the plant is the model")
    return found


def _at(bench: Bench, contender: Contender, bandwidth: float, pd: Array) -> Match:
    """The law at a bandwidth, Hz, whether it holds there or not."""
    law = contender.make(design_of(bench.robot, bench.home, 2.0 * np.pi * bandwidth, 1.0, bench.control_period))
    stiffness, damping = small_signal(bench.robot, contender.smooth(law), bench.home, bench.control_period)
    return Match(contender, bandwidth, law, stiffness, damping, _mean(stiffness / pd))


def _mean(shares: Array) -> float:
    """Geometric mean; tiny if one is not positive, to keep logarithms finite."""
    return float(np.exp(np.mean(np.log(shares)))) if (shares > 0).all() else 1e-12
