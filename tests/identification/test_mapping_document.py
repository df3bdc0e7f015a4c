"""The page on the mapping says what the schema and the tables of units and names say, and its example is read."""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
import yaml
from machine_logs import positions, times
from pydantic.fields import FieldInfo

from cutpoint.identification import Channel, Table, parse_mapping, recording_of
from cutpoint.identification.logs.channel_names import NAMES, TIME
from cutpoint.identification.logs.mapping_sheet import ChannelSheet, MappingSheet, TimeSheet
from cutpoint.model.stated_units import COUNTS, SPELLINGS, TIMES, UNITS, WITH_GAIN

PAGE = (Path(__file__).parents[2] / "docs" / "log-mapping.md").read_text(encoding="utf-8")

(EXAMPLE,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)


def fields() -> Iterator[tuple[str, FieldInfo]]:
    """Every field as the page names it: those of a quantity once, by themselves."""
    for name, field in MappingSheet.model_fields.items():
        yield name, field
    for name, field in TimeSheet.model_fields.items():
        yield f"time.{name}", field
    yield from ChannelSheet.model_fields.items()


def row(name: str, field: FieldInfo) -> str:
    """The line of the page's table that a field must have."""
    units = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    unit = "; ".join(dict.fromkeys(str(units[key]) for key in ("unit", "linear_unit") if key in units))
    return f"| `{name}` | {unit} | {default(field)} | {field.description} |"


def default(field: FieldInfo) -> str:
    match field.default:
        case [float(number)]:
            return f"{number:g}"
        case TimeSheet():
            return "empty"
        case None:
            return "none"
        case str(word):
            return word
        case _:
            return "required"


@pytest.mark.parametrize("name", [name for name, _ in fields()])
def test_every_field_is_on_the_page_with_unit_default_and_meaning(name: str):
    assert row(name, dict(fields())[name]) in PAGE.splitlines()


def quoted(words: Sequence[str] | Mapping[str, object]) -> str:
    return ", ".join(f"`{word}`" for word in words)


@pytest.mark.parametrize("quantity", [*UNITS, "time"])
def test_every_unit_and_every_name_is_on_the_page(quantity: str):
    units, names = {"time": TIMES, **UNITS}[quantity], {"time": TIME, **NAMES}[quantity]
    counts = quoted([COUNTS[quantity]] if quantity in COUNTS else [])
    assert f"| `{quantity}` | {quoted(units)} | {counts} |" in PAGE.splitlines()
    assert f"| `{quantity}` | {quoted(names)} |" in PAGE.splitlines()


def test_every_spelling_of_a_unit_is_on_the_page():
    assert all(f"| `{unit}` | {quoted(those)} |" in PAGE.splitlines() for unit, those in SPELLINGS.items())
    assert f"these are units too: {quoted(WITH_GAIN)}." in PAGE


def test_the_page_has_no_field_unit_or_name_that_is_none():
    known = {name for name, _ in fields()} | UNITS.keys() | {"time"} | SPELLINGS.keys()
    assert set(re.findall(r"^\| `([a-z0-9_.]+)` \|", PAGE, re.MULTILINE)) == known


def test_the_example_is_complete():
    stated = yaml.safe_load(EXAMPLE)
    quantities = [stated[name] for name in UNITS if isinstance(stated[name], dict)]
    assert stated.keys() == MappingSheet.model_fields.keys()
    assert {key for each in quantities for key in each} == ChannelSheet.model_fields.keys()
    assert stated["time"].keys() == TimeSheet.model_fields.keys() - {"period"}  # stands instead of a channel


def test_the_example_is_read():
    t = times(1000)
    q, v, kept = positions(t), positions(t, 1), t >= 0.5  # as the example states
    ratio = np.array([101.0, -100.0])
    encoders = np.degrees((q - [0.0, 1.5708]) * [1.0, -1.0])
    amperes = v / ratio / [0.11, 0.09]
    columns = {"stamp": 1e3 * t, "mot": q * ratio / (2.0 * np.pi) * 8192, "mot_speed": v * ratio * 30.0 / np.pi}
    for k in range(2):
        columns |= {f"enc_{k + 1}": encoders[:, k], f"qd_{k + 1}": v[:, k], f"amp_{k + 1}": amperes[:, k]}
    log = Table("log", {name: Channel(values) for name, values in columns.items()})
    found = recording_of(log, parse_mapping(EXAMPLE))
    expected = {"q": q, "theta": q, "v": v, "theta_dot": v, "torque": v, "current": amperes}
    assert found.joints == ("shoulder", "elbow")
    assert np.allclose(found.time, t[kept], rtol=1e-14, atol=0.0)
    for name, values in expected.items():
        assert np.allclose(found[name], values[kept], rtol=1e-12, atol=1e-12)
