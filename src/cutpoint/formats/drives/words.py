"""A `Drive` as an entry of a drive file that gives the same drive when read back."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.formats.drives.friction_entry import friction_entry
from cutpoint.formats.drives.spring_sheets import MOST_ELEMENTS
from cutpoint.mechanics.drives.backlash import Backlash, spring_of
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip, loss_of
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring
from cutpoint.model.drive import Compliance, Drive, Harmonic, Motor, Rotor
from cutpoint.model.mechanism import Limits
from cutpoint.scalars import is_of_cutpoint


def to_entry(drive: Drive) -> dict[str, Any]:
    """The fields that give the same drive when read back, defaults left out.

    Raises InputError for anything a drive file cannot express.
    """
    frictions = drive.link_friction, drive.motor_friction
    sliding = (getattr(law, "sliding", None) for law in frictions)
    for law in (drive.compliance, drive.hysteresis, drive.kinematic_error, *frictions, *sliding):
        if law is not None and not is_of_cutpoint(law):
            raise InputError(f"a drive file cannot express {law!r}, a law of your own", law=law)
    spring = spring_of(drive.compliance)
    if isinstance(spring, HarmonicSpring) and spring.wave_generator.ratio != abs(drive.ratio):
        raise InputError("a drive file has one ratio, and the wave generator's differs", ratio=drive.ratio)
    friction = {"link": friction_entry(drive.link_friction), "motor": friction_entry(drive.motor_friction)}
    fields = {
        "rotor": drive.rotor and _rotor_entry(drive.rotor),
        "compliance": _spring_entry(spring) or "rigid",
        "backlash": float(drive.compliance.gap) if isinstance(drive.compliance, Backlash) else None,
        "damping": _number(drive.damping),
        "hysteresis": _hysteresis_entry(drive.hysteresis, spring),
        "kinematic_error": _error_entry(drive.kinematic_error),
        "friction": stated(friction) or None,
        "motor": drive.motor and _motor_entry(drive.motor),
        "limits": stated(_limits_entry(drive.limits)) or None,
        "ratings": drive.ratings and stated({name: _number(x) for name, x in vars(drive.ratings).items()}),
    }
    return {"ratio": float(drive.ratio)} | stated(fields)


def _spring_entry(law: Compliance | None) -> dict[str, Any] | None:
    match law:
        case None:
            return None
        case LinearSpring(stiffness):
            return {"linear": {"stiffness": float(stiffness)}}
        case Flexspline(stiffness, hardening):
            return {"flexspline": {"stiffness": float(stiffness), "hardening": float(hardening)}}
        case CatalogueSpring():
            return {"catalogue": {name: float(value) for name, value in vars(law).items()}}
        case HarmonicSpring(Flexspline() as flexspline, wave):
            own = {name: float(getattr(wave, name)) for name in ("stiffness", "hardening", "blend")}
            return (_spring_entry(flexspline) or {}) | {"wave_generator": own}
    raise InputError(f"a drive file cannot express {law!r}", law=law)


def _hysteresis_entry(law: Any, spring: Compliance | None) -> dict[str, Any] | None:
    """Only elements that follow `MaxwellSlip.smooth` can be expressed."""
    if law is None:
        return None
    if isinstance(law, MaxwellSlip) and spring is not None and len(law.reach) <= MOST_ELEMENTS and is_smooth(law):
        loss, reach, elements = loss_of(law, spring), law.reach[-1], len(law.reach)
        return {"loss": float(loss), "reach": float(reach), "elements": elements}
    raise InputError(f"a drive file cannot express {law!r}", law=law)


def is_smooth(law: MaxwellSlip) -> bool:
    """Whether its elements follow `MaxwellSlip.smooth`."""
    alike = MaxwellSlip.smooth(float(law.friction), law.reach[-1], len(law.reach))
    return np.allclose([*alike.stiffness, *alike.reach], [*law.stiffness, *law.reach], rtol=1e-12, atol=0.0)


def _error_entry(error: Any) -> dict[str, Any] | None:
    if error is None:
        return None
    if isinstance(error, KinematicError):
        return _waves_entry(error.harmonics)
    raise InputError(f"a drive file cannot express {error!r}", error=error)


def _waves_entry(waves: Sequence[Harmonic]) -> dict[str, Any] | None:
    if not waves:
        return None
    first, *further = [[int(wave.order), float(wave.amplitude), float(wave.phase)] for wave in waves]
    entry: dict[str, Any] = dict(zip(("order", "amplitude", "phase"), first, strict=True))
    return entry | ({"harmonics": further} if further else {})


def _motor_entry(motor: Motor) -> dict[str, Any]:
    numbers = {name: _number(value) for name, value in vars(motor).items() if name not in ("ripple", "cogging")}
    return stated(numbers | {"ripple": _waves_entry(motor.ripple), "cogging": _waves_entry(motor.cogging)})


def _rotor_entry(rotor: Rotor) -> dict[str, Any]:
    """Its own mass only if the link does not include it: otherwise it has no meaning, and reading would refuse it."""
    if rotor.inertia == 0:
        raise InputError(f"a drive file cannot express {rotor!r}; a rotor without inertia is no rotor", rotor=rotor)
    own = () if rotor.in_link_inertia else ("mass", "transverse", "position")
    entry = {"inertia": float(rotor.inertia), "in_link_inertia": bool(rotor.in_link_inertia)}
    entry |= {name: float(value) for name in own if (value := getattr(rotor, name))}
    return entry | ({"coupling": "full"} if rotor.coupling == "full" else {})


def _limits_entry(limits: Limits) -> dict[str, Any]:
    position = [float(limits.lower), float(limits.upper)]
    bounded = np.isfinite(position).any()
    effort, velocity = _number(limits.effort), _number(limits.velocity)
    return {"torque": effort, "velocity": velocity, "position": position if bounded else None}


def _number(value: float | None) -> float | None:
    """A number as a file states it: None if there is none, or no bound."""
    return float(value) if value is not None and np.isfinite(value) else None


def stated(fields: dict[str, Any]) -> dict[str, Any]:
    """The fields that have a value."""
    return {name: value for name, value in fields.items() if value is not None}
