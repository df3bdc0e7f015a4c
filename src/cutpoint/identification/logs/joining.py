"""Several recordings of one machine as one."""

from collections.abc import Sequence

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import check_kind
from cutpoint.errors import InputError
from cutpoint.identification.logs.recording import Recording, check_recording

PAUSE = 1.0
"""s without samples between recordings: long enough that nothing connects them."""

SAME = 0.01
"""Share by which the recordings' periods may differ: clocks do."""


def joined(recordings: Sequence[Recording]) -> Recording:
    """Recordings one after another, `PAUSE` apart, with the joints of the first and the channels that all have.

    Encoders must have kept their zeros and their clocks' delays: nothing is shifted.

    Raises:
        InputError: no recording, different periods, a joint of the first that others lack, no common channel.
    """
    check_kind("joined", "recordings", recordings, Sequence, "Recordings in a list")
    for recording in recordings:
        check_recording("joined", recording)
    if not recordings:
        raise InputError("joined: there is no recording; give at least one")
    names = [name for name in recordings[0].channels if all(name in each.channels for each in recordings)]
    if not names:
        held = "; ".join(", ".join(each.channels) for each in recordings)
        raise InputError(f"joined: no channel is in every recording; they hold {held}; join those that share some")
    period = _common_period(recordings)
    pause = period * np.arange(1.0, PAUSE / period + 2.0)
    parts = [each.in_order(recordings[0].joints) for each in recordings]
    unknown = np.full((pause.size, len(parts[0].joints)), np.nan)
    channels = {name: _alternating([part[name] for part in parts], unknown) for name in names}
    notes = dict.fromkeys([*(note for part in parts for note in part.notes), *_left_out(recordings, names)])
    return Recording(_times(recordings, pause, period), parts[0].joints, **channels, notes=tuple(notes))


def _common_period(recordings: Sequence[Recording]) -> float:
    """s, the first recording's."""
    periods = [float(np.median(np.diff(each.time))) for each in recordings]
    for number, period in enumerate(periods, start=1):
        if abs(period - periods[0]) > SAME * periods[0]:
            rule = f"recording {number} has a period of {period:.4g} s, the first one of {periods[0]:.4g} s"
            raise InputError(f"joined: {rule}; resample one of them: recording.resampled({periods[0]:.4g})")
    return periods[0]


def _times(recordings: Sequence[Recording], pause: Array, period: float) -> Array:
    """Of all samples, s, and of the pauses between them; each recording counts from its own start."""
    found, start = list[Array](), float(recordings[0].time[0])
    for each in recordings:
        own = start + each.time - each.time[0]
        found += [own, own[-1] + pause]
        start = float(found[-1][-1]) + period
    return np.concatenate(found[:-1])


def _alternating(parts: Sequence[Array], pause: Array) -> Array:
    """The parts, with a pause after each but the last."""
    return np.concatenate([x for part in parts for x in (part, pause)][:-1])


def _left_out(recordings: Sequence[Recording], kept: Sequence[str]) -> list[str]:
    """Notes on channels that only some recordings have."""
    others = dict.fromkeys(name for each in recordings for name in each.channels if name not in kept)
    lacking = {name: sum(name not in each.channels for each in recordings) for name in others}
    return [f"{name} is not used: {count} of {len(recordings)} logs lack it" for name, count in lacking.items()]
