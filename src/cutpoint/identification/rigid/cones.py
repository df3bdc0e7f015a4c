"""Physical bodies by a conic program, with cvxpy and Clarabel."""

import warnings
from contextlib import suppress
from importlib import import_module
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import CutpointError
from cutpoint.identification.rigid.physical_fit import Fit

BLUNTER = (1.0, 0.1, 1e-2, 1e-3)
"""Factors tried in turn if Clarabel gives up: on torques that no body causes, such as those of reversed sign."""


def solve(fit: Fit, entropic: bool) -> Array:
    """The unknowns by a conic program."""
    cp = cvxpy()
    X = [cp.Variable((4, 4), PSD=True) for _ in range(fit.bodies.count)]
    rotors = cp.Variable(fit.scale.size, nonneg=True) if fit.scale.size else None
    others = cp.Variable(fit.positive.size) if fit.positive.size else None
    parts = [*(cp.vec(each, order="C") for each in X), *(x for x in (rotors, others) if x is not None)]
    misfit = cp.sum_squares(fit.data @ cp.hstack(parts) - fit.z)
    distance = sum(_distance(cp, each, entropic) for each in X)
    if rotors is not None:
        distance += cp.sum_squares(rotors - fit.stated)
    distance /= fit.spread**2
    if others is not None:
        distance += cp.sum_squares((others - fit.prior) / fit.loose)
    bounds = _bounds(fit, others)
    sharp = cp.Parameter(nonneg=True)
    problem = cp.Problem(cp.Minimize(sharp * misfit + distance), bounds)
    for blunt in BLUNTER:
        sharp.value = blunt**2
        # about a solution within reduced tolerances, which is good enough here
        with warnings.catch_warnings(), suppress(cp.error.SolverError):
            warnings.filterwarnings("ignore", r"Solution may be inaccurate", UserWarning)
            problem.solve(solver=cp.CLARABEL)
            break
    if problem.status not in ("optimal", "optimal_inaccurate"):
        remedy = "check the torques' unit and sign, or try solver='log_cholesky', --solver log_cholesky"
        raise CutpointError(f"the search for physical bodies failed: {remedy}")
    return np.concatenate([np.ravel(x.value) for x in [*X, rotors, others] if x is not None])


def _bounds(fit: Fit, others: Any) -> list[Any]:
    """Bounds of friction; others: None without any."""
    bounded = np.isfinite(fit.most)
    low = [others[fit.positive] >= 0] if fit.positive.any() else []
    return [*low, others[bounded] <= fit.most[bounded]] if bounded.any() else low


def _distance(cp: Any, X: Any, entropic: bool) -> Any:
    """Distance between a body and the file's, which is the unit matrix."""
    return (cp.trace(X) - cp.log_det(X) - 4) / 2 if entropic else cp.sum_squares(X - np.eye(4)) / 4


def cvxpy() -> Any:
    """Returns cvxpy.  Raises CutpointError if it or Clarabel is not installed."""
    try:
        import_module("clarabel")
        return import_module("cvxpy")
    except ImportError as error:
        rule = "bodies by linear matrix inequalities need cvxpy and clarabel: pip install 'cutpoint[identify]'"
        raise CutpointError(f"{rule}, or use solver='log_cholesky', --solver log_cholesky") from error
