"""Joints with an encoder on one side only, beside others that have both."""

from dataclasses import replace

import numpy as np

from cutpoint.errors import InputError
from cutpoint.identification.logs.recording import Recording


def with_other_sides(recording: Recording) -> Recording:
    """The recording, with empty q or theta of a joint replaced by the other side's, and a note.

    Raises:
        InputError: neither side of a joint was recorded.
    """
    if not {"q", "theta"} <= recording.channels.keys():
        return recording
    sides = {name: recording[name].copy() for name in ("q", "theta")}
    known = {name: np.atleast_1d(np.isfinite(x).any(axis=0)) for name, x in sides.items()}
    notes: list[str] = []
    for k, joint in enumerate(recording.joints):
        there = [name for name in sides if known[name][k]]
        if not there:
            rule = "neither q nor theta holds any number: lock the joint, or record one of them"
            raise InputError(f"joint {joint!r}: {rule}", joint=joint)
        if len(there) == 1:
            (own,), (other,) = there, sides.keys() - there
            sides[other][:, k] = sides[own][:, k]
            notes.append(f"{joint}: {other} holds no numbers, so {own} stands in for it: its spring cannot be told")
    return replace(recording, **sides).with_notes(notes) if notes else recording
