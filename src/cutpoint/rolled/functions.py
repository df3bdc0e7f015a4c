"""Functions of large robots: loops over their bodies, compiled once for a tree of any size.

Straight-line code is quickest for small robots; its size, and the time to compile it, grow with the robot.
"""

import time
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.door import are_finite_vectors, checked_array
from cutpoint.errors import InputError
from cutpoint.kernels import Program, backends, compile_program
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled import bodies as tables
from cutpoint.rolled import steps
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.steps import Rolled

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

    loops: Callable[[Columns, int], Rolled]
    inputs: tuple[str, ...]
    output: str
    resting: str
    place: int
    above: int


RECIPES = {
    "inverse_dynamics": Recipe(steps.inverse_dynamics, ("q", "v", "a"), "tau", "motion", 3, 96),
    "bias_forces": Recipe(steps.inverse_dynamics, ("q", "v"), "tau", "motion", 3, 96),
    "gravity_forces": Recipe(steps.inverse_dynamics, ("q",), "tau", "motion", 3, 96),
    "forward_dynamics": Recipe(steps.forward_dynamics, ("q", "v", "tau"), "a", "acceleration", 0, 48),
}


def rolled_function(name: str, variant: bool, system: System, backend: str) -> "RolledFunction | None":
    """A function as loops, if it has such a recipe and the robot is so large that loops suit it better.

    variant: whether it is asked for with external wrenches, which loops do not take.

    Raises:
        InputError: the robot is too large for anything but loops, and has something that they do not take.
    """
    bodies, recipe = len(system.segments), RECIPES.get(name)
    if recipe is None or bodies <= recipe.above or backends.chosen(backend) != "llvm":
        return None
    odd = "external wrenches" if variant else tables.unsuited(system)
    if odd is None:
        return RolledFunction(name, system, backend)
    if bodies > TOO_LARGE:
        complaint = f"{bodies} bodies are too many for code without loops, and loops do not take {odd}"
        raise InputError(f"{name}: {complaint}; at most {TOO_LARGE} bodies, or backend='numpy', can do", bodies=bodies)
    return None


class RolledFunction:
    """A function of one robot, for arrays (..., n) that broadcast.

    Attributes:
        compile_seconds: what tracing and compiling took, s; a first batch compiles once more.
    """

    def __init__(self, name: str, system: System, backend: str) -> None:
        start = time.perf_counter()
        self.name, self._inputs = name, RECIPES[name].inputs
        self._columns, self._bodies = Columns(tables.rows_of(system)), len(system.segments)
        self._make = lambda lanes: _Loops(RECIPES[name], system, self._columns, backend, lanes)
        self._single = self._make(1)
        self._width = _width() if self._single.program.backend == "llvm" else 1
        self.compile_seconds = time.perf_counter() - start

    @cached_property
    def _wide(self) -> "_Loops":
        return self._make(self._width)

    def __call__(self, *given: ArrayLike) -> Array:
        """The output (..., n); from several threads at once, each in memory of its own.

        Raises:
            InputError: a wrong shape, or a number that is not finite.
        """
        if are_finite_vectors(given):
            for x in given:
                if len(x) != self._bodies:  # type: ignore[arg-type]
                    break
            else:
                return self._single.one(given)
        pairs = zip(self._inputs, given, strict=True)
        return self._batch([checked_array(self.name, key, x, self._bodies) for key, x in pairs])

    def _batch(self, given: Sequence[Array]) -> Array:
        """As many as possible side by side, what is left one by one."""
        try:
            shape = np.broadcast_shapes(*(x.shape for x in given))
        except ValueError:
            found = ", ".join(f"{name} {x.shape[:-1]}" for name, x in zip(self._inputs, given, strict=True))
            raise InputError(f"{self.name}: leading axes do not broadcast: {found}") from None
        rows = [np.broadcast_to(x, shape).reshape(-1, self._bodies) for x in given]
        found = np.empty((len(rows[0]), self._bodies))
        wide = len(found) - len(found) % self._width if self._width > 1 else 0
        if wide:
            self._wide.several([x[:wide] for x in rows], found[:wide])
        self._single.several([x[wide:] for x in rows], found[wide:])
        return found.reshape(shape)


def _width() -> int:
    from cutpoint.kernels.jit import vector_width

    return vector_width()


class _Loops:
    """A function's loops, compiled for so many configurations side by side, and memory for calls."""

    def __init__(self, recipe: Recipe, system: System, columns: Columns, backend: str, lanes: int) -> None:
        self._recipe, self._columns, self._lanes, self._bodies = recipe, columns, lanes, len(system.segments)
        self._rolled = recipe.loops(columns, lanes)
        self.program: Program = compile_program(self._rolled.body, self._rolled.regions, backend)
        world = self._bodies
        self._parents = np.array([world if b.parent == WORLD else b.parent for b in system.segments], dtype=np.int64)
        self._lifted = np.repeat(np.array([*system.base_acceleration], dtype=np.float64), lanes)
        self._groups = max(1, CHUNK // (lanes * self._bodies))
        self._spare: list[_Memory] = []

    def one(self, given: Sequence[Any]) -> Array:
        """One configuration, of checked vectors."""
        memory = self._taken()
        found = memory.one(given)
        self._spare.append(memory)
        return found

    def several(self, given: Sequence[Array], found: Array) -> None:
        """Configurations (m, n) into found, m whole in lanes."""
        memory, step = self._taken(), self._groups * self._lanes
        for first in range(0, len(found), step):
            memory.several([x[first : first + step] for x in given], found[first : first + step])
        self._spare.append(memory)

    def _taken(self) -> "_Memory":
        """Memory that no other call uses."""
        try:
            return self._spare.pop()
        except IndexError:
            return self._memory()

    def _memory(self) -> "_Memory":
        n, recipe, numbers, lanes = self._bodies, self._recipe, self._rolled.numbers, self._lanes
        kept = {r.name: np.zeros((n + 1, r.size)) for r in self._rolled.regions if r.name not in numbers}
        kept[recipe.resting][n, recipe.place * lanes :][: 6 * lanes] = self._lifted
        each = {name: np.zeros((self._groups * n, lanes)) for name in numbers}
        arrays = kept | each | {"body": self._columns.read, "parent": self._parents}
        return _Memory(self.program, recipe, arrays, n)


class _Memory:
    """What the loops of one call read and write."""

    def __init__(self, program: Program, recipe: Recipe, arrays: dict[str, Array], bodies: int) -> None:
        self._program, self._arrays, self._bodies = program, arrays, bodies
        names = (*recipe.inputs, recipe.output)
        # by group, lane, body
        *self._inputs, self._output = (arrays[k].reshape(-1, bodies, arrays[k].shape[1]).swapaxes(1, 2) for k in names)
        *self._first, self._last = (arrays[k][:bodies, 0] for k in names)
        self._runs: dict[int, Callable[[], int]] = {}
        self._run = self._bound(1)

    def one(self, given: Sequence[Any]) -> Array:
        for own, x in zip(self._first, given, strict=True):
            own[:] = x
        self._run()
        return self._last.copy()

    def several(self, given: Sequence[Array], found: Array) -> None:
        _, lanes, n = self._output.shape
        groups = len(found) // lanes
        for own, x in zip(self._inputs, given, strict=True):
            own[:groups] = x.reshape(groups, lanes, n)
        self._bound(groups)()
        found.reshape(groups, lanes, n)[:] = self._output[:groups]

    def _bound(self, groups: int) -> Callable[[], int]:
        if groups not in self._runs:
            counts = {"groups": groups, "bodies": self._bodies}
            self._runs[groups] = self._program.bound(counts, **self._arrays)
        return self._runs[groups]
