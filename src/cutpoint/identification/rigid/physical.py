"""All parameters of all bodies, of those that can exist the ones that fit a log best and lie near the file's.

Torques tell combinations of parameters only; what they leave open stays as in the file, by a distance between bodies
that depends on no frame and no unit.  Traversaro et al. (2016), IROS; Lee, Wensing and Park (2020), IEEE Trans.
Robot. 36(2), for the entropic distance; Rucker and Wensing (2022), IEEE Robot. Autom. Lett. 7(2), for log-Cholesky.
"""

import warnings
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.errors import CutpointError, InputError, unknown_name
from cutpoint.identification.rigid.base_parameters import BaseParameters
from cutpoint.identification.rigid.bodies import Bodies, bodies_of
from cutpoint.identification.rigid.rigid_robot import stated_coefficient

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


LOOSE = 20.0
"""Times its usual size: how far friction or an offset may be from the file's.  Told, they hardly feel it."""

NEAR = 0.2
"""The same where the file states it and the log does not tell it, but may tell its sum with others; of what the file
states where that is less."""

LEAST = 1e-3
"""Times its usual size: nothing is nearer than that, for the solvers' sake."""


SHARPEST = 1e7
"""Torques over their noise, all together: of logs that are more exact a solver would not see bodies beside them."""

BLUNTER = (1.0, 0.1, 1e-2, 1e-3)
"""Times these, in turn, where Clarabel gives up: of torques that no body makes, as those of turned sign."""


class Fit(NamedTuple):
    """Minimise |data @ unknowns - z|^2 + sum of distances / spread^2 over [X.ravel() of bodies, rotors, others].

    The distance of a body that is (1 + e) times the file's is e^2, nearly, and so is a rotor's; others are spread over
    `loose` sizes.  Of static friction the unknown is what it is more than Coulomb's, see `_steps`.
    scale (rotors,): their size in the file, or in the arm where the file has none.  stated: whether it has.
    sizes (others,): what they are shares of.  prior: the file's, as shares.  positive: which must not be negative.
    """

    data: Array
    z: Array
    bodies: Bodies
    scale: Array
    stated: NDArray[np.bool_]
    sizes: Array
    prior: Array
    loose: Array
    positive: NDArray[np.bool_]
    spread: float

    @property
    def first_rotor(self) -> int:
        return 16 * self.bodies.count

    @property
    def first_other(self) -> int:
        return self.first_rotor + self.scale.size

    def unpacked(self, unknowns: Array) -> tuple[Array, Array, Array]:
        """X (bodies, 4, 4), rotors as shares of their scale, others of their sizes."""
        rotors, others = self.first_rotor, self.first_other
        return unknowns[:rotors].reshape(-1, 4, 4), unknowns[rotors:others], unknowns[others:]


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
    fit = _fit(base, names, blunt * R, blunt * z, sizes, told, prior_spread)
    if solver == "log_cholesky":
        from cutpoint.identification.rigid.log_cholesky import solve

        unknowns = solve(fit)
    else:
        unknowns = _by_cones(fit, entropic=solver == "lmi")
    X, rotors, others = fit.unpacked(unknowns)
    others = _sums(names[-others.size :]) @ (np.where(fit.positive, np.maximum(others, 0.0), others) * fit.sizes)
    inertial, rotors = fit.bodies.parameters(X), np.maximum(rotors, 0.0) * fit.scale
    found = np.concatenate([base.matrix @ np.concatenate([inertial, rotors]), others])
    return Physical(inertial, rotors, others, found)


def _fit(
    base: BaseParameters,
    names: Sequence[str],
    R: Array,
    z: Array,
    sizes: Array,
    told: NDArray[np.bool_],
    spread: float,
) -> Fit:
    robot, b = base.robot, base.independent.size
    bodies = bodies_of(robot.mechanism)
    counted = [*base.rotors]
    reflected = np.array([float(drive.reflected_inertia) for drive in robot.drives.values()])[counted]
    arm = np.diag(robot.mass_matrix(robot.neutral()))[counted]
    scale = np.where(reflected > 0.0, reflected, np.maximum(arm, np.finfo(float).tiny))
    ten = 10 * bodies.count
    links = base.matrix[:, :ten].reshape(b, -1, 10)
    blocks = np.einsum("rbp,bpk->rbk", links, bodies.maps).reshape(b, -1)
    inertial = R[:, :b] @ np.concatenate([blocks, base.matrix[:, ten:] * scale], axis=1)
    stated, sums = np.array([stated_coefficient(robot, name) for name in names[b:]]), _sums(names[b:])
    more = sums - np.eye(sizes.size)
    prior = np.nan_to_num(stated - more @ np.nan_to_num(stated)) / sizes
    # a file without friction at rest means that of motion
    near = NEAR * np.where(prior == 0.0, 1.0, np.clip(np.abs(prior), LEAST, 1.0))
    loose = np.where(told | np.isnan(stated) & ~more.any(axis=1), LOOSE, near)
    positive = np.array([not name.startswith("offset.") for name in names[b:]], dtype=bool)
    data = np.concatenate([inertial, R[:, b:] @ sums * sizes], axis=1)
    return Fit(data, z, bodies, scale, reflected > 0.0, sizes, prior, loose, positive, spread)


def _sums(names: Sequence[str]) -> Array:
    """Friction and offsets (k,) are these (k, k) times the unknowns, all of which may be zero: friction at rest is that
    in motion and what it is more."""
    found = np.eye(len(names))
    for k, name in enumerate(names):
        if name.startswith("static."):
            found[k, names.index(name.replace("static", "coulomb", 1))] = 1.0
    return found


def _by_cones(fit: Fit, entropic: bool) -> Array:
    """The unknowns by a conic program."""
    cp = _cvxpy()
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
    bounds = [others[fit.positive] >= 0] if others is not None and fit.positive.any() else []
    sharp = cp.Parameter(nonneg=True)
    problem = cp.Problem(cp.Minimize(sharp * misfit + distance), bounds)
    for blunt in BLUNTER:
        sharp.value = blunt**2
        # of a solution within reduced tolerances, which is good enough here
        with warnings.catch_warnings(), suppress(cp.error.SolverError):
            warnings.filterwarnings("ignore", r"Solution may be inaccurate", UserWarning)
            problem.solve(solver=cp.CLARABEL)
            break
    if problem.status not in ("optimal", "optimal_inaccurate"):
        remedy = "check the torques' unit and sign, or try solver='log_cholesky', --solver log_cholesky"
        raise CutpointError(f"the search for physical bodies failed: {remedy}")
    return np.concatenate([np.ravel(x.value) for x in [*X, rotors, others] if x is not None])


def _distance(cp: Any, X: Any, entropic: bool) -> Any:
    """Between a body and the file's, which is the unit matrix."""
    return (cp.trace(X) - cp.log_det(X) - 4) / 2 if entropic else cp.sum_squares(X - np.eye(4)) / 4


def check_solver(solver: str) -> None:
    """Raises InputError for one that is unknown, CutpointError for one that is not installed."""
    if solver not in SOLVERS:
        raise unknown_name("solver", solver, SOLVERS)
    if solver != "log_cholesky":
        _cvxpy()


def _cvxpy() -> Any:
    try:
        import_module("clarabel")
        return import_module("cvxpy")
    except ImportError as error:
        rule = "bodies by linear matrix inequalities need cvxpy and clarabel: pip install 'cutpoint[identify]'"
        raise CutpointError(f"{rule}, or take solver='log_cholesky', --solver log_cholesky") from error
