"""The fastest dynamics of a robot that integration steps must resolve: modes, decays, slipping, stops, waves."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.functions.idle_joints import check_moves_inertia
from cutpoint.mechanics.drives.harmonic_drive import friction_resistance, waves_of
from cutpoint.mechanics.drives.presliding import Presliding, sliding_of
from cutpoint.mechanics.rotor_coupling import rotor_coupling, rotor_mobility, without_rotors
from cutpoint.model.drive import Drive, Friction
from cutpoint.robot import Robot
from cutpoint.simulation.steps.spring_slopes import stiffest

STOPPED, PULLED, TIED = 16.0, 0.2, 3.0
"""Steps times rates of friction at rest, and of a spring's damping, up to either of which what must stop does stop; and
how much of damping is taken off friction there, since it ties what slides to its other side."""

SINGULAR = 1e12
"""Condition of a mass matrix, of any units, from which on it is asked whether inertia is missing."""

SLIPPING = np.geomspace(1e-7, 1e3, 1000)
"""Speeds at which it is asked how friction falls, rad/s."""

FEW = 256
"""Rows of a matrix up to which all its eigenvalues are found; of a larger one the largest alone."""


class Limit(NamedTuple):
    """A rate (rad/s of a mode, 1/s of a decay) that steps must resolve, and its source in the robot."""

    rate: float
    cause: str


class Posture(NamedTuple):
    """A configuration q (nq,), and the accelerations of all links and rotors per unit torque on each of them.

    mobility: (2 drives, 2 drives), 1/(kg m2); zero for a rigid drive's rotor.
    """

    q: Array
    mobility: Array


def posture(robot: Robot, q: Array) -> Posture:
    """By [M, S; S^T, J]^-1, see `mechanics.rotor_coupling`.  Raises ModelError: a joint moves no inertia."""
    driven, J_inverse = [d.v for d in robot.machine.drives], rotor_mobility(robot.machine.drives)
    S = rotor_coupling(*robot.machine, q)
    free = without_rotors(robot.machine.drives, robot.mass_matrix(q), S)
    if free.size and (sizes := np.linalg.eigvalsh(free))[0] * SINGULAR < sizes[-1]:
        check_moves_inertia(robot.mechanism, robot.machine)
    link = np.linalg.inv(free)
    cross = -link @ S * J_inverse
    rotor = np.diag(J_inverse) - (S * J_inverse).T @ cross
    return Posture(q, np.block([[link[np.ix_(driven, driven)], cross[driven]], [cross[driven].T, rotor]]))


def fastest_mode(robot: Robot, postures: Sequence[Posture], deflections: Array | None = None) -> Limit:
    """Highest angular frequency of links and rotors on springs and bristles, while nothing slips.

    It is attributed to the part with most of the mode's strain energy.
    deflections: (m, drives), of the springs at the postures; by default those under gravity.
    """
    names, drives = [*robot.drives], [*robot.drives.values()]
    elastic = np.array([d.is_elastic for d in drives], bool)
    bristles = np.array([[_bristles(d.link_friction), _bristles(d.motor_friction)] for d in drives]).reshape(-1, 2)
    best = Limit(0.0, "nothing that swings")
    for m, (q, mobility) in enumerate(postures):
        lead = robot.static_deflection(q) if deflections is None else deflections[m]
        K = np.array([stiffest(*each) for each in zip(drives, lead, robot.effort_limits, strict=True)])
        square, shape = _largest_eigenvalue(_swing(mobility, K, bristles, elastic))
        if (rate := float(np.sqrt(square))) > best.rate:
            best = Limit(rate, _most_strained(names, K, bristles, elastic, shape))
    return best


def fastest_decay(robot: Robot) -> Limit:
    """Fastest decay that is not integrated implicitly: that of the current loops."""
    motors = {name: d.motor for name, d in robot.drives.items() if d.motor and d.motor.bandwidth is not None}
    loops = [Limit(math.tau * motor.bandwidth, f"the current loop of {name!r}") for name, motor in motors.items()]
    return max([Limit(0.0, "nothing that decays"), *loops])


def fastest_reversal(robot: Robot, postures: Sequence[Posture]) -> Limit:
    """Fastest decay by bristles that slip and reverse within a step, which its implicit part does not include."""
    names, drives = [*robot.drives], [*robot.drives.values()]
    on_link = np.array([_unwinding(d.link_friction) for d in drives])
    on_motor = np.array([_unwinding(d.motor_friction) for d in drives])
    elastic = np.array([d.is_elastic for d in drives], bool)
    on_link, on_motor = on_link + np.where(elastic, 0.0, on_motor), np.where(elastic, on_motor, 0.0)
    rates = np.zeros(len(names))
    for _, mobility in postures if on_link.any() or on_motor.any() else ():
        at_link, at_motor = np.split(np.diag(mobility), 2)
        rates = np.max([rates, on_link * at_link, on_motor * at_motor], axis=0)
    of_each = zip(names, rates.tolist(), strict=True)
    found = [Limit(rate, f"the damping of the bristles of {name!r}") for name, rate in of_each]
    return max([Limit(0.0, "nothing that turns back"), *found])


def fastest_growth(robot: Robot, postures: Sequence[Posture]) -> Limit:
    """Fastest growth of slip where friction falls with speed, as in Stribeck's law."""
    names, drives = [*robot.drives], [*robot.drives.values()]
    motor = np.array([_fall(d.motor_friction) for d in drives])
    rigid = np.array([not d.is_elastic for d in drives], bool)
    link = np.array([_fall(d.link_friction) for d in drives]) + rigid * motor
    falls = np.concatenate([link, motor])
    where = [f"slipping of {name!r}" for name in names] + [f"slipping of the motor of {name!r}" for name in names]
    best = Limit(0.0, "nothing that slips")
    for _, mobility in postures if falls.any() else ():
        rate, shape = _largest_eigenvalue(mobility * falls)
        best = max(best, Limit(rate, where[int((falls * shape**2).argmax())]))
    return best


def fastest_stop(robot: Robot, postures: Sequence[Posture], slip: float) -> Limit:
    """Fastest stop of a motor by friction while its spring's damping pulls as fast: longer steps would let it slide on.

    slip: rad, least deflection by dry friction for which it matters: the resulting error of the motor's position.
    Either alone is stable with steps of any length.  A rate of 1 allows a step of 1 s, with STOPPED and PULLED, which
    were fitted to one joint with friction 3 to 1e4 times, and damping 0.03 to 1e3 times, as fast as a step.
    """
    best = Limit(0.0, "nothing that stops")
    soft = [d.is_elastic and bool(d.damping) and _wound_by(d) > slip for d in robot.drives.values()]
    damping = np.array([d.damping or 0.0 for d in robot.drives.values()]) * soft
    stops = np.maximum([_grip(d.motor_friction) for d in robot.drives.values()] - TIED * damping, 0.0) * soft
    for _, mobility in postures if any(soft) else ():
        rates = np.diag(mobility)[len(soft) :] * np.minimum(stops / STOPPED, damping / PULLED)
        which = f"friction beside the damping of {[*robot.drives][int(rates.argmax())]!r}"
        best = max(best, Limit(float(rates.max()), which))
    return best


def fastest_wave(robot: Robot, speeds: Array) -> Limit:
    """Fastest wave of torque or kinematic error, rad/s, of drives that turn with speeds (n,), rad/s at the joint."""
    best = Limit(0.0, "nothing that waves")
    for (name, drive), speed in zip(robot.drives.items(), speeds, strict=True):
        order = max((wave.order for wave in waves_of(drive) if wave.amplitude), default=0)
        rate = float(order * abs(drive.ratio * speed))
        best = max(best, Limit(rate, f"waves of order {order} of the motor of {name!r}"))
    return best


def _swing(mobility: Array, K: Array, bristles: Array, elastic: NDArray[np.bool_]) -> Array:
    """-[a; theta''] for each of [q; theta]: mobility [K + b_l, -K; -K, K + b_m]; a rigid drive's b_m acts on its link.

    K: (drives,), N m/rad.  bristles: (drives, 2), b_l and b_m, N m/rad.
    """
    by_link, by_motor = np.hsplit(mobility, 2)
    on_link, on_motor = K + bristles[:, 0] + np.where(elastic, 0.0, bristles[:, 1]), K + bristles[:, 1]
    return np.hstack([by_link * on_link - by_motor * K, by_motor * on_motor - by_link * K])


def _most_strained(names: Sequence[str], K: Array, bristles: Array, elastic: NDArray[np.bool_], shape: Array) -> str:
    """The part with most of a mode's strain energy.  K, bristles: as in `_swing`."""
    at_link, at_motor = np.split(shape, 2)
    at_motor = np.where(elastic, at_motor, at_link)
    strains = {
        "spring": K * (at_motor - at_link) ** 2,
        "link friction's bristles": bristles[:, 0] * at_link**2,
        "motor friction's bristles": bristles[:, 1] * at_motor**2,
    }
    part = max(strains, key=lambda part: strains[part].max())
    return f"the {part} of {names[int(strains[part].argmax())]!r}"


def _largest_eigenvalue(A: Array) -> tuple[float, Array]:
    """Its magnitude, and its vector; A is a product of two positive semidefinite matrices.

    Of a large A by 200 power iterations: from a random start these come within some 4 % of it, however dense the
    eigenvalues lie.  Kuczynski and Wozniakowski (1992).
    """
    if not len(A):
        return 0.0, np.zeros(0)
    if len(A) <= FEW:
        values, vectors = np.linalg.eig(A)
        k = int(np.abs(values).argmax())
        return float(np.abs(values[k])), np.real(vectors[:, k])
    x, size = np.random.default_rng(0).standard_normal(len(A)), 1.0
    for _ in range(200):
        x = A @ (x / size)
        if not (size := float(np.linalg.norm(x))):
            break
    return size, x


def _bristles(law: Friction | None) -> float:
    return float(law.stiffness) if isinstance(law, Presliding) else 0.0


def _grip(law: Friction | None) -> float:
    """Slope of friction with speed at rest, N m s/rad; bristles stick instead."""
    return float(friction_resistance(law, 0.0, 0, 0.0))


def _wound_by(drive: Drive) -> float:
    """Deflection of a drive's spring under its motor's dry friction, rad."""
    law, spring = sliding_of(drive.motor_friction), drive.compliance
    return 0.0 if law is None or spring is None else float(spring.deflection(law.plateau(0.0)))


def _unwinding(law: Friction | None) -> float:
    """Resistance of bristles after a reversal, N m s/rad."""
    return float(law.damping * law.most_winding) if isinstance(law, Presliding) else 0.0


def _fall(law: Friction | None) -> float:
    """Steepest fall of friction with speed, N m s/rad."""
    if law is None:
        return 0.0
    return max(0.0, -float((np.diff(law.torque(SLIPPING)) / np.diff(SLIPPING)).min()))
