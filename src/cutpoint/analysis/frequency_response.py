"""From a motor's torque to the speeds on both sides of its drive, over frequency."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.analysis.linear_model import LinearModel
from cutpoint.arrays import Array, ComplexArray
from cutpoint.door import check_kind, checked_name, checked_numbers
from cutpoint.errors import InputError
from cutpoint.resolvent import resolvent

HAS_A_PEAK = 1 / np.sqrt(2)
"""A second-order resonance damped more than this has no peak over frequency."""

CANCELS = 0.005
"""Distance of a pole and a zero, relative to their frequency, below which they leave no mark on a motor's velocity."""

SHOWN = 0.1
"""Residue of a pole in the link's velocity, over that of all in the motor's, from which on it leaves a mark there."""

BESIDE = 1e-6
"""Distance from a pole, relative to its frequency, at which its residue is read."""


UNDAMPED = 1e-9
"""Distance of a pole from a frequency, relative to that: so near there is no damping but that of rounding."""


@dataclass(frozen=True, eq=False, repr=False)
class FrequencyResponse:
    """Response of a joint to a sinusoidal torque of its motor, with all other motors' torques held.

    Attributes:
        joint: the joint's name.
        frequencies: (F,) Hz.
        motor_velocity, link_velocity: (F,) complex, (rad/s)/(N m) at the joint's side; (m/s)/N on a prismatic joint.
        resonances: Hz, ascending, of the robot's poles in this band with damping low enough for a peak.
        antiresonances: Hz, likewise of the zeros of motor_velocity: the modes that remain with this motor locked.
            A pole and a zero within CANCELS of each other are a mode that this motor hardly excites: neither is listed,
            unless it shows in the link's velocity.
    """

    joint: str
    frequencies: Array
    motor_velocity: ComplexArray
    link_velocity: ComplexArray
    resonances: Array
    antiresonances: Array

    def __repr__(self) -> str:
        peaks, dips = (", ".join(f"{f:.4g}" for f in x) or "none" for x in (self.resonances, self.antiresonances))
        band = (
            f"{self.frequencies.size} frequencies from {self.frequencies.min():.4g} to {self.frequencies.max():.4g} Hz"
        )
        return f"FrequencyResponse({self.joint!r}, {band}: resonances {peaks}; anti-resonances {dips})"


def frequency_response(model: LinearModel, frequencies: ArrayLike, joint: str) -> FrequencyResponse:
    """C (s - A)^-1 B + D from a joint's motor torque to its motor's and its link's velocity, at s = 2 pi i frequency.

    With one elastic joint, link inertia M, reflected rotor inertia J and stiffness K, the anti-resonance is at
    sqrt(K / M), where the motor does not move, as if locked, and the resonance at sqrt(K (1 / M + 1 / J)), rad/s.

    Args:
        model: of `linearize`.
        frequencies: (F,) Hz, positive.
        joint: name of the driven joint.

    Raises:
        InputError: an unknown joint, frequencies that are not positive numbers, or one at an undamped resonance.
    """
    check_kind("frequency_response", "model", model, LinearModel, "the linear model of a robot, as linearize gives it")
    joint = checked_name("driven joint", joint, model.joints)
    f = _checked(frequencies)
    b = model.B[:, model.inputs.index(f"motor_torque.{joint}")]
    motor, link = (model.outputs.index(f"{side}.{joint}") for side in ("theta_dot", "v"))
    poles = _poles(model.A)
    _check_no_pole(f, poles)
    response = _resolvent(model.A, b)
    x = response(2j * np.pi * f.astype(np.complex128))
    swinging = _sharp(poles)
    shown = _residues(response, model.C[link], swinging) > SHOWN * abs(model.C[motor] @ b)
    left = _without_pairs(swinging, _sharp(motor_locked(model.A, b, model.C[motor])), shown)
    marks = [np.sort(np.abs(s)) / (2 * np.pi) for s in left]
    marks = [each[(each >= f.min()) & (each <= f.max())] for each in marks]
    return FrequencyResponse(joint, f, x @ model.C[motor], x @ model.C[link], *marks)


def motor_locked(A: Array, b: Array, c: Array) -> ComplexArray:
    """Zeros of c (s - A)^-1 b, rad/s, and a zero at 0: the poles left when b's input holds the output c x still.

    Isidori (1995) section 4.3: the zero dynamics, for an output that its input accelerates, c b != 0.
    """
    return _poles(A - np.outer(b, c @ A) / (c @ b))


def _poles(A: Array) -> ComplexArray:
    return np.linalg.eigvals(A).astype(np.complex128)


def _sharp(s: ComplexArray) -> ComplexArray:
    """Those that oscillate with a peak."""
    return s[(s.imag > 0) & (np.abs(s.real) < HAS_A_PEAK * np.abs(s))]


def _resolvent(A: Array, b: Array) -> Callable[[ComplexArray], ComplexArray]:
    """(s - A)^-1 b, (k, n), as a function of s (k,), by back substitution with one triangular form of A.

    A is balanced first: its entries differ by stiffness over inertia, which would cost half of the digits.
    """
    from scipy.linalg import matrix_balance, schur  # slow to import

    balanced: Any = matrix_balance(A, permute=False, separate=True)
    scale = balanced[1][0]
    triangular: Any = schur(balanced[0], output="complex")
    T, Q = triangular
    given = Q.conj().T @ (b / scale)
    return lambda s: (scale[:, None] * (Q @ resolvent(T, given, s))).T


def _residues(response: Callable[[ComplexArray], ComplexArray], c: Array, poles: ComplexArray) -> Array:
    """Magnitudes of the residues of c (s - A)^-1 b at each pole; the residues sum to c b."""
    steps = BESIDE * np.abs(poles)
    return np.abs(steps * (response(poles + steps) @ c))


def _without_pairs(
    poles: ComplexArray, zeros: ComplexArray, shown: NDArray[np.bool_]
) -> tuple[ComplexArray, ComplexArray]:
    """Poles and zeros that remain after each zero cancels the nearest pole that is not shown, if one is close."""
    left, kept = [*poles[~shown]], []
    for zero in zeros:
        near = min(left, key=lambda pole: abs(pole - zero), default=np.inf)
        if abs(near - zero) < CANCELS * abs(zero):
            left.remove(near)
        else:
            kept.append(zero)
    return np.array([*left, *poles[shown]], complex), np.array(kept, complex)


def _check_no_pole(f: Array, poles: ComplexArray) -> None:
    """Raises InputError for a frequency at which the response is infinite."""
    s = 2j * np.pi * f[:, None]
    hit = (np.abs(s - poles) < UNDAMPED * np.abs(s)).any(axis=1)
    if hit.any():
        found = f"{f[hit][0]:g} Hz is an undamped resonance"
        raise InputError(f"frequency_response: {found}; shift it slightly, or state a damping", frequency=f[hit][0])


def _checked(frequencies: ArrayLike) -> Array:
    f = checked_numbers("frequency_response", "frequencies", frequencies, "numbers (F,), Hz")
    if f.ndim != 1 or not f.size or not (np.isfinite(f) & (f > 0)).all():
        raise InputError("frequency_response: frequencies must be a list (F,) of positive finite numbers, Hz")
    return f
