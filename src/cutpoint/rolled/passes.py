"""A function as passes over bodies, and passes as loops: for one configuration, or for several side by side."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any, Literal, NamedTuple

from cutpoint.kernels import Loop, Region, Stage, Traced, View, graph_of
from cutpoint.kernels.program_plan import LaneLoop
from cutpoint.rolled.bodies import Columns
from cutpoint.scalars import Jet, Scalar

Scalars = Sequence[Scalar]

BASE = "base acceleration"
"""In a row of the world, (BASE, k) stands for the k-th of its six numbers."""


class Pass(NamedTuple):
    """A step of every body: alone, outward (parents first) or inward (children first); or of every pair of bodies.

    Of a pair, the stage reads first what is "held" of one, which is all that it reads of the other.
    """

    way: Literal["alone", "outward", "inward", "pairs"]
    stage: Stage


class Steps(NamedTuple):
    """A function as passes over the bodies.

    kept: sizes of regions that have a row for each body, and a last one for the world.  numbers: names of regions with
    one number for each body, inputs and outputs.  views: rows of a body's parent.  world: how the world's rows begin;
    they are zero elsewhere.
    """

    kept: dict[str, int]
    numbers: tuple[str, ...]
    views: tuple[View, ...]
    world: dict[str, list[Any]]
    passes: list[Pass]

    @property
    def sizes(self) -> dict[str, int]:
        return {**self.kept, **dict.fromkeys(self.numbers, 1)}


class Rolled(NamedTuple):
    """Loops, and the memory that they need."""

    body: Loop
    regions: tuple[Region, ...]


def side_by_side(steps: Steps, columns: Columns, lanes: int) -> Rolled:
    """So many configurations in each step, "groups" of them in turn, over "bodies"."""

    def loop(passes: Iterable[Pass], inward: bool) -> Loop:
        stages = [replace(p.stage, lanes=lanes) for p in passes]
        return Loop("bodies", stages, ("body", *steps.kept), None, steps.numbers, inward, steps.views)

    loops = [loop(some, inward) for inward, some in groupby(steps.passes, key=lambda p: p.way == "inward")]
    regions = [Region(name, size * lanes, lanes) for name, size in steps.sizes.items()]
    return Rolled(Loop("groups", loops), (Region("body", columns.width), *regions))


def one_by_one(steps: Steps, columns: Columns, lanes: int) -> Rolled:
    """One configuration.  What bodies do alone, so many do at once, "blocks" of them in turn."""
    sizes = {"body": columns.width, **steps.sizes}

    def loop(p: Pass) -> Loop:
        if p.way == "alone":
            return Loop("blocks", [replace(p.stage, lanes=lanes)], tuple(sizes))
        if p.way == "pairs":
            return _pairs(p.stage, lanes)
        return LaneLoop("bodies", [p.stage], tuple(sizes), backward=p.way == "inward", views=steps.views)

    regions = [Region(name, size * lanes, lanes) for name, size in sizes.items()]
    for p in steps.passes:
        if p.way == "pairs":
            regions += [Region(p.stage.reads[0], sum(sizes[name] for name in p.stage.reads[1:]))]
            regions += [Region(name, lanes, lanes) for name in p.stage.writes]
    return Rolled(Loop(1, [loop(p) for p in steps.passes]), tuple(regions))


def _pairs(stage: Stage, lanes: int) -> Loop:
    """Each body with blocks of others."""
    held, *names = stage.reads
    views = tuple(View(f"own_{name}", name, "self") for name in names)
    hold = Stage(lambda *own: [x for numbers in own for x in numbers], [view.name for view in views], (held,))
    others = Loop("blocks", [replace(stage, lanes=lanes)], names, onward=stage.writes)
    return LaneLoop("bodies", [hold, others], views=views)


class Kept:
    """A list of numbers as a region keeps it: without those that are the same for all bodies."""

    def __init__(self, function: Callable[..., Any], **sizes: int) -> None:
        """function: makes the list from lists of these sizes."""
        self._known = [None if isinstance(x, Traced) else x for x in graph_of(function, **sizes).results]
        self.size = self._known.count(None)

    def some(self, numbers: Scalars) -> list[Scalar]:
        """Those that are kept."""
        return [x for x, known in zip(numbers, self._known, strict=True) if known is None]

    def all(self, kept: Scalars) -> list[Scalar]:
        numbers = iter(kept)
        return [next(numbers) if known is None else known for known in self._known]


class Order(NamedTuple):
    """With how many coefficients scalars go through the passes: 1 is plain numbers, more are time jets."""

    coefficients: int

    def packed(self, scalars: Iterable[Scalar]) -> list[Scalar]:
        """The numbers of scalars, one after another."""
        return [x for scalar in scalars for x in self._taylor(scalar)]

    def scalars(self, numbers: Scalars) -> list[Scalar]:
        m = self.coefficients
        return [*numbers] if m == 1 else [Jet.of_taylor(numbers[k : k + m]) for k in range(0, len(numbers), m)]

    def rate(self, rates: Sequence[Scalars], k: int) -> list[Scalar]:
        """The k-th derivative of a body's coordinate, of which all rates are given, each as a list of one number."""
        first, *others = [x for (x,) in rates[k : k + self.coefficients]]
        return [Jet(first, *others) if others else first]

    def _taylor(self, scalar: Scalar) -> list[Scalar]:
        rest = [0] * (self.coefficients - 1)
        return scalar.c[: self.coefficients] if isinstance(scalar, Jet) else [scalar, *rest]


PLAIN = Order(1)
WITH_RATES = Order(3)
"""A torque with the two derivatives that a motor behind a spring asks for."""
