"""What a stepping program is made of: regions of memory, stages that map regions to regions, loops around them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

N = TypeVar("N")


@dataclass(frozen=True)
class Region:
    """A named stretch of `size` numbers that the caller provides and that stages read and write.

    lanes: how many like things its numbers belong to, side by side: number f of thing l is at f * lanes + l.
    triples: whether every three numbers have the room of four, so that a wide register takes them at once; only in
        regions of one lane, and only stages in a LaneLoop may use them.
    """

    name: str
    size: int
    lanes: int = 1
    triples: bool = False

    @property
    def room(self) -> int:
        """Numbers that a row of its array has."""
        return self.place(self.size)

    def place(self, slot: int) -> int:
        """Where a slot is in that row."""
        return slot // 3 * 4 + slot % 3 if self.triples else slot


@dataclass(frozen=True, eq=False)
class Stage:
    """A pure function from regions to regions.

    function: receives a flat list of scalars for each region in `reads` and returns one for each in `writes` (the list
    itself if there is but one).  All is read before anything is written.
    lanes: how many like things it is computed for, all at once.  The function then sees one of them: its own numbers of
    regions with as many lanes, and all numbers of the others, which it can only read.
    as_in_threes: whether each lane computes what a stage on regions of triples does, to the last bit.
    """

    function: Callable[..., Any]
    reads: Sequence[str]
    writes: Sequence[str]
    lanes: int = 1
    as_in_threes: bool = False


@dataclass(frozen=True)
class View:
    """A row of a region, the one that a list of whole numbers says, as of a tree's parents.

    name: what stages call that row.  of: the region.  index: the list, an int64 for each iteration; it goes with the
    loop's streams, backward if they do.  A stage must not write one row under both names.
    """

    name: str
    of: str
    index: str


@dataclass(frozen=True, eq=False)
class Loop:
    """Runs its body again and again.

    count: how often; a text names a number that each run states.
    streams: regions that advance with the loop: their arrays have a row for each iteration, and inside the loop the
        region is the row of the iteration.  Entered again, the loop begins with the first row.  Outside there is none.
        A region that streams in loops inside too has a row for each of their iterations, within each of this loop's.
    until: a region of one slot; after an iteration that leaves it other than 0, the loop is left.
    backward: whether streams begin with the last of each entry's rows and end with the first.
    views: rows of regions that lists of whole numbers name, to be used inside.
    """

    count: int | str
    body: "Sequence[Stage | Loop]"
    streams: Sequence[str] = ()
    until: str | None = None
    backward: bool = False
    views: Sequence[View] = ()

    def within(self, name: str) -> "tuple[int | str, ...]":
        """Counts of the loops inside that a region streams in too, outermost first."""
        return next(iter(self.all_within(name)), ())

    def all_within(self, name: str) -> "set[tuple[int | str, ...]]":
        """The same of each path inward: they must not differ."""
        found: set[tuple[int | str, ...]] = set()
        for item in self.body:
            if isinstance(item, Loop):
                own = (item.count,) if name in item.streams else ()
                found |= {(*own, *counts) for counts in item.all_within(name) or {()}} - {()}
        return found


def number_of(count: int | str, counts: Mapping[str, N]) -> int | N:
    """How many a loop's count is, where a run states those that have a name."""
    return counts[count] if isinstance(count, str) else count


class LaneLoop(Loop):
    """A loop through like things one by one, whose regions hold several of them side by side.

    Its streams and views advance lane by lane: inside, such a region is one lane of a row, and a row of its array
    serves as many iterations as it has lanes.  Only stages of one lane can use it there.
    """
