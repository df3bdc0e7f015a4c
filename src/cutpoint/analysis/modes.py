"""Vibration modes of a robot's elastic drives."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from cutpoint.analysis.linear_model import LinearModel
from cutpoint.analysis.linearize import linearize
from cutpoint.arrays import Array, ComplexArray
from cutpoint.mechanics.drives.backlash import spring_of
from cutpoint.mechanics.drives.harmonic_drive import deflection, transmission
from cutpoint.mechanics.rotor_coupling import rotor_coupling
from cutpoint.model.drive import Drive
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot, checked_pose

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPRING_SHARE = 0.1
"""Of a mode's energy, what its springs hold at least if it is one of the drives: half without damping, next to nothing
where the arm swings as a whole under its weight."""

LEAST_SHARE = 0.1
"""Of a mode's spring energy: a joint with less is not named."""

STANDSTILL = 1e-6
"""A pole slower than this part of the fastest one is zero: rounding moves a pair of zeros that far apart."""


@dataclass(frozen=True, eq=False, repr=False)
class Modes:
    """The vibration modes of elastic drives, by frequency; m of them.

    Free turning and swinging of the whole arm are not drive modes and not listed; neither are modes with so much
    damping that they do not oscillate.  A robot without elastic drives has none: m is 0.

    Attributes:
        frequencies: (m,) Hz, undamped: |pole| / 2 pi.
        damping: (m,) damping ratios, -Re(pole) / |pole|; negative if unstable.
        link, motor: (m, nv), (m, drives) complex, amplitudes on both sides, the largest of a mode is 1; rad (m).
        participation: (m, drives): share of each drive in the mode's spring energy; a row sums to 1.
        poles: (N,) all eigenvalues of model.A, 1/s.
        model: the underlying linear model.
        elastic: number of elastic drives, which is the number of modes without damping.
        stiffening: how many times as stiff a spring is, at most, while its hysteresis elements stick; 1 without any.
    """

    frequencies: Array
    damping: Array
    link: ComplexArray
    motor: ComplexArray
    participation: Array
    poles: ComplexArray
    model: LinearModel
    elastic: int
    stiffening: float

    def joints_of(self, mode: int) -> dict[str, float]:
        """Joints whose drives have at least a tenth of a mode's spring energy, with their shares, the largest first."""
        shares = self.participation[mode]
        return {self.model.joints[k]: float(shares[k]) for k in np.argsort(-shares) if shares[k] >= LEAST_SHARE}

    def plot(self) -> "Figure":
        """Motor torque to motor and link velocity, a panel a joint: `modes.plot().savefig("modes.png")`."""
        from cutpoint.analysis.picture import picture

        return picture(self)

    @property
    def remark(self) -> str:
        """What the list lacks: modes, and hysteresis; empty if it lacks nothing."""
        if not self.elastic:
            return "no drive bends, so there are no drive modes: state a compliance in the drive file"
        missing = self.elastic - len(self.frequencies)
        slow = f", or are slower than {STANDSTILL:g} of the fastest pole"
        told = [f"{missing} of {self.elastic} drive modes are overdamped{slow}"] if missing > 0 else []
        if self.stiffening > 1:
            faster = f"springs up to {self.stiffening:.2f} times as stiff, and frequencies higher"
            told.append(f"hysteresis is left out: in motions too small to make it slip, it makes {faster}")
        return "; ".join(told)

    def __repr__(self) -> str:
        lines = []
        for k, (f, zeta) in enumerate(zip(self.frequencies, self.damping, strict=True)):
            shares = ", ".join(f"{name} {share:.0%}" for name, share in self.joints_of(k).items())
            lines.append(f"{f:8.2f} Hz, damping {zeta:z.4f}: {shares}")
        return "\n".join([*lines, self.remark] if self.remark else lines)


def modes(robot: Robot, q: ArrayLike, *, friction: bool = False) -> Modes:
    """The drives' modes at rest at q (nq,), motors balancing gravity; from the eigenvectors of `linearize`'s A.

    friction: as in `linearize`; if included, its slope at rest damps or suppresses modes.

    Raises:
        InputError: q of a wrong shape, not finite, or far beyond limits, as if in degrees.
        ModelError: a joint can move without moving any inertia.
    """
    check_robot("modes", robot)
    model = linearize(robot, checked_pose("modes", robot, q), friction=friction)
    poles, vectors = _eigen(model)
    nv, y = robot.nv, (model.C @ vectors).T
    link, motor = y[:, :nv], y[:, 2 * nv : 2 * nv + len(robot.drives)]
    strain = _strain(robot, model, link, motor)
    chosen = _drive_modes(poles, strain.sum(axis=1), _kinetic(robot, model, poles, link, motor))
    s, strain, scale = poles[chosen], strain[chosen], _largest(np.hstack([link, motor])[chosen])
    return Modes(
        frequencies=np.abs(s) / (2 * np.pi),
        damping=-s.real / np.abs(s),
        link=link[chosen] / scale,
        motor=motor[chosen] / scale,
        participation=strain / strain.sum(axis=1, keepdims=True),
        poles=poles,
        model=model,
        elastic=sum(drive.is_elastic for drive in robot.drives.values()),
        stiffening=max((_stiffening(drive) for drive in robot.drives.values()), default=1.0),
    )


def _stiffening(drive: Drive) -> float:
    """How many times as stiff an unloaded spring, without play, is while all its hysteresis elements stick."""
    spring = spring_of(drive.compliance)
    if spring is None or drive.hysteresis is None:
        return 1.0
    return 1.0 + float(sum(drive.hysteresis.stiffness) / spring.tangent(0.0))


def _eigen(model: LinearModel) -> tuple[ComplexArray, ComplexArray]:
    """Poles, and eigenvectors, one column each.

    By the Schur form, with time in units of the fastest oscillation.  LAPACK's balancing would amplify noise in columns
    that are zero up to rounding; it leaves a triangular matrix unchanged.
    """
    moving = np.array([name.startswith(("v.", "theta_dot.")) for name in model.states])
    swing = np.sqrt(np.abs(model.A[np.ix_(moving, ~moving)]).sum(axis=1).max(initial=0.0)) or 1.0
    scale = np.where(moving, swing, 1.0)
    triangle, turned, *_ = scipy.linalg.schur(model.A * scale / scale[:, None], output="complex")
    poles, vectors = np.linalg.eig(triangle)
    return poles, (turned @ vectors) * scale[:, None]


def _drive_modes(poles: ComplexArray, strain: Array, kinetic: Array) -> NDArray[np.intp]:
    """Indices of the poles of drive modes, by frequency; of each pair the one above the real axis."""
    swings = poles.imag > STANDSTILL * np.abs(poles).max(initial=0.0)
    bends = swings & (strain > SPRING_SHARE * (strain + kinetic))
    return np.flatnonzero(bends)[np.argsort(np.abs(poles[bends]))]


def _strain(robot: Robot, model: LinearModel, link: ComplexArray, motor: ComplexArray) -> Array:
    """Twice the energy in each drive's spring, (N, drives), at its stiffness under the present load."""
    driven = robot.machine.drives
    theta, q = model.point.theta, model.point.q[[d.q for d in driven]]
    places = [*zip((d.drive for d in driven), theta, q, strict=True)]
    K = np.array([d.compliance.tangent(deflection(d, x, y)) if d.compliance else 0.0 for d, x, y in places])
    wound = motor * [transmission(d, x) for d, x, _ in places] - link[:, [d.v for d in driven]]
    return K * np.abs(wound) ** 2


def _kinetic(robot: Robot, model: LinearModel, poles: ComplexArray, link: ComplexArray, motor: ComplexArray) -> Array:
    """Twice the energy of links and elastic drives' rotors, (N,): by [M, S; S^T, J], see `mechanics.rotor_coupling`."""
    J = np.array([d.drive.reflected_inertia if d.drive.is_elastic else 0.0 for d in robot.machine.drives])
    q, moving = model.point.q, np.hstack([link, motor])
    S = rotor_coupling(*robot.machine, q)
    inertia = np.block([[robot.mass_matrix(q), S], [S.T, np.diag(J)]])
    return np.abs(poles) ** 2 * np.einsum("mi,ij,mj->m", moving.conj(), inertia, moving).real


def _largest(shapes: ComplexArray) -> ComplexArray:
    """Each row's entry of largest size, (m, 1)."""
    if not shapes.size:
        return np.ones((len(shapes), 1), complex)
    return np.take_along_axis(shapes, np.abs(shapes).argmax(axis=1)[:, None], axis=1)
