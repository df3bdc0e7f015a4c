"""Spring laws that a measured deflection may follow, and their constants by nonlinear least squares.

The deflection's other components are linear in their unknowns and are projected out: only the law's own constants are
searched.  Golub and Pereyra (1973), SIAM J. Numer. Anal. 10(2).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from cutpoint import kernels
from cutpoint.arrays import Array
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.compliance import Flexspline, LinearSpring
from cutpoint.scalars import Scalar

Projection = Callable[[Array], Array]

FARTHEST = 5.0
"""Constants are searched within a factor of exp(5) = 148 of their start."""

CORNERS = (0.1, 0.2, 0.35, 0.5, 0.7, 0.85)
"""Shares of the largest torque at which a catalogue's stiffness may change, to start the search from."""

STARTS = 4
"""Pairs of these from which the search starts: the squared error has several minima over the corners."""

LEAST = 0.01
"""Share of a catalogue's largest compliance: smaller ones are not used as starts."""

HARDENING = 0.5
"""Hardening to start the search from, times the reciprocal of the largest torque."""


@dataclass(frozen=True)
class SpringLaw:
    """constants: their names, stiffnesses first.  make: the law from its constants.  starts: constants to search from,
    given torque (N,), the rest of the deflection (N,), a compliance (rad/(N m)), and the projection."""

    name: str
    constants: tuple[str, ...]
    make: Callable[[Sequence[Scalar]], Any]
    starts: Callable[[Array, Array, float, Projection], list[Array]]
    stiffnesses: int = 1

    def deflection(self, constants: Array, torque: Array) -> Array:
        """(N,), rad, under torque (N,)."""
        return np.asarray(_compiled(self)[0](constants, torque))

    def columns(self, constants: Array, torque: Array) -> Array:
        """Derivatives (N, p) of the deflection by the constants."""
        return np.asarray(_compiled(self)[1](constants, torque).d_result_d_constants)

    def spring(self, constants: Array) -> Any:
        """The law of these constants."""
        return self.make(constants.tolist())


@lru_cache(maxsize=8)
def _compiled(law: SpringLaw) -> tuple[kernels.Kernel, kernels.Kernel]:
    """The law's deflection and derivatives."""

    def deflection(constants: Sequence[Scalar], torque: Scalar) -> Any:
        return law.make(constants).deflection(torque)

    slopes = kernels.jacobian_of(deflection, with_respect_to=["constants"])
    both = (kernels.compile(function, constants=len(law.constants), torque=()) for function in (deflection, slopes))
    return next(both), next(both)


def fitted(law: SpringLaw, torque: Array, rest: Array, project: Projection, near: Array | None) -> Array:
    """Constants with which the law's deflection under torque (N,) is closest to `rest` (N,), rad, after `project`.

    near: constants to search from; None for the law's own starts.
    """
    target = project(rest)
    scale = float(np.linalg.norm(target)) or 1.0
    best: Any = None
    for start in law.starts(torque, rest, _slope(project(torque), target), project) if near is None else [near]:

        def error(logarithms: Array) -> Array:
            left = (target - project(law.deflection(np.exp(logarithms), torque))) / scale
            # a law that cannot be inverted explains nothing
            return left if np.isfinite(left).all() else np.ones_like(left)

        def slopes(logarithms: Array) -> Array:
            constants = np.exp(logarithms)
            found = -project(law.columns(constants, torque) * constants) / scale
            return found if np.isfinite(found).all() else np.zeros_like(found)

        origin = np.log(start)
        bounds = origin - FARTHEST, origin + FARTHEST
        jac: Any = slopes  # SciPy's stubs allow only names
        found = least_squares(error, origin, jac, bounds=bounds, x_scale=0.3, max_nfev=30)
        if best is None or found.cost < best.cost:
            best = found
    return np.exp(best.x)


def beside(columns: Array) -> Projection:
    """What columns (N, k) do not explain of values (N,)."""
    basis, _ = np.linalg.qr(columns)
    return lambda values: values - basis @ (basis.T @ values)


def _slope(torque: Array, deflection: Array) -> float:
    """Compliance, rad/(N m); very small if the deflection does not follow the torque at all."""
    power = float(torque @ torque)
    slope = float(torque @ deflection) / power if power else 0.0
    largest = float(np.linalg.norm(deflection)) / np.sqrt(power) if power else 1.0
    return max(slope, 1e-3 * largest, np.finfo(float).tiny)


def _linear_starts(torque: Array, rest: Array, compliance: float, project: Projection) -> list[Array]:
    return [np.array([1.0 / compliance])]


def _flexspline_starts(torque: Array, rest: Array, compliance: float, project: Projection) -> list[Array]:
    largest = float(np.abs(torque).max())
    return [np.array([1.0 / compliance, HARDENING / largest])]


def _catalogue_starts(torque: Array, rest: Array, compliance: float, project: Projection) -> list[Array]:
    """The best pairs of corners, each with the segments' compliances, which are linear unknowns."""
    largest, target = float(np.abs(torque).max()), project(rest)
    found: list[tuple[float, Array]] = []
    for first, second in combinations(largest * np.array(CORNERS), 2):
        low, middle = np.clip(torque, -first, first), np.clip(torque, -second, second)
        columns = np.column_stack([project(part) for part in (low, middle - low, torque - middle)])
        compliances, *_ = np.linalg.lstsq(columns, target, rcond=None)
        if compliances.min() > LEAST * compliances.max():
            error = float(np.sum((target - columns @ compliances) ** 2))
            found.append((error, np.array([*(1.0 / compliances), first, second - first])))
    starts = [start for _, start in sorted(found, key=lambda pair: pair[0])[:STARTS]]
    return starts or [np.array([1.0 / compliance] * 3 + [0.3 * largest, 0.4 * largest])]


LINEAR = SpringLaw("linear", ("stiffness",), lambda c: LinearSpring(*c), _linear_starts)
FLEXSPLINE = SpringLaw("flexspline", ("stiffness", "hardening"), lambda c: Flexspline(*c), _flexspline_starts)
CATALOGUE = SpringLaw(
    "catalogue",
    ("k1", "k2", "k3", "t1", "t2 - t1"),
    lambda c: CatalogueSpring(c[0], c[1], c[2], c[3], c[3] + c[4]),
    _catalogue_starts,
    stiffnesses=3,
)
LAWS = {law.name: law for law in (LINEAR, FLEXSPLINE, CATALOGUE)}
"""From the fewest constants to the most."""


@dataclass(frozen=True)
class _Stiffer:
    """A curve that is stiffer by a factor."""

    curve: Any
    factor: Scalar

    def deflection(self, torque: Scalar) -> Any:
        return self.curve.deflection(torque / self.factor)

    def tangent(self, deflection: Scalar) -> Any:
        return self.factor * self.curve.tangent(deflection)


def as_stated(curve: Any) -> SpringLaw:
    """The curve that a file states, with one unknown factor."""
    return SpringLaw("as stated", ("factor",), lambda c: _Stiffer(curve, *c), lambda *_: [np.ones(1)])
