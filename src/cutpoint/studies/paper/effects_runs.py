"""Closed loops with a drive's effects switched on one by one, known to the feedforward and not."""

from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control import Feedforward
from cutpoint.simulation import Log
from cutpoint.studies.drive_effects import EFFECTS, FRICTION, NEEDS, with_effects
from cutpoint.studies.paper.bench import Bench, pd

Effects = tuple[str, ...]

MISTAKEN = 0.9


class Share(NamedTuple):
    """RMS tracking errors of the links by joint, (6,) in degrees: without an effect, with it unknown, with it known."""

    before: Array
    unknown: Array
    known: Array

    @property
    def costs(self) -> tuple[float, float]:
        """What the arm's error grows by as the effect is switched on, degrees: unknown, known."""
        before = arm(self.before)
        return arm(self.unknown) - before, arm(self.known) - before

    @property
    def recovered(self) -> float:
        """What of the effect's cost the feedforward that knows it takes away."""
        unknown, known = self.costs
        return 1 - known / unknown


class Shares(NamedTuple):
    """added: each effect on top of those before it.  alone: on linear springs, with no more than what it needs.

    ignorant: all effects under the feedforward of linear springs; mistaken: gear friction alone under a feedforward
    that takes it for MISTAKEN of what it is; (6,) in degrees.
    """

    added: dict[str, Share]
    alone: dict[str, Share]
    ignorant: Array
    mistaken: Array


def arm(errors: Array) -> float:
    """One number for the arm: RMS over its joints of (6,) RMS errors."""
    return float(np.sqrt(np.mean(np.square(errors))))


class Runs:
    """Loops of the bench on drives with some effects, under a feedforward that knows some; only errors are kept."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self._errors: dict[tuple[frozenset[str], frozenset[str], float], Array] = {}

    def log(self, on: Effects, known: Effects, rubs: float = 1.0) -> Log:
        """rubs: times as much as the drives do, the feedforward believes that they rub."""
        plant, model = with_effects(self._bench.robot, on), with_effects(self._bench.robot, known, rubs)
        log = self._bench.run(plant, pd() + Feedforward(model, "elastic"))
        self._errors[frozenset(on), frozenset(known), rubs] = np.rad2deg(log.rms("position_error"))
        return log

    def error(self, on: Effects, known: Effects, rubs: float = 1.0) -> Array:
        """RMS tracking errors of the links, (6,) in degrees."""
        key = frozenset(on), frozenset(known), rubs
        if key not in self._errors:
            self.log(on, known, rubs)
        return self._errors[key]

    def share(self, before: Effects, effect: str) -> Share:
        """Of an effect on top of others."""
        on = (*before, effect)
        return Share(self.error(before, before), self.error(on, before), self.error(on, on))


def shares(runs: Runs) -> Shares:
    added = {effect: runs.share(EFFECTS[:k], effect) for k, effect in enumerate(EFFECTS)}
    alone = {effect: runs.share(needed(effect), effect) for effect in EFFECTS}
    mistaken = runs.error((FRICTION,), (FRICTION,), MISTAKEN)
    return Shares(added, alone, runs.error(EFFECTS, ()), mistaken)


def needed(effect: str) -> Effects:
    """What must be there before an effect can."""
    return (NEEDS[effect],) if effect in NEEDS else ()
