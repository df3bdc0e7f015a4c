"""Mapping files (YAML, version 1): which channels of a log are which quantity.  Fields: see `mapping_sheet.py`."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from cutpoint.door import check_kind, path_of
from cutpoint.errors import ModelError, listed
from cutpoint.formats.drives.section import Section
from cutpoint.formats.reading import read_bytes
from cutpoint.formats.safe_yaml import MAXIMUM_BYTES, YamlDocument, YamlPath, parse_yaml
from cutpoint.identification.logs.default_mapping import default_mapping
from cutpoint.identification.logs.mapping_sheet import ChannelSheet, MappingSheet
from cutpoint.identification.logs.recording import QUANTITIES
from cutpoint.identification.logs.table import Table
from cutpoint.model.stated_units import COUNTS, UNITS, WITH_GAIN

VERSION = 1


class Lineless(YamlDocument):
    """A mapping without a file: messages name only its fields, and the log if the mapping was derived from it."""

    def place(self, *paths: YamlPath) -> str:
        return self.file


class Mapped(NamedTuple):
    """A quantity of a mapping: its name and its fields.  section: of the whole file."""

    name: str
    sheet: ChannelSheet
    section: Section

    def error(self, key: str, complaint: str) -> ModelError:
        """An error at the line of a field."""
        return self.section.error((self.name, key), complaint)


@dataclass(frozen=True, eq=False)
class ChannelMap:
    """A mapping, and the places of its fields, for messages."""

    sheet: MappingSheet
    section: Section

    @property
    def quantities(self) -> dict[str, Mapped]:
        """The mapped quantities, by name."""
        found = {name: getattr(self.sheet, name) for name in QUANTITIES}
        return {name: Mapped(name, sheet, self.section) for name, sheet in found.items() if sheet is not None}


def load_mapping(path: str | Path) -> ChannelMap:
    """The mapping in a file (YAML); docs/log-mapping.md has its fields.

    Raises ModelError, with file and line, for any error in it.
    """
    path = path_of("load_mapping", path, "a mapping file")
    return parse_mapping(read_bytes(path, MAXIMUM_BYTES), str(path))


def parse_mapping(content: str | bytes | Mapping[str, Any], place: str = "<mapping>") -> ChannelMap:
    """The mapping of a text or a file's bytes (YAML), or of a dict of the same fields; `place` names it in messages.

    Raises ModelError for any error in it, with the line of a text; InputError for content of another kind.
    """
    check_kind("parse_mapping", "content", content, (str, bytes, Mapping), "text, or a dict of its fields")
    if isinstance(content, Mapping):
        document = Lineless("", _plain(content), {})
    else:
        document = parse_yaml(content.encode() if isinstance(content, str) else content, place)
    section = Section("mapping", document, ((),))
    found = ChannelMap(section.read(MappingSheet, document.value), section)
    _check(found)
    return found


def obvious_mapping(table: Table, joints: Sequence[str] = ()) -> ChannelMap:
    """The mapping that the channels' names suggest.  Raises InputError where they suggest none."""
    return ChannelMap(default_mapping(table, joints), Section("mapping", Lineless(table.file, None, {}), ((),)))


def completed(mapping: ChannelMap, table: Table, joints: Sequence[str]) -> ChannelMap:
    """The mapping; one that names no quantity gets those that the channels' names suggest.

    joints: of the robot, () if it is not known.  Raises InputError where they suggest none.
    """
    if mapping.quantities:
        return mapping
    sheet, suggested = mapping.sheet, default_mapping(table, mapping.sheet.joints or joints)
    found = {name: getattr(suggested, name) for name in QUANTITIES} | {"joints": sheet.joints or suggested.joints}
    return replace(mapping, sheet=sheet.model_copy(update=found))


def _plain(given: Mapping[str, Any]) -> Any:
    """A dict's values in the types of a file: lists for tuples, floats for numbers.  Raises ModelError."""
    try:
        return json.loads(json.dumps(dict(given)), parse_int=float)
    except (TypeError, ValueError, RecursionError) as error:
        raise ModelError(f"mapping: it may hold only text, numbers, lists and dicts: {error}") from error


def _check(mapping: ChannelMap) -> None:
    """Checks the rules that involve several fields."""
    sheet, section = mapping.sheet, mapping.section
    if sheet.version != VERSION:
        raise section.error(("version",), f"version {sheet.version:g} is not known; this cutpoint reads {VERSION}")
    if sheet.time.period is not None and sheet.time.channel is not None:
        raise section.error(("time",), "time has both 'channel' and 'period'; state only one")
    start, end = sheet.time.start or 0.0, sheet.time.end
    if end is not None and end <= start:
        raise section.error(("time", "end"), f"time.end {end:g} s must be later than time.start, {start:g} s")
    if sheet.joints and len(set(sheet.joints)) < len(sheet.joints):
        raise section.error(("joints",), f"joints {sheet.joints} must be distinct names")
    if sheet.ratio and 0.0 in sheet.ratio:
        raise section.error(("ratio",), "ratio must not be zero")
    for quantity in mapping.quantities.values():
        _check_quantity(quantity)


def _check_quantity(quantity: Mapped) -> None:
    name, sheet, _ = quantity
    if set(sheet.sign) - {1.0, -1.0}:
        raise quantity.error("sign", f"{name}.sign {sheet.sign} must be 1 or -1; a scale factor goes into gain")
    if sheet.gain and 0.0 in sheet.gain:
        raise quantity.error("gain", f"{name}.gain must not be zero")
    for unit in sheet.unit or ():
        check_unit(quantity, unit)


def check_unit(quantity: Mapped, unit: str) -> None:
    """Raises ModelError for a unit that the quantity cannot have, or that needs another number."""
    name, sheet, _ = quantity
    if unit == COUNTS.get(name):
        if sheet.counts_per_turn is None and sheet.gain is None:
            raise quantity.error("unit", f"{name}.unit {unit!r} needs 'counts_per_turn'")
    elif unit in WITH_GAIN and unit not in UNITS[name]:
        if sheet.gain is None:
            raise quantity.error("unit", f"{name}.unit {unit!r} needs 'gain': the SI value of one {unit}")
    elif unit not in UNITS[name]:
        raise quantity.error("unit", f"{name}.unit {unit!r} is not known; use {listed(UNITS[name])}, or state 'gain'")
