"""MJCF's <include>: replaced by the contents of the file that it names."""

from collections.abc import Iterator
from os.path import abspath
from pathlib import Path

from cutpoint.errors import ModelError
from cutpoint.formats.beside import file_within
from cutpoint.formats.mjcf.meshes import ONE_FILE
from cutpoint.formats.reading import read_bytes
from cutpoint.formats.safe_xml import MAXIMUM_DEPTH, Element, parse_xml

MAXIMUM_FILES = 100


def include_files(root: Element, path: Path, limit: int) -> None:
    """Inserts into a file's document what it includes.  limit: bytes of all included files together.

    As in MuJoCo, names are relative to the folder of the first file, and a file is included once.
    Raises ModelError: a file is missing, outside that folder, named twice, no XML, or too large; too many files.
    """
    _Includes(path, limit).expand(root)


class _Includes:
    """The files included so far."""

    def __init__(self, path: Path, limit: int) -> None:
        self._folder, self._place, self._left = path.parent, str(path), limit
        self._read = {abspath(path)}  # as in MuJoCo, links are files of their own

    def expand(self, root: Element) -> None:
        waiting = [(root, 1)]
        while waiting:
            element, depth = waiting.pop()
            if depth > MAXIMUM_DEPTH:
                complaint = f"XML holds elements nested more than {MAXIMUM_DEPTH} deep, the limit"
                raise self._wrong(element, complaint)
            element.children[:] = [each for child in element.children for each in self._instead_of(child)]
            waiting.extend((child, depth + 1) for child in reversed(element.children))

    def _instead_of(self, element: Element) -> Iterator[Element]:
        if element.tag != "include":
            yield element
            return
        for child in self._root(element).children:
            yield from self._instead_of(child)

    def _root(self, include: Element) -> Element:
        """The root of the file that an element names."""
        name = include.attributes.get("file")
        if not name:
            raise self._wrong(include, '<include> names no file; give it file="..."')
        if include.children:
            inner = include.children[0].tag
            raise self._wrong(include, f"<include> stands for its file and must be empty, but holds <{inner}>")
        try:
            path = file_within(self._folder, name, ONE_FILE)
        except ModelError as problem:
            raise self._wrong(include, f"<include> {problem}") from problem
        target = abspath(path)
        if target in self._read:
            raise self._wrong(include, f"<include> {name!r}: the file is already part of the model; include it once")
        if len(self._read) > MAXIMUM_FILES:
            complaint = f"more than {MAXIMUM_FILES} files are included, the limit; {ONE_FILE}"
            raise self._wrong(include, complaint)
        self._read.add(target)
        try:
            content = read_bytes(path, self._left)
        except ModelError as problem:
            raise self._wrong(include, f"<include> {name!r}: {problem}") from problem
        self._left -= len(content)
        root = parse_xml(content, str(path), file=str(path), at=include.at or include.line)
        if root.tag in ("robot", "sdf"):
            rule = "is of another format: its root must be <mujocoinclude>"
            raise self._wrong(include, f"<include> {name!r} {rule}, got <{root.tag}>")
        return root

    def _wrong(self, element: Element, complaint: str) -> ModelError:
        return ModelError(complaint, place=element.where(self._place))
