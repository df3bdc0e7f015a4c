"""The study of cost: measured, then written all at once."""

import platform
from pathlib import Path
from typing import Any

from cutpoint.door import whole
from cutpoint.errors import InputError
from cutpoint.reporting.folder import checked_folder, write
from cutpoint.reporting.html import Heading
from cutpoint.reporting.standing import Standing
from cutpoint.reporting.style import styled
from cutpoint.reporting.terminal import say, show
from cutpoint.studies.cost.measure import ARM, BATCH, measured
from cutpoint.studies.cost.page import page_of, verdict_page

SIZES = (1, 2, 3, 4, 6, 8, 10, 12, 16, 24, 32, 48, 64)

_HEADING = Heading(
    "What inverse dynamics costs",
    "The claim examined: K. Xia, H. Xing, L. Ding, H. Gao, G. Liu, Z. Deng: Virtual Decomposition Based Modeling for "
    "Multi-DOF Manipulator With Flexible Joint. IEEE Access 7, 2019, sections I and IV.B, doi "
    "10.1109/ACCESS.2019.2919749",
    (
        "Virtual decomposition beside classical Newton-Euler, Newton-Euler for elastic joints, and two Lagrangian "
        "formulations, all through the same tracer and compiler.",
    ),
)


def run(output: Path, *, largest: int = SIZES[-1], progress: bool = True) -> dict[str, Any]:
    """What one inverse dynamics costs: writes output/index.html, output/figures/figure_c1.png and output/cost.json.

    largest: number of joints to go to, 6 to 64.  progress: show a bar while it runs, and tables and findings at its
    end.  Returns what cost.json holds.

    Raises:
        InputError: a number of joints that is not such a one; output is no folder, cannot be written, or holds a report
            by others.
    """
    output = checked_folder(output, "cost.json", "cost")
    largest = whole("cost", "largest", largest, least=ARM)
    if largest > SIZES[-1]:
        rule = f"must be at most {SIZES[-1]}, the largest size of the contenders"
        raise InputError(f"cost: largest {largest} {rule}", largest=largest)
    sizes = [*(n for n in SIZES if n < largest), largest]
    with styled(), Standing(shown=progress) as bar:
        task = bar.add_task("chains", total=sum(sizes))
        costs = measured(sizes, lambda n: bar.advance(task, n))
        pages = [page_of(costs), verdict_page(costs)]
        settings = {"batch": BATCH, "processor": processor(), "units": "operations, ns, s"}
        results = write(output, _HEADING, pages, settings, "cost.json", "cost")
    if progress:
        show(pages)
        say(pages[-1])
    return results


def processor() -> str:
    """The processor's name where the system tells it, or its architecture."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
