"""All parameters of all bodies, of those that can exist the ones that fit a log best and lie near the file's.

Torques tell combinations of parameters only; what they leave open stays as in the file, by a distance between bodies
that depends on no frame and no unit.  Traversaro et al. (2016), IROS; Lee, Wensing and Park (2020), IEEE Trans.
Robot. 36(2), for the entropic distance; Rucker and Wensing (2022), IEEE Robot. Autom. Lett. 7(2), for log-Cholesky.
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.errors import InputError, unknown_name
from cutpoint.identification.rigid import cones, log_cholesky
from cutpoint.identification.rigid.base_parameters import BaseParameters
from cutpoint.identification.rigid.physical_fit import fit_of, sums_of

Array = NDArray[np.float64]

Solver = Literal["lmi", "lmi_trace", "log_cholesky"]
SOLVERS = ("lmi", "lmi_trace", "log_cholesky")


class Physical(NamedTuple):
    """inertial: (10 bodies,), of bodies that can exist.  rotors: kg m2 at the joint, of those that are sought.
    others: friction, not negative, and offsets, in the regression's order.  base: what follows for all its parameters.
    """

    inertial: Array
    rotors: Array
    others: Array
    base: Array


SHARPEST = 1e7
"""Torques over their noise, all together: of logs that are more exact a solver would not see bodies beside them."""


def physical(
    base: BaseParameters,
    names: Sequence[str],
    R: Array,
    z: Array,
    sizes: Array,
    told: NDArray[np.bool_],
    *,
    solver: Solver = "lmi",
    prior_spread: float = 0.5,
) -> Physical:
    """The physical parameters nearest to R x = z (base parameters first, then friction and offsets, by names).

    sizes: of friction and offsets, as they usually are in such a robot.  told: which of these the log tells; others
    stay near what the file states.  Friction at rest is no less than in motion.
    solver: "lmi", with the entropic distance to the file's bodies; "lmi_trace", with its quadratic approximation, both
    by cvxpy and Clarabel; "log_cholesky", the latter without constraints, by SciPy alone.
    prior_spread: standard deviation of the bodies from the file's, as a share: 0.5 is half of a body's mass.

    Raises InputError: an unknown solver, a spread that is not positive.  CutpointError: a solver that is not there.
    """
    check_solver(solver)
    if not (np.isfinite(prior_spread) and prior_spread > 0.0):
        raise InputError(f"prior_spread {prior_spread} must be positive, as a share: 0.5 is half of a body's mass")
    blunt = min(1.0, SHARPEST / max(float(np.linalg.norm(z)), 1.0))
    fit = fit_of(base, names, blunt * R, blunt * z, sizes, told, prior_spread)
    unknowns = log_cholesky.solve(fit) if solver == "log_cholesky" else cones.solve(fit, entropic=solver == "lmi")
    X, rotors, others = fit.unpacked(unknowns)
    others = sums_of(names[-others.size :]) @ (np.where(fit.positive, np.maximum(others, 0.0), others) * fit.sizes)
    inertial, rotors = fit.bodies.parameters(X), np.maximum(rotors, 0.0) * fit.scale
    found = np.concatenate([base.matrix @ np.concatenate([inertial, rotors]), others])
    return Physical(inertial, rotors, others, found)


def check_solver(solver: str) -> None:
    """Raises InputError for one that is unknown, CutpointError for one that is not installed."""
    if solver not in SOLVERS:
        raise unknown_name("solver", solver, SOLVERS)
    if solver != "log_cholesky":
        cones.cvxpy()
