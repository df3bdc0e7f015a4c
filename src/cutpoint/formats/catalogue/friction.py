"""Friction of a gear from its data sheet: starting torque, no-load running torque, efficiency."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from cutpoint.formats.catalogue.sheets import CatalogueGear
from cutpoint.model.units import RPM


@dataclass(frozen=True)
class InputFriction:
    """No-load torque at the input, N m: dry + slope w, w in rad/s; and the share that a load adds at the output.

    None if unknown.  estimated: which of the three were adopted from another gear.
    """

    dry: float | None = None
    slope: float | None = None
    per_load: float | None = None
    estimated: tuple[str, ...] = ()


def input_friction(gear: CatalogueGear, named: Callable[[str], CatalogueGear]) -> InputFriction:
    """Friction from a gear's sheet; missing data are taken from the gear that it is `like`.

    Starting torque is the dry part.  The slope goes through it and the running points by least squares.  The share of
    the load accounts for the remaining losses, by 1/eta - 1 = per_load + ratio (dry + slope w) / tau at an output
    torque tau.  If efficiency is known and running torque is not, all three follow from it, and starting torque is
    ignored.
    """
    own = _from_efficiency(gear) if gear.efficiency and not gear.running else _from_running(gear)
    if gear.friction is None:
        return own
    other, scale = input_friction(named(gear.friction.like), named), gear.friction.scale
    theirs = {"dry": times(other.dry, scale), "slope": times(other.slope, scale), "per_load": other.per_load}
    taken = {name: value for name, value in theirs.items() if getattr(own, name) is None and value is not None}
    known = {name: getattr(own, name) for name in theirs if name not in taken}
    return InputFriction(**known, **taken, estimated=tuple(taken))


def efficiency(friction: InputFriction, ratio: float, speed: float, torque: float) -> float:
    """Power out over power in, at a speed of the input (rad/s) and a torque at the output (N m)."""
    without_load = ratio * ((friction.dry or 0.0) + (friction.slope or 0.0) * speed)
    return torque / (torque * (1 + (friction.per_load or 0.0)) + without_load)


def times(value: float | None, factor: float) -> float | None:
    """The product; None, for unknown, stays None."""
    return None if value is None else factor * value


def _from_running(gear: CatalogueGear) -> InputFriction:
    dry, slope = gear.starting.torque if gear.starting else None, None
    if gear.running:
        speed, torque = np.array(gear.running.points).T * [[RPM], [1.0]]
        if dry is None:
            dry, slope = nnls(np.column_stack([np.ones_like(speed), speed]), torque)[0].tolist()
        else:
            slope = max(0.0, float(speed @ (torque - dry) / (speed @ speed)))
    found = InputFriction(dry, slope)
    return replace(found, per_load=_share(gear, found))


def _share(gear: CatalogueGear, unloaded: InputFriction) -> float | None:
    if gear.efficiency is None:
        return None
    gaps = [1 / eta - 1 / efficiency(unloaded, gear.ratio, rpm * RPM, tau) for rpm, tau, eta in gear.efficiency.points]
    return max(0.0, float(np.mean(gaps)))


def _from_efficiency(gear: CatalogueGear) -> InputFriction:
    """Weights turn the residuals into those of the efficiency itself: d eta = -eta^2 d(1/eta)."""
    assert gear.efficiency is not None
    rpm, tau, eta = np.array(gear.efficiency.points).T
    factors = np.column_stack([gear.ratio / tau, gear.ratio * rpm * RPM / tau, np.ones_like(tau)])
    return InputFriction(*nnls(factors * (eta**2)[:, None], (1 / eta - 1) * eta**2)[0].tolist())
