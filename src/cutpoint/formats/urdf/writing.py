"""A URDF with new inertias: only <inertial> elements of the user's text change, every other byte is kept."""

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from defusedxml.ElementTree import DefusedXMLParser

from cutpoint.errors import InputError
from cutpoint.formats.safe_xml import Element, parse_xml
from cutpoint.model.mechanism import WORLD, Body, Mechanism

_TAG = re.compile(rb"""<[^\s/>]+(?:\s+[^\s=]+\s*=\s*(?:"[^"]*"|'[^']*'))*\s*/?>""")

MOVED = b"<!-- mass and inertia are counted in the link that carries this one -->"
"""Replaces the <inertial> of a link that is fixed to another."""


class _Place(NamedTuple):
    """Byte ranges of a link and of its <inertial>; the latter None if there is none."""

    link: tuple[int, int]
    inertial: tuple[int, int] | None


def updated_urdf(
    content: bytes, before: Mechanism, after: Mechanism, place: str = "<string>"
) -> tuple[bytes, tuple[str, ...]]:
    """A URDF (UTF-8) from which `before` was read, with the inertias of `after`; and notes on what went where.

    A body that changed is one link with all that is fixed to it: the link that moves gets mass and inertia of all.
    Raises ModelError where the text cannot be read, InputError where it is not the robot's.
    """
    root = parse_xml(content, place)
    places = _places(content)
    missing = [body.name for body in before.bodies if body.name not in places]
    if missing or content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        what = f"has no link {missing[0]!r}" if missing else "is not UTF-8"
        raise InputError(f"the URDF {what}: its inertias cannot be replaced", place=place)
    edits: dict[tuple[int, int], bytes] = {}
    notes: list[str] = []
    for index, (old, new) in enumerate(zip(before.bodies, after.bodies, strict=True)):
        if not _is_same(old, new):
            fixed = _carried(before, index, places)
            edits |= dict([_edit(content, places[new.name], new)])
            edits |= {span: MOVED for name in fixed if (span := places[name].inertial)}
            if fixed:
                notes.append(f"link {new.name!r} now includes mass and inertia of {', '.join(fixed)}, fixed to it")
            if locked := _locked(before, index, root):
                notes.append(f"load it with {', '.join(locked)} locked as now: the links they move have no mass left")
    return _edited(content, edits), tuple(notes)


def _is_same(a: Body, b: Body) -> bool:
    return a.mass == b.mass and np.array_equal(a.com, b.com) and np.array_equal(a.inertia, b.inertia)


def _carried(mechanism: Mechanism, index: int, places: Mapping[str, _Place]) -> list[str]:
    """Links with inertia that are fixed to a body and do not name it."""
    frames, own = mechanism.frames, mechanism.bodies[index].name
    return [
        name
        for name, at in places.items()
        if at.inertial and name != own and name in frames and frames[name].body == index != WORLD
    ]


def _locked(mechanism: Mechanism, index: int, root: Element) -> list[str]:
    """Movable joints of the file that are locked and fix a link to a body."""
    frames, own = mechanism.frames, mechanism.bodies[index].name
    found: list[str] = []
    for joint in root.all("joint"):
        child = next(joint.all("child")).attributes["link"].strip()
        if joint.attributes["type"] != "fixed" and child != own and frames[child].body == index:
            found.append(joint.attributes["name"])
    return found


def _edit(content: bytes, at: _Place, body: Body) -> tuple[tuple[int, int], bytes]:
    """The bytes to replace, and their replacement."""
    end = b"\r\n" if b"\r\n" in content else b"\n"
    start = at.inertial[0] if at.inertial else at.link[0]
    indent = content[content.rfind(b"\n", 0, start) + 1 : start]
    indent = indent if not indent.strip() else b""
    if at.inertial:
        return at.inertial, _inertial(body, indent, end)
    tag = _TAG.match(content, at.link[0])
    assert tag  # expat has read it
    inside = end + indent + b"  " + _inertial(body, indent + b"  ", end)
    if not tag[0].endswith(b"/>"):
        return (tag.end(), tag.end()), inside
    return (tag.end() - 2, tag.end()), b">" + inside + end + indent + b"</link>"


def _inertial(body: Body, indent: bytes, end: bytes) -> bytes:
    xyz = " ".join(repr(float(x)) for x in body.com)
    upper = [repr(float(x)) for x in body.inertia[np.triu_indices(3)]]
    inertia = " ".join(f'i{name}="{x}"' for name, x in zip(("xx", "xy", "xz", "yy", "yz", "zz"), upper, strict=True))
    inner = [f'<origin xyz="{xyz}" rpy="0 0 0"/>', f'<mass value="{float(body.mass)!r}"/>', f"<inertia {inertia}/>"]
    lines = [b"<inertial>", *(b"  " + line.encode() for line in inner), b"</inertial>"]
    return (end + indent).join(lines)


def _edited(content: bytes, edits: Mapping[tuple[int, int], bytes]) -> bytes:
    parts, position = [], 0
    for (start, stop), new in sorted(edits.items()):
        parts += [content[position:start], new]
        position = stop
    return b"".join([*parts, content[position:]])


class _Spans:
    """Callbacks of the parser; places of links, by name."""

    def __init__(self, content: bytes) -> None:
        self.content = content
        self.expat: Any = None  # set once the parser exists: it knows where it is
        self.open: list[tuple[str, str, int]] = []
        self.inertial: tuple[int, int] | None = None
        self.places: dict[str, _Place] = {}

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.open.append((tag, attributes.get("name", "").strip(), self._here))

    def end(self, tag: str) -> None:
        depth, (_, name, start) = len(self.open), self.open.pop()
        here = self._here
        # for a self-closing element the parser is past the end already
        closes = self.content.startswith(b"</" + tag.encode(), here)
        stop = self.content.index(b">", here) + 1 if closes else here
        if depth == 3 and tag == "inertial" and self.open[-1][0] == "link":
            self.inertial = (start, stop)
        if depth == 2 and tag == "link":
            self.places[name] = _Place((start, stop), self.inertial)
            self.inertial = None

    def data(self, text: str) -> None:
        """Text has no meaning here."""

    def close(self) -> None:
        """The places are kept."""

    @property
    def _here(self) -> int:
        return int(self.expat.CurrentByteIndex)


def _places(content: bytes) -> dict[str, _Place]:
    spans = _Spans(content)
    parser = DefusedXMLParser(target=spans, forbid_dtd=True, forbid_entities=True, forbid_external=True)
    spans.expat = parser.parser
    parser.feed(content)
    parser.close()
    return spans.places
