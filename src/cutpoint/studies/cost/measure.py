"""Counting and timing: contenders agree first, then run in turns on the same random motions."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import CutpointError
from cutpoint.kernels import Kernel, compile, graph_of
from cutpoint.kernels.machine.cache import not_kept
from cutpoint.studies.cost.chains import random_machine
from cutpoint.studies.cost.contenders import CONTENDERS, JETS, VD, Contender, arithmetic
from cutpoint.studies.cost.timing import Timing, in_turns

ARM = 6
"""Joints up to which every contender is timed, whatever the limits: the arm that the findings speak of."""

BATCH = 64
AGREEMENT = 1e-10
"""Largest difference of torques, as a share of the largest torque."""

COMPILE_LIMIT, STUDY_LIMIT = 5.0, 90.0
"""s, for one contender's code, and from the study's start: whoever is beyond is counted and not timed."""

_GROWTH = 1.5
"""Compile time grows by about this power of the number of operations."""


@dataclass
class Cost:
    """Of one contender, by number of joints.

    operations: see `arithmetic`.  single: one call from Python.  batched: one of BATCH in one call.  seconds: to trace
    and compile.
    """

    operations: dict[int, int] = field(default_factory=dict[int, int])
    single: dict[int, Timing] = field(default_factory=dict[int, Timing])
    batched: dict[int, Timing] = field(default_factory=dict[int, Timing])
    seconds: dict[int, float] = field(default_factory=dict[int, float])

    def least_times(self) -> dict[int, float]:
        """Least times of one in a batch, ns, which other work on the machine disturbs least."""
        return {n: timing.least for n, timing in self.batched.items()}

    def may_compile(self, operations: int) -> bool:
        """Whether that many operations will compile within COMPILE_LIMIT, judging by the last that did."""
        if not self.seconds:
            return True
        last = max(self.seconds)
        return self.seconds[last] * (operations / self.operations[last]) ** _GROWTH < COMPILE_LIMIT


def measured(sizes: Sequence[int], advance: Callable[[int], None]) -> dict[str, Cost]:
    """The cost of every contender at these numbers of joints, as far as the limits allow; advance hears of each."""
    costs, end = {c.key: Cost() for c in CONTENDERS}, time.perf_counter() + STUDY_LIMIT
    for n in sizes:
        machine, kernels = random_machine(n), dict[Contender, Kernel]()
        for contender in (c for c in CONTENDERS if n <= c.largest):
            cost, function = costs[contender.key], contender.on(machine)
            inputs = dict.fromkeys(contender.motion, n)
            operations = arithmetic(graph_of(function, **inputs))
            allowed = cost.may_compile(operations) and time.perf_counter() < end
            if n <= ARM or (allowed and _reference(contender) in (contender, *kernels)):
                with not_kept():
                    kernels[contender] = compile(function, name=contender.key, backend="auto", **inputs)
                cost.seconds[n] = kernels[contender].compile_seconds
            cost.operations[n] = operations
        motions = np.random.default_rng(n).normal(size=(5, BATCH, n))
        check_agreement(kernels, motions)
        single, batched = in_turns(_calls(kernels, motions[:, :1])), in_turns(_calls(kernels, motions), BATCH)
        for key in single:
            costs[key].single[n], costs[key].batched[n] = single[key], batched[key]
        advance(n)
    return costs


def check_agreement(kernels: dict[Contender, Kernel], motions: Array) -> None:
    """Raises CutpointError unless all torques of these motions (5, N, n) are those of virtual decomposition."""
    torques = {c: kernel(*motions[: len(c.motion)]) for c, kernel in kernels.items()}
    for contender, tau in torques.items():
        expected = torques[_reference(contender)]
        if not np.abs(tau - expected).max() <= AGREEMENT * np.abs(expected).max():
            raise CutpointError(
                f"{contender.name}: torques of {tau.shape[-1]} joints differ from those of virtual decomposition by "
                f"{np.abs(tau - expected).max():.2g} N m, more than {AGREEMENT:g} of the largest; nothing was timed"
            )


def _reference(contender: Contender) -> Contender:
    """The contender with the reference torques."""
    return JETS if contender.elastic else VD


def _calls(kernels: dict[Contender, Kernel], motions: Array) -> dict[str, Callable[[], object]]:
    out = np.empty(motions.shape[1:])
    return {c.key: partial(kernel, *motions[: len(c.motion)], out=out) for c, kernel in kernels.items()}
