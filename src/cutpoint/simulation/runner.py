"""Running a closed loop: in compiled chunks of samples, one by one around a Python callback, or adaptively."""

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.callers import warn
from cutpoint.control.interface import name_of, stepped
from cutpoint.errors import TraceError
from cutpoint.joint_units import at_joints
from cutpoint.kernels import Program
from cutpoint.model.limits import looks_like_degrees
from cutpoint.reporting.bar import Bar
from cutpoint.simulation.loop.loop import ClosedLoop
from cutpoint.simulation.loop.step import TABLEAU
from cutpoint.simulation.plant import State

Integrate = Callable[[dict[str, Array], Array], None]
"""Of a loop's memory and a period's row."""

FIRST_STEPS, CHUNK_SECONDS = 500, 0.1
"""Integration steps of the first chunk; seconds of those after it."""


class UntracedControllerWarning(UserWarning):
    """A controller could not be compiled into the loop; it runs as a Python callback, slower, with the same result."""


class NoNumberError(Exception):
    """Raised for a command that is not a number.  time: s.  command: as it is recorded, or its torques."""

    def __init__(self, time: float, command: Array) -> None:
        self.time, self.command = time, command


class Outcome(NamedTuple):
    """The number of recorded samples, and what stopped the run early, if anything."""

    ticks: int
    cause: str | None = None
    diverged: bool = False


def working_memory(
    loop: ClosedLoop, start: State, commanded: Array, rows: Array, noise: Array, substeps: int
) -> dict[str, Array]:
    """All regions of the loop at the start of a run; row, noise and record have one row a sample.

    commanded: the motors' first commands, N m.
    """
    regions: dict[str, Array] = {region.name: np.zeros(region.size) for region in loop.regions()}
    regions |= first_numbers(loop, start, commanded) | shared_numbers(loop, substeps)
    return regions | {"row": rows, "noise": noise, "record": np.empty((len(rows), sum(loop.channels.values())))}


def first_numbers(loop: ClosedLoop, start: State, commanded: Array) -> dict[str, Array]:
    """Regions that are not zero at the start of a run, and are its own."""
    driven = loop.robot.machine.drives
    sample = [*start.q[[d.q for d in driven]], *start.theta, *start.v[[d.v for d in driven]], *start.theta_dot]
    line, positions = loop.encoders.at_rest(sample)
    state = np.array(loop.lanes.padded(np.concatenate(start)))
    torque = np.array(loop.lanes.padded(commanded))
    return {
        "state": state, "origin": state.copy(), "total": state.copy(), "torque": torque, "torque_before": torque.copy(),
        "line": line, "positions": positions, "memory": loop.initial_memory(),
        "parameters": loop.parameters(), "law": loop.law_parameters(), "numbers": loop.plant.numbers(),
    }  # fmt: skip


def shared_numbers(loop: ClosedLoop, substeps: int) -> dict[str, Array]:
    """Regions with the integrator's own numbers."""
    middles: Array = (np.arange(substeps, dtype=np.float64) + 0.5) * (loop.period / substeps)
    return {"elapsed": middles[:, None], "tableau": TABLEAU.copy(), "steps": np.array([loop.period / substeps])}


def run(loop: ClosedLoop, memory: dict[str, Array], substeps: int, integrate: Integrate | None) -> Outcome:
    """Runs all samples, with a progress bar if it takes long; memory holds the results so far.

    integrate: advances the state from one sample to the next; None uses fixed steps.
    """
    advance = _advance(loop, memory, substeps, integrate)
    total, done, chunk = len(memory["row"]), 0, first_chunk(substeps)
    with Bar("simulating", total * loop.period) as bar:
        try:
            while done < total:
                before = time.perf_counter()
                ticks = min(chunk, total - done)
                reached = advance(done, ticks)
                done += reached
                # nothing is computed after the last sample
                if is_no_number(memory) or (memory["fault"][0] and done < total):
                    return Outcome(done, diagnosis(loop, memory, done), diverged=True)
                chunk = next_chunk(ticks, time.perf_counter() - before)
                bar.show(done * loop.period)
        except NoNumberError as found:
            return Outcome(done + 1, _odd_command(loop, found.command, found.time), diverged=True)
        except KeyboardInterrupt:
            when = (
                f"at t = {(done - 1) * loop.period:g} s; the log holds everything until then"
                if done
                else "before it began"
            )
            return Outcome(done, f"interrupted {when}")
    return Outcome(done)


def first_chunk(substeps: int) -> int:
    """Length of the first chunk, which times the samples."""
    return max(1, FIRST_STEPS // max(substeps, 1))


def next_chunk(ticks: int, seconds: float) -> int:
    """As many samples as take about CHUNK_SECONDS, so that progress is shown and Ctrl-C is noticed."""
    return max(1, min(64 * ticks, int(ticks * CHUNK_SECONDS / max(seconds, 1e-6))))


def _advance(
    loop: ClosedLoop, memory: dict[str, Array], substeps: int, integrate: Integrate | None
) -> Callable[[int, int], int]:
    """A function (first sample, how many) -> how many were run."""
    try:
        if integrate is None:
            whole = loop.program("whole")
            return lambda first, ticks: run_samples(whole, memory, first, ticks, substeps)
        before, call = loop.program("command"), None
    except TraceError as error:
        before, after = programs_beside_law(loop, integrate)
        name = name_of(loop.controller)
        warn(f"controller {name} runs as a Python callback: {error}", UntracedControllerWarning)
        call = _callback(loop)
    else:
        after = loop.program("output")

    def one(first: int, ticks: int) -> int:
        run_samples(before, memory, first, 1)
        if call:
            memory["command"][:] = call(memory["measured"], memory["row"][first])
        run_samples(after, memory, first, 1, None if integrate else substeps)
        if integrate and first + 1 < len(memory["row"]) and not is_no_number(memory):
            integrate(memory, memory["row"][first])
        return 1

    return one


def programs_beside_law(loop: ClosedLoop, integrate: Integrate | None = None) -> tuple[Program, Program]:
    """What is run before and after a law that cannot be compiled.

    Raises TraceError if that cannot either, as with a spring of the user's own: it is not the law's fault.
    """
    return loop.program("sense"), loop.program("output" if integrate else "after")


def _callback(loop: ClosedLoop) -> Callable[[Array, Array], list[float]]:
    """The controller called on plain floats; it keeps its own memory."""
    remembered = loop.memory

    def call(measured: Array, row: Array) -> list[float]:
        nonlocal remembered
        try:
            remembered, command = stepped(loop.controller, remembered, *loop.layout.seen(measured, row, loop.period))
        except Exception as error:
            error.add_note(f"in the step of controller {name_of(loop.controller)} at t = {row[0]:g} s")
            raise
        return loop.layout.command(command, row)

    return call


def run_samples(program: Program, memory: dict[str, Array], first: int, ticks: int, substeps: int | None = None) -> int:
    """Runs these samples; without substeps, the program does not integrate."""
    there = memory | {name: memory[name][first : first + ticks] for name in ("row", "noise", "record")}
    regions = {name: there[name] for name in program.plan.names}
    return program.run({"ticks": ticks} if substeps is None else {"ticks": ticks, "substeps": substeps}, **regions)


def is_no_number(memory: dict[str, Array]) -> bool:
    """Whether the last command, or its motor reference, is not a number for some drive."""
    return bool(np.isnan(memory["command"][:-1]).any())


def diagnosis(loop: ClosedLoop, memory: dict[str, Array], done: int) -> str:
    """When the state diverged and its largest component then, or one sample earlier if the state is not a number.

    If the command was not finite, that is reported instead.
    """
    command = memory["command"][:-1]
    if not np.isfinite(command).all():
        return _odd_command(loop, command, (done - 1) * loop.period)
    state = np.array(loop.lanes.dense(memory["state"]))
    if np.isfinite(state).all():
        found = _largest(loop, state)
    elif loop.kept is None:
        found = (
            f"the state is not finite; one sample earlier {_largest(loop, memory['record'][done - 1, : len(state)])}"
        )
    else:
        found = "the state is not finite"
    remedy = "lower the gains (or the rates of a law that learns), check the sides they act on, or use more substeps"
    return f"diverged at t = {done * loop.period:g} s: {found}; {_of_degrees(loop, memory['row'])}{remedy}"


def _of_degrees(loop: ClosedLoop, rows: Array) -> str:
    """What to say first of a reference that looks like degrees; nothing of others."""
    furthest = np.abs(loop.layout.references(rows)[0]).max(axis=0)
    for name, x in zip(loop.robot.drives, furthest.tolist(), strict=True):
        if looks_like_degrees(loop.robot.mechanism, name, x):
            told = f"the reference of {name!r} reaches {x:g} rad, which looks like degrees"
            return f"{told}: give radians (numpy.radians); if it is no mistake, "
    return ""


def _odd_command(loop: ClosedLoop, command: Array, time: float) -> str:
    worst = int((~np.isfinite(command)).argmax())
    part, drive = divmod(worst, loop.layout.n)
    joint, sides = [*loop.robot.drives][drive], loop.encoders.sides
    what = f"{('torque', 'feedforward', 'theta', 'theta_dot')[part]} {command[worst]}"
    told = f"controller {name_of(loop.controller)} commands {what} for {joint!r} at t = {time:g} s"
    why = f"; sensors are on the {sides} side only, so it reads NaN for the other" if sides != "both" else ""
    return f"{told}, which is not a finite number{why}"


def _largest(loop: ClosedLoop, state: Array) -> str:
    worst = int(np.abs(state).argmax())
    what, unit = _slots(loop)[worst]
    return f"{what} is {state[worst]:.3g} {unit}"


def _slots(loop: ClosedLoop) -> list[tuple[str, str]]:
    """Name and unit of each number of the state."""
    robot = loop.robot
    lags = [name for name, drive in robot.drives.items() if drive.has_current_lag]
    angles, torques = at_joints(robot, "rad"), at_joints(robot, "N m")
    inner = [(f"motor torque of {name!r}", torques[name]) for name in lags]
    for name, what in (whole.rsplit(": ", 1) for whole in robot.strain_names):
        inner.append((f"strain of {what} of {name!r}", angles[name]))
    q, v = [("", "")] * robot.nq, [("", "")] * robot.nv
    for body, segment in zip(robot.mechanism.bodies, robot.machine.system.segments, strict=True):
        for whole, own, what in ((q, segment.q, "coordinate"), (v, segment.v, "speed")):
            whole[own] = [(f"{what} of joint {body.joint.name!r}", "")] * (own.stop - own.start)
    theta: list[tuple[str, str]] = []
    theta_dot: list[tuple[str, str]] = []
    for name, driven in zip(robot.drives, robot.machine.drives, strict=True):
        unit = angles[name]
        q[driven.q], v[driven.v] = (f"position of {name!r}", unit), (f"speed of {name!r}", f"{unit}/s")
        theta.append((f"motor position of {name!r}", unit))
        theta_dot.append((f"motor speed of {name!r}", f"{unit}/s"))
    return [*q, *v, *theta, *theta_dot, *inner]
