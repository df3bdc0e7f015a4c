"""User-written laws: whether one is a pure step that can be compiled, and what its compiled step depends on."""

from collections.abc import Hashable, Iterable
from typing import Any, NamedTuple, NoReturn

import numpy as np

from cutpoint.control.held_state import MOVING, as_it_was, changed, held_by
from cutpoint.control.interface import (
    SENSED,
    Measurement,
    Reference,
    is_own,
    name_of,
    numbers_after,
    start_of,
    stepped,
)
from cutpoint.control.law import inner_laws, makes_reference, needs_of, parts_of
from cutpoint.errors import InputError, TraceError
from cutpoint.kernels import Graph, graph_of
from cutpoint.kernels.arrays.numpy_backend import evaluate
from cutpoint.kernels.graphs.refusals import refusals
from cutpoint.scalars import constants, keys_of, leaves, rebuild, with_float_leaves

STEPS_TRIED = 16
"""In numbers, of a law that is to be compiled."""

SEEN = (*SENSED, *(f"reference_{name}" for name in Reference._fields))


class Found(NamedTuple):
    """Result of tracing a user's law.

    key: equal for laws that share one compiled loop.  reads: fields of a Measurement that the step depends on.
    refusal: the reason if it cannot be compiled.
    """

    key: Hashable
    reads: tuple[str, ...] = ()
    refusal: TraceError | None = None


def innermost(law: Any) -> list[Any]:
    """The laws inside sums and wrappers; one that is neither, alone."""
    inner = () if is_own(law) else inner_laws(law)
    return [part for x in inner for part in innermost(x)] if inner else [law]


def own_parts(law: Any) -> list[Any]:
    """A user's own laws, alone or inside sums and wrappers.  Raises InputError for one without a step."""
    own = [part for part in innermost(law) if is_own(part)]
    for part in own:
        if not hasattr(part, "step"):
            raise InputError(f"controller {name_of(part)} has no step(memory, measurement, reference)")
    return own


def fields_read(law: Any, own: Iterable[tuple[Any, Found]]) -> tuple[tuple[str, str], ...]:
    """Fields of a Measurement that a law's parts declare to need, each with the part's name; those of its own parts
    that declare none are what was found."""
    needs = [(part, name) for part in parts_of(law) for name in getattr(part, "needs", ())]
    needs += [(part, name) for part, found in own for name in found.reads if not hasattr(part, "needs")]
    return tuple((name_of(part), name) for part, name in needs)


def check_encoders(function: str, reads: Iterable[tuple[str, str]], sides: str) -> None:
    """Raises InputError for a law that reads missing encoders; reads: see `fields_read`."""
    missing = {"both": (), "motor": ("q", "v"), "link": ("theta", "theta_dot")}[sides]
    wanted = [(reader, name) for reader, name in reads if name in missing]
    if wanted:
        reader = wanted[0][0]
        names = [name for who, name in wanted if who == reader]
        told = f"{reader} reads {', '.join(names)}, but sensors are on the {sides} side only"
        raise InputError(f"{function}: {told}; use a law of that side, or Sensors(sides='both')", needs=names)


def check_pure(law: Any, drives: int) -> None:
    """Raises TraceError if a user-written part of the law cannot be compiled."""
    for part in own_parts(law):
        if refusal := traced(part, drives).refusal:
            raise refusal


def traced(law: Any, drives: int) -> Found:
    """A user's law, traced anew: its numbers may have changed since the last time.

    Its step runs twice on the same traced numbers.  Both runs must return the same, and leave the law's state
    unchanged; if not, the state is restored.  Numeric steps must then reproduce the traced result.
    """
    step = _Step(law, drives)
    try:
        with as_it_was(law):
            graph = graph_of(step, **step.inputs)
            step.check(graph)
    except TraceError as error:
        error.__cause__ = error.__context__ = None
        return Found(("called", name_of(law)), refusal=error.with_traceback(None))
    return Found((graph.fingerprint(), *step.shape, makes_reference(law), needs_of(law)), _reads(graph))


class _Step:
    """A law's step from flat numbers to flat numbers.

    Attributes:
        inputs: sizes, by name.
        shape: how many numbers the law has, and which parts of its command it leaves out; known after the first call.
    """

    def __init__(self, law: Any, drives: int) -> None:
        self._law, self._start, self._drives = law, with_float_leaves(start_of(law)), drives
        self._memory, self._numbers = len(leaves(self._start)), len(leaves(law))
        self.inputs: dict[str, Any] = {"time": (), "period": (), "memory": self._memory, "numbers": self._numbers}
        self.inputs |= dict.fromkeys(SEEN, drives)
        self.shape: tuple[Any, ...] = ()

    def __call__(self, *, numbers: Any, **given: Any) -> list[Any]:
        """Raises TraceError for a law that is not a function of what its step is given."""
        own, refused = rebuild(self._law, iter(numbers)), refusals()
        before = held_by(own)
        if moving := [held.name for held in before.values() if held.kind is MOVING]:
            what = "an iterator, a generator or a file, whose state cannot be seen"
            _refuse(self._law, f"holds what moves on by itself ({', '.join(moving)}): {what}")
        first, shape = self._once(own, **given)
        between = held_by(own)
        second, self.shape = self._once(own, **given)
        if refusals() > refused:
            told = "catches the error that says it cannot be compiled, as an `if` within a `try` does"
            raise TraceError(f"{name_of(self._law)} {told}; write cutpoint.where(condition, yes, no)")
        if changes := changed(before, between) + changed(between, held_by(own)):
            _refuse(self._law, f"keeps state in itself ({', '.join(dict.fromkeys(changes))})")
        if shape != self.shape or not all(x is y or repr(x) == repr(y) for x, y in zip(first, second, strict=True)):
            told = "gives different results for the same memory, measurement and reference"
            _refuse(self._law, f"{told}, in two trials before the run, which also used up what it read from outside")
        return first

    def check(self, graph: Graph) -> None:
        """Raises TraceError if consecutive numeric steps of the law differ from the traced step.

        Such laws branch on the type of their numbers, or catch a TraceError: the other branch is not compiled.
        """
        given, expected = self._in_numbers()
        if not given:
            return
        found = evaluate(graph, [*np.array(given).T])
        for k, (one, other) in enumerate(zip(np.array(expected).T, found, strict=True)):
            scale = np.abs(one, where=np.isfinite(one), out=np.zeros(len(one))).max()
            same = np.isclose(one, other, rtol=1e-6, atol=1e-6 * scale + 1e-12, equal_nan=True)
            if not same.all():
                at = int((~same).argmax())
                was, now = one[at], float(np.broadcast_to(other, one.shape)[at])
                what = "its memory" if k < self._memory else "its command"
                told = f"gives {was:.6g} in {what} with plain numbers, but {now:.6g} compiled"
                _refuse(self._law, f"{told}: isinstance, try, np.nan_to_num or state kept elsewhere can cause this")

    def _in_numbers(self) -> tuple[list[list[float]], list[list[float]]]:
        """Inputs and results of consecutive numeric steps, up to the first error of the law's own."""
        rng, period = np.random.default_rng(0), 1e-3
        memory, numbers = [float(x) for x in leaves(self._start)], [float(x) for x in leaves(self._law)]
        given, expected = list[list[float]](), list[list[float]]()
        for k in range(STEPS_TRIED):
            # measurements around one motion, from zero error to large ones
            motion, error = rng.uniform(-1, 1, self._drives), 10.0 ** rng.uniform(-6, 0.5) if k else 0.0
            seen = {name: motion + error * rng.uniform(-1, 1, self._drives) for name in SEEN}
            time = np.float64(k * period)
            try:
                found, _ = self._once(self._law, time=time, period=np.float64(period), memory=memory, **seen)
                results = [float(x) for x in found]
            except Exception:  # the user's code may fail on these numbers only; a run reports errors on its own
                break
            given.append([time, period, *memory, *numbers, *(x for name in SEEN for x in seen[name])])
            expected.append(results)
            memory = results[: self._memory]
        return given, expected

    def _once(self, own: Any, *, time: Any, period: Any, memory: Any, **seen: Any) -> tuple[list[Any], tuple[Any, ...]]:
        """The result of one step, flattened, and its shape."""
        arrays = [np.array(seen[name]) for name in SEEN]
        asked = Measurement(time, period, *arrays[:4]), Reference(*arrays[4:])
        after, command = stepped(own, rebuild(self._start, iter(memory)), *asked)
        _check_memory(self._law, self._start, after)
        parts = [x for part in command if part is not None for x in np.broadcast_to(np.asarray(part), self._drives)]
        return [*numbers_after(self._law, after, self._memory), *parts], (self._numbers, *(x is None for x in command))


def _check_memory(law: Any, start: Any, after: Any) -> None:
    """Raises TraceError for memory that a compiled loop cannot carry."""
    if keys_of(start) != keys_of(after):
        _refuse(law, "returns memory with other keys than start() gives")
    pairs = zip(was := constants(start), now := constants(with_float_leaves(after)), strict=False)
    if len(was) != len(now) or not all(x is y or (type(x) is type(y) is str and x == y) for x, y in pairs):
        _refuse(law, "changes what is no number in its memory, such as a text or a truth value")


def _refuse(law: Any, told: str) -> NoReturn:
    remedy = (
        "state can be compiled if it is kept as numbers in the memory that start() gives and step takes and returns"
    )
    raise TraceError(f"{name_of(law)} {told}; {remedy}")


def _reads(graph: Graph) -> tuple[str, ...]:
    """Measurement fields among the inputs that the results depend on."""
    return tuple(name for name in SENSED if name in graph.inputs_read)
