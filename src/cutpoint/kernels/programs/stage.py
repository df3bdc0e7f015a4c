"""A stage of a program in machine code: which parts are computed ahead, and where its numbers are."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.graphs.ports import places_of
from cutpoint.kernels.lowering.scheduling import scheduled
from cutpoint.kernels.machine.llvm import Lanes, straight_line
from cutpoint.kernels.machine.llvm_code import LINE, Code, Running
from cutpoint.kernels.programs.hoisting import hoist
from cutpoint.kernels.programs.lowered import lowered
from cutpoint.kernels.programs.plan import Plan
from cutpoint.kernels.programs.stepping import Stage

AT_ONCE = 8
"""Iterations that a stage looks ahead: numbers that a wide register holds."""

_WORTH_LOOKING_AHEAD = 128
"""Operations; those of a few are sooner done than their numbers are brought into lanes and back."""

_MOST_HANDED_ON = 16
"""Numbers that an iteration hands to the next in registers; with more they would go through memory after all."""

Place = tuple[str, int]
"""A region and a slot of it."""

_NOTHING: Mapping[Place, str] = MappingProxyType({})


class StageCode:
    """A stage lowered.

    Operations on constants alone are hoisted before all loops.  Those on rows that no stage writes are computed for
    AT_ONCE iterations at a time, in vector lanes, where that pays off.

    lanes: of the stage.  hands_on: whether an iteration may pass its results to the next in registers.
    """

    def __init__(self, code: Code, plan: Plan, stage: Stage, regions: Mapping[str, str]) -> None:
        self._graph, fed, self.lanes = lowered(plan, stage), plan.fed(stage), Lanes(stage.lanes)
        laned = {name for name in (*plan.regions, *plan.views) if plan.is_laned(stage, name)}
        self._plan, self._rows = plan, plan.known_ahead(stage)
        self._steps = dict.fromkeys(laned, stage.lanes)
        self._steps |= {name: plan.regions[plan.root(name)].lanes for name in plan.single[stage]}
        self._sources = [(name, k, name in laned) for name, k in places_of(self._graph.inputs)]
        self._targets = places_of(self._graph.outputs)
        self._begun = dict[int, str]()
        can_hand_on = bool(fed) and (bool(plan.single[stage]) or self._is_laned(fed))
        self.hands_on = can_hand_on and self._handed_on({*fed.values()}) <= _MOST_HANDED_ON
        self._fix(code, regions, Lanes(1))
        if laned:
            self._fix(code, regions, self.lanes)
        self._ahead, self._ahead_at = self._cut_ahead(code)
        self._rest = self._graph

    def _is_laned(self, slots: Iterable[int]) -> bool:
        """Whether each lane has its own copy of these numbers."""
        return all(self._sources[slot][2] for slot in slots)

    def _handed_on(self, results: set[int]) -> int:
        """Registers that these results take."""
        return len(results) * -(-self.lanes.width // AT_ONCE)

    def _fix(self, code: Code, regions: Mapping[str, str], lanes: Lanes) -> None:
        """Computes loop-invariant numbers here; in one lane, those that all lanes of the stage share."""
        before, self._graph = hoist(self._graph, self._fixed(laned=lanes.width > 1))
        values = straight_line(code, before, lanes, lambda slot: self._load(code, regions, slot, lanes=lanes))
        memory = self._kept(code, lanes, len(values), laned=lanes.width > 1)
        for k, value in enumerate(values):
            code.store(value, code.at(memory, k * lanes.width), 0, lanes.real, align=8)

    def _fixed(self, *, laned: bool) -> set[int]:
        """Input slots that never change; with laned, also those of which each lane has its own."""
        changing = self._plan.changing
        return {k for k, (name, _, own) in enumerate(self._sources) if name not in changing and (laned or not own)}

    def _kept(self, code: Code, lanes: Lanes, count: int, *, laned: bool) -> str:
        """Allocates memory for so many numbers, which are inputs from here on; returns its name, the pointer's."""
        # of numbers, not of vectors: in an array LLVM rounds those of 24 up to 32
        memory = code.let(f"alloca double, i64 {count * lanes.width}, align {LINE}") if count else ""
        self._sources += [(memory, k, laned) for k in range(count)]
        self._steps[memory] = lanes.width
        return memory

    def _cut_ahead(self, code: Code) -> tuple[Graph | None, str]:
        """Splits off the part of the graph that can be computed ahead from rows, with memory for its results."""
        rows = {k for k, (name, *_) in enumerate(self._sources) if name in self._rows}
        before, inside = hoist(self._graph, self._fixed(laned=False) | rows)
        if sum(before.operations.values()) < _WORTH_LOOKING_AHEAD:
            return None, ""
        self._graph = inside
        return before, self._kept(code, Lanes(AT_ONCE), len(before.results), laned=False)

    def look_ahead(self, code: Code, regions: Mapping[str, str], iteration: str, count: str | int) -> dict[str, str]:
        """Computes ahead for the next iterations, if due; returns where this iteration's numbers are.

        Nothing where it does not pay off.
        """
        if self._ahead is None:
            return {}
        lanes, lane = Lanes(AT_ONCE), code.let(f"urem i64 {iteration}, {AT_ONCE}")
        with code.where(code.let(f"icmp eq i64 {lane}, 0")):
            rows = self._rows_ahead(code, regions, code.let(f"sub i64 {count}, {iteration}"))

            def load(slot: int) -> str:
                name, k, _ = self._sources[slot]
                if name not in rows:
                    return self._load(code, regions, slot, lanes=lanes)
                return lanes.joined(code, [code.load(row, k) for row in rows[name]])

            for k, value in enumerate(straight_line(code, scheduled(self._ahead), lanes, load)):
                code.store(value, code.at(self._ahead_at, k * AT_ONCE), 0, lanes.real, align=8)
        return {self._ahead_at: code.at(self._ahead_at, lane)}

    def _rows_ahead(self, code: Code, regions: Mapping[str, str], left: str) -> dict[str, list[str]]:
        """Pointers to the rows of the next iterations, the last repeated past the end.  left: how many remain."""
        last, rows = code.let(f"sub i64 {left}, 1"), list[str]()
        for k in range(AT_ONCE):
            is_there = code.let(f"icmp slt i64 {k}, {left}")
            rows.append(code.let(f"select i1 {is_there}, i64 {k}, i64 {last}"))
        return {name: [self._at_row(code, regions, name, row) for row in rows] for name in self._rows}

    def _at_row(self, code: Code, regions: Mapping[str, str], name: str, row: str) -> str:
        return code.at(regions[name], code.let(f"mul i64 {row}, {self._plan.sizes[name]}"))

    def begin(self, code: Code, regions: Mapping[str, str], awaited: Sequence[str]) -> None:
        """Emits what does not depend on the awaited regions; `write` continues from there, and must follow."""
        root = self._plan.root
        late = {k for k, (name, *_) in enumerate(self._sources) if root(name) in map(root, awaited)}
        before, self._rest = hoist(self._graph, set(range(len(self._sources))) - late)
        begun = straight_line(code, scheduled(before), self.lanes, lambda slot: self._load(code, regions, slot))
        self._begun = dict(enumerate(begun, len(self._sources)))

    def write(self, code: Code, regions: Mapping[str, str], at_hand: dict[Place, str]) -> None:
        """Reads, computes, then writes what has changed.

        at_hand: scalars that stages of this block have just written.  Lanes take them from registers: a vector load of
        memory just written by scalar stores fails store forwarding and stalls.
        """

        width = self.lanes.width
        for (name, k), value in self._written(code, regions, lambda slot: self._load(code, regions, slot, at_hand)):
            written = {(name, k * width + lane): value for lane in range(width)}
            at_hand.update(written) if width == 1 else [at_hand.pop(place, None) for place in written]
        if self._plan.views:  # a number may have been written under an alias
            at_hand.clear()

    def write_on(self, code: Code, regions: Mapping[str, str], running: Running) -> None:
        """The same in a loop over bodies: a row that the previous iteration wrote need not go through memory."""
        root, known, written = self._plan.root, dict[int, str](), {name for name, _ in self._targets}
        # a row of the same name as an output is another one: rarely the previous one's, and read only to be added to
        names = dict.fromkeys(name for name, *_ in self._sources if name not in written)
        handed = [name for name in dict.fromkeys(map(root, names)) if name in {root(x) for x in written}]
        before = {name: code.name("before") for name in handed}
        numbers = {(root(name), k): code.name("number") for name, k in self._targets if root(name) in handed}
        for name in names:
            if root(name) in handed:
                known |= self._at_hand_or_loaded(code, regions, name, before[root(name)], numbers)
        for (name, k), value in self._written_with(code, regions, known):
            if root(name) in handed:
                running.handed_on[before[root(name)]] = ("ptr", "null", regions[name])
                running.handed_on[numbers[root(name), k]] = (self._kind(name), "zeroinitializer", value)

    def _at_hand_or_loaded(
        self, code: Code, regions: Mapping[str, str], name: str, before: str, numbers: Mapping[Place, str]
    ) -> dict[int, str]:
        """A region's numbers by input slot.  before, numbers: the row that the last iteration wrote, and its own."""
        slots = self._fetched(name)
        here, fetch, there = (code.name(x) for x in ("here", "fetch", "there"))
        code.label(here)
        code.branch(code.let(f"icmp eq ptr {regions[name]}, {before}"), there, fetch)
        code.open(fetch)
        loaded = [self._fetch(code, regions, slot) for slot in slots]
        code.label(there)
        at_hand = [numbers[self._plan.root(name), self._sources[slot][1]] for slot in slots]
        either = zip(at_hand, loaded, strict=True)
        found = [code.let(f"phi {self._kind(name)} [ {x}, {here} ], [ {y}, {fetch} ]") for x, y in either]
        return dict(zip(slots, found, strict=True))

    def _fetched(self, name: str) -> list[int]:
        """The slots of a region that are read."""
        used = {x.args[0] for x in self._graph.nodes if x.op == "input"}
        return [slot for slot, (own, *_) in enumerate(self._sources) if own == name and slot in used]

    def _fetch(self, code: Code, regions: Mapping[str, str], slot: int) -> str:
        return self._load(code, regions, slot)

    def _kind(self, name: str) -> str:
        """The type in which a region's numbers are carried to the next iteration."""
        return self.lanes.real

    def _written_with(
        self, code: Code, regions: Mapping[str, str], known: Mapping[int, str]
    ) -> list[tuple[Place, str]]:
        """As `_written`.  known: numbers that need not be loaded, by slot."""

        def load(slot: int) -> str:
            return known[slot] if slot in known else self._load(code, regions, slot)

        return self._written(code, regions, load)

    def _written(self, code: Code, regions: Mapping[str, str], load: Callable[[int], str]) -> list[tuple[Place, str]]:
        """Stores changed results to memory; returns all results with their places."""
        graph, self._rest = self._rest, self._graph
        values = straight_line(code, scheduled(graph), self.lanes, load)
        for x, value, (name, k) in zip(graph.results, values, self._targets, strict=True):
            if not self._is_input(x, (name, k)):
                code.store(value, code.at(regions[name], k * self._steps.get(name, 1)), 0, self.lanes.real, align=8)
        return [*zip(self._targets, values, strict=True)]

    def _is_input(self, x: Operand, place: Place) -> bool:
        """Whether a result already is in its place."""
        slot = x.args[0] if isinstance(x, Node) and x.op == "input" else len(self._sources)
        return slot < len(self._sources) and self._sources[slot][:2] == place

    def _load(
        self,
        code: Code,
        regions: Mapping[str, str],
        slot: int,
        at_hand: Mapping[Place, str] = _NOTHING,
        lanes: Lanes | None = None,
    ) -> str:
        """An input's number, in the stage's lanes or in others."""
        if slot in self._begun:
            return self._begun[slot]
        (name, k, laned), lanes = self._sources[slot], lanes or self.lanes
        places = [(name, k * lanes.width + lane) for lane in range(lanes.width)]
        if laned and all(place in at_hand for place in places):
            return lanes.joined(code, [at_hand[place] for place in places])
        start, place = regions.get(name, name), k * self._steps.get(name, 1)
        if laned or lanes.width == 1:
            return code.load(code.at(start, place), 0, lanes.real, align=8)
        return lanes.spread(code, code.load(start, place))
