"""LLVM IR that transposes rows of a C-ordered array into lanes, and lanes into rows: a column is one vector.

Columns go in blocks of a power of two, HALF_LINE at most: most longer ones would straddle two cache lines.

In a block of c columns, vector k first holds the rows k, k + c, k + 2 c, ... in sequence; then c x c squares are
transposed inside all vectors at once, by exchanges between vectors 1, 2, 4, ... apart (Eklundh 1972: log2(c) shuffles a
vector).
"""

from collections.abc import Iterator, Sequence

from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.llvm_code import Code, literal

HALF_LINE = 32
"""Bytes."""


def blocks(columns: int, width: int, item: int) -> Iterator[tuple[int, int]]:
    """First column and number of columns of each block.  width: number of rows; item: size of a number, bytes."""
    first, most = 0, min(width, HALF_LINE // item)
    while first < columns:
        size = min(most, 1 << (columns - first).bit_length() - 1)
        yield first, size
        first += size


def lanes_of_rows(code: Code, precision: Precision, rows: Sequence[str], first: int, size: int) -> list[str]:
    """A vector for each column of a block, from pointers to the rows."""
    one, item = precision.real, precision.item
    parts = [code.load(code.at(row, first, one), 0, f"<{size} x {one}>", align=item) for row in rows]
    return _transposed(code, one, [_joined(code, one, parts[k::size], size) for k in range(size)], len(rows))


def lanes_to_rows(code: Code, precision: Precision, vectors: Sequence[str], rows: Sequence[str], first: int) -> None:
    """Writes a block of columns, a vector each, through pointers to the rows."""
    one, item, size = precision.real, precision.item, len(vectors)
    for k, vector in enumerate(_transposed(code, one, [*vectors], len(rows))):
        for group, row in enumerate(rows[k::size]):
            part = _shuffled(code, one, vector, vector, len(rows), range(group * size, (group + 1) * size))
            code.store(part, code.at(row, first, one), 0, f"<{size} x {one}>", align=item)


def constants_to_rows(
    code: Code, precision: Precision, numbers: Sequence[float], rows: Sequence[str], first: int
) -> None:
    """Writes numbers that are equal in all rows."""
    one, kind = precision.real, f"<{len(numbers)} x {precision.real}>"
    constant = ", ".join(f"{one} {literal(x)}" for x in numbers)
    for row in rows:
        code.store(f"<{constant}>", code.at(row, first, one), 0, kind, align=precision.item)


def _transposed(code: Code, one: str, vectors: list[str], width: int) -> list[str]:
    """The vectors with their squares of len(vectors) rows and columns transposed; one: the type of a number."""
    distance = 1
    while distance < len(vectors):
        low = [j if not j & distance else width + j - distance for j in range(width)]
        high = [j + distance if not j & distance else width + j for j in range(width)]
        for k in [k for k in range(len(vectors)) if not k & distance]:
            a, b = vectors[k], vectors[k + distance]
            vectors[k] = _shuffled(code, one, a, b, width, low)
            vectors[k + distance] = _shuffled(code, one, a, b, width, high)
        distance *= 2
    return vectors


def _joined(code: Code, one: str, parts: list[str], size: int) -> str:
    """One vector concatenated from parts, a power of two, of so many numbers each."""
    while len(parts) > 1:
        pairs = zip(parts[::2], parts[1::2], strict=True)
        parts, size = [_shuffled(code, one, a, b, size, range(2 * size)) for a, b in pairs], 2 * size
    return parts[0]


def _shuffled(code: Code, one: str, a: str, b: str, size: int, chosen: Sequence[int]) -> str:
    """The chosen lanes of two vectors of so many numbers each."""
    kind, places = f"<{size} x {one}>", ", ".join(f"i32 {k}" for k in chosen)
    return code.let(f"shufflevector {kind} {a}, {kind} {b}, <{len(chosen)} x i32> <{places}>")
