"""`simulate_many`: studies over seeds, gains, plants and starts, several runs at once."""

import warnings
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from threading import Event
from typing import Any, Literal

import numpy as np

from cutpoint.arrays import Array
from cutpoint.callers import warn
from cutpoint.control.interface import Control, name_of
from cutpoint.control.sensors import Sensors
from cutpoint.door import check_choice, check_takes, whole
from cutpoint.errors import InputError, SimulationError, TraceError
from cutpoint.reporting.bar import Bar
from cutpoint.robot import Robot
from cutpoint.simulation.controllers import admitted
from cutpoint.simulation.inputs import Disturbance, reference_at, rows_of, sample_times
from cutpoint.simulation.log.log import Log
from cutpoint.simulation.packs import Pack, Setup, packs_of
from cutpoint.simulation.plant import State
from cutpoint.simulation.runner import UntracedControllerWarning, programs_beside_law
from cutpoint.simulation.simulate import check_kinds, prepared, simulate, steps_of
from cutpoint.simulation.steps.steps_reached import TooFew, check_steps, warn_of
from cutpoint.simulation.steps.substeps import Steps
from cutpoint.trajectories.trajectory import Moves, duration_of

MOST_NAMED = 8
"""Runs that a warning names."""


@dataclass(frozen=True, eq=False, repr=False)
class Runs(Sequence[Any]):
    """Results of runs, in order: logs, or the results of `each`.

    errors: by index, SimulationErrors of the runs that diverged or were interrupted, with the logs until then.
    runs[k] is the result of run k, or raises its error; `finished` holds those without errors.
    """

    results: tuple[Any, ...]
    errors: dict[int, SimulationError] = field(default_factory=dict[int, SimulationError])

    def __len__(self) -> int:
        return len(self.results)

    def __getitem__(self, k: Any) -> Any:
        numbers = range(len(self))[k]
        if isinstance(numbers, range):
            return [self[i] for i in numbers]
        if numbers in self.errors:
            raise self.errors[numbers]
        return self.results[numbers]

    @property
    def finished(self) -> list[Any]:
        """Results of the runs that reached their end."""
        return [x for k, x in enumerate(self.results) if k not in self.errors]

    def __repr__(self) -> str:
        return f"Runs({len(self) - len(self.errors)} of {len(self)} runs reached their end)"


def simulate_many(
    robot: Robot | Sequence[Robot],
    controller: Control | Sequence[Control | None] | None = None,
    trajectory: Moves | Sequence[Moves] | None = None,
    duration: float | None = None,
    control_period: float = 1e-3,
    initial: State | Sequence[State] | None = None,
    *,
    sensors: Sensors | Sequence[Sensors] | None = None,
    disturbances: Disturbance | Sequence[Disturbance] | None = None,
    accuracy: Literal["standard", "fine"] = "standard",
    substeps: int | None = None,
    channels: Collection[str] | None = None,
    each: Callable[[Log], Any] | None = None,
    threads: int = 1,
) -> Runs:
    """Simulate many closed loops that differ in numbers, four or eight at once in one compiled program; see `simulate`.

    robot, controller, trajectory, initial, sensors and disturbances are one for all runs, or a list or tuple with one
    per run.  Runs with different structures, mechanisms or laws are compiled and packed separately; laws that cannot be
    compiled run one by one as Python callbacks.
    duration: s; that of the longest trajectory by default.  control_period: s.  Both are the same for all runs.
    accuracy: "standard" or "fine", as for `simulate`.  substeps: by default enough for the most demanding run.
    channels: names of the channels to record, as for `simulate`; logs of 10 s with all channels take 7 MB each.
    each: a function of a log whose result is kept instead, as soon as its pack is done; it is called on the pack's
        thread, and an exception from it ends all runs and is raised.
    threads: how many packs of four or eight runs are computed at once; more than there are packs gain nothing.  Python
        callbacks run on the calling thread.
    Runs give what `simulate` gives with as many substeps, to the last bit.  One that diverges does not stop the others.
    Ctrl-C ends all runs, and the results so far are returned.
    Raises InputError for wrong arguments: no list, or lists of different lengths, among them.
    """
    given = {
        "robot": robot, "controller": controller, "trajectory": trajectory, "initial": initial, "sensors": sensors,
        "disturbances": disturbances,
    }  # fmt: skip
    runs = _dealt(given)
    threads = whole("simulate_many", "threads", threads)
    _check(runs, each, channels, accuracy)
    if duration is None:
        moves = [t for t in runs["trajectory"] if t is not None]
        duration = max((duration_of("simulate_many", t) for t in moves), default=None)
    with _in_the_name_of("simulate_many"):
        times = sample_times(None, duration, control_period)
    setups, steps = _setups(runs, times, control_period, accuracy, substeps, channels)
    settings: dict[str, object] = {"accuracy": accuracy, "substeps": steps.number, "steps_set_by": steps.cause}
    packs = packs_of(setups, _structure, times=times, steps=steps, settings=settings)
    alone = _untraceable(packs)
    too_few: dict[int, list[TooFew]] = {}
    keep = _kept(each, too_few if substeps is None else None)
    found = _run_all([pack for pack in packs if pack not in alone], times, threads, keep)
    numbers = [setup.number for pack in alone for setup in pack.setups]
    common = {"duration": float(times[-1]), "control_period": control_period, "channels": channels}
    own = {k: {name: values[k] for name, values in runs.items()} | common for k in numbers}
    found |= _one_by_one(own, steps.number, settings, keep)
    _warn_of(too_few, len(setups))
    for number in range(len(setups)):
        found.setdefault(number, SimulationError("interrupted before it ended", diverged=False))
    errors = {k: x for k, x in sorted(found.items()) if isinstance(x, SimulationError)}
    return Runs(tuple(None if k in errors else found[k] for k in range(len(setups))), errors)


def _dealt(given: dict[str, Any]) -> dict[str, list[Any]]:
    """One set of arguments for each run."""
    for name, value in given.items():
        if isinstance(value, Iterator) or (name == "controller" and isinstance(value, np.ndarray)):
            kind = type(value).__name__
            raise InputError(f"simulate_many: {name} is a {kind}; give one for all runs, or a list with one per run")
    lists = {name: value for name, value in given.items() if type(value) in (list, tuple)}
    counts = {name: len(value) for name, value in lists.items()}
    if len({*counts.values()}) != 1 or 0 in counts.values():
        told = ", ".join(f"{count} of {name}" for name, count in counts.items()) or "none"
        raise InputError(f"simulate_many: lists must have one entry per run, at least 1; there are {told}")
    n = next(iter(counts.values()))
    return {name: [*value] if name in lists else [value] * n for name, value in given.items()}


def _check(runs: dict[str, list[Any]], each: object, channels: Collection[str] | None, accuracy: str) -> None:
    """Raises InputError for an argument, of any run, of the wrong kind."""
    if each is not None:
        check_takes("simulate_many: each", each, "log")
    for number, values in enumerate(zip(*runs.values(), strict=True)):
        with _in_the_name_of(f"simulate_many: run {number}"):
            check_kinds(**{k: x for k, x in zip(runs, values, strict=True) if k != "controller"}, channels=channels)
    check_choice("simulate_many", "accuracy", accuracy, ("standard", "fine"))


@contextmanager
def _in_the_name_of(whose: str) -> Iterator[None]:
    """Errors of `simulate` are raised in the name of `simulate_many`."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{whose}: {str(error).removeprefix('simulate: ')}", **error.evidence) from None


def _setups(
    runs: dict[str, list[Any]],
    times: Array,
    period: float,
    accuracy: str,
    substeps: int | None,
    channels: Collection[str] | None,
) -> tuple[list[Setup], Steps]:
    """All runs before they start, and their common number of integration steps; shared parts are made once."""
    known: dict[Any, Any] = {}

    def once(make: Callable[..., Any], *causes: Any, given: tuple[Any, ...]) -> Any:
        key = (make, *map(id, causes))
        if key not in known:
            known[key] = make(*given)
        return known[key]

    setups: list[Setup] = []
    steps = Steps(0, "")
    for k, (robot, controller, trajectory, initial, sensors, pushed) in enumerate(zip(*runs.values(), strict=True)):
        with _in_the_name_of(f"simulate_many: run {k}"):
            rest = initial if trajectory is None else None
            reference = once(reference_at, robot.mechanism, trajectory, rest, given=(robot, trajectory, initial, times))
            law = once(admitted, robot.mechanism, controller, given=(robot, controller))
            loop, start, commanded = prepared(robot, law, period, initial, reference, sensors, channels)
            rows = once(rows_of, reference, pushed, given=(loop, times, reference, pushed))
            given = (robot, accuracy, substeps, period, start, reference)
            steps = max(steps, once(steps_of, robot, reference, initial, given=given))
            setups.append(Setup(k, loop, start, commanded, rows))
    return setups, steps


def _structure(setup: Setup) -> Any:
    """Equal for runs that one program serves."""
    return id(setup.loop.programs)


def _untraceable(packs: list[Pack]) -> list[Pack]:
    """Packs whose law cannot be compiled; compiles the programs of the others."""
    found: list[Pack] = []
    for pack in packs:
        try:
            pack.program()
        except TraceError as error:
            programs_beside_law(pack.setups[0].loop)
            name = name_of(pack.setups[0].loop.controller)
            told = f"controller {name} runs as a Python callback, run by run: {error}"
            warn(told, UntracedControllerWarning)
            found.append(pack)
    return found


def _one_by_one(
    runs: dict[int, dict[str, Any]], substeps: int, settings: dict[str, object], keep: Any
) -> dict[int, Any]:
    """Executes runs one by one until one is interrupted: each one's result, or its error."""
    found: dict[int, Any] = {}
    for number, own in runs.items():
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UntracedControllerWarning)
                log = simulate(substeps=substeps, **own)
        except SimulationError as error:
            found[number] = error
            if not error.evidence["diverged"]:  # Ctrl-C
                break
        else:
            found[number] = keep(number, replace(log, meta={**log.meta, **settings}))
    return found


def _kept(each: Callable[[Log], Any] | None, too_few: dict[int, list[TooFew]] | None) -> Callable[[int, Log], Any]:
    """A run's result from its number and log; notes runs that took too few steps."""

    def keep(number: int, log: Log) -> Any:
        if too_few is not None and log.run and (found := check_steps(log.run.robot, log)):
            too_few[number] = found
        return each(log) if each else log

    return keep


def _warn_of(too_few: dict[int, list[TooFew]], count: int) -> None:
    """Warns, in the caller's thread, of runs that took too few steps."""
    if too_few:
        numbers, more = [*map(str, sorted(too_few))], len(too_few) - MOST_NAMED
        told = ", ".join(numbers[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
        who = f"simulate_many: {'run' if len(numbers) == 1 else 'runs'} {told} of {count}"
        warn_of([each for found in too_few.values() for each in found], who)


def _run_all(packs: list[Pack], times: Array, threads: int, keep: Callable[[int, Log], Any]) -> dict[int, Any]:
    """Runs all packs on threads that release the GIL; this thread shows progress and handles Ctrl-C."""
    stop, done, found = Event(), [0] * len(packs), dict[int, Any]()
    total = float(len(packs) * times[-1])

    def task(k: int) -> dict[int, Any]:
        def goes_on(samples: int) -> bool:
            done[k] = samples
            return not stop.is_set()

        found = packs[k].run(goes_on)
        done[k] = len(times)
        return {n: x if isinstance(x, SimulationError) else keep(n, x) for n, x in found.items()}

    with Bar("simulating", total) as bar, ThreadPoolExecutor(threads) as pool:
        waiting: set[Future[dict[int, Any]]] = {pool.submit(task, k) for k in range(len(packs))}
        while waiting:
            try:
                finished, waiting = wait(waiting, 0.1, FIRST_COMPLETED)
                for future in finished:
                    found |= future.result()
                bar.show(sum(done) / len(times) * float(times[-1]))
            except KeyboardInterrupt:
                stop.set()
            except BaseException:
                stop.set()
                raise
    return found
