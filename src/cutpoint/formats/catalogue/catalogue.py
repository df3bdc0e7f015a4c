"""The drive catalogue that comes with the package: gears and actuators by name.  `docs/catalogue.md` lists them.

`catalogue_data/` holds the numbers, each group with its source; `entry` converts them to drives.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from cutpoint.errors import ModelError, close_to, those_that_exist
from cutpoint.formats.catalogue.entry import drive_entry
from cutpoint.formats.catalogue.friction import InputFriction, input_friction
from cutpoint.formats.catalogue.sheets import CatalogueGear
from cutpoint.formats.drives.drive_sheet import DriveSheet
from cutpoint.formats.drives.entry import to_drive
from cutpoint.formats.drives.section import Section
from cutpoint.formats.reading import read_bytes
from cutpoint.formats.safe_yaml import MAXIMUM_BYTES, YamlDocument, parse_yaml
from cutpoint.model.drive import Drive

_FOLDER = Path(__file__).parents[2] / "catalogue_data"

_NOT_THE_ACTUATORS = ("maker", "series", "size", "ratio", "inertia", "mass")
"""Fields of a gear that an actuator with it does not inherit."""


def catalogue_names() -> tuple[str, ...]:
    """Names of all gears and actuators, in the catalogue's order."""
    return tuple(_gears())


def catalogue_gear(name: str) -> CatalogueGear:
    """A gear's or actuator's data in the maker's units (arcmin, rpm, h), each group with its source.

    Raises ModelError for an unknown name.
    """
    if (gear := _gears().get(name)) is None:
        raise ModelError(unknown_gear(name), name=name)
    return gear


def catalogue_friction(name: str) -> InputFriction:
    """A gear's friction at its input, from its sheet or as an estimate.  Raises ModelError as `catalogue_gear` does."""
    return input_friction(catalogue_gear(name), catalogue_gear)


def entry_of(name: str) -> dict[str, Any]:
    """A gear or actuator as an entry of a drive file, in its units: a dict of fields, without those that lack data.

    The circular spline is fixed, and the flexspline turns the joint.  Raises ModelError as `catalogue_gear` does.
    """
    return drive_entry(catalogue_gear(name), catalogue_friction(name))


def catalogue_drive(name: str) -> Drive:
    """A gear or actuator as the drive of a revolute joint, with whatever its data sheet tells.

    The circular spline is fixed, so the ratio is negative.  A gear's rotor is its wave generator alone: the motor's
    inertia has to be added.  Raises ModelError as `catalogue_gear` does.
    """
    section = Section(name, YamlDocument("catalogue", {}, {}), ((),))
    return to_drive(section.read(DriveSheet, entry_of(name)), section)


def unknown_gear(name: str) -> str:
    """The error message for an unknown catalogue name, which may differ in digits only."""
    names = catalogue_names()
    near = close_to(name, names)
    told = f"did you mean {' or '.join(map(repr, near))}?" if near else those_that_exist(name, names)
    return f"the catalogue has no {name!r}; {told} (cutpoint drive lists them; state others by their data sheets)"


@cache
def _gears() -> dict[str, CatalogueGear]:
    gears, actuators = _document("harmonic_drive.yaml"), _document("actuators.yaml")
    entries = {name: _with_sources(gears, entry) for name, entry in gears.value["gears"].items()}
    found = {name: _record(name, entry, gears, "gears") for name, entry in entries.items()}
    for name, entry in actuators.value["actuators"].items():
        own = _with_sources(actuators, entry)
        gear = own.pop("gear")
        base = entries[gear] if isinstance(gear, str) else _with_sources(actuators, gear)
        inherited = {key: value for key, value in base.items() if key not in _NOT_THE_ACTUATORS}
        found[name] = _record(name, inherited | own, actuators, "actuators")
    return found


def _document(file: str) -> YamlDocument:
    return parse_yaml(read_bytes(_FOLDER / file, MAXIMUM_BYTES), str(_FOLDER / file))


def _record(name: str, entry: Mapping[str, Any], document: YamlDocument, chapter: str) -> CatalogueGear:
    section = Section(f"catalogue {name!r}", document, ((chapter, name),))
    return section.read(CatalogueGear, {"name": name, **entry})


def _with_sources(document: YamlDocument, entry: Mapping[str, Any]) -> dict[str, Any]:
    """An entry whose groups hold their sources instead of the sources' keys."""
    sources = document.value["sources"]

    def cited(group: Any) -> Any:
        if not isinstance(group, dict) or "source" not in group:
            return group
        key = group["source"]
        return group | {"source": {"key": key, **sources[key]}}

    return {name: cited(group) for name, group in entry.items()}
