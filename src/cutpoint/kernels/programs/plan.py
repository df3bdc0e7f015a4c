"""A program checked and traced: what its backends run."""

from collections import defaultdict
from collections.abc import Container, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple

from cutpoint.errors import InputError, TraceError, unknown_name
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.specialise import checked, name_of
from cutpoint.kernels.graphs.tracing import tracing
from cutpoint.kernels.programs.stepping import LaneLoop, Loop, Region, Stage, View

Counts = tuple[int | str, ...]


class Advance(NamedTuple):
    """How a region streams: counts whose product is how often it advances, and how many such steps take one row."""

    counts: Counts
    steps: int


@dataclass(frozen=True, eq=False)
class Plan:
    """A program that is known to be sound.

    regions: by name.  graphs: of the stages, of one lane each.  written: regions that some stage writes.
    streamed: of regions with rows, how they stream, for each time they do: never if they are only viewed.
    counts: the names of numbers that a run must state.  views: by name.
    single: for each stage the names of which it sees one lane.  single_views: the views that are one lane of a row.
    indices: for each list of rows, the counts of the loops it advances with.
    advancing: for each stage the regions that go on to the next row with the loop right around it.
    """

    body: Loop
    regions: dict[str, Region]
    graphs: dict[Stage, Graph]
    written: frozenset[str]
    streamed: dict[str, list[Advance]]
    counts: tuple[str, ...]
    views: dict[str, View]
    indices: dict[str, list[int | str]]
    single: dict[Stage, frozenset[str]]
    single_views: frozenset[str]
    advancing: dict[Stage, frozenset[str]]

    @cached_property
    def sizes(self) -> dict[str, int]:
        """Numbers in a row of each region's array."""
        return {name: region.room for name, region in self.regions.items()}

    @property
    def names(self) -> tuple[str, ...]:
        """Of all arrays that a run is given."""
        return (*self.regions, *self.indices)

    @property
    def changing(self) -> frozenset[str]:
        """Names whose numbers are not the same for the whole of a run."""
        return self.written | self.streamed.keys() | self.views.keys()

    def root(self, name: str) -> str:
        """The region that a name stands for."""
        return self.views[name].of if name in self.views else name

    def fed(self, stage: Stage) -> dict[int, int]:
        """By input slot that reads rows which the stage writes too: the result that may be there an iteration later.

        What it writes under the same name is another's row: rarely the one before, and read just to be added to.
        """
        graph, root = self.graphs[stage], self.root
        places = [(root(port.name), k) for port in graph.outputs for k in range(port.size)]
        results = {place: k for k, place in enumerate(places) if place[0] in self.streamed}
        sources = [(port.name, k) for port in graph.inputs for k in range(port.size)]
        own = {port.name for port in graph.outputs}
        fed = {slot: (root(name), k) for slot, (name, k) in enumerate(sources) if name not in own}
        return {slot: results[place] for slot, place in fed.items() if place in results}

    def known_ahead(self, stage: Stage) -> frozenset[str]:
        """Regions that a stage reads row by row, each row there before its turn and the same for all lanes."""
        shared = {name for name in stage.reads if name in self.regions and self.regions[name].lanes == 1}
        return (self.advancing[stage] & shared) - self.written

    def in_threes(self, stage: Stage) -> bool:
        """Whether a stage uses regions whose numbers come in threes."""
        return any(self.regions[self.root(name)].triples for name in (*stage.reads, *stage.writes))

    def is_laned(self, stage: Stage, name: str) -> bool:
        """Whether each lane of a stage has numbers of its own in a region."""
        return stage.lanes > 1 and self.regions[self.root(name)].lanes == stage.lanes


def plan(body: Loop, regions: Sequence[Region]) -> Plan:
    """Checks and traces a program.

    Raises:
        InputError: a region is unknown, given twice or of the wrong size, or the nest of loops makes no sense.
        TraceError: a stage cannot be traced or returns something else than its regions.
    """
    named = {region.name: region for region in regions}
    if len(named) < len(regions) or any(r.size < 0 or r.lanes < 1 or r.size % r.lanes for r in regions):
        raise InputError(f"regions must have different names and sizes of 0 or more, whole in lanes: {[*regions]}")
    if any(r.triples and (r.lanes > 1 or r.size % 3) for r in regions):
        raise InputError(f"regions of triples must be of one lane and of a size whole in threes: {[*regions]}")
    walk = _Walk(named)
    walk.loop(body, frozenset(), frozenset(), ())
    walk.check_streams()
    written = frozenset(walk.views[name].of if name in walk.views else name for name in walk.written)
    streamed, indices = dict(walk.streamed), dict(walk.indices)
    single_views = frozenset(name for name, single in walk.single_views.items() if single)
    counts = tuple(walk.counts)
    return Plan(
        body,
        named,
        walk.graphs,
        written,
        streamed,
        counts,
        walk.views,
        indices,
        walk.single,
        single_views,
        walk.advancing,
    )


class _Walk:
    """Collects what is in a nest of loops."""

    def __init__(self, regions: dict[str, Region]) -> None:
        self.regions = regions
        self.graphs: dict[Stage, Graph] = {}
        self.written: set[str] = set()
        self.streamed: dict[str, list[Advance]] = defaultdict(list)
        self.single: dict[Stage, frozenset[str]] = {}
        self.single_views: dict[str, bool] = {}
        self.advancing: dict[Stage, frozenset[str]] = {}
        self.views: dict[str, View] = {}
        self.indices: dict[str, list[int | str]] = defaultdict(list)
        self.counts: dict[str, None] = {}
        self.uses: list[tuple[str, frozenset[str]]] = []

    def loop(self, loop: Loop, advancing: frozenset[str], single: frozenset[str], around: Counts) -> None:
        self._check_loop(loop, advancing)
        if isinstance(loop.count, str):
            self.counts[loop.count] = None
        for name in loop.advancing:
            counts = (*around, loop.count) if name in loop.onward else (loop.count,)
            self.streamed[name].append(Advance(counts, self.regions[name].lanes if isinstance(loop, LaneLoop) else 1))
        for view in loop.views:
            self._view(view, loop)
        own = frozenset((*loop.advancing, *(view.name for view in loop.views)))
        inside, single = advancing | own, single | own if isinstance(loop, LaneLoop) else single
        for item in loop.body:
            if isinstance(item, Loop):
                self.loop(item, inside, single, (*around, loop.count))
            elif isinstance(item, Stage):
                self._stage(item, inside, single)
                goes_on = frozenset(() if loop.backward or isinstance(loop, LaneLoop) else loop.streams)
                self.advancing[item] = self.advancing.get(item, goes_on) & goes_on
            else:
                raise InputError(f"a loop's body holds stages and loops, not a {type(item).__name__}")

    def _check_loop(self, loop: Loop, advancing: frozenset[str]) -> None:
        if not isinstance(loop, Loop) or not isinstance(loop.count, (int, str)):
            raise InputError(f"a program is a Loop with a count that is a number or a name, not {loop!r}")
        if not isinstance(loop.count, str) and loop.count < 0:
            raise InputError(f"a loop's count {loop.count} must not be negative")
        until = [] if loop.until is None else [loop.until]
        self._check_names((*loop.advancing, *until), advancing.union(loop.advancing))
        if len(set(loop.advancing)) < len(loop.advancing):
            raise InputError(f"a loop's streams {loop.advancing} must have different names")
        for name in advancing.intersection(loop.advancing):
            raise InputError(f"region {name!r} streams in two loops, one inside the other; it can advance with one")
        end = self.regions.get(loop.until or "")
        if loop.until is not None and (end is None or end.size != 1 or loop.until in loop.advancing):
            raise InputError(f"region {loop.until!r} ends a loop, so it must have one slot and not stream in that loop")

    def _view(self, view: View, loop: Loop) -> None:
        """A view may be had in several loops, but then it is the same."""
        if view.of not in self.regions:
            raise unknown_name("region", view.of, self.regions)
        self.streamed.setdefault(view.of, [])
        self.views.setdefault(view.name, view)
        self.indices[view.index].append(loop.count)
        single = self.single_views.setdefault(view.name, isinstance(loop, LaneLoop))
        kinds = (self.regions.keys(), self.views.keys(), self.indices.keys())
        differs = self.views[view.name] != view or single != isinstance(loop, LaneLoop)
        if differs or any(a & b for a, b in combinations(kinds, 2)):
            raise InputError(f"view {view.name!r} by {view.index!r}: both must have names that nothing else has")

    def check_streams(self) -> None:
        """A region that streams, or is viewed, has rows only inside its loop."""
        for name, advancing in self.uses:
            if (name in self.streamed or name in self.views) and name not in advancing:
                raise InputError(f"region {name!r} has rows, so it can only be used inside the loop that it streams in")

    def _stage(self, stage: Stage, advancing: frozenset[str], single: frozenset[str]) -> None:
        self._check_names((*stage.reads, *stage.writes), advancing)
        if len(set(stage.writes)) != max(1, len(stage.writes)):
            raise InputError(f"stage {name_of(stage.function)} must write at least one region, and each but once")
        self.written.update(stage.writes)
        self._check_single(stage, single.intersection((*stage.reads, *stage.writes)))
        if stage not in self.graphs:
            known = self.regions | {name: self.regions[view.of] for name, view in self.views.items()}
            self._check_lanes(stage, known)
            self.graphs[stage] = stage_graph(stage, known, self.single[stage])

    def _check_single(self, stage: Stage, seen: frozenset[str]) -> None:
        if self.single.setdefault(stage, seen) != seen or (seen and stage.lanes > 1):
            told = f"stage {name_of(stage.function)} uses {', '.join(sorted(self.single[stage] | seen))}"
            raise InputError(f"{told} lane by lane: it must be of one lane, and do so in every loop that holds it")
        for name in (*stage.reads, *stage.writes):
            root = self.views[name].of if name in self.views else name
            if self.regions[root].triples and name not in seen:
                told = f"stage {name_of(stage.function)} uses region {name!r} of triples"
                raise InputError(f"{told}, so it must be in a LaneLoop that advances with it")

    def _check_lanes(self, stage: Stage, known: dict[str, Region]) -> None:
        for name in stage.writes if stage.lanes > 1 else ():
            if known[name].lanes != stage.lanes:
                told = f"a stage of {stage.lanes} lanes writes region {name!r}, which has {known[name].lanes}"
                raise InputError(f"{told}; they must be as many")

    def _check_names(self, names: Sequence[str], advancing: frozenset[str]) -> None:
        for name in names:
            if name not in self.regions and name not in self.views:
                raise unknown_name("region", name, [*self.regions, *self.views])
            self.uses.append((name, advancing))


def stage_graph(stage: Stage, regions: dict[str, Region], single: Container[str] = ()) -> Graph:
    """The graph of one lane of a stage: a vector in for each region read, a vector out for each region written.

    single: regions of which it sees one lane.
    """
    lanes = {name: r.lanes if r.lanes == stage.lanes or name in single else 1 for name, r in regions.items()}
    seen = {name: r.size // lanes[name] for name, r in regions.items()}
    inputs, outputs = ([Port(name, (seen[name],)) for name in names] for names in (stage.reads, stage.writes))
    with tracing() as trace:
        slots = iter([trace.node("input", k) for k in range(sum(p.size for p in inputs))])
        result = stage.function(*[[next(slots) for _ in range(p.size)] for p in inputs])
        lists = [result] if len(outputs) == 1 else result
        _check_lists(stage, outputs, lists)
        pairs = zip(outputs, lists, strict=True)
        numbers = [checked(stage.function, port.name, x, trace) for port, one in pairs for x in one]
    return Graph(tuple(inputs), tuple(outputs), tuple(numbers))


def _check_lists(stage: Stage, outputs: Sequence[Port], lists: Any) -> None:
    stage_name = name_of(stage.function)
    if not isinstance(lists, (list, tuple)) or len(lists) != len(outputs):
        raise TraceError(f"stage {stage_name} must return {len(outputs)} lists, for {', '.join(stage.writes)}")
    for port, one in zip(outputs, lists, strict=True):
        found = len(one) if isinstance(one, (list, tuple)) else f"a {type(one).__name__}"
        if found != port.size:
            raise TraceError(f"stage {stage_name} returns {found} for region {port.name!r} of {port.size} slots")
