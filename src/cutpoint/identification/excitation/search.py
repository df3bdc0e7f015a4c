"""The search for the best excitation: many starts, each with increasingly hard barriers, until time is up."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.identification.excitation.problem import Problem, Worst
from cutpoint.reporting.bar import Bar

PHASES = ((0.3, 0.01), (0.03, 0.003), (3e-3, 1e-3), (3e-4, 1e-4))
"""Weights of the barriers and the slacks where they turn into parabolas, phase by phase.

They are steep from the first: a motion far beyond a limit seldom returns.
"""

OPTIONS = {"maxiter": 150}
"""Options of L-BFGS: the largest number of steps in each phase."""

CENTRES, SPREAD, SWING = 64, 0.5, 0.3
"""Number of centres drawn for each start, their share of the range, and the waves' standard deviation."""

HALVINGS = 10

MOST_UNTOLD = 0.25
"""Share of the parameters about which a motion may tell next to nothing; one near rest tells little but gravity."""

LEAST_SCALE = 0.01
"""Scale of the waves: if limits allow less, the centre is wrong."""


@dataclass
class Found:
    """The best z within all limits, and its cost; first: the initial random one, if it was within them.

    untold: parameters about which it tells next to nothing.  worst: of all motions beyond a limit, the one least so:
    its worst limit.  blind: if a motion within all limits told of too few parameters, the one it tells least about.
    """

    z: Array | None = None
    cost: float = np.inf
    first: Array | None = None
    starts: int = 0
    untold: tuple[str, ...] = ()
    worst: Worst | None = None
    blind: str = ""


class TimeIsUpError(Exception):
    """The time of the search is up."""


def search(
    problem: Problem,
    begin: Array | None,
    seconds: float,
    starts: int | None,
    seed: int,
    keep: Callable[[Array, float], None],
) -> Found:
    """The best motion found until time is up, all starts are made, or Ctrl-C is pressed.

    begin: the first start, random if not given.  keep: called on every improvement, with z and its cost.

    Raises InputError, which names limit and joint, or a parameter, if no motion within all limits was found that tells
    of most parameters.
    """
    found, rng = Found(), np.random.default_rng(seed)
    with Bar("exciting", seconds) as bar:
        clock = _Clock(seconds, bar)
        try:
            if begin is not None:  # as it is: a start is a little smaller
                _consider(problem, begin, found, keep)
            while starts is None or found.starts < starts:
                z = _within(problem, _random(problem, rng) if begin is None else begin, clock)
                _consider(problem, z, found, keep)
                if begin is None and not found.starts:
                    found.first = found.z
                _improve(problem, z, found, clock, keep)
                begin, found.starts = None, found.starts + 1
        except TimeIsUpError:
            pass
        except KeyboardInterrupt:
            if found.z is None:
                raise
    if found.z is None:
        raise _nothing(found, clock.passed)
    return found


def _nothing(found: Found, seconds: float) -> InputError:
    passed, longer = f"in {seconds:.3g} s", "search longer (seconds=, --seconds)"
    at_best = f"; at best, {found.worst.words}" if found.worst else ""
    if found.blind:
        words = f"no motion within the limits that tells of most parameters was found {passed}"
        return InputError(
            f"{words}; least is told about {found.blind}{at_best}: allow more travel or speed, or {longer}"
        )
    slower = "allow more there, or move slower (base_frequency=, --base-frequency), or " if at_best else ""
    return InputError(f"no motion was found within all limits {passed}{at_best}: {slower}{longer}")


def _random(problem: Problem, rng: np.random.Generator) -> Array:
    """A random motion about that of many centres where rest is farthest from all limits."""
    rows, joints = problem.shape
    centres = rng.uniform(-SPREAD, SPREAD, (CENTRES, joints))
    z = SWING * rng.standard_normal((rows, joints))
    z[0] = centres[problem.standing(centres).argmax()]
    return z


def _within(problem: Problem, z: Array, clock: "_Clock") -> Array:
    """The motion scaled down to the limits; if they allow none there, about a centre where they leave most room.

    A large motion that starts beyond a limit too often stays there.
    """
    factor = _largest_factor(problem, z)
    if factor < LEAST_SCALE:
        z = _scaled(z, LEAST_SCALE)

        def cost(centre: Array) -> tuple[float, Array]:
            clock.check()
            value, slope = problem.barrier(np.vstack([centre, z[1:]]), PHASES[0][1])
            return value, slope[0]

        result: Any = minimize(cost, z[0], jac=True, method="L-BFGS-B", options=OPTIONS)
        z = np.vstack([result.x, z[1:]])
        factor = _largest_factor(problem, z)
    return _scaled(z, factor or 1.0)


def _improve(problem: Problem, z: Array, found: Found, clock: "_Clock", keep: Callable[[Array, float], None]) -> None:
    """Improves z through all phases."""
    for weight, softness in PHASES:

        def cost(x: Array, weight: float = weight, softness: float = softness) -> tuple[float, Array]:
            clock.check()
            value, slope = problem.barred(x.reshape(problem.shape), weight, softness)
            return value, slope.ravel()

        def step(x: Array) -> None:
            nonlocal z
            z = x.reshape(problem.shape).copy()

        try:
            minimize(cost, z.ravel(), jac=True, method="L-BFGS-B", callback=step, options=OPTIONS)
        finally:
            _consider(problem, z, found, keep)


def _consider(problem: Problem, z: Array, found: Found, keep: Callable[[Array, float], None]) -> None:
    """Keeps the motion, scaled down to all limits, if it is the best so far: it tells of more parameters, or more."""
    worst = problem.worst(z)
    if worst.room < 0.0:
        if found.worst is None or worst.room > found.worst.room:
            found.worst = worst
        z = _scaled(z, _largest_factor(problem, z))
        worst = problem.worst(z)
    if worst.room < 0.0:
        return
    untold, cost = problem.untold(z), problem.cost(z)
    if len(untold) > MOST_UNTOLD * problem.information.parameters:
        found.blind = untold[0]
    elif found.z is None or (len(untold), cost) < (len(found.untold), found.cost):
        found.z, found.cost, found.untold = z, cost, untold
        keep(z, cost)


def _largest_factor(problem: Problem, z: Array) -> float:
    """Largest scale of the waves within all limits, by bisection; 0 if rest violates one."""
    least, most = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (least + most) / 2.0
        least, most = (middle, most) if problem.worst(_scaled(z, middle)).room >= 0.0 else (least, middle)
    return least


def _scaled(z: Array, factor: float) -> Array:
    return np.vstack([z[:1], factor * z[1:]])


class _Clock:
    """Raises TimeIsUpError once the time is up, and shows the progress."""

    def __init__(self, seconds: float, bar: Bar) -> None:
        self._seconds, self._bar, self._begin = seconds, bar, time.perf_counter()

    @property
    def passed(self) -> float:
        """Elapsed time, s."""
        return time.perf_counter() - self._begin

    def check(self) -> None:
        if self.passed > self._seconds:
            raise TimeIsUpError
        self._bar.show(self.passed)
