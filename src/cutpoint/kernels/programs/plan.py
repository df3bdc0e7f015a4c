"""A checked and traced program, as backends run it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from cutpoint.errors import InputError
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import places_of
from cutpoint.kernels.programs.stepping import Loop, Region, Stage, View
from cutpoint.kernels.programs.walk import Advance, Walk


@dataclass(frozen=True, eq=False)
class Plan:
    """A program that has passed all checks.

    regions: by name.  graphs: of the stages, for one lane each.  written: regions that any stage writes.
    streamed: for regions with rows, each way in which they stream; none if they are only viewed.
    counts: the names of numbers that a run must state.  views: by name.
    single: for each stage the names of which it sees one lane.  single_views: the views that are one lane of a row.
    indices: for each list of rows, the counts of the loops it advances with.
    advancing: for each stage the regions that advance a row with the innermost loop around it.
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
        """Row size of each region's array."""
        return {name: region.room for name, region in self.regions.items()}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all arrays of a run."""
        return (*self.regions, *self.indices)

    @property
    def key(self) -> tuple[object, ...]:
        """Everything that determines its behaviour, equal for two plans only if they do the same."""
        numbers = {stage: k for k, stage in enumerate(self.graphs)}

        def key_of(item: Stage | Loop) -> tuple[object, ...]:
            if isinstance(item, Stage):
                about = (tuple(item.reads), tuple(item.writes), item.lanes, item.as_in_threes)
                return (numbers[item], self.graphs[item].digest(), *about)
            about = (type(item).__name__, item.count, tuple(item.streams), item.until, item.backward)
            return (*about, tuple(item.views), *map(key_of, item.body))

        return (tuple(self.regions.values()), key_of(self.body))

    @property
    def changing(self) -> frozenset[str]:
        """Names whose numbers change during a run."""
        return self.written | self.streamed.keys() | self.views.keys()

    def root(self, name: str) -> str:
        """The region that a name refers to."""
        return self.views[name].of if name in self.views else name

    def fed(self, stage: Stage) -> dict[int, int]:
        """By input slot of a region that the stage also writes: the result that it may read an iteration later.

        Inputs named as outputs are left out: rarely the previous iteration's row, and read only to be added to.
        """
        graph, root = self.graphs[stage], self.root
        places = [(root(name), k) for name, k in places_of(graph.outputs)]
        results = {place: k for k, place in enumerate(places) if place[0] in self.streamed}
        own = {port.name for port in graph.outputs}
        fed = {slot: (root(name), k) for slot, (name, k) in enumerate(places_of(graph.inputs)) if name not in own}
        return {slot: results[place] for slot, place in fed.items() if place in results}

    def known_ahead(self, stage: Stage) -> frozenset[str]:
        """Regions that a stage reads row by row, each row known before its iteration and the same for all lanes."""
        shared = {name for name in stage.reads if name in self.regions and self.regions[name].lanes == 1}
        return (self.advancing[stage] & shared) - self.written

    def in_threes(self, stage: Stage) -> bool:
        """Whether a stage uses regions of triples."""
        return any(self.regions[self.root(name)].triples for name in (*stage.reads, *stage.writes))

    def is_laned(self, stage: Stage, name: str) -> bool:
        """Whether each lane of a stage has its own numbers in a region."""
        return stage.lanes > 1 and self.regions[self.root(name)].lanes == stage.lanes


def plan(body: Loop, regions: Sequence[Region]) -> Plan:
    """Checks and traces a program.

    Raises:
        InputError: a region is unknown, given twice or of the wrong size, or the loop nest makes no sense.
        TraceError: a stage cannot be traced or returns something else than its regions.
    """
    named = {region.name: region for region in regions}
    if len(named) < len(regions) or any(r.size < 0 or r.lanes < 1 or r.size % r.lanes for r in regions):
        raise InputError(f"regions must have different names and sizes of 0 or more, whole in lanes: {[*regions]}")
    if any(r.triples and (r.lanes > 1 or r.size % 3) for r in regions):
        raise InputError(f"regions of triples must be of one lane and of a size whole in threes: {[*regions]}")
    walk = Walk(named)
    walk.loop(body, frozenset(), frozenset(), {})
    walk.check_streams()
    streamed, indices = dict(walk.streamed), dict(walk.indices)
    single_views = frozenset(name for name, single in walk.single_views.items() if single)
    counts = tuple(walk.counts)
    return Plan(
        body,
        named,
        walk.graphs,
        frozenset(walk.written),
        streamed,
        counts,
        walk.views,
        indices,
        walk.single,
        single_views,
        walk.advancing,
    )
