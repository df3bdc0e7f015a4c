"""Functions of large robots: loops over their bodies, compiled once for a tree of any size.

Straight-line code is quickest for small robots; its size, and the time to compile it, grow with the robot.
"""

import time
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.definitions import Machine
from cutpoint.door import checked_array
from cutpoint.errors import InputError
from cutpoint.kernels import backends
from cutpoint.rolled.bodies import Columns, rows_of
from cutpoint.rolled.memory import Task
from cutpoint.rolled.recipes import PLAIN_VARIANTS, RECIPES
from cutpoint.rolled.runs import Many, One
from cutpoint.rolled.suited import unsuited

Array = np.ndarray

LANES = 8
"""Bodies, or configurations, that are computed side by side: what AVX-512 takes at once, others in two or four."""

TOO_LARGE = 1000
"""Bodies beyond which straight-line machine code would take many minutes to compile."""


def rolled(
    key: Any, machine: Machine, backend: str, record: type[tuple[Any, ...]] | None = None
) -> "RolledFunction | None":
    """A function as loops, if it has such a recipe and the robot is so large that loops suit it better.

    key: its name, in a tuple if it is asked for in a variant.  record: what holds the outputs.

    Raises:
        InputError: the robot is too large for anything but loops, and has something that they do not take.
    """
    name = key[0] if isinstance(key, tuple) else key
    bodies, recipe = len(machine.system.segments), RECIPES.get(name)
    if recipe is None or bodies <= recipe.above or backends.chosen(backend) != "llvm":
        return None
    odd = recipe.odd if key not in (name, *PLAIN_VARIANTS) else unsuited(machine, recipe.reads_drives)
    if odd is None:
        return RolledFunction(name, machine, backend, record)
    if bodies > TOO_LARGE:
        complaint = f"{bodies} bodies are too many for code without loops, and loops do not take {odd}"
        raise InputError(f"{name}: {complaint}; at most {TOO_LARGE} bodies, or backend='numpy', can do", bodies=bodies)
    return None


class RolledFunction:
    """A function of one robot, for arrays (..., n) that broadcast.

    Attributes:
        compile_seconds: what tracing and compiling took, s; a first batch compiles once more.
    """

    def __init__(
        self, name: str, machine: Machine, backend: str, record: type[tuple[Any, ...]] | None = None
    ) -> None:
        start = time.perf_counter()
        self.name, self._record, recipe = name, record, RECIPES[name]
        self._inputs, self._bodies = recipe.inputs, len(machine.system.segments)
        drives = machine.drives if recipe.reads_drives else ()
        columns = Columns(rows_of(machine.system, drives), drives)
        self._task = Task(recipe, machine.system, columns, backend)
        self._one = One(self._task, LANES)
        self._quick = self._shortcut()
        self.compile_seconds = time.perf_counter() - start

    def __call__(self, *given: ArrayLike) -> Any:
        """The outputs (..., n); from several threads at once.

        Raises:
            InputError: a wrong shape, or a number that is not finite.
        """
        return self._quick(*given)

    def _shortcut(self) -> Callable[..., Any]:
        """For single calls, with less between."""
        if self._one.program.backend != "llvm" or len(self._task.shape) > 1:  # a matrix is kept with padded rows
            return self._general
        from cutpoint.kernels.fastcall import Front
        from cutpoint.kernels.program_front import front_of

        memory = self._one.spare.take()
        front = Front(self._general, finite=True, record=self._record)
        return front_of(memory.run, self.name, memory.inputs, memory.outputs, front)

    def _general(self, *given: ArrayLike) -> Any:
        pairs = zip(self._inputs, given, strict=True)
        found = self._batch([checked_array(self.name, key, x, self._bodies) for key, x in pairs])
        return self._record(*found) if self._record else found[0]

    @cached_property
    def _many(self) -> Many:
        return Many(self._task, LANES)

    def _batch(self, given: Sequence[Array]) -> list[Array]:
        """As many as possible side by side, what is left one by one, in memory that no other call uses.

        Matrices one by one: their entries are many at once already.
        """
        try:
            shape = np.broadcast_shapes(*(x.shape for x in given))
        except ValueError:
            found = ", ".join(f"{name} {x.shape[:-1]}" for name, x in zip(self._inputs, given, strict=True))
            raise InputError(f"{self.name}: leading axes do not broadcast: {found}") from None
        rows = [np.broadcast_to(x, shape).reshape(-1, self._bodies) for x in given]
        own = self._task.shape
        found = [np.empty((len(rows[0]), *own)) for _ in self._task.recipe.outputs]
        wide = len(rows[0]) // LANES * LANES if len(own) == 1 else 0
        if wide:
            self._many([x[:wide] for x in rows], [x[:wide] for x in found])
        memory = self._one.spare.take()
        for k in range(wide, len(rows[0])):
            memory([x[k] for x in rows], [x[k] for x in found])
        self._one.spare.give_back(memory)
        return [x.reshape(shape[:-1] + own) for x in found]
