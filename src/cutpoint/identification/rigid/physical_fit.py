"""Unknowns of bodies, rotors and friction, and how far each may be from the file's."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.rigid.base_parameters import BaseParameters, rotor_sizes
from cutpoint.identification.rigid.bodies import Bodies, bodies_of
from cutpoint.identification.rigid.least_squares import solved
from cutpoint.identification.rigid.rigid_robot import stated_coefficient
from cutpoint.mechanics.drives.friction import Sliding

LOOSE = 20.0
"""Spread of friction or an offset about the file's, times its usual size.  It hardly affects determined ones."""

TIGHT = 0.2
"""Spread, likewise, of what the file states and the log determines in a sum with others at most; times the file's value
if that is less."""

LEAST = 1e-3
"""Least spread, times the usual size, for the solvers' sake."""

MOST_OF_LOAD = 0.99
"""Largest share of its load that a drive's friction takes: with all of it no load could be moved."""

SHARPEST = 1e7
"""Largest norm of all torques over their noise: in more exact logs a solver would not resolve the bodies' distances."""


class Fit(NamedTuple):
    """Minimise |data @ unknowns - z|^2 + sum of distances / spread^2 over [X.ravel() of bodies, rotors, others].

    The distance of a body that is (1 + e) times the file's is nearly e^2, and so is a rotor's; others are spread over
    `loose` sizes.  Friction and offsets are sums (others, others) times their unknowns, see `_sums`.
    scale (rotors,): their size in the file, or in the arm if the file has none.  stated: whether it has.
    sizes (others,): units of their shares.  prior: the file's, as shares.  positive: which must not be negative.
    most: upper bounds, as shares; infinite for all but load-dependent friction.
    """

    base: BaseParameters
    data: Array
    z: Array
    bodies: Bodies
    scale: Array
    stated: NDArray[np.bool_]
    sums: Array
    sizes: Array
    prior: Array
    loose: Array
    positive: NDArray[np.bool_]
    most: Array
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


def fit_of(
    base: BaseParameters,
    names: Sequence[str],
    laws: Mapping[str, Sliding],
    R: Array,
    z: Array,
    sizes: Array,
    told: NDArray[np.bool_],
    spread: float,
) -> Fit:
    """The fit of R x = z, in units of noise: base parameters first, then friction and offsets, by names.

    laws: by joint, of the friction.
    sizes: usual ones of friction and offsets in such a robot.  told: which of these the log determines; others stay
    near the file's.  spread: standard deviation of the bodies from the file's, as a share: 0.5 is half of a body's
    mass.
    """
    blunt = min(1.0, SHARPEST / max(float(np.linalg.norm(z)), 1.0))
    R, z = blunt * R, blunt * z
    b, bodies = base.independent.size, bodies_of(base.robot)
    scale, has_rotor = rotor_sizes(base)
    # behind a gear's ratio a rotor may be far heavier than the links of a wrist
    scale = np.where(has_rotor, scale, np.maximum(scale, _joint_inertias(base, R, z)))
    inertial = R[:, :b] @ _base_of(base, bodies, scale)
    # friction and offsets, as shares of their sizes
    stated, sums = np.array([stated_coefficient(base.robot, name) for name in names[b:]]), _sums(names[b:])
    more = sums - np.eye(sizes.size)
    prior = np.nan_to_num(stated - more @ np.nan_to_num(stated)) / sizes
    # a file without static friction means that it equals the friction in motion
    near = TIGHT * np.where(prior == 0.0, 1.0, np.clip(np.abs(prior), LEAST, 1.0))
    near[_needless(names[b:], R, z, sizes, told)] = LEAST
    loose = np.where(told | np.isnan(stated) & ~more.any(axis=1), LOOSE, near)
    positive = np.array([not name.startswith("offset.") for name in names[b:]], dtype=bool)
    most = np.array([_most(name, laws) for name in names[b:]]) / sizes
    data = np.concatenate([inertial, R[:, b:] @ sums * sizes], axis=1)
    return Fit(base, data, z, bodies, scale, has_rotor, sums, sizes, prior, loose, positive, most, spread)


def _joint_inertias(base: BaseParameters, R: Array, z: Array) -> Array:
    """What rotors (rotors,) have at most of the base parameters that R x = z tells, kg m2 at the joint."""
    shares = np.abs(base.matrix[:, len(base.parameters) - len(base.rotors) :])
    values, counts = np.abs(solved(R, z)[0][: len(shares), None]), shares > 0.0
    most = np.where(counts, values / np.where(counts, shares, 1.0), np.inf).min(axis=0)
    return np.where(np.isfinite(most), most, 0.0)


def _needless(names: Sequence[str], R: Array, z: Array, sizes: Array, told: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which of friction and offsets (k,), the last parameters of R x = z, are offsets that a log does not determine,
    and in whose place friction, none negative, or weights explain it: files hold these, but no offset."""
    untold = np.array([name.startswith("offset.") for name in names], dtype=bool) & ~told
    values = solved(R * np.append(np.ones(len(R) - len(names)), ~untold), z)[0][-len(names) :]
    pairs = [name.split(".", 1) for name in names]
    pushing = (values < -LEAST * sizes).tolist()
    pushes = {joint for (kind, joint), push in zip(pairs, pushing, strict=True) if push and kind != "offset"}
    return untold & np.array([joint not in pushes for _, joint in pairs], dtype=bool)


def _most(name: str, laws: Mapping[str, Sliding]) -> float:
    """The largest possible value of a coefficient or an offset."""
    kind, _, joint = name.partition(".")
    return MOST_OF_LOAD / (1.0 + abs(laws[joint].asymmetry or 0.0)) if kind == "per_load" else np.inf


def _base_of(base: BaseParameters, bodies: Bodies, scale: Array) -> Array:
    """Base parameters are this matrix times [X.ravel() of bodies, rotors as shares of their scale]."""
    ten = 10 * bodies.count
    links = base.matrix[:, :ten].reshape(base.independent.size, -1, 10)
    blocks = np.einsum("rbp,bpk->rbk", links, bodies.maps).reshape(len(links), -1)
    return np.concatenate([blocks, base.matrix[:, ten:] * scale], axis=1)


def _sums(names: Sequence[str]) -> Array:
    """Friction and offsets (k,) are these (k, k) times the unknowns, all of which may be zero: static friction is that
    in motion plus an excess."""
    found = np.eye(len(names))
    for k, name in enumerate(names):
        if name.startswith("static."):
            found[k, names.index(name.replace("static", "coulomb", 1))] = 1.0
    return found
