"""C99 of a program: loops around stages, on stack memory; it rounds exactly as our machine code does."""

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from math import prod
from typing import NamedTuple

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.graphs.ports import Port, places_of
from cutpoint.kernels.graphs.precision import FLOAT64
from cutpoint.kernels.lowering.scheduling import scheduled
from cutpoint.kernels.programs.lowered import lowered
from cutpoint.kernels.programs.outputs import Fixed, Output
from cutpoint.kernels.programs.stepping import LaneLoop, Loop, Region, Stage
from cutpoint.kernels.targets.c99 import Source, helpers, number, statements

MOST_STACK = 2**22
"""Bytes that a call may take: half of what threads usually have on a PC."""

_FEW = 32
"""Numbers up to which memory is begun by an assignment each, not by copying a table."""


def source_of(fixed: Fixed, name: str) -> Source:
    """The function of inputs and outputs.  All inputs are read before an output is written, so they may alias.

    name: used in errors.
    Raises InputError for a program whose memory exceeds a stack's.
    """
    rooms = _Rooms(fixed)
    check_stack(name, rooms.stack)
    loops = _Loops(fixed, rooms)
    lines = [line for key, x in fixed.inputs.items() for line in _copied(rooms, key, x, inward=True)]
    lines += loops.loop(fixed.plan.body, {})
    lines += [line for key, x in fixed.outputs.items() for line in _copied(rooms, key, x, inward=False)]
    text = "\n".join(lines)
    lines = [*loops.lists(text), *rooms.declared(text), *lines]
    inputs, outputs = ([Port(key, x.shape) for key, x in some.items()] for some in (fixed.inputs, fixed.outputs))
    called = helpers([lowered(fixed.plan, stage) for stage in fixed.plan.graphs], FLOAT64)
    return Source(inputs, outputs, FLOAT64, called, "".join(f"  {line}\n" for line in lines), rooms.stack)


def check_stack(name: str, stack: int) -> None:
    """Raises InputError if this many bytes are too many."""
    if stack > MOST_STACK:
        told = f"in C it would take {stack:,} bytes of stack, more than {MOST_STACK:,}; use a smaller model"
        raise InputError(f"{name}: {told}", bytes=stack)


class _Room(NamedTuple):
    """A C array, for arrays that share memory here, initialised with its contents."""

    name: str
    memory: np.ndarray
    about: str


def _room(name: str, arrays: Mapping[str, np.ndarray]) -> _Room:
    """The memory shared by arrays of these names, from the first number used to the last."""
    (owner, *_), starts = map(_owner, arrays.values()), [x.ctypes.data for x in arrays.values()]
    ends = [start + x.nbytes for start, x in zip(starts, arrays.values(), strict=True)]
    first, last = ((place - owner.ctypes.data) // FLOAT64.item for place in (min(starts), max(ends)))
    return _Room(name, owner.reshape(-1)[first:last], ", ".join(arrays))


class _Rooms:
    """The C arrays; read-only ones are tables, and only those used are declared."""

    def __init__(self, fixed: Fixed) -> None:
        plan = fixed.plan
        given = [part.own for x in fixed.inputs.values() for part in x.parts]
        found = [part.own for x in fixed.outputs.values() for part in x.parts]
        arrays: dict[int, dict[str, np.ndarray]] = {}
        for name in plan.regions:
            arrays.setdefault(id(_owner(fixed.arrays[name])), {})[name] = fixed.arrays[name]
        for x in (*given, *found):
            arrays.setdefault(id(_owner(x)), {"zeros": x})
        self._rooms = {key: _room(f"_m{k}", some) for k, (key, some) in enumerate(arrays.items())}
        self._changing = {id(_owner(x)) for x in (*given, *(fixed.arrays[name] for name in plan.written))}

    @property
    def stack(self) -> int:
        """Stack memory of a call, bytes."""
        return sum(self._rooms[key].memory.nbytes for key in self._changing)

    def place(self, array: np.ndarray) -> tuple[str, int]:
        """The C array that holds an array, and its offset there."""
        room = self._rooms[id(_owner(array))]
        return room.name, (array.ctypes.data - room.memory.ctypes.data) // FLOAT64.item

    def declared(self, text: str) -> Iterator[str]:
        """Declarations of those that a text uses."""
        for key, (name, memory, about) in self._rooms.items():
            if f"{name}[" not in text:
                continue
            yield f"/* {about} */"
            numbers = [number(x, FLOAT64) for x in memory.tolist()]
            if key not in self._changing:
                yield from _table("double", name, numbers)
                continue
            there = np.flatnonzero((memory != 0) | np.signbit(memory)).tolist()
            if len(there) <= _FEW:
                yield f"double {name}[{len(numbers)}] = {{0}};"
                yield from (f"{name}[{k}] = {numbers[k]};" for k in there)
            else:
                yield from _table("double", f"{name}_begun", numbers)
                yield f"double {name}[{len(numbers)}];"
                yield f"memcpy({name}, {name}_begun, sizeof {name});"
            if not re.search(rf"= .*\b{name}\[|if \({name}\[", text):
                yield f"(void){name}; /* written alone */"


class _Loops:
    """Loops and stages as statements."""

    def __init__(self, fixed: Fixed, rooms: _Rooms) -> None:
        self._fixed, self._plan, self._rooms, self._numbers = fixed, fixed.plan, rooms, count()
        self._lists = {index: f"_r{k}" for k, index in enumerate(fixed.plan.indices)}

    def lists(self, text: str) -> Iterator[str]:
        """The lists of rows that a text uses."""
        for index, name in self._lists.items():
            if f"{name}[" in text:
                yield from _table("int", name, [*map(str, self._fixed.arrays[index].tolist())])

    def loop(self, this: Loop, starts: Mapping[str, str]) -> Iterator[str]:
        """starts: by name, offsets of the rows of regions that outer loops step through."""
        if not (often := self._number(this.count)):
            return  # its list of rows is empty as well, and C has no empty arrays
        k = f"_i{next(self._numbers)}"
        groups = {name: prod(map(self._number, this.within(name))) for name in this.streams}
        rows = {name: (name, f"{k} * {size}" if size > 1 else k) for name, size in groups.items()}
        rows |= {view.name: (view.of, f"{self._lists[view.index]}[{k}]") for view in this.views}
        own = {name: f"_at{next(self._numbers)}" for name in rows}
        body = [line for item in this.body for line in self._item(item, {**starts, **own})]
        if this.until:
            body.append(f"if ({self._slot(this.until, 0, starts)} != 0) break;")
        if often == 1 and not rows and not this.until:
            yield from body
            return
        text = "\n".join(body)
        yield f"for (int {k} = {f'{often - 1}; {k} >= 0; {k}--' if this.backward else f'0; {k} < {often}; {k}++'}) {{"
        for name, (region, row) in rows.items():
            if re.search(rf"\b{own[name]}\b", text):
                start = self._start(self._plan.regions[region], row, this)
                outer = f"{starts[name]} + " if name in groups and name in starts else ""
                yield f"  const int {own[name]} = {outer}{start};"
        yield from (f"  {line}" for line in body)
        yield "}"

    def _number(self, count: int | str) -> int:
        return self._fixed.counts[count] if isinstance(count, str) else count

    def _item(self, item: Stage | Loop, starts: Mapping[str, str]) -> Iterator[str]:
        return self.loop(item, starts) if isinstance(item, Loop) else self._stage(item, starts)

    def _start(self, region: Region, row: str, loop: Loop) -> str:
        if isinstance(loop, LaneLoop) and region.lanes > 1:
            return f"{row} / {region.lanes} * {region.room} + {row} % {region.lanes}"
        return f"{row} * {region.room}"

    def _stage(self, stage: Stage, starts: Mapping[str, str]) -> Iterator[str]:
        graph = scheduled(lowered(self._plan, stage))
        read, write = (
            [self._slot(name, k, starts, stage) for name, k in places_of(ports)]
            for ports in (graph.inputs, graph.outputs)
        )
        lanes = f"for (int _lane = 0; _lane < {stage.lanes}; _lane++) " if stage.lanes > 1 else ""
        yield f"{lanes}{{ /* from {', '.join(stage.reads)} to {', '.join(stage.writes)} */"
        yield from (f"  {line}" for line in statements(graph, read, write))
        yield "}"

    def _slot(self, name: str, k: int, starts: Mapping[str, str], stage: Stage | None = None) -> str:
        """A number of a region, from the view of a stage."""
        region = self._plan.regions[self._plan.root(name)]
        room, first = self._rooms.place(self._fixed.arrays[region.name])
        is_laned = stage is not None and self._plan.is_laned(stage, name)
        is_single = stage is not None and name in self._plan.single[stage]
        step = region.lanes if is_laned or is_single else 1
        place = first + region.place(k) * step
        terms = [starts.get(name, ""), str(place) if place else "", "_lane" if is_laned else ""]
        return f"{room}[{' + '.join(filter(None, terms)) or place}]"


def _copied(rooms: _Rooms, name: str, argument: Output, *, inward: bool) -> Iterator[str]:
    """Copies an argument's numbers into memory, or out of it."""
    everything = np.empty(argument.shape)
    for part in argument.parts:
        if not part.own.size:
            continue
        there = part.place(everything)
        room, first = rooms.place(part.own)
        place = (there.ctypes.data - everything.ctypes.data) // FLOAT64.item
        axes = [axis for axis in zip(there.shape, there.strides, part.own.strides, strict=True) if axis[0] > 1]
        for depth, (length, *_) in enumerate(axes):
            yield f"{'  ' * depth}for (int _k{depth} = 0; _k{depth} < {length}; _k{depth}++)"
        given = _index(name, place, [step for _, step, _ in axes])
        own = _index(room, first, [step for *_, step in axes])
        yield f"{'  ' * len(axes)}{own if inward else given} = {given if inward else own};"


def _index(name: str, first: int, steps: Sequence[int]) -> str:
    """steps: in bytes, of each loop."""
    numbers = [step // FLOAT64.item for step in steps]
    terms = [f"_k{depth}" if k == 1 else f"{k} * _k{depth}" for depth, k in enumerate(numbers)]
    return f"{name}[{' + '.join([str(first)] * (first > 0) + terms) or first}]"


def _table(kind: str, name: str, numbers: Sequence[str]) -> Iterator[str]:
    yield f"static const {kind} {name}[{len(numbers)}] = {{"
    for k in range(0, len(numbers), 8):
        yield f"  {', '.join(numbers[k : k + 8])},"
    yield "};"


def _owner(array: np.ndarray) -> np.ndarray:
    """The array that owns an array's memory."""
    while isinstance(array.base, np.ndarray):
        array = array.base
    return array
