"""An excitation for a terminal, and its files in a folder."""

from pathlib import Path

import numpy as np
from rich.table import Table

from cutpoint.errors import listed
from cutpoint.files import save_figure
from cutpoint.identification.excitation.excitation import Excitation, Quality
from cutpoint.identification.excitation.limits import Use

FILES = ("excitation.csv", "excitation.json", "excitation.png")
"""The motion; the series, to resume from; the picture."""


def table_of(found: Excitation) -> Table:
    """The motion's use of every limit, and its information about the parameters."""
    title = f"{found.robot.name}: excitation of {found.trajectory.duration:g} s, {found.trajectory.harmonics} harmonics"
    table = Table(title=title, title_justify="left")
    for k, column in enumerate(("joint", "quantity", "range used", "limit", "used")):
        table.add_column(column, justify="left" if k < 2 else "right", overflow="fold")
    order = {joint: k for k, joint in enumerate(found.robot.joints)}
    for use in sorted(found.limits, key=lambda use: order.get(use.name, len(order))):
        factor, unit = _for_people(use.unit)
        table.add_row(
            use.name,
            use.kind,
            f"{factor * use.least:.4g} to {factor * use.largest:.4g} {unit}",
            f"{factor * use.low:.4g} to {factor * use.high:.4g} {unit}",
            _share(use),
        )
    first = "the file's motion" if found.resumed else "a random motion"
    began = "" if found.before is None else f"{first}: {_words(found.before)}; "
    table.caption = f"{began}this one: {_words(found.after)}{_still(found)}"
    if found.untold:
        table.caption += f"\nit tells next to nothing about {listed(found.untold)}: too little of the torques"
    return table


def save(found: Excitation, folder: Path) -> list[Path]:
    """Writes motion and picture beside the series that the search wrote there."""
    found.save_csv(folder / FILES[0])
    save_figure(found.plot(), folder / FILES[2])
    return [folder / name for name in FILES]


def _share(use: Use) -> str:
    """Use of the nearer bound: 0 midway between two, 100 % at either."""
    if not np.isfinite(use.high - use.low):
        return "-"
    middle, reach = (use.high + use.low) / 2.0, (use.high - use.low) / 2.0
    return f"{max(use.largest - middle, middle - use.least) / reach:.1%}"


def _still(found: Excitation) -> str:
    """What to do if the search found nothing better than what it began with."""
    better = found.before != found.after
    return "" if better else "; none better was found: search longer (--seconds), with the same --output"


def _words(quality: Quality) -> str:
    return f"log det {quality.log_determinant:.1f}, condition {quality.condition:.3g}"


def _for_people(unit: str) -> tuple[float, str]:
    return (180.0 / np.pi, unit.replace("rad", "deg")) if unit.startswith("rad") else (1.0, unit)
