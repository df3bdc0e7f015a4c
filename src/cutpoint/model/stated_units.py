"""Units that users' tables state, their factors to SI, and their spellings in titles of columns."""

import math
import re

from cutpoint.model.units import RPM

ANGLES = {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0, "rev": 2.0 * math.pi, "m": 1.0, "mm": 1e-3}
SPEEDS = {f"{unit}/s": factor for unit, factor in ANGLES.items()} | {"rpm": RPM}
SMALL = {unit: 1e-3 for unit in ("mN m", "mNm", "N mm", "Nmm")}
TORQUES = {"N m": 1.0, "Nm": 1.0, **SMALL, "kN m": 1e3, "N": 1.0, "kN": 1e3}
CURRENTS = {"A": 1.0, "mA": 1e-3}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

UNITS = {"q": ANGLES, "theta": ANGLES, "v": SPEEDS, "theta_dot": SPEEDS, "torque": TORQUES, "current": CURRENTS}
"""Factors by quantity; the first of each is SI."""

LENGTHS = ("m", "mm")
"""Units of positions in which a turn is not a fixed number."""

SLIDING = (*LENGTHS, "m/s", "mm/s", "N", "kN")
"""Units of positions, speeds and forces that only prismatic joints have."""

TURNING = frozenset(unit for units in (ANGLES, SPEEDS, TORQUES) for unit in units) - {
    "rad", "rad/s", "N m", "Nm", *SLIDING
}  # fmt: skip
"""Units that only revolute joints have; unstated ones are taken as SI, rad or m, N m or N."""

COUNTS = {"q": "counts", "theta": "counts", "v": "counts/s", "theta_dot": "counts/s"}
"""Units of an encoder, by quantity: `counts_per_turn` gives their size."""

WITH_GAIN = ("A", "mA", "V", "%", "1")
"""Units that need a gain to become a torque (or a current): a motor's current, an amplifier's command, a share."""

SPELLINGS = {
    "rad": ("radian", "radians"),
    "deg": ("°", "º", "degs", "degree", "degrees"),
    "rev": ("turn", "turns", "revs"),
    "counts": ("count", "cnt", "cnts", "inc", "ticks"),
    "rpm": ("1/min", "rev/min", "r/min", "U/min"),
    "s": ("sec", "second", "seconds"),
    "ms": ("msec", "milliseconds"),
    "us": ("µs", "μs", "usec", "microseconds"),
    "ns": ("nsec", "nanoseconds"),
}
"""Other spellings of units in the titles of columns; case is ignored."""

LONGEST_NAME = 200
"""Characters of a channel's name: longer ones are not searched for units."""

KNOWN = frozenset(unit for units in (*UNITS.values(), TIMES) for unit in units) | {*COUNTS.values(), *WITH_GAIN} - {"1"}

_SPELT = {spelling.lower(): unit for unit, those in SPELLINGS.items() for spelling in (unit, *those)}


def known_unit(text: str) -> str | None:
    """The unit spelled by a text such as `°/sec`, `N.m` or `[Nm]`, or None."""
    text = re.sub(r"^([mk]?N)[\s.·⋅*-]*(mm?)$", r"\1 \2", text.strip(" []()"))
    whole, _, per = text.partition("/")
    rate = f"{_SPELT.get(whole.strip().lower(), whole.strip())}/s" if _SPELT.get(per.strip().lower()) == "s" else ""
    return next((unit for unit in (text, _SPELT.get(text.lower()), rate) if unit in KNOWN), None)


def name_and_unit(title: str) -> tuple[str, str]:
    """Name and unit of a column's title: `q1 [deg]`, `Time(ms)`; brackets hold any unit, parentheses a known one."""
    pattern = r"(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))"
    found = re.fullmatch(pattern, title) if len(title) <= LONGEST_NAME else None
    if not found:
        return title, ""
    name, bracketed, inner = found[1], found[2], found[2] if found[3] is None else found[3]
    unit = known_unit(inner)
    if unit is None and (bracketed is None or re.search(r"\d", inner)):
        return title, ""  # a number, as in q[3] and q(3), or a word that belongs to the name
    return name, unit or inner.strip(" -")
