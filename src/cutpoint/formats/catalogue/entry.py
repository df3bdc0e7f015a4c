"""A catalogue gear as an entry of a drive file: from makers' data to the laws' parameters."""

from typing import Any

from cutpoint.formats.catalogue.friction import InputFriction, times
from cutpoint.formats.catalogue.sheets import CatalogueGear
from cutpoint.formats.drives.words import stated
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.model.units import ARC_MINUTE, RPM


def drive_entry(gear: CatalogueGear, friction: InputFriction) -> dict[str, Any]:
    """A drive's fields known from the catalogue; the circular spline is fixed, the flexspline turns the joint."""
    spring = _spring(gear)
    fields = {
        "gear": {"reduction": float(gear.ratio), "fixed": "circular_spline"},
        "rotor": _rotor(gear),
        "compliance": spring and {"catalogue": {name: float(x) for name, x in vars(spring).items()}},
        "hysteresis": spring and _hysteresis(gear, spring),
        "kinematic_error": gear.accuracy and _kinematic_error(gear.accuracy.transmission_arcmin),
        "friction": _friction(gear, friction),
        "motor": _motor(gear),
        "limits": _limits(gear),
        "ratings": _ratings(gear),
    }
    return _rounded(stated(fields))


def _rotor(gear: CatalogueGear) -> dict[str, float] | None:
    """The inertia on the motor's side: the wave generator, and an actuator's rotor."""
    parts = [gear.inertia and gear.inertia.wave_generator, gear.motor and gear.motor.inertia]
    inertia = sum(part for part in parts if part)
    return {"inertia": inertia} if inertia else None


def _spring(gear: CatalogueGear) -> CatalogueSpring | None:
    """The gear's curve, in series with an actuator's spring: deflections of straight segments add up."""
    if gear.stiffness is None:
        return None
    softer = 1 / gear.output.spring if gear.output and gear.output.spring else 0.0
    own = gear.stiffness
    k1, k2, k3 = (k if softer == 0.0 else 1 / (1 / k + softer) for k in (own.k1, own.k2, own.k3))
    return CatalogueSpring(k1, k2, k3, own.t1, own.t2)


def _hysteresis(gear: CatalogueGear, spring: CatalogueSpring) -> dict[str, float] | None:
    """Hysteresis loss is the loop's width in a cycle to rated torque.

    The return from there to zero torque must strain the elements from one side to the other, twice their reach; if the
    default reach, the loss itself, is too large for that, it is reduced.
    """
    if gear.hysteresis is None:
        return None
    loss = gear.hysteresis.loss_arcmin * ARC_MINUTE
    if gear.ratings is None:
        return {"loss": loss}
    slipping = spring.torque(loss / 2)
    way_back = float(spring.deflection(gear.ratings.rated - slipping)) - loss / 2
    farthest = 0.9 * way_back / 2
    return {"loss": loss} if loss <= farthest else {"loss": loss, "reach": farthest}


def _kinematic_error(arc_minutes: float) -> dict[str, float]:
    """Catalogues state accuracy peak to peak."""
    return {"amplitude": arc_minutes * ARC_MINUTE / 2, "order": 2.0}


def _friction(gear: CatalogueGear, friction: InputFriction) -> dict[str, Any] | None:
    """At the joint: dry torque times ratio, viscous friction times its square; a motor's own adds to the gear's."""
    law = {
        "coulomb": times(_sum(friction.dry, gear.motor and gear.motor.coulomb), gear.ratio),
        "viscous": times(_sum(friction.slope, gear.motor and gear.motor.viscous), gear.ratio**2),
        "per_load": friction.per_load,
    }
    return {"motor": known} if (known := stated(law)) else None


def _motor(gear: CatalogueGear) -> dict[str, float] | None:
    """An AC supply says little about the voltage at the winding, and is left out."""
    if (own := gear.motor) is None:
        return None
    numbers = {
        "torque_constant": own.torque_constant,
        "resistance": own.resistance,
        "current_limit": own.current_peak,
        "voltage_limit": own.voltage,
    }
    return stated(numbers)


def _limits(gear: CatalogueGear) -> dict[str, float] | None:
    """An actuator's own limits, or a gear's largest input speed; a gear's torques are ratings, not motor limits."""
    torque = gear.output.maximum_torque if gear.output else None
    rpm = gear.output.maximum_rpm if gear.output else gear.speeds and gear.speeds.maximum_rpm / gear.ratio
    found = {"torque": torque, "velocity": rpm and rpm * RPM}
    return stated(found) or None


def _ratings(gear: CatalogueGear) -> dict[str, float] | None:
    torques, speeds = gear.ratings, gear.speeds
    found = {
        "rated_torque": torques and torques.rated,
        "average_torque": torques and torques.average,
        "repeated_peak_torque": torques and torques.repeated_peak,
        "momentary_peak_torque": torques and torques.momentary_peak,
        "rated_speed": torques and torques.rated_rpm * RPM,
        "average_speed": speeds and speeds.average_rpm * RPM,
        "maximum_speed": speeds and speeds.maximum_rpm * RPM,
        "life": gear.life and gear.life.hours,
    }
    return stated(found) or None


def _sum(known: float | None, more: float | None) -> float | None:
    return (known or 0.0) + more if more else known


def _rounded(value: Any) -> Any:
    """Rounded to ten digits, for readable files."""
    if isinstance(value, dict):
        return {name: _rounded(x) for name, x in value.items()}
    return float(f"{value:.10g}") if isinstance(value, float) else value
