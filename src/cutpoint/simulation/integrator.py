"""Fixed-step integration between two control samples, and how fine its steps must be."""

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.mechanics.motor import TURN
from cutpoint.mechanics.presliding import Presliding
from cutpoint.model.drive import Drive, Friction
from cutpoint.robot import Robot
from cutpoint.scalars import Scalar

Array = NDArray[np.float64]

TABLEAU = np.array([[1 / 2, 1 / 6], [1 / 2, 1 / 3], [1.0, 1 / 3], [0.0, 1 / 6]])
"""Classical Runge-Kutta of order 4, a row a stage: how far to go for the next stage, and this stage's weight."""

SETTINGS = {"standard": (0.25, 2.0, 2.5e-4), "fine": (0.1, 0.25, 6.25e-5)}
"""Largest step: times the fastest drive mode (rad/s), times the fastest friction decay (1/s), and in s."""

MOST_SUBSTEPS = 400


class StiffnessWarning(UserWarning):
    """The fixed-step integrator cannot follow the plant's fastest part."""


def stage(
    k: list[Scalar], origin: list[Scalar], total: list[Scalar], row: list[Scalar], h: Scalar
) -> tuple[list[Scalar], list[Scalar]]:
    """The next stage's state, and the step's result so far, from the rates k.  Hairer et al. (1993) section II.1."""
    ahead, weight = row[0] * h, row[1] * h
    y = [x + ahead * r for x, r in zip(origin, k, strict=True)]
    return y, [x + weight * r for x, r in zip(total, k, strict=True)]


class Limit(NamedTuple):
    """A rate (rad/s of a mode, 1/s of a decay) that steps must follow, and what in the robot has it."""

    rate: float
    cause: str


class Steps(NamedTuple):
    """Integration steps a control period, and what asks for as many."""

    number: int
    cause: str


def substeps_for(robot: Robot, accuracy: str, period: float, poses: Array) -> Steps:
    """Steps a control period so that every drive mode, friction law and current loop is followed at poses (m, nq)."""
    mode_steps, decay_steps, longest = SETTINGS[accuracy]
    mode, decay = fastest_mode(robot, poses), fastest_decay(robot, poses)
    bounds = [(longest, "the longest step of this accuracy")]
    bounds += [(share / max(x.rate, 1e-9), x.cause) for share, x in ((mode_steps, mode), (decay_steps, decay))]
    step, cause = min(bounds)
    wanted = int(np.ceil(period / step - 1e-9))
    if wanted > MOST_SUBSTEPS:
        warnings.warn(
            f"{cause} would take {wanted} integration steps a control period (its fastest mode is "
            f"{mode.rate / 2 / np.pi:.0f} Hz, its fastest decay {decay.rate:.0f} 1/s); {MOST_SUBSTEPS} are taken. "
            "Soften it (smoothing, distance, stiffness, damping), or give substeps=",
            StiffnessWarning,
            stacklevel=4,
        )
    return Steps(max(1, min(wanted, MOST_SUBSTEPS)), cause)


def fastest_mode(robot: Robot, poses: Array) -> Limit:
    """Highest angular frequency of links and rotors on springs and bristles, nothing slipping yet."""
    names, drives = [*robot.drives], [*robot.drives.values()]
    elastic = np.array([d.is_elastic for d in drives], bool)
    bristles = np.array([[_bristles(d.link_friction), _bristles(d.motor_friction)] for d in drives]).reshape(-1, 2)
    J_inverse = _rotor_mobility(robot)
    best = Limit(0.0, "nothing that swings")
    for q in poses:
        M_inverse, lead = _link_mobility(robot, q), robot.static_deflection(q)
        K = np.array([_spring_stiffness(d, x) for d, x in zip(drives, lead, strict=True)])
        on_link = K + bristles[:, 0] + np.where(elastic, 0.0, bristles[:, 1])
        # [a; theta''] = -[M^-1 (K + b_l), -M^-1 K; -J^-1 K, J^-1 (K + b_m)] [q; theta]
        squares, shapes = np.linalg.eig(
            np.block([
                [M_inverse * on_link, -M_inverse * K],
                [-np.diag(J_inverse * K), np.diag(J_inverse * (K + bristles[:, 1]))],
            ])
        )  # fmt: skip
        if len(squares) and (rate := float(np.sqrt(np.abs(squares).max()))) > best.rate:
            k = int(np.abs(shapes[:, np.abs(squares).argmax()]).argmax()) % len(drives)
            parts = {"spring": K[k], "link friction's bristles": bristles[k, 0]}
            parts["motor friction's bristles"] = bristles[k, 1]
            best = Limit(rate, f"the {max(parts, key=lambda part: parts[part])} of {names[k]!r}")
    return best


def fastest_decay(robot: Robot, poses: Array) -> Limit:
    """Fastest decay by friction, damping and current loops."""
    names, drives = [*robot.drives], [*robot.drives.values()]
    J_inverse = _rotor_mobility(robot)
    link = np.array([_slope(d.link_friction) for d in drives])
    motor = np.array([_slope(d.motor_friction) for d in drives])
    damping = np.array([d.damping or 0.0 if d.is_elastic else 0.0 for d in drives])
    rigid = np.array([0.0 if d.is_elastic else 1.0 for d in drives])
    found = [Limit(0.0, "nothing that decays")]
    for name, drive, rate in zip(names, drives, (motor + damping) * J_inverse, strict=True):
        found.append(Limit(float(rate), f"the motor friction or damping of {name!r}"))
        if drive.motor is not None and drive.motor.bandwidth is not None:
            found.append(Limit(TURN * drive.motor.bandwidth, f"the current loop of {name!r}"))
    for q in poses if drives else ():
        rates, shapes = np.linalg.eig(_link_mobility(robot, q) * (link + damping + rigid * motor))
        k = int(np.abs(shapes[:, np.abs(rates).argmax()]).argmax())
        found.append(Limit(float(np.abs(rates).max()), f"the friction or damping on the link of {names[k]!r}"))
    return max(found)


def _link_mobility(robot: Robot, q: Array) -> Array:
    """M^-1 of the driven joints."""
    driven = np.array([d.v for d in robot.machine.drives], int)
    return np.asarray(np.linalg.inv(robot.mass_matrix(q)), np.float64)[np.ix_(driven, driven)]


def _rotor_mobility(robot: Robot) -> Array:
    return np.array([1 / d.reflected_inertia if d.is_elastic else 0.0 for d in robot.drives.values()], np.float64)


def _spring_stiffness(drive: Drive, lead: float) -> float:
    if drive.compliance is None:
        return 0.0
    return float(drive.compliance.tangent(lead)) + (sum(drive.hysteresis.stiffness) if drive.hysteresis else 0.0)


def _bristles(law: Friction | None) -> float:
    return float(law.stiffness) if isinstance(law, Presliding) else 0.0


def _slope(law: Friction | None) -> float:
    """d torque / d speed of a friction law at rest, where it is steepest; of bristles, of their damping."""
    if law is None:
        return 0.0
    if isinstance(law, Presliding):
        return float(law.damping + law.sliding.viscosity)
    small = 1e-6
    return float((law.torque(small) - law.torque(-small)) / (2 * small))
