"""A catalogue's drive as text to paste into a drive file."""

from textwrap import indent
from typing import Any

import yaml

from cutpoint.formats.catalogue.catalogue import catalogue_friction, catalogue_gear, entry_of

PARTS = {"dry": "starting torque", "slope": "running torque", "per_load": "losses that grow with load"}
"""Of `InputFriction`, in words."""

_JOINT = "JOINT"


def entry_text(name: str) -> str:
    """The entry, to go below `drives:`, with what it is worth above it.  Errors as in `catalogue_gear`."""
    entry = yaml.dump({_JOINT: entry_of(name)}, Dumper=_Flow, sort_keys=False, width=110)
    notes = [f"# {name}: put the joint's name for {_JOINT}", *(f"# {line}" for line in _doubts(name))]
    return indent("\n".join([*notes, entry]), "  ")


def _doubts(name: str) -> list[str]:
    """Notes on estimates and on numbers that were not read on a page of the maker's."""
    gear, friction = catalogue_gear(name), catalogue_friction(name)
    lines = [estimate_note(name)] if friction.estimated else []
    unverified = [key for key, group in gear.groups.items() if not group.verified and key != "friction"]
    return [*lines, f"not verified: {', '.join(unverified)}"] if unverified else lines


def estimate_note(name: str) -> str:
    """Which parts of the friction are estimates, and their source; empty if none is."""
    gear, friction = catalogue_gear(name), catalogue_friction(name)
    if gear.friction is None or not friction.estimated:
        return ""
    what = ", ".join(PARTS[part] for part in friction.estimated)
    scale = f", its input torque times {gear.friction.scale:g}" if gear.friction.scale != 1.0 else ""
    return f"friction is an estimate ({what}): as of {gear.friction.like}{scale}"


class _Flow(yaml.SafeDumper):
    """Mappings without mappings in them on one line."""

    def represent_mapping(self, tag: str, mapping: Any, flow_style: bool | None = None) -> Any:
        simple = not any(isinstance(value, dict) for value in dict(mapping).values())
        return super().represent_mapping(tag, mapping, flow_style=simple)
