"""Validation of drives, before any law uses them."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, NamedTuple

import numpy as np

from cutpoint.door import check_kind
from cutpoint.errors import ModelError, listed, unknown_name
from cutpoint.model.drive import Drive, Harmonic
from cutpoint.model.drive_rules import KINDS, OFFERED, RISING, RULES, WAVES, WITHIN, Rule, is_number
from cutpoint.model.mechanism import Mechanism
from cutpoint.model.own_laws import is_own, wrong_in_friction, wrong_in_spring
from cutpoint.scalars import leaves

STEEPEST = 0.7
"""Of a kinematic error, rad of output for each of the motor's: up to there its inverse is found for any waves."""

STEEPEST_CORNER = 30.0
"""Between neighbouring segments a catalogue's stiffness changes by no more of a factor: its inverse, five Newton steps,
is then within 1e-9."""


DRIVES = "a mapping of joint names to Drives"
"""What arguments that give drives must be."""


class Complaint(NamedTuple):
    """What is wrong in a drive, and in which field, such as "motor_friction.sliding.coulomb".

    number: the field's value, if `words` only complete the sentence; None if they are the whole message.
    """

    field: str
    words: str
    number: Any = None

    def __str__(self) -> str:
        part, _, name = self.field.rpartition(".")
        return self.words if self.number is None else f"{name} {self.number} {self.words}{part and f', in {part}'}"


def validated_drives(mechanism: Mechanism, drives: Mapping[str, Drive]) -> dict[str, Drive]:
    """A drive for every driven joint, in their order.  Raises ModelError or InputError."""
    joints = mechanism.driven_joints
    check_kind("Robot", "drives", drives, Mapping, DRIVES)
    for name, drive in drives.items():
        if name not in joints:
            raise unknown_name("driven joint", name, joints)
        check_drive(name, drive)
        if drive.is_elastic and drive.is_coupled and mechanism.coupled and _has_followers(mechanism):
            rule = "full rotor coupling behind an elastic drive cannot be combined with coupled mimic joints"
            raise ModelError(f"joint {name!r}: {rule}; load them as independent, or use 'reduced'", joint=name)
        own, file = drive.limits, mechanism.bodies[joints[name]].joint.limits
        if max(own.lower, file.lower) > min(own.upper, file.upper):
            apart = f"[{own.lower:g}, {own.upper:g}], and the robot's, [{file.lower:g}, {file.upper:g}]"
            told = f"its drive's position limits, {apart}, do not overlap: change either"
            raise ModelError(f"joint {name!r}: {told}", joint=name)
    return {name: drives.get(name, Drive()) for name in joints}


def _has_followers(mechanism: Mechanism) -> bool:
    return any(body.joint.mimic for body in mechanism.bodies)


def check_drive(name: str, drive: Any) -> None:
    """Raises ModelError for the first rule that the drive of a joint breaks: see `complaints`."""
    if not isinstance(drive, Drive):
        raise ModelError(f"joint {name!r}: its drive must be a Drive, got {drive!r}", joint=name)
    for complaint in complaints(drive):
        raise ModelError(f"joint {name!r}: {complaint}", joint=name, field=complaint.field)


def complaints(drive: Drive) -> Iterator[Complaint]:
    """Violations of rules: kinds of parts, single numbers by their part's table, then relations between several.

    Only the first is reliable: later rules assume that earlier ones hold.
    """
    yield from _of_kinds(drive)
    yield from _of_numbers(drive, RULES["drive"], "")
    yield from _of_springs(drive)
    yield from _of_motors(drive)
    yield from _of_friction("link_friction", drive.link_friction, drive.is_elastic)
    yield from _of_friction("motor_friction", drive.motor_friction, drive.is_elastic)


def _of_kinds(drive: Drive) -> Iterator[Complaint]:
    """Each part has its field's kind, an elastic drive has a rotor, and the ratio is not zero."""
    for what, kind in KINDS.items():
        part = getattr(drive, what)
        is_one = isinstance(part, kind) and not isinstance(part, type)  # a law's class has its methods, but no numbers
        if not is_one and (part is not None or what == "limits"):
            yield Complaint(
                what, f"{what} must be a {kind.__name__}{OFFERED.get(kind, '')}, got {part!r}{_lacks(kind, part)}"
            )
    if is_number(drive.ratio) and drive.ratio == 0:
        yield Complaint("ratio", "must not be zero: motor turns per joint turn, signed", 0)
    inertia: Any = getattr(drive.rotor, "inertia", None)
    if drive.is_elastic and not (is_number(inertia) and inertia > 0):
        yield Complaint("rotor", "an elastic drive needs a rotor with a positive inertia, kg m2")
    if any(np.isnan(bound) for bound in leaves(drive.limits)):
        yield Complaint("limits", f"limits {drive.limits} contain nan; use infinity for no limit")


def _lacks(kind: type, part: Any) -> str:
    """What a user's own law, with some of its kind's methods, lacks to be of that kind."""
    methods = [name for name in vars(kind) if not name.startswith("_")] if kind in OFFERED else []
    missing = [name for name in methods if not hasattr(part, name)]
    return f", which lacks {', '.join(missing)}" if 0 < len(missing) < len(methods) else ""


def _of_numbers(record: Any, rules: dict[str, Rule], part: str) -> Iterator[Complaint]:
    """Every number of a part, and of the parts within it, by their tables."""
    at = f", in {part}" if part else ""
    for field in fields(record):
        name, value = field.name, getattr(record, field.name)
        within, table = f"{part}.{name}".lstrip("."), RULES.get(name, rules)
        if value is None and field.default is None:
            continue
        if name in rules:
            if words := rules[name].complaint(name, value):
                yield Complaint(within, words + at)
        elif name in WAVES:
            yield from _of_waves(value, within)
        elif not all(hasattr(value, known) for known in WITHIN.get(name, ())):
            yield Complaint(within, f"{name} must have {', '.join(WITHIN[name])}, got {value!r}{at}")
        elif is_dataclass(value):
            yield from _of_numbers(value, table, within)
        elif not all(np.isfinite(number) for number in leaves(value)):
            yield Complaint(within, f"its drive has {value} as {name}; every number must be finite{at}")
    for low, high in RISING:
        if high in rules and hasattr(record, high) and getattr(record, low) >= getattr(record, high):
            yield Complaint(f"{part}.{high}", f"must be above {low} {getattr(record, low)}", getattr(record, high))


def _of_waves(waves: Any, part: str) -> Iterator[Complaint]:
    if not isinstance(waves, tuple) or not all(isinstance(wave, Harmonic) for wave in waves):
        yield Complaint(part, f"{part} must be a tuple of Harmonic, got {waves!r}")
    for k, wave in enumerate(waves):
        yield from _of_numbers(wave, RULES["wave"], f"{part}[{k}]")


def _of_springs(drive: Drive) -> Iterator[Complaint]:
    """Parts of a spring need a spring; ratios agree, slipping elements are complete, kinematic errors small enough."""
    rule = "needs an elastic drive; give it a compliance"
    for what in ("kinematic_error", "hysteresis"):
        if getattr(drive, what) and not drive.is_elastic:
            yield Complaint(what, f"{what} {rule}")
    if drive.damping and not drive.is_elastic:
        yield Complaint("damping", rule, drive.damping)
    spring = getattr(drive.compliance, "spring", drive.compliance)
    if drive.is_elastic and is_own(spring):
        yield from _of_own("compliance", spring, wrong_in_spring)
    if (steepest := getattr(spring, "steepest_corner", 0.0)) > STEEPEST_CORNER:
        rule = f"more than {STEEPEST_CORNER:g}-fold cannot be inverted; check the units of k1, k2, k3"
        yield Complaint("compliance", f"stiffness changes {steepest:.3g}-fold at a corner, {rule}")
    wave = getattr(spring, "wave_generator", None)
    if (ratio := getattr(wave, "ratio", None)) is not None and ratio != abs(drive.ratio):
        words = f"the wave generator's ratio {ratio} must be the drive's, {abs(drive.ratio)}"
        yield Complaint("compliance.wave_generator.ratio", words)
    if drive.hysteresis and len(drive.hysteresis.stiffness) != len(drive.hysteresis.reach):
        counts = f"{len(drive.hysteresis.stiffness)} stiffness and {len(drive.hysteresis.reach)} reach"
        yield Complaint("hysteresis", f"hysteresis must state both for each element, got {counts}")
    if getattr(drive.kinematic_error, "harmonics", None) == ():
        yield Complaint("kinematic_error", "kinematic_error must have a harmonic; use None for no error")
    if drive.kinematic_error and (steepest := drive.kinematic_error.steepest(drive.ratio)) > STEEPEST:
        rule = f"must not exceed {STEEPEST}: at 1 the drive would run backwards"
        words = f"kinematic error is too large: order * ratio * amplitude, in total {steepest:g}, {rule}"
        yield Complaint("kinematic_error", words)


def _of_own(field: str, law: Any, trial: Callable[[Any], Iterator[str]]) -> Iterator[Complaint]:
    yield from (Complaint(field, f"{field}, a {type(law).__name__}: {words}") for words in trial(law))


def _of_motors(drive: Drive) -> Iterator[Complaint]:
    """A rotor is a possible body; a motor's voltage limit comes with its resistance, and ripple is below 1."""
    rotor, motor = drive.rotor, drive.motor
    if rotor and not rotor.in_link_inertia and 0 < 2 * rotor.transverse < rotor.inertia:
        rule = f"must be at least half of inertia {rotor.inertia}, as for any body that is round about its axis"
        yield Complaint("rotor.transverse", rule, rotor.transverse)
    if motor and motor.voltage_limit is not None and motor.resistance is None:
        yield Complaint("motor.voltage_limit", "needs the resistance, ohm, as well", motor.voltage_limit)
    if motor and (ripple := sum(wave.amplitude for wave in motor.ripple)) >= 1:
        words = f"torque ripple, {ripple:g} summed over its waves, must stay below 1, in motor"
        yield Complaint("motor.ripple", words)


def _of_coefficients(side: str, law: Any) -> Iterator[Complaint]:
    """A law of the user's own names the fields in which its torque is linear, and is a dataclass that has them."""
    law_is, named = f"{side}, a {type(law).__name__},", getattr(law, "coefficients", None)
    own = {field.name for field in fields(law)} if is_dataclass(law) else set[str]()
    if not isinstance(named, (tuple, list)):
        rule = (
            "must state `coefficients`, a tuple of the names of its fields in which the torque is linear; () for none"
        )
        yield Complaint(side, f"{law_is} {rule}")
    elif strange := [name for name in named if name not in own]:
        kind = f"fields of it: {listed(sorted(own))}" if own else "fields of a dataclass, which it is not"
        yield Complaint(side, f"{law_is} states {listed(strange)} in `coefficients`, which must name {kind}")


def _of_friction(side: str, law: Any, elastic: bool) -> Iterator[Complaint]:
    """Static friction is not below that in motion; load dependence is for the motor's side only, and with bristles it
    needs a spring to measure the load."""
    sliding = getattr(law, "sliding", law)  # of bristles, their sliding law
    per_load, asymmetry = (getattr(sliding, name, None) for name in ("per_load", "asymmetry"))
    coulomb, static = (getattr(sliding, name, None) for name in ("coulomb", "static"))
    if hasattr(sliding, "columns"):
        yield from _of_coefficients(side, sliding)
    if law is not None and is_own(sliding):
        yield from _of_own(side, sliding, wrong_in_friction)
    if coulomb is not None and static is not None and static < coulomb:
        yield Complaint(f"{side}.static", f"must not be below coulomb {coulomb}", static)
    if per_load is not None and side == "link_friction":
        words = "link friction cannot grow with load; per_load is for motor_friction, where the gear's teeth are"
        yield Complaint(side, words)
    if per_load is not None and sliding is not law and not elastic:
        rule = "presliding friction that grows with load needs an elastic drive, whose spring measures the load"
        yield Complaint(side, f"{rule}; give it a compliance")
    share = (per_load or 0) * (1 + abs(asymmetry or 0))
    if share >= 1:
        rule = f"makes friction's share of the load {share:g}: it must stay below 1, or no load could be moved"
        yield Complaint(f"{side}.per_load", rule, per_load)
    if sliding is not law and coulomb is not None and coulomb <= 0:
        rule = "must be above 0 with presliding: without dry friction, bristles hold nothing"
        yield Complaint(f"{side}.coulomb", rule, coulomb)
