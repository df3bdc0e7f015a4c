"""The page on the drive file says what the schema says, and its example loads."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from pydantic.fields import FieldInfo
from urdf_text import joint, link, robot

from cutpoint.formats import parse_drives, parse_urdf
from cutpoint.formats.drives.drive_sheet import DriveSheet, FileSheet
from cutpoint.formats.drives.section import sheet_at

PAGE = (Path(__file__).parents[2] / "docs" / "drive-file.md").read_text(encoding="utf-8")

(EXAMPLE,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)

ROBOT = parse_urdf(
    robot(
        *map(link, ("base", "a", "b", "c", "d")),
        joint("shoulder", "base", "a"),
        joint("elbow", "a", "b"),
        joint("wrist", "b", "c"),
        joint("lift", "c", "d", "prismatic"),
    )
)


def fields(path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], FieldInfo]]:
    """Every field of a drive, in order, with its keys."""
    sheet = sheet_at(DriveSheet, path)
    for name, field in sheet.model_fields.items() if sheet else ():
        yield (*path, name), field
        yield from fields((*path, name))


def row(path: tuple[str, ...], field: FieldInfo) -> str:
    """The line of the page's table that a field must have."""
    units = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    unit = "; ".join(dict.fromkeys(str(units[key]) for key in ("unit", "linear_unit") if key in units))
    default = "required" if field.is_required() else "none" if field.default is None else yaml_text(field.default)
    return f"| `{'.'.join(path)}` | {unit} | {default} | {field.description} |"


def yaml_text(value: bool | float | str | list[object]) -> str:
    if isinstance(value, list):
        return "empty"
    if isinstance(value, str):
        return value
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"


@pytest.mark.parametrize("name", [".".join(path) for path, _ in fields()])
def test_every_field_is_on_the_page_with_unit_default_and_meaning(name: str) -> None:
    path = tuple(name.split("."))
    assert row(path, dict(fields())[path]) in PAGE.splitlines()


def test_the_page_has_no_field_that_the_schema_lacks() -> None:
    known = {".".join(path) for path, _ in fields()} | FileSheet.model_fields.keys()
    assert set(re.findall(r"^\| `([a-z0-9_.]+)` \|", PAGE, re.MULTILINE)) == known


@pytest.mark.parametrize("name", FileSheet.model_fields)
def test_every_section_is_on_the_page_with_its_meaning(name: str) -> None:
    field = FileSheet.model_fields[name]
    default = "required" if field.is_required() else "empty"
    assert f"| `{name}` | {default} | {field.description} |" in PAGE.splitlines()


def test_the_example_loads() -> None:
    drives = parse_drives(EXAMPLE, ROBOT)
    ratios = {"shoulder": 101, "elbow": -100, "wrist": 100, "lift": 1256.637}
    assert {name: drive.ratio for name, drive in drives.items()} == ratios


def test_the_example_is_complete() -> None:
    stated = yaml.safe_load(EXAMPLE)
    used = set(keys(stated["defaults"])) | {key for drive in stated["drives"].values() for key in keys(drive)}
    assert used == {path for path, _ in fields()}


def keys(value: object, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield (*path, key)
            yield from keys(inner, (*path, key))
