"""Program: a loop nest around traced stages, compiled into one function that steps through memory."""

import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from cutpoint.kernels.arrays.backends import check_length, chosen
from cutpoint.kernels.machine.waiting import shown
from cutpoint.kernels.programs.arrays import check_run
from cutpoint.kernels.programs.interpreted import NumpyProgram
from cutpoint.kernels.programs.plan import Plan, plan
from cutpoint.kernels.programs.stepping import Loop, Region


def compile_program(
    body: Loop, regions: Sequence[Region], backend: str = "auto", *, name: str = "a stepping program"
) -> "Program":
    """Compiles a loop nest around stages.

    Args:
        body: the outermost loop.
        regions: all memory that stages read and write.
        backend: "llvm" for machine code, "numpy", or "auto": LLVM where llvmlite is installed.
        name: used in errors and in progress messages.

    Raises:
        InputError: regions, stages and loops do not fit together, or they are too long to compile.
        TraceError: a stage needs a value where there is none yet, or returns something else than its regions.
    """
    start = time.perf_counter()
    with shown(name):
        return Program(plan(body, regions), chosen(backend), name, start)


class Program:
    """A compiled program; its memory is the caller's.

    Attributes:
        plan: what it runs.
        backend: "llvm" or "numpy".
        counts: names of the loop counts that runs are given.
        compile_seconds: time for tracing, and for compiling or loading the code from disk, s.
    """

    def __init__(self, plan: Plan, backend: str, name: str, start: float) -> None:
        self.plan, self.backend, self.counts = plan, backend, frozenset(plan.counts)
        if backend == "llvm":
            from cutpoint.kernels.programs.compiled import LlvmProgram

            check_length(name, plan.graphs.values())
            self._runner = LlvmProgram(plan)
        else:
            self._runner = NumpyProgram(plan)
        self.compile_seconds = time.perf_counter() - start

    def run(self, counts: Mapping[str, int], /, **arrays: np.ndarray) -> int:
        """Runs the program on these arrays, in place, without the GIL.

        Args:
            counts: loop counts that are given by name.
            arrays: for each region a C-contiguous float64 array: (size,), or (rows, size) where it streams; for each
                list of rows an int64 array.

        Returns:
            The iterations done of the outermost loop, including the one that ended it.

        Raises:
            InputError: a count or an array is missing, unknown or does not fit.
        """
        return self.bound(counts, **arrays)()

    def bound(self, counts: Mapping[str, int], /, **arrays: np.ndarray) -> Callable[[], int]:
        """`run` with these counts and arrays, checked only once, here: for many runs on the same memory.

        Lists of rows must not change; the other arrays' numbers may.

        Raises:
            InputError: as `run`.
        """
        check_run(self.plan, counts, arrays)
        return self._runner.bound(counts, arrays)
