"""A drive file that documents the origin of each number: the entries of `dump_drives`, with remarks on their lines."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from cutpoint.formats.drives.drives import dump_drives
from cutpoint.formats.drives.words import is_smooth
from cutpoint.formats.safe_yaml import YamlPath, parse_yaml
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.model.drive import Drive

ELEMENTS = 4
"""Of hysteresis that a drive file cannot express as it is."""


def remarked_drives(
    drives: Mapping[str, Drive], remarks: Mapping[str, Mapping[YamlPath, str]], heading: Sequence[str] = ()
) -> str:
    """The text of a drive file that loads back to the same drives.

    remarks: by joint and path within its entry, as ("compliance", "linear", "stiffness"); a path that the entry does
    not state is left out.  heading: lines above.
    Raises InputError for anything a drive file cannot express: see `worded`.
    """
    lines = dump_drives(drives).splitlines()
    places = parse_yaml("\n".join(lines).encode(), "<drive file>").lines
    for joint, own in remarks.items():
        for path, remark in own.items():
            line = places.get(("drives", joint, *path))
            if line is not None:
                lines[line - 1] += f"  # {_one_line(remark)}"
    return "\n".join([*(f"# {_one_line(words)}" for words in heading), *lines, ""])


def worded(drive: Drive) -> tuple[Drive, tuple[str, ...]]:
    """The nearest drive that a drive file can express, and the changes made."""
    rotor = drive.rotor
    if rotor is not None and rotor.inertia == 0 and rotor.in_link_inertia and not drive.is_elastic:
        drive, notes = worded(replace(drive, rotor=None))
        return drive, ("a rotor without inertia is written as no rotor", *notes)
    if not isinstance(drive.hysteresis, MaxwellSlip) or is_smooth(drive.hysteresis):
        return drive, ()
    alike = f"{ELEMENTS} whose wide loops have the same width and area"
    note = f"hysteresis of {len(drive.hysteresis.reach)} elements written as {alike}"
    return replace(drive, hysteresis=_smoothed(drive.hysteresis)), (note,)


def _smoothed(law: MaxwellSlip) -> MaxwellSlip:
    """Smooth elements whose full loops have the same width, sum(k r), and the same loss, determined by sum(k r^2)."""
    unit = MaxwellSlip.smooth(1.0, 1.0, ELEMENTS)
    reach = (_moment(law) / float(law.friction)) / (_moment(unit) / float(unit.friction))
    # made of its own width, as the file's reader does, so that all digits come back
    return MaxwellSlip.smooth(float(law.friction), reach, ELEMENTS)


def _moment(law: MaxwellSlip) -> float:
    return float(np.dot(law.stiffness, np.square(law.reach)))


def _one_line(words: str) -> str:
    return " ".join(words.split())
