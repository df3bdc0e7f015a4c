"""The study: pages made one after another, then written all at once."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.progress import Progress

from cutpoint.errors import SimulationError
from cutpoint.reporting.folder import checked_folder, write
from cutpoint.reporting.html import Heading
from cutpoint.reporting.page import Page
from cutpoint.reporting.standing import Standing
from cutpoint.reporting.style import styled
from cutpoint.reporting.terminal import show
from cutpoint.studies.paper import catalogue, effects, link_side, schematics, table_3, table_4, table_5, torque_estimate
from cutpoint.studies.paper.bench import KD, KP, PERIOD, Bench
from cutpoint.studies.paper.printed import DURATION, GOAL

_HEADING = Heading(
    "Section IV of Xia et al. (2019), computed again",
    "K. Xia, H. Xing, L. Ding, H. Gao, G. Liu, Z. Deng: Virtual Decomposition Based Modeling for Multi-DOF "
    "Manipulator With Flexible Joint. IEEE Access 7, 2019, doi 10.1109/ACCESS.2019.2919749",
    (
        "The figures of the paper are redrawn and its simulations run again with equations written independently. "
        "Where the paper is open or slips, the reading taken is stated; each of its tables stands beside ours (its "
        "rows are shaded), with what makes the difference where that can be known and the word that it cannot where "
        "not. The experiment of section IV.C needs the authors' arm and is not repeated; a simulated stand-in, named "
        "so, is shown in its place.",
    ),
)
_SETTINGS = {
    "goal": GOAL, "duration": DURATION, "kp": KP, "kd": KD, "control_period": PERIOD, "units": "rad, s, N m",
}  # fmt: skip
_PAGES: dict[str, Callable[[Bench], Page]] = {
    "drawing joint and arm": schematics.page,
    "Table 3: torques against Newton-Euler and Lagrange": table_3.page,
    "Table 4: closed loops": table_4.page,
    "PD on the link's side": link_side.page,
    "the drive against its catalogue": catalogue.page,
    "torque from two encoders": torque_estimate.page,
    "a drive's effects, one by one": effects.page,
    "Table 5: simulated stand-in for the experiment": table_5.page,
}


def run(output: Path, *, progress: bool = True) -> dict[str, Any]:
    """Section IV of Xia (2019) again: writes output/index.html, output/figures/*.png and output/results.json.

    progress: show a bar while it runs, and the tables at its end.  Each file is written whole or not at all, and none
    before everything is computed.  Returns what results.json holds, by table and figure.

    Raises:
        InputError: output is no folder, cannot be written, or holds a report by others.
    """
    output = checked_folder(output, "results.json", "paper")
    with styled(), Standing(shown=progress) as bar:
        pages = _made(bar)
        drawing = bar.add_task("writing the report", total=None)
        results = write(output, _HEADING, pages, _SETTINGS, "results.json", "paper")
        bar.remove_task(drawing)
    if progress:
        show(pages)
    return results


def _made(bar: Progress) -> list[Page]:
    bench, pages = Bench(), []
    task = bar.add_task("", total=len(_PAGES))
    for name, page in _PAGES.items():
        bar.update(task, description=name)
        pages.append(_page(page, bench))
        bar.advance(task)
    return pages


def _page(page: Callable[[Bench], Page], bench: Bench) -> Page:
    """Raises KeyboardInterrupt where one of its runs was interrupted: nothing of it is kept."""
    try:
        return page(bench)
    except SimulationError as stopped:
        if stopped.evidence["diverged"]:
            raise
        raise KeyboardInterrupt from stopped
