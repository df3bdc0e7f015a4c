"""YAML from untrusted files, as plain values with line numbers.

A small, strict YAML: mappings, lists, texts, numbers, true and false.  No tags, no anchors or aliases, no merge keys,
no second document, no key twice, no empty values; size, depth and number of values are capped.  Every number is a
float, written in plain decimals (`1e4` too) or as `.inf`; `yes`, `12:30` and `1_000` are texts.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NoReturn

import yaml

from cutpoint.errors import ModelError
from cutpoint.formats.reading import parse_number

MAXIMUM_BYTES = 2**18
MAXIMUM_DEPTH = 16
MAXIMUM_VALUES = 20_000

_WORDS = {"true": True, "false": False, ".inf": math.inf, "+.inf": math.inf, "-.inf": -math.inf}
_NO_VALUE = ("", "~", "null")

YamlPath = tuple[str, ...]
"""Keys (and list indices, as texts) from the root to a value."""


@dataclass(frozen=True)
class YamlDocument:
    """The values of a file, and the line, counted from 1, on which each stands."""

    file: str
    value: Any
    lines: dict[YamlPath, int]

    def place(self, *paths: YamlPath) -> str:
        """`file:line` of the path of which the fewest last keys are not in the file; earlier paths win ties."""
        for cut in range(max(map(len, paths))):
            for path in paths:
                kept = path[: max(0, len(path) - cut)]
                if kept and kept in self.lines:
                    return f"{self.file}:{self.lines[kept]}"
        return f"{self.file}:1"


def parse_yaml(content: bytes, file: str) -> YamlDocument:
    """The values of one YAML document.

    Raises ModelError, with the line: not YAML, not UTF-8, beyond the strict subset, over a cap.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = content.count(b"\n", 0, problem.start) + 1
        raise ModelError("YAML must be UTF-8 text; save the file as UTF-8", place=f"{file}:{line}") from problem
    try:
        loader = yaml.SafeLoader(text)
    except yaml.reader.ReaderError as problem:
        line = text.count("\n", 0, problem.position) + 1
        complaint = f"YAML cannot be read: character {chr(problem.character)!r} is not allowed"
        raise ModelError(complaint, place=f"{file}:{line}") from problem
    try:
        return _Composer(file, iter(loader.get_event, None)).document()
    except ModelError:
        raise
    except yaml.MarkedYAMLError as problem:
        mark = problem.problem_mark or problem.context_mark
        place = f"{file}:{mark.line + 1}" if mark else file
        told = f"{problem.problem or problem.context}"
        spaces = "; indent lines with spaces" if r"'\t'" in told else ""
        raise ModelError(f"YAML cannot be read: {told}{spaces}", place=place) from problem
    except (ValueError, OverflowError) as problem:
        complaint = "YAML cannot be read: the number of a character (\\U) or of the version is too large"
        raise ModelError(complaint, place=f"{file}:{loader.line + 1}") from problem


@dataclass
class _Composer:
    """Builds values from the parser's events."""

    file: str
    events: Iterator[Any]
    lines: dict[YamlPath, int] = field(default_factory=dict)
    count: int = 0

    def document(self) -> YamlDocument:
        for event in self.events:
            if isinstance(event, yaml.NodeEvent):
                value = self.value(event, ())
                self.refuse_second_document()
                return YamlDocument(self.file, value, self.lines)
        raise ModelError("YAML holds no values", place=self.file)

    def refuse_second_document(self) -> None:
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                self.refuse(event, "a second document (---) is not read")

    def value(self, event: Any, path: YamlPath) -> Any:
        self.check(event, path)
        self.lines[path] = event.start_mark.line + 1
        if isinstance(event, yaml.MappingStartEvent):
            return self.mapping(path)
        if isinstance(event, yaml.SequenceStartEvent):
            return self.sequence(path)
        return self.scalar(event, path)

    def mapping(self, path: YamlPath) -> dict[str, Any]:
        found: dict[str, Any] = {}
        while not isinstance(key := next(self.events), yaml.MappingEndEvent):
            self.check(key, path)
            if not isinstance(key, yaml.ScalarEvent):
                self.refuse(key, "a key must be plain text")
            if key.value in found:
                self.refuse(key, f"key {key.value!r} is given twice")
            place = (*path, key.value)
            found[key.value] = self.value(next(self.events), place)
            self.lines[place] = key.start_mark.line + 1
        return found

    def sequence(self, path: YamlPath) -> list[Any]:
        found: list[Any] = []
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            found.append(self.value(event, (*path, str(len(found)))))
        return found

    def scalar(self, event: Any, path: YamlPath) -> Any:
        text = event.value
        if event.style is not None:
            return text
        if text in _NO_VALUE:
            comma = "; in {} a comma ends a value: 4000, not 4,000" if "".join(path[-1:]).isdigit() else ""
            self.refuse(event, f"{'.'.join(path) or 'the file'} has no value{comma}")
        number = parse_number(text)
        return number if number is not None else _WORDS.get(text, text)

    def check(self, event: Any, path: YamlPath) -> None:
        self.count += 1
        if self.count > MAXIMUM_VALUES:
            self.refuse(event, f"YAML holds more than {MAXIMUM_VALUES:,} values, the limit")
        if len(path) > MAXIMUM_DEPTH:
            self.refuse(event, f"YAML is nested more than {MAXIMUM_DEPTH} deep, the limit")
        if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
            self.refuse(event, "YAML anchors and aliases (&, *) are not read, for safety; write the value out")
        if event.tag is not None:
            self.refuse(event, f"YAML tags ({event.tag!r}) are not read, for safety; remove the tag")

    def refuse(self, event: Any, complaint: str) -> NoReturn:
        raise ModelError(complaint, place=f"{self.file}:{event.start_mark.line + 1}")
