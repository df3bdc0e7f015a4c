"""Runs of one structure in the lanes of one program: a pack.  Each gives the same result as alone, to the last bit."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import SimulationError
from cutpoint.kernels import Program
from cutpoint.kernels.arrays.backends import numbers_at_once
from cutpoint.simulation.inputs import noise_of
from cutpoint.simulation.log.log import Log
from cutpoint.simulation.loop.loop import ClosedLoop
from cutpoint.simulation.loop.noise import BLOCK, Noise
from cutpoint.simulation.plant import State
from cutpoint.simulation.recording import log_of
from cutpoint.simulation.runner import (
    first_chunk,
    first_numbers,
    next_chunk,
    run,
    run_samples,
    shared_numbers,
    working_memory,
)
from cutpoint.simulation.steps.substeps import Steps

BUFFER = 4 * BLOCK
"""Samples whose noise and record a pack holds at a time, so that a cache does."""


@dataclass(frozen=True, eq=False)
class Setup:
    """A run before it starts.

    number: among all runs.  commanded: motor commands until the first sample, N m.  rows (N, ...) may be shared with
    other runs.
    """

    number: int
    loop: ClosedLoop
    start: State
    commanded: Array
    rows: Array


@dataclass(frozen=True, eq=False)
class Pack:
    """Setups of one structure, one lane each; unused lanes repeat the last.

    own_rows, own_laws: see `ClosedLoop`.  times (N,), s; settings go into the logs.
    """

    setups: Sequence[Setup]
    lanes: int
    own_rows: bool
    own_laws: bool
    times: Array
    steps: Steps
    settings: dict[str, object]

    def program(self) -> Program:
        """The pack's program, compiled at first use.  Raises TraceError for a law that cannot be compiled."""
        return self._loop(self.setups[0]).program("whole")

    def run(self, goes_on: Callable[[int], bool]) -> dict[int, Log | SimulationError]:
        """All runs' logs or errors; goes_on gets the number of samples done, and may stop the pack."""
        program, memory, noise = self.program(), self._memory(), self._noise()
        beside = memory["record"].reshape(BUFFER, -1, self.lanes)
        records = [np.empty((len(self.times), beside.shape[1])) for _ in self.setups]
        total, done, chunk = len(self.times), 0, first_chunk(self.steps.number)
        while done < total and goes_on(done):
            first = done % BUFFER
            if first == 0:
                memory["row"] = self._rows(done)
                noise.fill(memory["noise"])
            before, ticks = time.perf_counter(), min(chunk, BUFFER - first, total - done)
            run_samples(program, memory, first, ticks, self.steps.number)
            for k, record in enumerate(records):
                record[done : done + ticks] = beside[first : first + ticks, :, k]
            done += ticks
            chunk = next_chunk(ticks, time.perf_counter() - before)
        found = zip(self.setups, records, memory["fault"], strict=False)
        return {setup.number: self._outcome(setup, own, done, bool(fault)) for setup, own, fault in found}

    def _loop(self, setup: Setup) -> ClosedLoop:
        return replace(setup.loop, runs=self.lanes, own_rows=self.own_rows, own_laws=self.own_laws)

    def _memory(self) -> dict[str, Array]:
        """Regions with the runs' numbers side by side, except rows; those with a row per sample have BUFFER rows."""
        loops = [self._loop(s) for s in self._filled]
        regions = {region.name: region.size for region in loops[0].regions()}
        own = [first_numbers(x, s.start, s.commanded) for x, s in zip(loops, self._filled, strict=True)]
        memory: dict[str, Array] = {name: np.zeros(size) for name, size in regions.items()}
        for name, numbers in own[0].items():
            memory[name] = numbers if name in loops[0].shared else _beside([x[name] for x in own])
        memory |= {name: np.empty((BUFFER, regions[name])) for name in ("noise", "record")}
        return memory | shared_numbers(loops[0], self.steps.number)

    def _rows(self, first: int) -> Array:
        """Inputs of the next BUFFER control periods."""
        rows = [s.rows[first : first + BUFFER] for s in self._filled]
        return _beside(rows) if self.own_rows else rows[0]

    def _noise(self) -> Noise:
        loops = [s.loop for s in self._filled]
        return Noise([x.encoders.seed for x in loops], loops[0].layout.noise, loops[0].robot.backend)

    @property
    def _filled(self) -> list[Setup]:
        """The setups, lane by lane."""
        return [*self.setups, *[self.setups[-1]] * (self.lanes - len(self.setups))]

    def _outcome(self, setup: Setup, record: Array, done: int, failed: bool) -> Log | SimulationError:
        """The run's log, or an error that holds the log so far."""
        loop, cause = setup.loop, None
        if not done:
            return SimulationError("interrupted before it began", diverged=False)
        if failed and (again := self._again(setup))[-1]:  # empty if the run failed after its last sample
            loop, record, done, cause = again
        elif done < len(self.times):
            cause = f"interrupted at t = {self.times[done - 1]:g} s; the log holds everything until then"
        log = log_of(loop, record[:done], self.times, setup.rows, self.settings)
        if cause is None:
            return log
        return SimulationError(cause, log=log, time=float(self.times[done - 1]), diverged=failed)

    def _again(self, setup: Setup) -> tuple[ClosedLoop, Array, int, str | None]:
        """Repeats a failed run alone up to the failure, with all channels: loop, record, number of samples, reason."""
        loop, steps = replace(setup.loop, kept=None), self.steps.number
        noise = noise_of(loop, len(self.times))
        memory = working_memory(loop, setup.start, setup.commanded, setup.rows, noise, steps)
        outcome = run(loop, memory, steps, None)
        return loop, memory["record"], outcome.ticks, outcome.cause


def _beside(numbers: Sequence[Array]) -> Array:
    """Numbers of several runs, (..., n) each, side by side: number f of run l is at f * runs + l."""
    *rows, n = numbers[0].shape
    return np.stack(numbers, axis=-1).reshape(*rows, n * len(numbers))


def packs_of(setups: Sequence[Setup], structure: Callable[[Setup], Any], **common: Any) -> list[Pack]:
    """Setups of one structure together, in their order."""
    groups: dict[Any, list[Setup]] = {}
    for setup in setups:
        groups.setdefault(structure(setup), []).append(setup)
    packs: list[Pack] = []
    for group in groups.values():
        own_rows = len({id(s.rows) for s in group}) > 1
        own_laws = len({s.loop.law_parameters().tobytes() for s in group}) > 1
        lanes = numbers_at_once(group[0].loop.robot.backend)
        packs += [Pack(group[k : k + lanes], lanes, own_rows, own_laws, **common) for k in range(0, len(group), lanes)]
    return packs
