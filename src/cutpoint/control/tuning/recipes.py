"""Gains of each law from a `Design`."""

from collections.abc import Callable
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control.gains import gains, motor_limits
from cutpoint.control.laws.adaptive_vdc import AdaptiveVDC
from cutpoint.control.laws.computed_torque import ComputedTorque
from cutpoint.control.laws.elastic_computed_torque import ElasticComputedTorque
from cutpoint.control.laws.full_state_feedback import FullStateFeedback
from cutpoint.control.laws.pd import PD
from cutpoint.control.laws.pid import PID
from cutpoint.control.laws.robust import Robust
from cutpoint.control.laws.slotine_li import SlotineLi
from cutpoint.control.laws.super_twisting import SuperTwisting
from cutpoint.control.laws.vdc import VDC
from cutpoint.control.tuning.design import Design
from cutpoint.control.tuning.learning_rates import STROKE, SWING, body_rate, joint_rate
from cutpoint.joint_units import are_prismatic
from cutpoint.model.drive import Drive

FASTEST, DAMPED = 0.6, 0.7
"""Of the springs' own poles in the closed loop: the most radians in a control period, beyond which sampling would
excite them, and their damping ratio.  Chosen on two arms, of 0.4 to 1.4 rad and 0.3 to 1."""

INTEGRAL = 0.25
"""Of the natural frequency of PID's pair of poles: where its third pole lies."""


def _pd(w: Design, **options: Any) -> PD:
    return PD(w.stiffness, 2 * w.damping * w.omega * w.inertia, **options)


def _pid(w: Design, **options: Any) -> PID:
    """Poles of (s^2 + 2 zeta u s + u^2) (s + INTEGRAL u), with u below omega such that kp equals that of PD."""
    u = w.omega / np.sqrt(1 + 2 * w.damping * INTEGRAL)
    ki, kd = INTEGRAL * u**3 * w.inertia, (2 * w.damping + INTEGRAL) * u * w.inertia
    return PID(w.stiffness, ki, kd, **{"limit": motor_limits(w.robot), **options})


def _vdc(w: Design, law: Any, **options: Any) -> Any:
    """A spring gain above the position gain, by more if a filter differentiates, so that link speed feedback damps."""
    filtered = law is AdaptiveVDC or options.get("derivatives") == "filter"
    motor = np.where(w.rotor > 0, 2 * w.omega * w.rotor, 0.0)
    return law(w.robot, w.omega, w.omega * w.link, motor, (8 if filtered else 4) * w.omega, **options)


def _adaptive_vdc(w: Design, **options: Any) -> AdaptiveVDC:
    rates = {
        "body_rate": body_rate(w, natural=options.get("update") == "natural"),
        "joint_rate": joint_rate(w, 8 * w.omega),
    }
    return _vdc(w, AdaptiveVDC, **{**rates, **options})


def _slotine_li(w: Design, **options: Any) -> SlotineLi:
    return SlotineLi(w.robot, w.omega, w.omega * w.inertia, **{"rate": body_rate(w), **options})


def _robust(w: Design, **options: Any) -> Robust:
    """Within its width the bounded term adds the damping bound / width, here at most the speed gain."""
    bound, speed_gain = gains("Robust", "bound", options.get("bound", _missed(w)), len(w.inertia)), w.omega * w.inertia
    width = np.maximum(0.05, bound / speed_gain)
    return Robust(w.robot, w.omega, speed_gain, **{"width": width, **options, "bound": bound})


def _full_state(w: Design, **options: Any) -> FullStateFeedback:
    """Damping for the reduced inertia, which the same stiffness accelerates faster."""
    shaping = gains("FullStateFeedback", "shaping", options.get("shaping", 0.5), len(w.inertia))
    left = w.link + np.where(w.rotor > 0.0, shaping, 1.0) * w.rotor
    damping = 2 * w.damping * w.omega * np.sqrt(w.inertia * left)
    return FullStateFeedback(w.robot, w.stiffness, damping, **{"lead": w.period, **options})


def _elastic_computed_torque(w: Design, **options: Any) -> ElasticComputedTorque:
    """Springs are damped where they resonate: moving them far takes feedback that cancels the springs."""
    frequency = np.maximum(np.minimum(w.resonance, FASTEST / w.period), 2 * w.omega)
    return ElasticComputedTorque(w.robot, w.omega, **{"frequency": frequency, "damping": DAMPED, **options})


RECIPES: dict[Any, Callable[..., Any]] = {
    PD: _pd,
    PID: _pid,
    ComputedTorque: lambda w, **o: ComputedTorque(w.robot, w.omega**2, 2 * w.damping * w.omega, **o),
    ElasticComputedTorque: _elastic_computed_torque,
    FullStateFeedback: _full_state,
    VDC: lambda w, **o: _vdc(w, VDC, **o),
    AdaptiveVDC: _adaptive_vdc,
    SlotineLi: _slotine_li,
    Robust: _robust,
    SuperTwisting: lambda w, **o: SuperTwisting(
        w.robot, w.omega, w.omega * w.inertia, **{"root_gain": _missed(w), "twist": w.omega * _missed(w), **o}
    ),
}


def _missed(w: Design) -> Array:
    """Assumed model error, N m: a tenth of the gravity torque of joints of a kind, and half of the friction."""
    slides = np.array(are_prismatic(w.robot), bool)
    weight: Array = np.zeros(len(w.inertia))
    for kind in (slides, ~slides):
        weight[kind] = np.abs(w.weight[kind]).max(initial=0.0) * w.inertia[kind] / w.inertia[kind].max(initial=1e-12)
    fastest = [limits.velocity for limits in w.robot.limits.values()]
    speeds = np.minimum(w.omega * np.where(slides, STROKE, SWING), fastest)
    friction = [_friction(drive, v) for drive, v in zip(w.robot.drives.values(), speeds, strict=True)]
    return 0.1 * weight + 0.5 * np.array(friction) + 1e-3


def _friction(drive: Drive, speed: float) -> float:
    """Friction on both sides, N m at the joint."""
    laws = [law for law in (drive.link_friction, drive.motor_friction) if law is not None]
    return sum(abs(float(law.torque(speed))) for law in laws)
