"""Unwrapping of positions whose sensor wraps around after a turn, or its counter after 2^n counts."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.model.stated_units import COUNTS, LENGTHS, UNITS
from cutpoint.model.units import joint_unit

TURN = 2.0 * np.pi

COUNTERS = 2.0 ** np.arange(8, 33)
"""Counts after which counters of 8 to 32 bits wrap around."""

NEARBY = np.array([-3, -2, -1, 1, 2, 3])
"""Steps beside a jump, whose median is the step expected instead of the jump."""

PRECISE = 1e-3
"""Share of a turn by which a jump may differ from one, in addition to the spread of neighbouring steps."""

UNSURE = 0.25
"""Share of a turn: if neighbouring steps differ by more, no jump is taken for a wrap."""

LOST = 20.0
"""Periods: across a longer gap it is unknown whether the joint turned further."""


def spans(name: str, units: Sequence[str], per_turn: Array) -> Array:
    """(k, n) in the log's units: a turn, and the ranges of counters; NaN if a quantity or its unit has none.

    per_turn: (n,), counts, NaN where not stated.
    """
    counted = np.array([unit == COUNTS.get(name) for unit in units])
    turns = {unit: TURN / factor for unit, factor in UNITS[name].items() if unit not in LENGTHS}
    turn = np.where(counted, per_turn, [turns.get(unit, np.nan) for unit in units])
    found = np.vstack([turn, np.where(counted, COUNTERS[:, None], np.nan)])
    return found if name in ("q", "theta") else np.full_like(found, np.nan)


def unwrapped(
    name: str,
    times: Array,
    values: Array,
    anew: Array,
    slides: NDArray[np.bool_],
    joints: Sequence[str],
    notes: list[str],
) -> Array:
    """Positions (N, n) without jumps by their sensors' spans, (k, n), with a note for each joint.

    slides: (n,), which joints are prismatic.

    They continue from the first sample; if whole turns of the joint are indistinguishable, their middle is within half
    a turn of zero.
    """
    found = values.copy()
    for joint, x, own, is_slide in zip(joints, found.T, anew.T, slides.tolist(), strict=True):
        known = np.isfinite(x)
        place, jumps = _wraps(times[known], x[known], own)
        if not jumps.any():
            continue
        x[known] -= own[place] * np.concatenate([[0.0], np.cumsum(jumps)])
        of_joint = not is_slide and bool(np.isclose(own[place], TURN))
        if of_joint:
            x -= TURN * np.round(0.5 * (np.nanmin(x) + np.nanmax(x)) / TURN)
        turn = f"a turn, {own[0]:.4g} {joint_unit('rad', is_slide)} at the joint,"
        what = f"{COUNTERS[place - 1]:.0f} counts" if place else turn
        zero = "" if of_joint else "; from its first sample on: if it had jumped before, state 'offset'"
        notes.append(f"{name} of {joint!r}: {np.abs(jumps).sum():.0f} jumps by {what} were unwrapped{zero}")
    return found


def _wraps(times: Array, x: Array, anew: Array) -> tuple[int, Array]:
    """Which of its sensor's spans (k,) a position (N,) without gaps jumps by, and its jumps; the first if by none."""
    longest = float(np.abs(np.diff(x)).max(initial=0.0))
    for place in np.flatnonzero(0.5 * anew < longest).tolist():
        jumps = _jumps(times, x, anew[place], is_counter=place > 0)
        if jumps.any():
            return place, jumps
    return 0, np.zeros(0)


def _jumps(times: Array, x: Array, span: float, is_counter: bool) -> Array:
    """For each step of positions (N,) without gaps: 1 for a jump upwards by a span, -1 downwards, 0 otherwise."""
    steps, passed = np.diff(x), np.diff(times)
    jumps = np.zeros(steps.size)
    within = np.ptp(x) < (1.0 + PRECISE) * span
    if steps.size < NEARBY.size or (is_counter and not within):
        return jumps
    # for a sensor that is always within one turn, the shorter of the two ways is its step
    rates = (steps - span * np.round(steps / span) if within else steps) / passed
    changes = np.abs(np.diff(rates))
    usual = float(np.median(changes[changes > 0.0])) if changes.any() else 0.0
    at = np.flatnonzero((np.abs(steps) > 0.5 * span) & (passed <= LOST * np.median(passed)))
    near = np.concatenate([np.full(3, np.nan), rates, np.full(3, np.nan)])[at[:, None] + 3 + NEARBY]
    rate = np.nanmedian(near, axis=1)
    unlike = np.nanmedian(np.abs(near - rate[:, None]), axis=1)
    reach = 3.0 * (unlike + usual) * passed[at] + PRECISE * span
    jump = np.sign(steps[at])
    is_turn = np.abs(steps[at] - jump * span - rate * passed[at]) <= reach
    jumps[at] = np.where(is_turn & (reach <= UNSURE * span), jump, 0.0)
    return jumps
