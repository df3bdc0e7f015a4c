"""A stepping program in machine code: all its stages and loops as one function."""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from cutpoint.kernels.algebra import Operand
from cutpoint.kernels.fusion import fuse
from cutpoint.kernels.hoisting import hoist
from cutpoint.kernels.jit import Compiled
from cutpoint.kernels.llvm import Lanes, straight_line
from cutpoint.kernels.llvm_code import Code, Running, in_turn
from cutpoint.kernels.lowering import in_primitives
from cutpoint.kernels.nodes import Node
from cutpoint.kernels.program_plan import LaneLoop, Plan
from cutpoint.kernels.recurrence import arrivals
from cutpoint.kernels.scheduling import depth_first, scheduled
from cutpoint.kernels.stepping import Loop, Stage
from cutpoint.kernels.tuning import beside_numbers, for_divisions

_FUNCTION = "program"

_MOST_HANDED_ON = 16
"""Numbers that an iteration hands to the next in registers; with more they would go through memory after all."""

Place = tuple[str, int]
"""A region and a slot of it."""


class LlvmProgram:
    """A plan's machine code: i64 program(i64 *counts, double **regions)."""

    def __init__(self, plan: Plan) -> None:
        self._names, self._counts = plan.names, plan.counts
        self._code = Compiled(program_ir(plan), _FUNCTION)
        self._call = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)(self._code.address)

    @property
    def address(self) -> int:
        return self._code.address

    def run(self, counts: Mapping[str, int], arrays: Mapping[str, np.ndarray]) -> int:
        """The iterations of the outermost loop; arrays must have been checked."""
        return self.bound(counts, arrays)()

    def bound(self, counts: Mapping[str, int], arrays: Mapping[str, np.ndarray]) -> Callable[[], int]:
        """`run` on these, again and again."""
        numbers = (ctypes.c_int64 * len(self._counts))(*[counts[name] for name in self._counts])
        pointers = (ctypes.c_void_p * len(self._names))(*[arrays[name].ctypes.data for name in self._names])
        return BoundProgram(self, self._call, numbers, pointers, [*arrays.values()])


class BoundProgram(NamedTuple):
    """A call with its arguments, and with what owns the code and the memory that they point to."""

    program: LlvmProgram
    call: Callable[..., int]
    numbers: Any
    pointers: Any
    arrays: list[np.ndarray]

    @property
    def symbols(self) -> dict[str, int]:
        """Where code and arguments are, for other code that calls it."""
        places = {"counts": ctypes.addressof(self.numbers), "regions": ctypes.addressof(self.pointers)}
        return {_FUNCTION: self.program.address, **places}

    def __call__(self) -> int:
        return self.call(self.numbers, self.pointers)


def program_ir(plan: Plan) -> str:
    """The module's text."""
    code = Code()
    counts = {name: code.load("%counts", k, "i64") for k, name in enumerate(plan.counts)}
    starts = {name: code.load("%regions", k, "ptr") for k, name in enumerate(plan.names)}
    stages = {stage: _Stage(code, plan, stage, starts) for stage in plan.graphs}

    def loop(this: Loop, regions: dict[str, str], around: list[_Turn]) -> str:
        count = counts[this.count] if isinstance(this.count, str) else this.count
        with code.loop(count, regions.get(this.until or "")) as running:
            turns = [*around, _Turn(running.iteration, count)]
            inside = regions | _rows(code, plan, this, turns, starts)
            at_hand: dict[Place, str] = {}
            for item, following in zip(this.body, [*this.body[1:], None], strict=True):
                if isinstance(item, Loop):
                    loop(item, inside, turns)
                    at_hand.clear()
                elif len(this.body) == 1 and stages[item].hands_on:
                    stages[item].write_on(code, inside, running)
                elif item.lanes > 1 and isinstance(following, Stage) and following.lanes in (1, item.lanes):
                    with code.aside() as wide:
                        stages[item].write(code, inside, at_hand)
                    with code.aside() as narrow:
                        stages[following].begin(code, inside, item.writes)
                    code.lines += in_turn(wide, narrow)
                else:
                    stages[item].write(code, inside, at_hand)
        return running.done

    done = loop(plan.body, starts, [])
    lanes = {stage.lanes.width: stage.lanes for stage in stages.values()}
    declarations = "".join(x.declarations for x in lanes.values())
    attributes = f"{beside_numbers() if 1 in lanes else ''} {for_divisions(plan.graphs.values())}"
    head = f"{declarations}define i64 @{_FUNCTION}(ptr %counts, ptr %regions) {attributes} {{\nentry:"
    return "\n".join([head, *code.lines, f"ret i64 {done}", "}", ""])


class _Turn(NamedTuple):
    """One of the loops around: its iteration, and how often it runs."""

    iteration: str
    often: str | int


def _rows(code: Code, plan: Plan, this: Loop, turns: Sequence[_Turn], starts: Mapping[str, str]) -> dict[str, str]:
    """Where the rows of this iteration begin, by name."""

    def at(region: str, row: str) -> str:
        size, lanes = plan.sizes[region], plan.regions[region].lanes
        if not isinstance(this, LaneLoop):
            return code.at(starts[region], code.let(f"mul i64 {row}, {size}"))
        block = code.let(f"mul i64 {code.let(f'udiv i64 {row}, {lanes}')}, {size}")
        return code.at(starts[region], code.let(f"add i64 {block}, {code.let(f'urem i64 {row}, {lanes}')}"))

    row, count = turns[-1]
    if this.backward:
        row = code.let(f"sub i64 {code.let(f'sub i64 {count}, 1')}, {row}")
    rows = {name: at(name, row) for name in this.streams}
    if this.onward:
        whole = _after_all(code, turns[:-1], count, row)
        rows |= {name: at(name, whole) for name in this.onward}
    named = {index: code.load(starts[index], row, "i64") for index in dict.fromkeys(view.index for view in this.views)}
    return rows | {view.name: at(view.of, named[view.index]) for view in this.views}


def _after_all(code: Code, around: Sequence[_Turn], count: str | int, row: str) -> str:
    """The row of a loop that goes on where it stopped."""
    entries = "0"
    for turn in around:
        entries = code.let(f"add i64 {code.let(f'mul i64 {entries}, {turn.often}')}, {turn.iteration}")
    return code.let(f"add i64 {code.let(f'mul i64 {entries}, {count}')}, {row}")


class _Stage:
    """A stage lowered; what it computes from numbers that never change is computed here, before all loops."""

    def __init__(self, code: Code, plan: Plan, stage: Stage, regions: Mapping[str, str]) -> None:
        fused, fed, self.lanes = fuse(plan.graphs[stage]), plan.fed(stage), Lanes(stage.lanes)
        graph = depth_first(in_primitives(fuse(plan.graphs[stage], arrivals(fused, fed)) if fed else fused))
        laned = {name for name in (*plan.regions, *plan.views) if plan.is_laned(stage, name)}
        changing, self._plan = plan.changing, plan
        self._steps = dict.fromkeys(laned, stage.lanes)
        self._steps |= {name: plan.regions[plan.root(name)].lanes for name in plan.single[stage]}
        self._sources = [(port.name, k, port.name in laned) for port in graph.inputs for k in range(port.size)]
        self._targets = [(port.name, k) for port in graph.outputs for k in range(port.size)]
        self.hands_on = bool(plan.single[stage] and fed) and len({*fed.values()}) <= _MOST_HANDED_ON
        before, self._graph = hoist(graph, {k for k, (name, *_) in enumerate(self._sources) if name not in changing})
        self._rest, count = self._graph, len(before.results)
        self._begun, self._first_begun = [], len(self._sources) + count
        self._hoisted = code.let(f"alloca {self.lanes.real}, i64 {count}") if count else ""
        values = straight_line(code, before, self.lanes, lambda slot: self._load(code, regions, slot, {}))
        for k, value in enumerate(values):
            code.store(value, self._hoisted, k, self.lanes.real)

    def begin(self, code: Code, regions: Mapping[str, str], awaited: Sequence[str]) -> None:
        """What does not wait for some regions; `write` goes on from there, and must follow."""
        root = self._plan.root
        late = {k for k, (name, *_) in enumerate(self._sources) if root(name) in map(root, awaited)}
        before, self._rest = hoist(self._graph, set(range(self._first_begun)) - late)
        first = scheduled(before)
        self._begun = straight_line(code, first, self.lanes, lambda slot: self._load(code, regions, slot, {}))

    def write(self, code: Code, regions: Mapping[str, str], at_hand: dict[Place, str]) -> None:
        """Reads, computes, then writes what has changed.

        at_hand: single numbers that stages of this block have just written.  Lanes take them from there: a wide load of
        memory that was written number by number a moment ago makes the processor wait.
        """

        width = self.lanes.width
        for (name, k), value in self._written(code, regions, lambda slot: self._load(code, regions, slot, at_hand)):
            written = {(name, k * width + lane): value for lane in range(width)}
            at_hand.update(written) if width == 1 else [at_hand.pop(place, None) for place in written]
        if self._plan.views:  # a number may have been written under another name
            at_hand.clear()

    def write_on(self, code: Code, regions: Mapping[str, str], running: Running) -> None:
        """The same in a loop through bodies: a row that the iteration before wrote need not come through memory."""
        root, known = self._plan.root, dict[int, str]()
        before = {root(name): code.name("before") for name, _ in self._targets}
        numbers = {(root(name), k): code.name("number") for name, k in self._targets}
        for name in dict.fromkeys(name for name, *_ in self._sources if root(name) in before):
            known |= self._at_hand_or_loaded(code, regions, name, before[root(name)], numbers)

        def load(slot: int) -> str:
            return known[slot] if slot in known else self._load(code, regions, slot, {})

        for (name, k), value in self._written(code, regions, load):
            running.handed_on[before[root(name)]] = ("ptr", "null", regions[name])
            running.handed_on[numbers[root(name), k]] = (self.lanes.real, "0.0", value)

    def _at_hand_or_loaded(
        self, code: Code, regions: Mapping[str, str], name: str, before: str, numbers: Mapping[Place, str]
    ) -> dict[int, str]:
        """A region's numbers by input slot.  before, numbers: the row that the iteration before wrote, and its own."""
        used = {x.args[0] for x in self._graph.nodes if x.op == "input"}
        slots = [slot for slot, (own, *_) in enumerate(self._sources) if own == name and slot in used]
        here, fetch, there = (code.name(x) for x in ("here", "fetch", "there"))
        code.label(here)
        code.branch(code.let(f"icmp eq ptr {regions[name]}, {before}"), there, fetch)
        code.open(fetch)
        loaded = [self._load(code, regions, slot, {}) for slot in slots]
        code.label(there)
        at_hand = [numbers[self._plan.root(name), self._sources[slot][1]] for slot in slots]
        either = zip(at_hand, loaded, strict=True)
        found = [code.let(f"phi {self.lanes.real} [ {x}, {here} ], [ {y}, {fetch} ]") for x, y in either]
        return dict(zip(slots, found, strict=True))

    def _written(self, code: Code, regions: Mapping[str, str], load: Callable[[int], str]) -> list[tuple[Place, str]]:
        """What has changed goes to memory; all results, with their places."""
        graph, self._rest = self._rest, self._graph
        values = straight_line(code, scheduled(graph), self.lanes, load)
        for x, value, (name, k) in zip(graph.results, values, self._targets, strict=True):
            if not self._is_input(x, (name, k)):
                code.store(value, code.at(regions[name], k * self._steps.get(name, 1)), 0, self.lanes.real, align=8)
        return [*zip(self._targets, values, strict=True)]

    def _is_input(self, x: Operand, place: Place) -> bool:
        """Whether a result is what already stands in its place."""
        slot = x.args[0] if isinstance(x, Node) and x.op == "input" else len(self._sources)
        return slot < len(self._sources) and self._sources[slot][:2] == place

    def _load(self, code: Code, regions: Mapping[str, str], slot: int, at_hand: Mapping[Place, str]) -> str:
        if slot >= self._first_begun:
            return self._begun[slot - self._first_begun]
        if slot >= len(self._sources):
            return code.load(self._hoisted, slot - len(self._sources), self.lanes.real)
        name, k, laned = self._sources[slot]
        places = [(name, k * self.lanes.width + lane) for lane in range(self.lanes.width)]
        if laned and all(place in at_hand for place in places):
            return self.lanes.joined(code, [at_hand[place] for place in places])
        if laned or self.lanes.width == 1:
            return code.load(code.at(regions[name], k * self._steps.get(name, 1)), 0, self.lanes.real, align=8)
        return self.lanes.spread(code, code.load(regions[name], k))
