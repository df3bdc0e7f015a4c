"""The study: pages made one after another, then written all at once."""

import json
import platform
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

import cutpoint
from cutpoint.errors import InputError
from cutpoint.files import replacing
from cutpoint.studies.paper import catalogue, link_side, schematics, table_3, table_4, torque_estimate
from cutpoint.studies.paper.bench import KD, KP, PERIOD, Bench
from cutpoint.studies.paper.page import Page, plain
from cutpoint.studies.paper.printed import DURATION, GOAL
from cutpoint.studies.paper.report import html
from cutpoint.studies.paper.terminal import show
from cutpoint.studies.style import png, styled

_PAGES: dict[str, Callable[[Bench], Page]] = {
    "drawing joint and arm": schematics.page,
    "Table 3: torques against Newton-Euler and Lagrange": table_3.page,
    "Table 4: closed loops": table_4.page,
    "PD on the link's side": link_side.page,
    "the drive against its catalogue": catalogue.page,
    "torque from two encoders": torque_estimate.page,
}


def run(output: Path, *, progress: bool = True) -> dict[str, Any]:
    """Section IV of Xia (2019) again: writes output/index.html, output/figures/*.png and output/results.json.

    progress: show a bar while it runs, and the tables at its end.  Each file is written whole or not at all, and none
    before everything is computed.  Returns what results.json holds, by table and figure.

    Raises:
        InputError: output is there and is not a folder.
    """
    output = Path(output)
    if output.exists() and not output.is_dir():
        raise InputError(f"output {str(output)!r} is not a folder; name one, or a new one", output=output)
    with styled(), Progress(console=Console(stderr=True), disable=not progress, transient=True) as bar:
        pages = _made(bar)
        drawing = bar.add_task("writing the report", total=None)
        images = {picture.key: png(picture.figure) for page in pages for picture in page.pictures()}
        bar.remove_task(drawing)
    results = _results(pages)
    text = json.dumps(results, indent=1, ensure_ascii=False, allow_nan=False, default=lambda x: x.tolist())
    _write(output, html(pages, images, results["versions"]), images, text)
    if progress:
        show(pages)
    return json.loads(text)


def _made(bar: Progress) -> list[Page]:
    bench, pages = Bench(), []
    task = bar.add_task("", total=len(_PAGES))
    for name, page in _PAGES.items():
        bar.update(task, description=name)
        pages.append(page(bench))
        bar.advance(task)
    return pages


def _results(pages: Sequence[Page]) -> dict[str, Any]:
    results: dict[str, Any] = {
        "versions": _versions(),
        "settings": {
            "goal": GOAL,
            "duration": DURATION,
            "kp": KP,
            "kd": KD,
            "control_period": PERIOD,
            "units": "rad, s, N m",
        },
    }
    for page in pages:
        for block in [*page.pictures(), *page.tables()]:
            results[block.key] = {"caption": plain(block.caption)}
        for picture in page.pictures():
            results[picture.key]["file"] = f"figures/{picture.key}.png"
        for key, values in page.results.items():
            results[key] = {**results.get(key, {}), **values}
    return results


def _versions() -> dict[str, str]:
    others = {name: version(name) for name in ("numpy", "scipy", "llvmlite", "matplotlib")}
    return {"cutpoint": cutpoint.__version__, "Python": platform.python_version(), **others}


def _write(output: Path, report: str, images: dict[str, bytes], results: str) -> None:
    """The pictures first and the report last: a report that is there is complete."""
    folder = output / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    files = {folder / f"{key}.png": image for key, image in images.items()}
    files |= {output / "results.json": results.encode(), output / "index.html": report.encode()}
    for path, content in files.items():
        with replacing(path) as file:
            file.write(content)
