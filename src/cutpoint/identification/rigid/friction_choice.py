"""Choice of each joint's friction law by cross-validation.

A richer law always fits better; whether it also predicts better is tested on blocks of the recording that are held out
in turn.  Of the laws within one standard error of the best, the expected one is taken, or else the simplest.  Hastie,
Tibshirani, Friedman (2009), The Elements of Statistical Learning, section 7.10.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import minimize, nnls

from cutpoint.arrays import Array
from cutpoint.identification.rigid.law_shape import is_sharp, moved, shape_of, widest_smoothing
from cutpoint.identification.rigid.regression import friction_columns
from cutpoint.mechanics.drives.friction import Coulomb, Sliding, Stribeck

Means = Callable[[Array], Array]
Tried = tuple[Sliding, Array]
"""A law, and the products of its columns with all others, see `_Trial.gram`."""

BLOCKS = 8
"""Contiguous blocks that are held out in turn."""

SMOOTHINGS = np.geomspace(0.005, 0.5, 5)
STRIBECKS = np.geomspace(0.02, 2.0, 5)
"""Speeds that are tried, in RMS speeds of the joint."""

ASYMMETRIES = (-0.3, -0.1, 0.1, 0.3)

FIRST_STEP = 0.3
"""First step of the search for the best shape, in logarithms."""

TRIALS = 20
"""Number of shapes that it tries."""

RIDGE = 1e-12
"""Regularisation, as a share of a column's square over all blocks, for columns that are excited in only one block."""

RICHNESS = (
    "coulomb",
    "coulomb, asymmetric",
    "coulomb, with load",
    "stribeck",
    "stribeck, asymmetric",
    "stribeck, with load",
)
"""Families, the simplest first."""


class Held(NamedTuple):
    """error: RMS error on held-out torques, N m.  deviation: its standard error over the blocks."""

    error: float
    deviation: float


@dataclass(frozen=True)
class FrictionChoice:
    """The law chosen for a joint, and each family's error, with its unit."""

    joint: str
    family: str
    law: Sliding
    compared: Mapping[str, Held]
    unit: str = "N m"

    def without_load(self) -> "FrictionChoice":
        """The same law, which does not grow with load."""
        law = _with(self.law, per_load=None)
        return replace(self, family=_family(law), law=law)

    def __str__(self) -> str:
        each = ", ".join(f"{name} {held.error:.4g}" for name, held in self.compared.items())
        return f"{self.joint}: {self.family} friction, chosen among (RMS error of held-out torques, {self.unit}) {each}"


def choose_friction(
    joint: str,
    torque: Array,
    others: Array,
    noise: float,
    speed: Array,
    means: Means,
    load: Array,
    offset: bool,
    expected: Sliding | None,
) -> FrictionChoice:
    """Coulomb or Stribeck, each symmetric, asymmetric, or growing with load, and the shape that fits best.

    torque (M,): friction of a joint, decimated, and possible errors of all that was subtracted from it: others (M, k),
    one standard deviation each, N m; noise: of the torques, N m.  speed, load: (N,), before decimation.
    offset: whether the torque may have a constant offset; with asymmetric friction, the asymmetry stands for it.
    expected: a law with the shape that the drive's file states; none if it states none.
    Of the shapes tried in the search for the best over all blocks, each block is judged by the one that fits the others
    best.  Every law dissipates energy: none of its coefficients is negative.
    """
    trial = _Trial(torque, others, noise, speed, means, load, offset)
    tried = _tried(trial, float(np.sqrt(np.nanmean(speed**2))), expected)
    families = [family for family in RICHNESS if family in tried]
    errors = np.array([trial.left_out(tried[family]) for family in families])
    errors *= BLOCKS / len(torque)
    squares, deviations = errors.mean(axis=1), errors.std(axis=1, ddof=1) / np.sqrt(BLOCKS)
    best = int(np.argmin(squares))
    alike = [families[k] for k in np.flatnonzero(squares <= squares[best] + deviations[best])]
    known = None if expected is None else _family(expected)
    chosen = known if known in alike else alike[0]
    sizes = np.sqrt(squares)
    compared = dict(zip(families, map(Held, sizes.tolist(), (deviations / (2.0 * sizes)).tolist()), strict=True))
    return FrictionChoice(joint, chosen, trial.best(tried[chosen]), compared)


@dataclass(frozen=True, eq=False)
class _Trial:
    torque: Array
    others: Array
    noise: float
    speed: Array
    means: Means
    load: Array
    offset: bool

    def gram(self, law: Sliding) -> Array:
        """Products of [others, friction, torque] with themselves, for each block, (BLOCKS, c, c)."""
        columns = friction_columns(law, self.speed, self.load)[1]
        if isinstance(law, Stribeck):
            # a drive file has no friction that is smaller at rest than in motion: the second is the excess at rest
            columns[:, 0] += columns[:, 1]
        columns = self.means(columns)
        ones = np.ones((len(self.torque), int(self.offset and law.asymmetry is None)))
        own = np.column_stack([ones, columns, self.torque])
        k = self.others.shape[1]
        found = np.empty((BLOCKS, k + own.shape[1], k + own.shape[1]))
        found[:, :k, :k] = self._of_others
        for gram, A, B in zip(found, *(np.array_split(x, BLOCKS) for x in (self.others, own)), strict=True):
            gram[:k, k:], gram[k:, k:] = A.T @ B, B.T @ B
            gram[k:, :k] = gram[:k, k:].T
        return found

    @cached_property
    def widest(self) -> float:
        """rad/s, see `widest_smoothing`."""
        return widest_smoothing(self.speed)

    @cached_property
    def _of_others(self) -> Array:
        return np.array([block.T @ block for block in np.array_split(self.others, BLOCKS)])

    def tried(self, laws: list[Sliding]) -> list[Tried]:
        return [(law, self.gram(law)) for law in laws]

    def best(self, tried: list[Tried]) -> Sliding:
        """The law that fits best."""
        return min(tried, key=self.misfit)[0]

    def misfit(self, tried: Tried) -> float:
        """Sum of squared residuals of a law over all blocks."""
        law, gram = tried
        return self.fit(law, gram.sum(axis=0), gram.sum(axis=0))[1]

    def left_out(self, tried: list[Tried]) -> Array:
        """Squared error of each block under the shape and parameters that fit the others best, (BLOCKS,)."""
        errors = np.empty(BLOCKS)
        for block in range(BLOCKS):
            # summed, not subtracted from the total, which rounding may leave without a root
            rest = np.arange(BLOCKS) != block
            fits = [(self.fit(law, gram[rest].sum(axis=0), gram.sum(axis=0)), gram[block]) for law, gram in tried]
            (values, _), own = min(fits, key=lambda each: each[0][1])
            both = np.append(-values, 1.0)
            errors[block] = both @ own @ both
        return errors

    def fit(self, law: Sliding, gram: Array, whole: Array) -> tuple[Array, float]:
        """Least squares of the last column on the others, from products (c, c), with friction nonnegative: values, and
        the sum of squared residuals.  whole: products over all blocks, relative to which small ones count as zero."""
        A, b, others = gram[:-1, :-1].copy(), gram[:-1, -1], self.others.shape[1]
        A[range(others), range(others)] += self.noise**2
        size = np.sqrt(np.maximum(np.diag(A + whole[:-1, :-1] - gram[:-1, :-1]), np.finfo(float).tiny))
        R = cholesky(A / np.outer(size, size) + RIDGE * np.eye(size.size))
        y = solve_triangular(R, b / size, trans=1)
        free = others + int(self.offset and law.asymmetry is None)
        # the triangle's last rows have only friction
        friction, _ = nnls(R[free:, free:], y[free:])
        rest = solve_triangular(R[:free, :free], y[:free] - R[:free, free:] @ friction)
        values = np.append(rest, friction) / size
        return values, float(gram[-1, -1] - 2.0 * values @ b + values @ A @ values)


def _family(law: Sliding) -> str:
    load, side = law.per_load is not None, law.asymmetry is not None
    return f"{type(law).__name__.lower()}{', with load' if load else ', asymmetric' if side else ''}"


def _tried(trial: _Trial, size: float, expected: Sliding | None) -> dict[str, list[Tried]]:
    """Laws by family, with their products; size: RMS speed."""
    grease = None if expected is None else expected.grease
    smoothings = np.minimum(size * SMOOTHINGS, trial.widest).tolist()
    sharp = [(x, size * y) for x in smoothings for y in STRIBECKS if size * y > x]
    plain: dict[str, list[Sliding]] = {
        "coulomb": [Coulomb(1.0, 0.0, x, grease=grease) for x in smoothings],
        "stribeck": [Stribeck(1.0, 1.0, 0.0, y, x, grease=grease) for x, y in sharp],
    }
    if isinstance(expected, (Coulomb, Stribeck)):  # others are user-defined
        plain[type(expected).__name__.lower()].append(_with(expected, per_load=None, asymmetry=None))
    found: dict[str, list[Tried]] = {}
    for family, laws in plain.items():
        found[family] = _refined(trial, trial.tried(laws))
        law = trial.best(found[family])
        found[f"{family}, asymmetric"] = _refined(trial, trial.tried([_with(law, asymmetry=x) for x in ASYMMETRIES]))
        if np.nanmax(np.abs(trial.load)) > 0.0:
            found[f"{family}, with load"] = _refined(trial, trial.tried([_with(law, per_load=0.0)]))
        # an improvement from a longer search for the shape is not due to the richer law
        richer = [trial.best(tried) for name, tried in found.items() if name.startswith(f"{family}, ")]
        found[family] += trial.tried([_with(law, per_load=None, asymmetry=None) for law in richer])
    return found


def _refined(trial: _Trial, tried: list[Tried]) -> list[Tried]:
    """Adds all laws tried in the search for the best shape near, by variable projection.  Golub and Pereyra (1973)."""
    law = trial.best(tried)
    names, found = shape_of(law), [*tried]

    def misfit(x: Array) -> float:
        new = moved(law, dict(zip(names, x.tolist(), strict=True)))
        if not is_sharp(new, trial.widest):
            return float(np.finfo(float).max)
        found.extend(trial.tried([new]))
        return trial.misfit(found[-1])

    start = np.zeros(len(names))
    steps = np.vstack([start, FIRST_STEP * np.eye(start.size)])
    options = {"maxfev": TRIALS, "xatol": 1e-2, "fatol": 0.0, "initial_simplex": steps}
    minimize(misfit, start, method="Nelder-Mead", options=options)
    return found


def _with(law: Any, **changed: Any) -> Sliding:
    return replace(law, **changed)
