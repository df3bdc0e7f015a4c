"""Functions of large robots: loops over their bodies, compiled once for a tree of any size.

Straight-line code is fastest for small robots, but its size and compile time grow with the robot.
"""

import time
from collections.abc import Callable, Sequence
from functools import cached_property
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.definitions import Machine
from cutpoint.door import LARGEST, checked_array
from cutpoint.errors import InputError
from cutpoint.kernels.arrays import backends
from cutpoint.kernels.arrays.arguments import common_batch
from cutpoint.kernels.programs.outputs import Fixed
from cutpoint.mechanics.system import System
from cutpoint.rolled.algorithms.derivatives import OF_MOTORS
from cutpoint.rolled.bodies import bodies_of, columns_of, rooted
from cutpoint.rolled.memory import Task
from cutpoint.rolled.recipes import OF_DRIVES, OF_FRAMES, RECIPES
from cutpoint.rolled.runs import One
from cutpoint.rolled.suited import unsuited

if TYPE_CHECKING:
    from cutpoint.kernels.targets.c99 import Source
    from cutpoint.rolled.batches import Batches

LANES = 8
"""Bodies, or configurations, that are computed side by side: what AVX-512 takes at once, others in two or four."""

TOO_LARGE = 1000
"""Bodies beyond which straight-line machine code would take many minutes to compile."""

MOST_NUMBERS = 2**28
"""Of one matrix, 2 GiB; loops hold it once, and each call makes another."""


def rolled(
    key: Any, machine: Machine, backend: str, record: type[tuple[Any, ...]] | None = None
) -> "RolledFunction | None":
    """A function as loops, if it has such a recipe and the robot is so large that loops suit it better.

    key: its name, in a tuple if it is asked for in a variant.  record: what holds the outputs.

    Raises:
        InputError: the robot is too large for anything but loops, and has something that they do not take.
    """
    asked, frame = without_frame(key)
    name, bodies = name_of(key), size_of(machine.system, frame)
    if not _is_large_for(key, machine.system, backend):
        return None
    odd = _hindrance(key, machine)
    if odd is None:
        return RolledFunction(asked, machine, backend, record, frame)
    if bodies > TOO_LARGE:
        complaint = f"{bodies} bodies are too many for code without loops, and loops do not support {odd}"
        raise InputError(f"{name}: {complaint}; use at most {TOO_LARGE} bodies, or backend='numpy'", bodies=bodies)
    return None


def loops_take(key: Any, machine: Machine, backend: str) -> bool:
    """Whether a function of this robot runs as loops: see `rolled`."""
    return _is_large_for(key, machine.system, backend) and _hindrance(key, machine) is None


def _is_large_for(key: Any, system: System, backend: str) -> bool:
    """Whether a function has a recipe, and the robot is large enough for loops to be better."""
    asked, frame = without_frame(key)
    recipe = RECIPES.get(asked) or RECIPES.get(name_of(key))
    if recipe is None or backends.chosen(backend) != "llvm":
        return False
    if frame is not None and 7 * system.nv > backends.MOST_NUMBERS:  # a Jacobian and q
        return True
    return size_of(system, frame) > recipe.most_bodies or sum(system.depths) > recipe.pairs


def _hindrance(key: Any, machine: Machine) -> str | None:
    """The feature of the robot, or of a function's arguments, that loops do not support."""
    asked = without_frame(key)[0]
    if asked not in RECIPES:
        return RECIPES[name_of(key)].unsupported_inputs
    return unsuited(machine, RECIPES[asked])


def name_of(key: Any) -> str:
    return key[0] if isinstance(key, tuple) else key


def without_frame(key: Any) -> tuple[Any, str | None]:
    """A key and the frame that it says, if it is that of a function of frames."""
    name = name_of(key)
    return ((name, *key[2:]), key[1]) if name in OF_FRAMES else (key, None)


def size_of(system: System, frame: str | None) -> int:
    """How many bodies a function is about: all, or those that carry a frame."""
    return len(system.chain_to(system.frames[frame].body)) if frame else len(system.segments)


class RolledFunction:
    """A function of one robot, for arrays (..., n) that broadcast.

    Attributes:
        compile_seconds: what tracing and compiling took, s; a first batch compiles once more.
    """

    def __init__(
        self,
        key: Any,
        machine: Machine,
        backend: str,
        record: type[tuple[Any, ...]] | None = None,
        frame: str | None = None,
    ) -> None:
        """key: of its recipe.  frame: the one it is about, if it is about any."""
        start = time.perf_counter()
        self.name, self._record, recipe = name_of(key), record, RECIPES[key]
        drives = machine.drives if recipe.reads_drives else ()
        system = rooted(machine.system) if recipe.is_rooted else machine.system
        columns = columns_of(system, drives, user_axes=recipe.reads_user_axes)
        self._driven = [d.segment - bodies_of(machine.system).start for d in drives]
        self._are_all_driven = len(self._driven) in (0, columns.bodies)
        self._task = Task(recipe, system, columns, backend, frame)
        for output in recipe.outputs:
            if prod(shape := self._task.shape(output)) > MOST_NUMBERS:
                told = f"{self.name}: a matrix {shape} has more than {MOST_NUMBERS} numbers"
                raise InputError(f"{told}, 2 GiB; use a smaller model", shape=shape)
        self._one = One(self._task, LANES, self.name)
        self._quick = self._shortcut()
        self.compile_seconds = time.perf_counter() - start

    def __call__(self, *given: ArrayLike) -> Any:
        """The outputs (..., n); from several threads at once.

        Raises:
            InputError: a wrong shape, a number that is not finite, or beyond what machines have.
        """
        return self._quick(*given)

    def quick(self) -> Callable[..., Any]:
        """The same function in its fastest form for single calls."""
        return self._quick

    def to_c(self, *outputs: str) -> "Source":
        """The same in C, the drives' numbers folded in.  outputs: what they are called, if not as in the record.

        Raises:
            InputError: some joints have no drive, or it takes more memory than a stack holds.
        """
        from cutpoint.kernels.targets.c99_program import source_of

        return source_of(self.fixed(*outputs), self.name)

    def fixed(self, *outputs: str) -> Fixed:
        """The loops and all memory that a run begins with, the drives' numbers included.  outputs: as for `to_c`.

        Raises:
            InputError: some joints have no drive.
        """
        if not self._are_all_driven:
            told = "loops are exported as C for robots with a drive in every joint, or in none; lock those without"
            raise InputError(f"{self.name}: {told}")
        known = getattr(self._record, "_fields", self._task.recipe.outputs)
        return self._one.memory().fixed(outputs or known)

    def _shortcut(self) -> Callable[..., Any]:
        """For single calls, with less between, where inputs and outputs lie in memory as they are given."""
        if self._one.program.backend != "llvm" or not self._are_all_driven:
            return self._general
        from cutpoint.kernels.arrays.fastcall import Front
        from cutpoint.kernels.programs.front import front_of

        memory = self._one.memory()
        front = Front(self._general, largest=LARGEST, record=self._record)
        return front_of(memory.run, self.name, memory.inputs, memory.outputs, front)

    def _general(self, *given: ArrayLike) -> Any:
        found = self._of_batch(given)
        if found is None:
            pairs = zip(self._task.recipe.inputs, given, strict=True)
            found = self.computed([self._at_bodies(key, x) for key, x in pairs])
        if not self._are_all_driven:
            names = self._task.recipe.outputs
            found = [self._of_driven(k, x) for k, x in zip(names, found, strict=True)]
        return self._record(*found) if self._record else found[0]

    def _of_driven(self, name: str, found: np.ndarray) -> np.ndarray:
        """An output without what it has for bodies that no drive moves."""
        if name in OF_DRIVES:
            return found[..., self._driven]
        return found[..., self._driven, :] if name in OF_MOTORS else found

    def _at_bodies(self, key: str, given: ArrayLike) -> np.ndarray:
        """An input, checked; of drives, with zeros for the bodies that have none."""
        if self._are_all_driven or key not in OF_DRIVES:
            return checked_array(self.name, key, given, self._task.size(key))
        x = checked_array(self.name, key, given, len(self._driven))
        spread = np.zeros((*x.shape[:-1], self._task.bodies))
        spread[..., self._driven] = x
        return spread

    def _of_batch(self, given: tuple[Any, ...]) -> Sequence[np.ndarray] | None:
        """The outputs of a contiguous batch; None for everything else, including mistakes."""
        first = given[0] if given else None
        if self._batches is None or not self._are_all_driven or type(first) is not np.ndarray or first.ndim < 2:
            return None
        with self._batches.of(len(first)).lent() as batch:
            found = batch.whole(given, None) if batch.whole else None
        return (found,) if isinstance(found, np.ndarray) else found

    def computed(self, given: Sequence[np.ndarray]) -> list[np.ndarray]:
        """The outputs for arrays of the right lengths, whatever numbers they hold."""
        pairs = zip(self._task.recipe.inputs, given, strict=True)
        shape = common_batch(self.name, {key: x.shape[:-1] for key, x in pairs})
        rows = [np.broadcast_to(x, (*shape, x.shape[-1])).reshape(-1, x.shape[-1]) for x in given]
        shapes = [self._task.shape(name) for name in self._task.recipe.outputs]
        found = [np.empty((len(rows[0]), *own)) for own in shapes]
        with (self._batches.of(len(rows[0])) if self._batches else self._one.spare).lent() as memory:
            memory(rows, found)
        return [x.reshape(shape + own)[()] for x, own in zip(found, shapes, strict=True)]

    @cached_property
    def _batches(self) -> "Batches | None":
        """In machine code, where there is some."""
        if self._one.program.backend != "llvm":
            return None
        from cutpoint.rolled.batches import Batches

        return Batches(self._task, self._one, LARGEST)
