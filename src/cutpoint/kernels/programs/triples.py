"""A stage of a program on triples of numbers: it loads, computes and stores them in vector registers."""

from collections.abc import Mapping, Sequence
from typing import Any

from cutpoint.kernels.machine.llvm_code import Code
from cutpoint.kernels.programs.plan import Plan
from cutpoint.kernels.programs.stage import Place, StageCode
from cutpoint.kernels.programs.stepping import Region, Stage
from cutpoint.kernels.programs.superword_line import WIDE, SuperwordLine
from cutpoint.kernels.programs.superwords import Superwords

_NOTHING: Mapping[int, str] = {}


class TripleStage(StageCode):
    """A lowered stage that uses regions of triples."""

    def __init__(self, code: Code, plan: Plan, stage: Stage, regions: Mapping[str, str]) -> None:
        super().__init__(code, plan, stage, regions)
        self._superwords = Superwords(self._graph, self._threes(self._sources), self._threes(self._targets))

    def write(self, code: Code, regions: Mapping[str, str], at_hand: dict[Place, str]) -> None:
        self._written_with(code, regions, _NOTHING)
        at_hand.clear()

    def _handed_on(self, results: set[int]) -> int:
        places = {slot: self._targets[slot] for slot in results}
        return len({slot - k % 3 if self._triples(name) else slot for slot, (name, k) in places.items()})

    def _triples(self, name: str) -> Region | None:
        """The region of that name, if it holds triples."""
        region = self._plan.regions.get(self._plan.root(name))
        return region if region and region.triples else None

    def _threes(self, places: Sequence[tuple[Any, ...]]) -> list[int]:
        """The first slots of triples."""
        return [slot for slot, (name, k, *_) in enumerate(places) if self._triples(name) and k % 3 == 0]

    def _kind(self, name: str) -> str:
        return WIDE.real if self._triples(name) else super()._kind(name)

    def _fetched(self, name: str) -> list[int]:
        found = super()._fetched(name)
        return sorted({slot - self._sources[slot][1] % 3 for slot in found}) if self._triples(name) else found

    def _fetch(self, code: Code, regions: Mapping[str, str], slot: int) -> str:
        name, k, _ = self._sources[slot]
        region = self._triples(name)
        if region is None:
            return self._load(code, regions, slot)
        return code.load(code.at(regions[name], region.place(k)), 0, WIDE.real, align=WIDE.item)

    def _written_with(
        self, code: Code, regions: Mapping[str, str], known: Mapping[int, str]
    ) -> list[tuple[Place, str]]:
        def three(slot: int) -> str:
            return known[slot] if slot in known else self._fetch(code, regions, slot)

        def one(slot: int) -> str:
            name, k, _ = self._sources[slot]
            region = self._triples(name)
            if region is None:
                return known[slot] if slot in known else self._load(code, regions, slot)
            if slot - k % 3 in known:
                return WIDE.one_of(code, known[slot - k % 3], k % 3)
            return code.load(regions[name], region.place(k))

        line, written = SuperwordLine(code, self._superwords, one, three), list[tuple[Place, str]]()
        for slot, (name, k) in enumerate(self._targets):
            region = self._triples(name)
            if region is None:
                value = line.number(self._graph.results[slot])
                code.store(value, regions[name], k * self._steps.get(name, 1))
            elif k % 3 == 0:
                value = line.word(self._superwords.words[slot])
                code.store(value, code.at(regions[name], region.place(k)), 0, WIDE.real, align=WIDE.item)
            else:
                continue
            written.append(((name, k), value))
        return written


def stage_code(code: Code, plan: Plan, stage: Stage, regions: Mapping[str, str]) -> StageCode:
    """The stage lowered."""
    return (TripleStage if plan.in_threes(stage) else StageCode)(code, plan, stage, regions)
