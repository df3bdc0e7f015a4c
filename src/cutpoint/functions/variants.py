"""Variants of a robot's functions: with wrenches at frames, a number of derivatives, or options."""

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.door import are_plain_vectors, check_kind, checked_array, checked_name
from cutpoint.errors import InputError


def checked_wrenches(
    function: str, external: Mapping[str, ArrayLike], frames: Mapping[str, Any]
) -> Mapping[str, ArrayLike]:
    """Wrenches (..., 6) by names of existing frames.  Raises InputError."""
    check_kind(function, "external", external, Mapping, "wrenches (..., 6) by the frame's name")
    for frame in external:
        checked_name("frame", frame, frames)
    if are_plain_vectors(external.values()) and all(np.size(F) == 6 for F in external.values()):
        return external
    return {frame: checked_array(function, f"the wrench at {frame!r}", F, 6) for frame, F in external.items()}


def on_frames(definition: Any, frames: Sequence[str]) -> Any:
    """The definition with its wrenches, wrench_0, wrench_1, ..., at these frames."""

    def with_wrenches(machine: Any, **given: Any) -> Any:
        wrenches = {frame: given.pop(f"wrench_{k}") for k, frame in enumerate(frames)}
        return definition(machine, **given, **wrenches)

    return with_wrenches


@cache
def motion_names(derivatives: int) -> str:
    """Names of a position and this many derivatives of it, separated by spaces."""
    return " ".join(["q v a jerk snap", *(f"derivative_{k}" for k in range(5, derivatives + 1))])


def wrong_motion(function: str, given: int, needed: int) -> InputError:
    """An error for a motion with too few or too many derivatives of the position."""
    names = motion_names(max(given, needed)).split()
    if given < needed:
        ends = dict.fromkeys((names[given + 1], names[needed]))
        missing = f"{given} are given, {' to '.join(ends)} missing"
        remedy = f"rotors with full coupling take {needed}; or use quasi_rigid=True"
        told = f"{function}: {needed - given} more derivatives of the position are needed: {missing}: {remedy}"
    else:
        taken = f"{needed} derivatives of the position are needed, {', '.join(names[1 : needed + 1])}"
        told = f"{function}: {taken}: {given} are given; pass strains and options by name, as in strains=..."
    return InputError(told, needed=needed)
