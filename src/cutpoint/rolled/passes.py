"""A function as passes over bodies, and passes as loops: for one configuration, or several in vector lanes."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import groupby
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

from cutpoint.kernels import LaneLoop, Loop, Region, Stage, Traced, View, graph_of
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.kinship import Kinship, kinships
from cutpoint.scalars import Jet, Scalar

Scalars = Sequence[Scalar]

UPWARD = "upward acceleration"
"""In a row of the world, (UPWARD, k) stands for the k-th of its six numbers."""


class Pass(NamedTuple):
    """A step for every body: alone, outward (parents first) or inward (children first); or for every pair of bodies of
    which one carries the other, or only the first the other.

    A step may also run once, for rows that belong to no body: of "base" and "world", and of the "tip", whose frame is
    asked for; they are named "base.motion" and the like.  For a pair, the stage receives the kinship, and first reads
    what is "held" of one body, which is all that it reads of that one.  It must write zeros for bodies that are no such
    pair.
    """

    way: Literal["alone", "outward", "inward", "pairs", "carrying", "once"]
    stage: Stage

    def kinships(self, *, is_sure: bool) -> list[Kinship]:
        """Kinships of the pairs that it iterates over; none if it iterates over bodies."""
        every = kinships(is_sure=is_sure) if self.way in ("pairs", "carrying") else []
        return [kin for kin in every if kin.carries or self.way == "pairs"]


NONE: Mapping[str, int] = MappingProxyType({})


class Steps(NamedTuple):
    """A function as passes over the bodies.

    kept: sizes of regions that have a row for each body, and further rows for base, world and tip.  numbers: names of
    regions with one number for each body, inputs and outputs.  views: rows of a body's parent, and of sums.  world:
    first numbers of the world's rows; the rest is zero.  apart: sizes of regions without rows, of passes that run once
    and of what one pass leaves to the next for the same body.  constants: sizes of those that hold the robot's numbers.
    shapes: of outputs that are not one number for each body.  threes: those of kept, apart and sums that hold only
    vectors and use vector registers; only passes outward, inward and once may use them.  entries: numbers for each
    pair, of outputs that have more than one.  sums: sizes of regions with the rows of `SumRows`.
    """

    kept: dict[str, int]
    numbers: tuple[str, ...]
    views: tuple[View, ...]
    world: dict[str, list[Any]]
    passes: list[Pass]
    apart: Mapping[str, int] = NONE
    constants: Mapping[str, int] = NONE
    shapes: Mapping[str, tuple[int, ...]] = MappingProxyType({})
    threes: tuple[str, ...] = ()
    entries: Mapping[str, int] = NONE
    sums: Mapping[str, int] = NONE

    @property
    def sizes(self) -> dict[str, int]:
        return {**self.kept, **dict.fromkeys(self.numbers, 1)}

    @property
    def matrices(self) -> tuple[str, ...]:
        """Outputs with a number for every pair of bodies.

        With a floating base, other regions hold its rows and its columns, by body, and its own block: "x_rows",
        "x_columns" unless x is symmetric, "base.x".
        """
        return tuple(name for p in self.passes if p.kinships(is_sure=True) for name in p.stage.writes)

    def kinships(self, *, is_sure: bool) -> list[Kinship]:
        """Kinships of the pairs that passes iterate over."""
        every = (kin for p in self.passes for kin in p.kinships(is_sure=is_sure))
        return [*dict.fromkeys(every)]

    def rows_of(self, p: Pass) -> tuple[View, ...]:
        """Names that a pass that runs once uses for rows."""
        names = dict.fromkeys((*p.stage.reads, *p.stage.writes))
        split = {name: name.split(".") for name in names if name not in {**self.apart, **self.constants}}
        rows = {name: f"{row}'s sum" if of in self.sums else row for name, (row, of) in split.items()}
        return tuple(View(name, of, rows[name]) for name, (_, of) in split.items())


class Rolled(NamedTuple):
    """Loops, and the memory that they need."""

    body: Loop
    regions: tuple[Region, ...]


def side_by_side(steps: Steps, columns: Columns, lanes: int) -> Rolled:
    """Loops over "bodies", with one configuration in each lane."""

    def joined(passes: Iterable[Pass], way: str) -> list[Loop]:
        if way == "once":
            return [Loop(1, [wide(p)], views=steps.rows_of(p)) for p in passes]
        if way in ("pairs", "carrying"):
            return [loop for p in passes for loop in _each_pair(p, lanes)]
        stages, inward = [wide(p) for p in passes], way == "inward"
        return [Loop("bodies", stages, tuple(sizes), backward=inward, views=steps.views)]

    def wide(p: Pass) -> Stage:
        of = {view.name: view.of for view in (steps.rows_of(p) if p.way == "once" else steps.views)}
        used = {of.get(name, name) for name in (*p.stage.reads, *p.stage.writes)}
        return replace(p.stage, lanes=lanes, as_in_threes=not used.isdisjoint(steps.threes))

    sizes = {**columns.sizes, **steps.sizes}
    kinds = groupby(steps.passes, key=lambda p: "outward" if p.way == "alone" else p.way)
    loops = [loop for way, some in kinds for loop in joined(some, way)]
    regions = [Region(name, size * lanes, lanes) for name, size in {**steps.sizes, **steps.apart, **steps.sums}.items()]
    constants = [Region(name, size) for name, size in {**columns.sizes, **steps.constants}.items()]
    entries = [Region(name, steps.entries.get(name, 1) * lanes, lanes) for name in steps.matrices]
    return Rolled(Loop(1, loops), (*constants, *regions, *entries))


def one_by_one(steps: Steps, columns: Columns, lanes: int) -> Rolled:
    """Loops for one configuration.  Steps of bodies alone run on a block of bodies in lanes, over "blocks"."""
    sizes = {**columns.sizes, **steps.sizes}

    def joined(passes: Sequence[Pass], way: str) -> list[Loop]:
        if way == "alone":
            return [Loop("blocks", [replace(p.stage, lanes=lanes) for p in passes], tuple(sizes))]
        if way in ("pairs", "carrying"):
            return [loop for p in passes for loop in _pairs(p, lanes)]
        if way == "once":
            return [LaneLoop(1, [p.stage], views=steps.rows_of(p)) for p in passes]
        stages, inward = [p.stage for p in passes], way == "inward"
        return [LaneLoop("bodies", stages, tuple(sizes), backward=inward, views=steps.views)]

    loops = [loop for way, some in groupby(steps.passes, key=lambda p: p.way) for loop in joined([*some], way)]
    apart, threes = {**steps.apart, **steps.constants, **steps.sums}, steps.threes
    regions = [Region(name, size * lanes, lanes) for name, size in sizes.items() if name not in threes]
    regions += [Region(name, sizes[name], triples=True) for name in threes if name in sizes]
    regions += [Region(name, size, triples=name in threes) for name, size in apart.items()]
    for p in steps.passes:
        if p.kinships(is_sure=False):
            regions += [Region(p.stage.reads[0], sum(sizes[name] for name in p.stage.reads[1:]))]
            regions += [Region(name, steps.entries.get(name, 1) * lanes, lanes) for name in p.stage.writes]
    return Rolled(Loop(1, loops), tuple(regions))


def _each_pair(p: Pass, lanes: int) -> list[Loop]:
    """A loop over each body with each other that it carries, or that carries it."""
    _, *names = p.stage.reads

    def loop(kin: Kinship) -> Loop:
        bodies, others, entries = kin.lists

        def entry(*numbers: Any) -> Any:
            held = [x for one in numbers[: len(names)] for x in one]
            return p.stage.function(kin, held, *numbers[len(names) :])

        read = [_view(name, index) for index in (bodies, others) for name in names]
        written = [_view(name, entries) for name in p.stage.writes]
        stage = Stage(entry, [view.name for view in read], [view.name for view in written], lanes)
        return Loop(kin.name, [stage], views=(*read, *written))

    return [loop(kin) for kin in p.kinships(is_sure=True)]


def _pairs(p: Pass, lanes: int) -> list[Loop]:
    """Each body, gathered, with each block of others that holds one which it carries, or which carries it."""
    held, *names = p.stage.reads
    own = tuple(View(f"own_{name}", name, "self") for name in names)
    hold = Stage(lambda *own: [x for numbers in own for x in numbers], [view.name for view in own], (held,))

    def loop(kin: Kinship) -> Loop:
        bodies, others, entries = kin.lists
        read = [_view(held, bodies), *(_view(name, others) for name in names)]
        written = [_view(name, entries) for name in p.stage.writes]
        reads, writes = ([view.name for view in some] for some in (read, written))
        return Loop(kin.name, [Stage(partial(p.stage.function, kin), reads, writes, lanes)], views=(*read, *written))

    return [LaneLoop("bodies", [hold], (held,), views=own), *(loop(kin) for kin in p.kinships(is_sure=False))]


def _view(name: str, index: str) -> View:
    return View(f"{name} by {index}", name, index)


class Kept:
    """A list of numbers as stored in a region: without those that are the same for all bodies, or at hand elsewhere."""

    def __init__(self, function: Callable[..., Any], at_hand: int = 0, **sizes: int) -> None:
        """function: computes the list from lists of these sizes, whose first so many numbers are at hand."""
        found = graph_of(function, **sizes).results
        slots = {k: x.args[0] for k, x in enumerate(found) if isinstance(x, Traced) and x.op == "input"}
        self._known = {k: x for k, x in enumerate(found) if not isinstance(x, Traced)}
        self._at_hand = {k: slot for k, slot in slots.items() if slot < at_hand}
        self._stored = [k for k in range(len(found)) if k not in {**self._known, **self._at_hand}]
        self.size = len(self._stored)

    def some(self, numbers: Scalars) -> list[Scalar]:
        """Those numbers that are stored."""
        return [numbers[k] for k in self._stored]

    def all(self, stored: Scalars, at_hand: Scalars = ()) -> list[Scalar]:
        others = {k: at_hand[slot] for k, slot in self._at_hand.items()}
        found = {**self._known, **others, **dict(zip(self._stored, stored, strict=True))}
        return [found[k] for k in range(len(found))]


class Order(NamedTuple):
    """How many numbers each scalar has in the passes: 1 is the plain value, more are time jets."""

    numbers: int

    def packed(self, scalars: Iterable[Scalar]) -> list[Scalar]:
        """The numbers of scalars, concatenated."""
        return [x for scalar in scalars for x in self._of(scalar)]

    def scalars(self, numbers: Scalars) -> list[Scalar]:
        m = self.numbers
        return [*numbers] if m == 1 else [Jet(*numbers[k : k + m]) for k in range(0, len(numbers), m)]

    def rate(self, rates: Sequence[Scalars], k: int) -> list[Scalar]:
        """The k-th derivative of a joint's coordinates, from all their rates."""
        first, *others = rates[k : k + self.numbers]
        return [Jet(*numbers) for numbers in zip(first, *others, strict=True)] if others else [*first]

    def _of(self, scalar: Scalar) -> Sequence[Scalar]:
        rest = [0] * (self.numbers - 1)
        return scalar.derivatives[: self.numbers] if isinstance(scalar, Jet) else [scalar, *rest]


PLAIN = Order(1)
WITH_RATES = Order(3)
"""A torque with the two derivatives that a motor behind a spring asks for."""
