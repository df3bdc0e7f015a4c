"""A walk through a loop nest: what is in it, and whether it is consistent."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

from cutpoint.errors import InputError, unknown_name
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.specialise import name_of
from cutpoint.kernels.programs.stage_graph import stage_graph
from cutpoint.kernels.programs.stepping import LaneLoop, Loop, Region, Stage, View


class Advance(NamedTuple):
    """How a region streams: counts whose product is the number of its steps, and how many steps take one row."""

    often: tuple[int | str, ...]
    steps: int


class Walk:
    """Collects the contents of a loop nest."""

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

    def loop(
        self,
        loop: Loop,
        advancing: frozenset[str],
        single: frozenset[str],
        outer: Mapping[str, tuple[int | str, ...]],
    ) -> None:
        """outer: counts of the enclosing loops that a region streams in, if it also streams further in."""
        self._check_loop(loop, advancing)
        if isinstance(loop.count, str):
            self.counts[loop.count] = None
        for name in loop.streams:
            lanes = self.regions[name].lanes if isinstance(loop, LaneLoop) else 1
            self.streamed[name].append(Advance((*outer.get(name, ()), loop.count), lanes))
        for view in loop.views:
            self._view(view, loop)
        grouped = {name: (*outer.get(name, ()), loop.count) for name in loop.streams if loop.within(name)}
        own = frozenset((*loop.streams, *(view.name for view in loop.views))) - grouped.keys()
        inside, single = advancing | own, single | own if isinstance(loop, LaneLoop) else single
        for item in loop.body:
            if isinstance(item, Loop):
                self.loop(item, inside, single, {**outer, **grouped})
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
        self._check_names((*loop.streams, *until), advancing.union(loop.streams))
        if len(set(loop.streams)) < len(loop.streams):
            raise InputError(f"a loop's streams {loop.streams} must have different names")
        for name in loop.streams:
            self._check_groups(name, loop)
        end = self.regions.get(loop.until or "")
        if loop.until is not None and (end is None or end.size != 1 or loop.until in loop.streams):
            raise InputError(f"region {loop.until!r} ends a loop, so it must have one slot and not stream in that loop")

    def _check_groups(self, name: str, loop: Loop) -> None:
        """Checks that a region that streams in several loops has as many rows in each."""
        inner = loop.all_within(name)
        if len(inner) > 1 or (inner and _has_lane_loop(loop, name)):
            told = f"region {name!r} streams in a loop and in others inside"
            raise InputError(f"{told}: these must have the same count, and none must be a LaneLoop, not {inner}")

    def _view(self, view: View, loop: Loop) -> None:
        """Checks that a view that occurs in several loops is the same in each."""
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
        """Checks that a region that streams, or is viewed, is used only inside its loop."""
        for name, advancing in self.uses:
            if (name in self.streamed or name in self.views) and name not in advancing:
                raise InputError(f"region {name!r} has rows, so it can only be used inside the loop that it streams in")

    def _stage(self, stage: Stage, advancing: frozenset[str], single: frozenset[str]) -> None:
        self._check_names((*stage.reads, *stage.writes), advancing)
        if len(set(stage.writes)) != max(1, len(stage.writes)):
            raise InputError(f"stage {name_of(stage.function)} must write at least one region, and each only once")
        self.written.update(map(self._root, stage.writes))
        self._check_single(stage, advancing, single.intersection((*stage.reads, *stage.writes)))
        if stage not in self.graphs:
            known = self.regions | {name: self.regions[view.of] for name, view in self.views.items()}
            self._check_lanes(stage, known)
            self.graphs[stage] = stage_graph(stage, known, self.single[stage])

    def _check_single(self, stage: Stage, advancing: frozenset[str], seen: frozenset[str]) -> None:
        if self.single.setdefault(stage, seen) != seen or (seen and stage.lanes > 1):
            told = f"stage {name_of(stage.function)} uses {', '.join(sorted(self.single[stage] | seen))}"
            raise InputError(f"{told} lane by lane: it must be of one lane, and do so in every loop that holds it")
        for name in (*stage.reads, *stage.writes):
            if self.regions[self._root(name)].triples and (stage.lanes > 1 or name in advancing - seen):
                told = f"stage {name_of(stage.function)} uses region {name!r} of triples"
                raise InputError(f"{told}, so it must be of one lane, and in a LaneLoop if that has rows")

    def _check_lanes(self, stage: Stage, known: dict[str, Region]) -> None:
        for name in stage.writes if stage.lanes > 1 else ():
            if known[name].lanes != stage.lanes:
                told = f"a stage of {stage.lanes} lanes writes region {name!r}, which has {known[name].lanes}"
                raise InputError(f"{told}; the numbers must match")

    def _root(self, name: str) -> str:
        """The region that a name refers to."""
        return self.views[name].of if name in self.views else name

    def _check_names(self, names: Sequence[str], advancing: frozenset[str]) -> None:
        for name in names:
            if name not in self.regions and name not in self.views:
                raise unknown_name("region", name, [*self.regions, *self.views])
            self.uses.append((name, advancing))


def _has_lane_loop(loop: Loop, name: str) -> bool:
    """Whether a region streams in a LaneLoop, this one or an inner one."""
    inside = any(isinstance(item, Loop) and _has_lane_loop(item, name) for item in loop.body)
    return inside or (isinstance(loop, LaneLoop) and name in loop.streams)
