"""Parts of a stepping program: regions of memory, stages that map regions to regions, loops around them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

N = TypeVar("N")


@dataclass(frozen=True)
class Region:
    """A named block of `size` numbers that the caller provides and that stages read and write.

    lanes: how many like things its numbers belong to, interleaved: number f of thing l is at f * lanes + l.
    triples: whether every three numbers are padded to four, to fit a vector register; only in regions of one lane, for
    stages of one lane; one with rows must stream in a LaneLoop.
    """

    name: str
    size: int
    lanes: int = 1
    triples: bool = False

    @property
    def room(self) -> int:
        """Size of a row of its array, with padding."""
        return self.place(self.size)

    def place(self, slot: int) -> int:
        """Position of a slot in that row."""
        return slot // 3 * 4 + slot % 3 if self.triples else slot


@dataclass(frozen=True, eq=False)
class Stage:
    """A pure function from regions to regions.

    function: receives a flat list of scalars for each region in `reads` and returns one for each in `writes` (the list
    itself if there is only one).  Everything is read before anything is written.
    lanes: how many like things it is computed for at once.  The function then sees one of them: its own numbers of
    regions with as many lanes, and all numbers of other regions, which it can only read.
    as_in_threes: whether each lane computes what a stage on regions of triples does, to the last bit.
    """

    function: Callable[..., Any]
    reads: Sequence[str]
    writes: Sequence[str]
    lanes: int = 1
    as_in_threes: bool = False


@dataclass(frozen=True)
class View:
    """A row of a region, selected by a list of integers, such as a tree's parents.

    name: the row's name in stages.  of: the region.  index: the list, an int64 for each iteration; it advances with the
    loop's streams, backward if they do.  A stage must not write one row under both names.
    """

    name: str
    of: str
    index: str


@dataclass(frozen=True, eq=False)
class Loop:
    """Runs its body repeatedly.

    count: trip count; a string names a number that each run gives.
    streams: regions that advance with the loop: their arrays have a row for each iteration, and inside the loop the
    region is the row of the iteration.  On re-entry the loop begins with the first row.  Outside there is none.
    A region that also streams in inner loops has a row for each of their iterations, within each of this loop's.
    until: a region of one slot; after an iteration that leaves it nonzero, the loop exits.
    backward: whether streams begin with the last of each entry's rows and end with the first.
    views: rows of regions that lists of integers select, for use inside.
    """

    count: int | str
    body: "Sequence[Stage | Loop]"
    streams: Sequence[str] = ()
    until: str | None = None
    backward: bool = False
    views: Sequence[View] = ()

    def within(self, name: str) -> "tuple[int | str, ...]":
        """Counts of the inner loops that a region also streams in, outermost first."""
        return next(iter(self.all_within(name)), ())

    def all_within(self, name: str) -> "set[tuple[int | str, ...]]":
        """The same for each path inward: they must not differ."""
        found: set[tuple[int | str, ...]] = set()
        for item in self.body:
            if isinstance(item, Loop):
                own = (item.count,) if name in item.streams else ()
                found |= {(*own, *counts) for counts in item.all_within(name) or {()}} - {()}
        return found


def number_of(count: int | str, counts: Mapping[str, N]) -> int | N:
    """A loop's count as a number; a run gives those that have a name."""
    return counts[count] if isinstance(count, str) else count


class LaneLoop(Loop):
    """A loop over like things one by one, whose regions interleave several of them.

    Its streams and views advance lane by lane: inside, such a region is one lane of a row, and a row of its array
    serves as many iterations as it has lanes.  Only stages of one lane can use it there.
    """
