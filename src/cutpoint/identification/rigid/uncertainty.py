"""Confidence intervals of parameters, and what a log cannot determine."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import counted
from cutpoint.identification.rigid.base_parameters import BaseParameters, rotor_sizes
from cutpoint.identification.rigid.least_squares import Estimate
from cutpoint.mechanics.bodies.pseudo_inertia import nominal_sizes

TOLD = 0.3
"""A parameter is determined if its standard deviation is at most this share of its size, here or in the file."""


COSTLY = 1.1
"""Times the torque error without them: from there on it is told what physically consistent bodies cost."""

STRAINED = 2.0
"""Half widths of an interval from its middle: a model's number farther off contradicts the log."""


FRICTION = ("coulomb", "static", "viscous", "per_load")
"""Prefixes of friction parameters' names."""


class Parameter(NamedTuple):
    """A base parameter, or one of friction, or an offset, in SI units at the joint's side.

    value, low, high: from the log alone, with its interval.  physical: its value with physically consistent bodies.
    prior: its value in the robot's files; NaN if they have none.  told: whether this log determines it.
    why: the reason if not.
    """

    name: str
    value: float
    low: float
    high: float
    physical: float
    prior: float
    told: bool
    why: str


def parameters(
    names: Sequence[str], estimate: Estimate, physical: Array, prior: Array, sizes: Array, level: float
) -> tuple[Parameter, ...]:
    """All parameters with their intervals at a level, as 0.95.  sizes (c,): usual ones in such a robot."""
    values, deviations, margins = estimate.values, estimate.spread.deviations(), estimate.spread.margins(level)
    reasons = map(_why, deviations.tolist(), np.maximum(np.abs(values), sizes).tolist())
    numbers = np.column_stack([values, values - margins, values + margins, physical, prior]).tolist()
    rows = zip(names, numbers, reasons, strict=True)
    return tuple(Parameter(name, *own, told=not why, why=why) for name, own, why in rows)


def are_told(estimate: Estimate, first: int, sizes: Array) -> NDArray[np.bool_]:
    """Which parameters, the `first` and all after it, a log determines, (k,); sizes (k,): usual in such a robot."""
    reference = np.maximum(np.abs(estimate.values[first:]), sizes)
    return np.asarray(estimate.spread.deviations()[first:] <= TOLD * reference)


def _why(deviation: float, reference: float) -> str:
    if not np.isfinite(deviation):
        return "this motion does not excite it, or not separately from others"
    if deviation > TOLD * reference:
        return f"its standard deviation, {deviation:.3g}, is {deviation / reference:.0%} of its usual size"
    return ""


def untold(found: Sequence[Parameter], base: BaseParameters) -> tuple[str, ...]:
    """Sentences on what a log does not determine."""
    said = [f"{each.name}: {each.why}; {_instead(each)}" for each in found if not each.told]
    if base.unidentifiable:
        some = ", ".join(base.unidentifiable[:4]) + (" ..." if len(base.unidentifiable) > 4 else "")
        said.append(f"no torque of any motion tells {len(base.unidentifiable)} parameters singly: {some}")
    return tuple(said)


def _instead(found: Parameter) -> str:
    """What the robot has for a parameter that the log does not determine."""
    if np.isfinite(found.prior):
        return "the robot stays near what its file says"
    kind, _, joint = found.name.partition(".")
    if kind == "static":
        return f"as its file states none, it stays near coulomb.{joint}"
    return "its file states none: the robot has what fits best"


def reversed_signs(found: Sequence[Parameter]) -> list[str]:
    """A sentence on joints whose friction or inertia is negative."""
    reason = "is the sign of the torque or of the position reversed?"
    turned = _turned(found)
    return [f"friction or inertia of {turned} comes out negative: {reason}"] if turned else []


def strained(found: Sequence[Parameter], costs: Mapping[str, float]) -> list[str]:
    """Sentences if physically consistent bodies, near the file's, or friction could not match the log.

    None if signs are reversed, which explains both.
    costs: by joint, the model's torque error over that of the log's own numbers.
    """
    if _turned(found):
        return []
    far = [x.name for x in found if x.told and abs(x.physical - x.value) > STRAINED * (x.high - x.value)]
    rubs = [name for name in far if name.partition(".")[0] in FRICTION]
    bodies = [name for name in far if name not in rubs]
    notes: list[str] = []
    if bodies:
        missed = f"the intervals of {counted(len(bodies), 'told number')}, {_some(bodies)}"
        reason = "the file's bodies, near which they stay, may be placeholders; state roughly what they weigh"
        if more := [f"{cost:.2f} times at {joint}" for joint, cost in costs.items() if cost > COSTLY]:
            missed += f", and torque errors are larger for it ({', '.join(more)})"
            reason += "; or no bodies are like this: check axes, zeros and torque constants"
        notes.append(f"the model's bodies miss {missed}: {reason}")
    if rubs:
        reason = "no part of friction may push, nor be less at rest than in motion, nor take the whole load"
        notes.append(f"the model's friction misses the intervals of {_some(rubs)}: {reason}")
    return notes


def _turned(found: Sequence[Parameter]) -> str:
    """Joints with significantly negative friction, in all parameters that are determined, or rotor if none is."""
    signs: dict[str, list[bool]] = {}
    for kinds in (FRICTION, ("I_m",)):
        own: dict[str, list[bool]] = {}
        for each in found:
            kind, _, joint = each.name.partition(".")
            if kind in kinds and each.told and " " not in joint:
                own.setdefault(joint, []).append(each.high < 0.0)
        signs = own | signs
    return ", ".join(joint for joint, negative in signs.items() if all(negative))


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:3]) + (" ..." if len(names) > 3 else "")


def base_sizes(base: BaseParameters) -> Array:
    """Usual sizes of base parameters (b,) in a robot like this: that of the leading parameter in a body like its own,
    or of the whole in the file, whichever is larger."""
    robot = base.robot
    natural = [x for p in robot.inertial_parameters.reshape(-1, 10) for x in nominal_sizes(p.tolist())]
    natural += rotor_sizes(base)[0].tolist()
    return np.maximum(np.abs(np.array(natural)[base.independent]), np.abs(base.nominal))


def friction_sizes(names: Sequence[str], joints: Sequence[str], torque: Array, speed: Array) -> Array:
    """Usual sizes of friction, offsets, (k,): a tenth of the joint's RMS torque (n,), at its RMS speed (n,) if viscous.

    Where these are zero, 1 N m and 1 rad/s replace them.
    """
    torque, speed = (np.where(x > 0.0, x, 1.0) for x in (torque, speed))
    found: list[float] = []
    for name in names:
        kind, _, joint = name.partition(".")
        j = joints.index(joint)
        share = {"viscous": 1.0 / speed[j], "per_load": 1.0 / torque[j]}
        found.append(0.1 * torque[j] * share.get(kind, 1.0))
    return np.array(found)
