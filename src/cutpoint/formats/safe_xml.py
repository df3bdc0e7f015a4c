"""XML from untrusted files, as a tree of elements with line numbers.

No document type, no entities, no external references; size, depth and number of elements are capped.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, cast
from xml.etree.ElementTree import ParseError
from xml.parsers.expat import ErrorString
from xml.parsers.expat.errors import (
    XML_ERROR_DUPLICATE_ATTRIBUTE,
    XML_ERROR_INVALID_TOKEN,
    XML_ERROR_JUNK_AFTER_DOC_ELEMENT,
    XML_ERROR_MISPLACED_XML_PI,
    XML_ERROR_NO_ELEMENTS,
    XML_ERROR_TAG_MISMATCH,
    XML_ERROR_UNBOUND_PREFIX,
    XML_ERROR_UNCLOSED_TOKEN,
    XML_ERROR_UNDEFINED_ENTITY,
    XML_ERROR_XML_DECL,
)

from defusedxml import DefusedXmlException, DTDForbidden
from defusedxml.ElementTree import DefusedXMLParser

from cutpoint.errors import ModelError

MAXIMUM_BYTES = 64 * 2**20
MAXIMUM_DEPTH = 499
"""Deepest nesting of elements: MuJoCo's.  Readers here must not recurse for each."""

MAXIMUM_ELEMENTS = 200_000
MAXIMUM_ATTRIBUTES = 1000
"""Of an element."""

MAXIMUM_ATTRIBUTE = 1_000_000
"""Largest length, in characters, of an attribute's value."""


@dataclass(frozen=True)
class Element:
    """A tag with its attributes and child elements; line counts from 1.  Text between tags is dropped.

    file, at: of what stands in a file which the document includes, that file, and the line that names it.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    children: list["Element"] = field(default_factory=list)
    file: str = ""
    at: int = 0

    def where(self, place: str) -> str:
        """File and line, for messages; place: the document's name."""
        return f"{self.file or place}:{self.line}"

    def all(self, tag: str) -> Iterator["Element"]:
        """Child elements of that tag, in order."""
        return (child for child in self.children if child.tag == tag)

    def walk(self) -> Iterator["Element"]:
        """The element and all its descendants, in the order of the document."""
        waiting: list[Element] = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))


REMEDIES = {
    XML_ERROR_MISPLACED_XML_PI: "remove everything before <?xml ...?>, even blank lines and comments",
    XML_ERROR_UNBOUND_PREFIX: 'declare the prefix in the root element, xmlns:prefix="...", or remove it',
    XML_ERROR_INVALID_TOKEN: (
        "write & as &amp; and < as &lt;, use no -- in comments and no control characters, and save the file as UTF-8"
    ),
    XML_ERROR_TAG_MISMATCH: "close each element before its parent",
    XML_ERROR_NO_ELEMENTS: "the file ends, maybe cut off, before its root element is closed",
    XML_ERROR_UNCLOSED_TOKEN: "the file ends, maybe cut off, before the tag or comment that begins here is closed",
    XML_ERROR_XML_DECL: 'write <?xml version="1.0"?>',
    XML_ERROR_UNDEFINED_ENTITY: "write the character itself",
    XML_ERROR_DUPLICATE_ATTRIBUTE: "give it once",
    XML_ERROR_JUNK_AFTER_DOC_ELEMENT: "remove everything after the root element",
}
"""Remedies by expat's error."""


class _Builder:
    """Callbacks of the parser, with the caps."""

    def __init__(self, place: str, file: str, at: int) -> None:
        self.place, self.file, self.at = place, file, at
        self.expat: Any = None  # set once the parser exists: it knows the current line
        self.root: Element | None = None
        self.open: list[Element] = []
        self.count = 0
        self.namespace = ""  # the root's, which all elements of the format share

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        if not self.root:
            self.namespace = tag[: tag.rfind("}") + 1]
        own = tag.removeprefix(self.namespace)
        element = Element(own, attributes, self.expat.CurrentLineNumber, file=self.file, at=self.at)
        self.count += 1
        if self.count > MAXIMUM_ELEMENTS:
            raise self._too_much(f"more than {MAXIMUM_ELEMENTS:,} elements", element)
        if len(self.open) >= MAXIMUM_DEPTH:
            raise self._too_much(f"elements nested more than {MAXIMUM_DEPTH} deep", element)
        if len(attributes) > MAXIMUM_ATTRIBUTES:
            raise self._too_much(f"more than {MAXIMUM_ATTRIBUTES:,} attributes in one element", element)
        for name, value in attributes.items():
            if len(value) > MAXIMUM_ATTRIBUTE:
                found = f"{name!r} of <{own}>, an attribute of {len(value):,} characters, more than"
                raise self._too_much(f"{found} {MAXIMUM_ATTRIBUTE:,}", element)
        if self.open:
            self.open[-1].children.append(element)
        else:
            self.root = element
        self.open.append(element)

    def end(self, tag: str) -> None:
        self.open.pop()

    def data(self, text: str) -> None:
        """Text has no meaning in the formats read here."""

    def close(self) -> None:
        """The tree is kept in `root`."""

    def _too_much(self, what: str, element: Element) -> ModelError:
        return ModelError(f"XML holds {what}, the limit", place=f"{self.place}:{element.line}")


def parse_xml(content: bytes | str, place: str, *, file: str = "", at: int = 0) -> Element:
    """The root element of a document; `place` names the file in messages.  file, at: its elements', see there.

    Raises ModelError: not well formed, a document type or entities, over a cap.
    """
    builder = _Builder(place, file, at)
    parser = DefusedXMLParser(target=builder, forbid_dtd=True, forbid_entities=True, forbid_external=True)
    builder.expat = parser.parser
    try:
        parser.feed(content)
        parser.close()
        return cast(Element, builder.root)  # a document without a root is not well formed
    except ParseError as problem:
        line, column = problem.position
        told = ErrorString(problem.code)
        remedy = f", at column {column + 1}: {REMEDIES[told]}" if told in REMEDIES else ""
        raise ModelError(f"XML is not well formed: {told}{remedy}", place=f"{place}:{line}", line=line) from problem
    except DefusedXmlException as problem:
        what = "a document type (<!DOCTYPE>)" if isinstance(problem, DTDForbidden) else "entities"
        line = builder.expat.CurrentLineNumber
        complaint = f"XML with {what} is not read, for safety; remove it"
        raise ModelError(complaint, place=f"{place}:{line}", line=line) from problem
    except (ValueError, LookupError) as problem:
        if isinstance(problem, ModelError):
            raise
        remedy = "save the file as UTF-8, and declare no other encoding"
        raise ModelError(f"XML cannot be decoded: {problem}; {remedy}", place=place) from problem
