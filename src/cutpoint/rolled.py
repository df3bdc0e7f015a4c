"""Functions of large robots: loops over their bodies, compiled once for a tree of any size.

Straight-line code is quickest for small robots; its size, and the time to compile it, grow with the robot.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cutpoint import rolled_steps
from cutpoint.door import are_finite_vectors, checked_array
from cutpoint.errors import InputError
from cutpoint.kernels import Program, backends, compile_program
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled_steps import Columns, Rolled

Array = np.ndarray

CHUNK = 4096
"""Numbers of one input that are handed over at a time: a batch's memory stays in the cache."""

TOO_LARGE = 1000
"""Bodies beyond which straight-line machine code would take many minutes to compile."""


class Recipe(NamedTuple):
    """A function as loops.

    inputs: those that are given; the others are zero.  resting: the region whose row for the world holds its
    acceleration, from the number `place` on.  above: how many bodies the last robot has that straight-line code suits:
    beyond, it takes more than 2 s to compile, or is no quicker.
    """

    loops: Callable[[Columns], Rolled]
    inputs: tuple[str, ...]
    output: str
    resting: str
    place: int
    above: int


RECIPES = {
    "inverse_dynamics": Recipe(rolled_steps.inverse_dynamics, ("q", "v", "a"), "tau", "motion", 3, 96),
    "bias_forces": Recipe(rolled_steps.inverse_dynamics, ("q", "v"), "tau", "motion", 3, 96),
    "gravity_forces": Recipe(rolled_steps.inverse_dynamics, ("q",), "tau", "motion", 3, 96),
    "forward_dynamics": Recipe(rolled_steps.forward_dynamics, ("q", "v", "tau"), "a", "acceleration", 0, 48),
}


def rolled_function(name: Any, system: System, backend: str) -> "RolledFunction | None":
    """A function as loops, if it has such a recipe and the robot is so large that loops suit it better.

    Raises:
        InputError: the robot is too large for anything but loops, and has joints that they do not take.
    """
    bodies, recipe = len(system.segments), RECIPES.get(name) if isinstance(name, str) else None
    if recipe is None or bodies <= recipe.above or backends.chosen(backend) != "llvm":
        return None
    odd = rolled_steps.unsuited(system)
    if odd is None:
        return RolledFunction(name, system, backend)
    if bodies > TOO_LARGE:
        complaint = f"{bodies} bodies are too many for code without loops, and loops do not take {odd}"
        remedy = f"have at most {TOO_LARGE} bodies, joints with one coordinate of their own, or backend='numpy'"
        raise InputError(f"{name}: {complaint}; {remedy}", bodies=bodies)
    return None


class RolledFunction:
    """A function of one robot, for arrays (..., n) that broadcast.

    Attributes:
        program: the loops.
        compile_seconds: what tracing and compiling took, s.
    """

    def __init__(self, name: str, system: System, backend: str) -> None:
        start = time.perf_counter()
        self.name, self._system, self._recipe = name, system, RECIPES[name]
        self._columns = Columns(rolled_steps.rows_of(system))
        self._rolled = self._recipe.loops(self._columns)
        self.program: Program = compile_program(self._rolled.body, self._rolled.regions, backend)
        self._bodies = n = len(system.segments)
        self._parents = np.array([n if b.parent == WORLD else b.parent for b in system.segments], dtype=np.int64)
        self._chunk = max(1, CHUNK // n)
        self._spare: list[_Memory] = []
        self.compile_seconds = time.perf_counter() - start

    def __call__(self, *given: ArrayLike) -> Array:
        """The output (..., n); from several threads at once, each in memory of its own.

        Raises:
            InputError: a wrong shape, or a number that is not finite.
        """
        if not are_finite_vectors(given) or any(len(x) != self._bodies for x in given):  # type: ignore[arg-type]
            pairs = zip(self._recipe.inputs, given, strict=True)
            arrays = [checked_array(self.name, key, x, self._bodies) for key, x in pairs]
            return self._in_memory(lambda memory: self._batch(memory, arrays))
        return self._in_memory(lambda memory: memory.one(given))

    def _in_memory(self, function: Callable[["_Memory"], Array]) -> Array:
        """The function of memory that no other call uses."""
        try:
            memory = self._spare.pop()
        except IndexError:
            memory = self._memory()
        try:
            return function(memory)
        finally:
            self._spare.append(memory)

    def _batch(self, memory: "_Memory", given: Sequence[Array]) -> Array:
        try:
            shape = np.broadcast_shapes(*(x.shape for x in given))
        except ValueError:
            found = ", ".join(f"{name} {x.shape[:-1]}" for name, x in zip(self._recipe.inputs, given, strict=True))
            raise InputError(f"{self.name}: leading axes do not broadcast: {found}") from None
        rows = [np.broadcast_to(x, shape).reshape(-1, self._bodies) for x in given]
        found = np.empty((len(rows[0]), self._bodies))
        for first in range(0, len(found), self._chunk):
            memory.several([x[first : first + self._chunk] for x in rows], found[first : first + self._chunk])
        return found.reshape(shape)

    def _memory(self) -> "_Memory":
        n, recipe, numbers = self._bodies, self._recipe, self._rolled.numbers
        kept = {r.name: np.zeros((n + 1, r.size)) for r in self._rolled.regions if r.name not in numbers}
        kept[recipe.resting][n, recipe.place : recipe.place + 6] = [*self._system.base_acceleration]
        each = {name: np.zeros((self._chunk * n, 1)) for name in numbers}
        return _Memory(self.program, recipe, kept | each | {"body": self._columns.read, "parent": self._parents}, n)


class _Memory:
    """What the loops of one call read and write."""

    def __init__(self, program: Program, recipe: Recipe, arrays: dict[str, Array], bodies: int) -> None:
        self._program, self._arrays, self._bodies = program, arrays, bodies
        self._inputs = [arrays[name].reshape(-1, bodies) for name in recipe.inputs]
        self._output = arrays[recipe.output].reshape(-1, bodies)
        self._first = [x[0] for x in self._inputs]
        self._runs: dict[int, Callable[[], int]] = {}
        self._run = self._bound(1)

    def one(self, given: Sequence[Any]) -> Array:
        for own, x in zip(self._first, given, strict=True):
            own[:] = x
        self._run()
        return self._output[0].copy()

    def several(self, given: Sequence[Array], found: Array) -> None:
        for own, x in zip(self._inputs, given, strict=True):
            own[: len(x)] = x
        self._bound(len(found))()
        found[:] = self._output[: len(found)]

    def _bound(self, configurations: int) -> Callable[[], int]:
        if configurations not in self._runs:
            counts = {"configurations": configurations, "bodies": self._bodies}
            self._runs[configurations] = self._program.bound(counts, **self._arrays)
        return self._runs[configurations]
