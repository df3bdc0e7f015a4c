"""Nesting depth of cells and structures in an array of a MATLAB file, checked before SciPy reads it.

SciPy recurses at every level, on the stack of the process.  It reads elements in sequence, whatever size an array
states, and so does this.  All numbers are from MathWorks, MAT-File Format, "Level 5 MAT-File Format".
"""

import math
from typing import Any, NamedTuple

ARRAY = 14
"""The tag of an array element, of numbers or of further arrays."""

CELL, STRUCTURE, OBJECT, FUNCTION, OPAQUE = 1, 2, 3, 16, 17
"""Classes of arrays that contain arrays."""

DEEPEST = 100
"""Deepest nesting of arrays."""

MOST_ARRAYS = 1_000_000
"""Largest number of arrays and of elements with their numbers."""

MOST_DIMENSIONS = 32
"""Largest number of an array's dimensions, as in SciPy."""


class Element(NamedTuple):
    """The content of an element, and the start of the next one."""

    content: memoryview
    end: int


def check_nesting(array: memoryview, order: Any) -> None:
    """Raises ValueError for an element whose arrays nest deeper than `DEEPEST`, are too many, or are incomplete."""
    place, count = 0, 0
    to_come = [1]  # arrays left at each depth
    while to_come:
        if not to_come[-1]:
            to_come.pop()
            continue
        if place >= len(array):
            raise ValueError("it ends in the middle of an array")
        count += 1
        if len(to_come) > DEEPEST or count > MOST_ARRAYS:
            rule = f"its arrays nest deeper than {DEEPEST}, or have more than {MOST_ARRAYS:,} elements"
            raise ValueError(f"{rule}; save only the matrices of numbers")
        kind, size = (int.from_bytes(array[place + k : place + k + 4], order) for k in (0, 4))
        if kind != ARRAY:
            place = _element(array, place, order).end
            continue
        to_come[-1] -= 1
        place += 8
        if size:  # else nothing follows
            held, place = _held(array, place, order)
            to_come.append(held)


def _held(array: memoryview, place: int, order: Any) -> tuple[int, int]:
    """How many arrays one contains, with its flags at a position, and where the data after its name begins."""
    kind = int.from_bytes(array[place + 8 : place + 12], order) & 0xFF
    place += 16
    if kind == OPAQUE:
        return 1, place
    sizes = _element(array, place, order)
    place = _element(array, sizes.end, order).end
    if len(sizes.content) > 4 * MOST_DIMENSIONS:
        raise ValueError(f"one of its arrays has more than {MOST_DIMENSIONS} dimensions")
    cells = math.prod(_number(sizes.content[k:], order) for k in range(0, len(sizes.content), 4))
    if kind not in (STRUCTURE, OBJECT):
        return {CELL: cells, FUNCTION: 1}.get(kind, 0), place
    if kind == OBJECT:
        place = _element(array, place, order).end
    longest = _element(array, place, order)
    names = _element(array, longest.end, order)
    return cells * (len(names.content) // max(1, _number(longest.content, order))), names.end


def _element(array: memoryview, place: int, order: Any) -> Element:
    """The element at a position; up to four bytes are within its tag."""
    kind = int.from_bytes(array[place : place + 4], order)
    if kind >> 16:
        return Element(array[place + 4 : place + 4 + min(4, kind >> 16)], place + 8)
    size = int.from_bytes(array[place + 4 : place + 8], order)
    return Element(array[place + 8 : place + 8 + size], place + 8 + size + -size % 8)


def _number(content: memoryview, order: Any) -> int:
    """The number at its start."""
    return int.from_bytes(content[:4], order)
