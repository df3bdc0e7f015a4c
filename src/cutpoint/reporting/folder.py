"""A report on disk: index.html, figures/*.png and the results as JSON, each written atomically."""

import json
import platform
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from cutpoint.errors import InputError
from cutpoint.files import check_target_folder, replacing
from cutpoint.reporting.html import Heading, html
from cutpoint.reporting.numbers import json_bytes
from cutpoint.reporting.page import Page, plain
from cutpoint.reporting.style import png
from cutpoint.version import __version__


def checked_folder(output: Path, name: str, study: str) -> Path:
    """The path of a folder that the report of a study, with `name` as its JSON file, can be written to.

    Raises:
        InputError: output is there and is not a folder, cannot be written, or holds files of these names by others.
    """
    output = Path(output)
    check_target_folder(output)
    there = [each for each in ("index.html", name) if (output / each).exists()]
    if there and not _is_of(study, output / name):
        names = " and ".join(there)
        remedy = "name another folder, or move them elsewhere"
        raise InputError(f"output {str(output)!r} holds {names} that this study did not write; {remedy}", output=output)
    return output


def _is_of(study: str, path: Path) -> bool:
    """Whether a JSON file was written by `write` for this study."""
    try:
        found = json.loads(path.read_bytes())
        return found["study"] == study and "cutpoint" in found["versions"]
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return False


def write(
    output: Path, heading: Heading, pages: Sequence[Page], settings: Mapping[str, Any], name: str, study: str
) -> Any:
    """Writes output/index.html, output/figures/*.png and output/`name`, each atomically.

    Returns what the JSON file holds: the study's name, versions, settings, and results by table and figure.
    """
    images = {picture.key: png(picture.figure) for page in pages for picture in page.pictures()}
    results = {"study": study, "versions": versions(), "settings": settings, **_results(pages)}
    text = json_bytes(results)
    folder = output / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    # figures first and the report last: an existing report is complete
    files = {folder / f"{key}.png": image for key, image in images.items()}
    files |= {output / name: text, output / "index.html": html(heading, pages, images, versions()).encode()}
    for path, content in files.items():
        with replacing(path) as file:
            file.write(content)
    return json.loads(text)


def _results(pages: Sequence[Page]) -> dict[str, Any]:
    results: dict[str, Any] = {}
    for page in pages:
        for block in [*page.pictures(), *page.tables()]:
            results[block.key] = {"caption": plain(block.caption)}
        for picture in page.pictures():
            results[picture.key]["file"] = f"figures/{picture.key}.png"
        for key, values in page.results.items():
            results[key] = {**results.get(key, {}), **values}
    return results


def versions() -> dict[str, str]:
    """Versions of the numerical packages that are installed."""
    found = {"cutpoint": __version__, "Python": platform.python_version()}
    for name in ("numpy", "scipy", "llvmlite", "matplotlib"):
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found
