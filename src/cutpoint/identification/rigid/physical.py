"""Physically consistent parameters of all bodies that fit a log best and stay close to the file's.

Torques determine combinations of parameters only; undetermined ones stay close to the file's, in a distance between
bodies independent of frame and units.  Traversaro et al. (2016), IROS; Lee, Wensing and Park (2020), IEEE Trans.
Robot. 36(2), for the entropic distance; Rucker and Wensing (2022), IEEE Robot. Autom. Lett. 7(2), for log-Cholesky.
"""

from typing import Literal, NamedTuple, get_args

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import checked_name
from cutpoint.identification.rigid import cones, log_cholesky
from cutpoint.identification.rigid.physical_fit import Fit

Solver = Literal["lmi", "lmi_trace", "log_cholesky"]
SOLVERS = get_args(Solver)

SOLVERS_ZERO = 1e-6
"""Share of friction's usual size: solvers stop this close to zero."""


class Physical(NamedTuple):
    """inertial: (10 bodies,), physically consistent.  rotors: kg m2 at the joint, the included ones.
    others: friction, not negative, and offsets, in the regression's order.  base: all resulting regression parameters.
    """

    inertial: Array
    rotors: Array
    others: Array
    base: Array


def physical(fit: Fit, solver: Solver) -> Physical:
    """Bodies, rotors and friction of a fit.  Static friction is not below that in motion.

    solver: "lmi", with the entropic distance to the file's bodies; "lmi_trace", with its quadratic approximation, both
    by cvxpy and Clarabel; "log_cholesky", the latter without constraints, by SciPy alone.

    Raises CutpointError if the search fails.
    """
    unknowns = log_cholesky.solve(fit) if solver == "log_cholesky" else cones.solve(fit, entropic=solver == "lmi")
    X, rotors, others = fit.unpacked(unknowns)
    others = fit.sums @ (np.where(fit.positive & (others < SOLVERS_ZERO), 0.0, others) * fit.sizes)
    inertial, rotors = fit.bodies.parameters(X), np.maximum(rotors, 0.0) * fit.scale
    found = np.concatenate([fit.base.matrix @ np.concatenate([inertial, rotors]), others])
    return Physical(inertial, rotors, others, found)


def check_solver(solver: str) -> None:
    """Raises InputError for an unknown solver, CutpointError for one that is not installed."""
    if checked_name("solver", solver, SOLVERS) != "log_cholesky":
        cones.cvxpy()
