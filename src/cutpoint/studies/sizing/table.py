"""Sizing for a terminal: a row a drive, and sentences on what is tightest and what is not known."""

from collections.abc import Iterator

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.table import Table

from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.model.units import RPM
from cutpoint.studies.sizing.demand import Peak
from cutpoint.studies.sizing.drive_sizing import DriveSizing, allowed
from cutpoint.studies.sizing.margins import Margin, told
from cutpoint.studies.sizing.sizing import Sizing

_COLUMNS = (
    "\n\ndrive", "peak\ntorque\nN m", "average\ntorque\nN m", "peak\nspeed\nrpm", "mean\nspeed\nrpm",
    "peak\ncurrent\nA", "\nlife\nh", "\n\nmargin", "\n\nby", "\n\nverdict",
)  # fmt: skip
_WORDS = (0, 8, 9)
"""Columns that do not hold numbers."""
_WHOLE = (0, 6, 7, 9)
"""Columns that are not broken where it gets narrow: the others break between asked and allowed."""

MOST_POSITIONS = 8
"""Joints whose positions a sentence lists; those of more make it unreadable, and the time says where they are."""


def table_of(found: Sizing) -> Table:
    """Demanded and allowed, at the gear's output and the motor's speed."""
    pause = f" and a pause of {found.dwell:g} s" if found.dwell else ""
    title = f"{found.robot}: what drives do in a motion of {found.duration:g} s{pause}, and may do"
    table = Table(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD, pad_edge=False)
    for k, name in enumerate(_COLUMNS):
        column = name.replace("N m", "N m, N") if any(drive.slides for drive in found.drives.values()) else name
        table.add_column(column, justify="left" if k in _WORDS else "right", overflow="fold", no_wrap=k in _WHOLE)
    for drive in found.drives.values():
        table.add_row(*_row(drive), style="" if drive.verdict != "fails" else "red")
    return table


def sentences(found: Sizing) -> Iterator[str]:
    """The tightest limit first, then what other limits are broken, then what is missing and what does not count."""
    if found.tightest is None:
        yield "Nothing is stated to hold the drives against: give them ratings, limits or motors in the drive file."
    else:
        yield from _rated(found, *found.tightest)
    loose = [joint for joint, sized in found.drives.items() if isinstance(sized.drive.compliance, Backlash)]
    if loose:
        yield f"Not counted at {', '.join(loose)}: the play, which a motor crosses in the time that it takes."


def _rated(found: Sizing, joint: str, margin: Margin) -> Iterator[str]:
    yield f"Tightest is {joint} by its {margin.limit}: {_asked(margin)}, margin {told(margin)}."
    for name, drive in found.drives.items():
        for failed in drive.failures:
            if failed is not margin:
                yield f"{name} fails by its {failed.limit}, too: {_asked(failed)}, margin {told(failed)}."
        smooth = found.smooth.get(name)
        if smooth and smooth.tightest and not smooth.failures:
            least = f"margin {told(smooth.tightest)}, {smooth.tightest.limit}"
            yield f"{name} would hold if its motor did not follow the gear's kinematic error: {least}."
        if drive.permitted_peaks is not None and np.isfinite(drive.permitted_peaks):
            often = _number(drive.permitted_peaks)
            yield f"{name} bears so long a stay above its repeated peak torque {often} times in all, for emergencies."
    yield from _missing(found)


def _missing(found: Sizing) -> Iterator[str]:
    """One sentence for all drives that lack the same ratings."""
    lacking: dict[tuple[str, ...], list[str]] = {}
    for joint, drive in found.drives.items():
        if drive.missing:
            lacking.setdefault(drive.missing, []).append(joint)
    for missing, joints in lacking.items():
        bare = all(found.drives[joint].drive.ratings is None for joint in joints)
        yield f"Not stated, and not checked, at {', '.join(joints)}: {'any rating' if bare else ', '.join(missing)}."


def _row(found: DriveSizing) -> tuple[str, ...]:
    asked, tightest = found.demand, found.tightest
    return (
        found.joint,
        _of(asked.output_torque, found, "repeated peak torque"),
        _of(asked.average_torque, found, "average torque"),
        _of(asked.motor_speed, found, "maximum speed", 1 / RPM),
        _of(asked.mean_motor_speed, found, "average speed", 1 / RPM),
        "-" if asked.current is None else _of(asked.current, found, "motor current"),
        "-" if found.life is None else _hours(found.life),
        "-" if tightest is None else told(tightest),
        "-" if tightest is None else tightest.limit,
        found.verdict,
    )


def _of(asked: Peak | float, found: DriveSizing, limit: str, factor: float = 1.0) -> str:
    """`37.8 of 56`; of a dash where the limit is not stated."""
    value = abs(asked.value) if isinstance(asked, Peak) else asked
    most = allowed(found, limit)
    return f"{_number(value * factor)} of {_number(most * factor) if most < np.inf else '-'}"


def _asked(margin: Margin) -> str:
    """Demand and limit, and when and where."""
    is_speed = margin.limit.startswith(("average speed", "maximum speed"))
    factor, unit = (1 / RPM, "rpm") if is_speed else (1.0, margin.unit)
    if margin.limit == "life":
        return f"{_hours(margin.allowed)} h, and {_hours(margin.demanded)} h are asked"
    asked = f"{_number(margin.demanded * factor)} {unit} of {_number(margin.allowed * factor)} {unit}"
    if margin.at is None:
        return f"{asked} over the cycle"
    asked += f"{' from the middle of its range' * (margin.limit == 'joint travel')} at {margin.at.time:.3f} s"
    position = margin.at.position
    return asked if len(position) > MOST_POSITIONS else f"{asked} (q = {', '.join(f'{x:.3g}' for x in position)})"


def _number(x: float) -> str:
    return f"{x:.0f}" if abs(x) >= 99.95 else f"{x:.3g}"


def _hours(x: float) -> str:
    return "> 10^6" if x > 1e6 else f"{x:.0f}"
