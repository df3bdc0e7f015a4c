"""The closed loop as stages over memory: sense, control, actuate, record, integrate.

Stages read and write flat lists of scalars; `kernels.programs` compiles them into one function that runs any number of
control periods, or runs them in Python if they cannot be compiled.
"""

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control.held_state import as_it_was
from cutpoint.control.interface import numbers_after, stepped
from cutpoint.control.sensors import SAMPLED, Encoders
from cutpoint.errors import TraceError
from cutpoint.kernels import Loop, Program, Region, Stage, compile_program
from cutpoint.mechanics.drives.motor import within_limits
from cutpoint.robot import Robot
from cutpoint.scalars import Scalar, absolute, clip, leaves, rebuild, where
from cutpoint.simulation.log.channels import absent_from, recordable, recorded_for
from cutpoint.simulation.loop.lanes import Lanes
from cutpoint.simulation.loop.layout import Layout
from cutpoint.simulation.loop.parameters import Given, law_parameters, parameters_of, with_parameters
from cutpoint.simulation.loop.stages import PlantStages
from cutpoint.simulation.loop.step import TABLEAU
from cutpoint.simulation.plant import Lengths, by_drive, is_uniform, lengths

Scalars = list[Scalar]

BEYOND = 1e6
"""A state (rad, rad/s, m, m/s) larger than this has diverged."""

INTEGRATION = ("origin", "total", "resistance", "earlier", "tableau", "elapsed", "turns", "efforts", "accelerations",
               "steps")  # fmt: skip
"""Regions that only the fixed steps use."""

LINE = ("line",)
"""Delayed readings: only what comes before the controller uses them, a row for each period of delay."""

FELT = {"motor_torque", "joint_torque", "friction_torque", "motor_friction_torque"}
"""Channels that `PlantStages.feel` finds."""


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """One robot, one controller and one set of sensors as stages.

    memory: the controller's memory at the start, a record.  programs: those compiled so far for loops of this
    structure.  refusal: why the controller cannot be compiled, where that is known.
    runs: how many runs of this structure go side by side, in lanes.  own_rows: whether each has a reference and
    disturbances of its own, or all the same.  own_laws: whether each has a law with numbers of its own.
    kept: the log's channels that are wanted; None for all.
    """

    robot: Robot
    controller: Any
    encoders: Encoders
    memory: Any
    period: float
    programs: dict[Hashable, Program]
    refusal: TraceError | None = None
    runs: int = 1
    own_rows: bool = False
    own_laws: bool = False
    kept: frozenset[str] | None = None

    @cached_property
    def lengths(self) -> Lengths:
        """Length of each part of the state."""
        return lengths(self.robot.machine)

    @cached_property
    def layout(self) -> Layout:
        return Layout(len(self.robot.drives), self.lengths.v, sum(self.lengths), self.encoders.normals)

    @cached_property
    def plant(self) -> PlantStages:
        return PlantStages(self.robot, self.layout, self.lanes)

    @cached_property
    def lanes(self) -> Lanes:
        """Lanes of drives, if these are uniform and runs are not side by side."""
        return Lanes.of(self.layout.n, self.runs == 1 and is_uniform(self.robot.machine))

    @cached_property
    def channels(self) -> dict[str, int]:
        """What is recorded each period, with its length, in order."""
        if self.kept is None:
            return self._recordable
        absent = absent_from(self.robot, self._recordable, reports=getattr(self.controller, "reports_faults", False))
        return recorded_for(self.kept, self._recordable, absent)

    @cached_property
    def _recordable(self) -> dict[str, int]:
        return recordable(self.lengths._asdict(), self.layout.n, self.layout.nv)

    def parameters(self) -> Array:
        return parameters_of(self.robot, self.encoders, self.period)

    def law_parameters(self) -> Array:
        return law_parameters(self.controller, self.period)

    def regions(self) -> list[Region]:
        n, nv, state, lanes = self.layout.n, self.layout.nv, self.layout.state, self.lanes
        laned = {
            "state": state, "origin": state, "total": state, "torque": n, "torque_before": n, "felt": 4 * n,
            "resistance": 6 * n, "earlier": 6 * n, "efforts": 3 * n, "accelerations": nv + n,
            "turns": 2 * n if self.plant.knows_turns else 0,
            "numbers": len(self.robot.drive_parameters) if lanes.are_wide else 0,
        }  # fmt: skip
        plain = {
            "row": self.layout.row, "measured": 4 * n, "line": 4 * n if self.encoders.delay else 0,
            "positions": 2 * n if self.encoders.differenced else 0,
            "memory": len(leaves(self.memory)), "command": 4 * n + 1, "elapsed": 1,
            "parameters": len(self.parameters()), "law": len(self.law_parameters()),
            "tableau": TABLEAU.shape[1], "record": sum(self.channels.values()), "fault": 1, "steps": 1,
            "noise": self.layout.noise,
        }  # fmt: skip
        runs = {name: 1 if name in self.shared else self.runs for name in plain}
        drives = [Region(name, lanes.size(size) * self.runs, lanes.width * self.runs) for name, size in laned.items()]
        return drives + [Region(name, size * runs[name], runs[name]) for name, size in plain.items()]

    @property
    def shared(self) -> tuple[str, ...]:
        """Regions that runs side by side have in common."""
        own = {"row": self.own_rows, "law": self.own_laws}
        return ("elapsed", "tableau", "steps", *(name for name, is_own in own.items() if not is_own))

    def initial_memory(self) -> Array:
        return np.array(leaves(self.memory), float)

    # stages

    def sense(self, state: Scalars, noise: Scalars, parameters: Scalars) -> Scalars:
        """What the encoders read of the state."""
        given = self._given(parameters)
        places = [own.at for own in by_drive(given.machine, self.lanes.dense(state))]
        return given.encoders.read([getattr(at, name) for name in SAMPLED for at in places], noise)

    def difference(self, measured: Scalars, positions: Scalars, parameters: Scalars) -> tuple[Scalars, Scalars]:
        """The measurement with speeds from positions; and its positions, for the next one."""
        given = self._given(parameters)
        return given.encoders.difference(measured, positions, given.period)

    def control(self, measured: Scalars, memory: Scalars, row: Scalars, law: Scalars) -> tuple[Scalars, Scalars]:
        """Command: torque, the part of it that is feedforward, motor reference and its speed; and a fault."""
        numbers, before = iter(law), rebuild(self.memory, iter(memory))
        controller, period = rebuild(self.controller, numbers), next(numbers)
        after, command = stepped(controller, before, *self.layout.seen(measured, row, period))
        return self.layout.command(command, row), numbers_after(controller, after, len(memory))

    def actuate(
        self, state: Scalars, command: Scalars, torque: Scalars, parameters: Scalars
    ) -> tuple[Scalars, Scalars]:
        """The motors' commands, N m, within the limits of drive, current and voltage; and their previous commands.

        A command that is NaN passes all limits as NaN.
        """
        given = self._given(parameters)
        own = by_drive(given.machine, self.lanes.dense(state))
        motors = zip(given.machine.drives, own, command[: self.layout.n], given.limits, strict=True)
        limited = [clip(within_limits(d.drive, u, own.at.theta_dot), -limit, limit) for d, own, u, limit in motors]
        return self.lanes.padded(limited), torque

    def record(self, *regions: Scalars) -> Scalars:
        """The recorded quantities of a sample."""
        numbers = iter(self.plant.record(*regions))
        found = {name: [next(numbers) for _ in range(size)] for name, size in self._recordable.items()}
        return [x for name in self.channels for x in found[name]]

    def watch(self, state: Scalars, command: Scalars, fault: Scalars) -> Scalars:
        """Nonzero once the state has diverged, or state or command is not finite."""
        found = fault[0]
        for x in command[self.layout.n : -1]:  # torque that is not finite shows in the state
            found = where(absolute(x) < np.inf, found, 1)
        for x in self.lanes.dense(state):
            found = where(x * x < BEYOND * BEYOND, found, 1)
        return [found]

    # programs

    def program(self, part: Literal["whole", "sense", "command", "after", "output"]) -> Program:
        """The compiled loop, or a part of what happens each sample.

        sense: before the controller.  command: sense, and the controller.  after: all that follows.  output: what
        follows, but for integration.  Raises TraceError for the whole or a command if the controller cannot be traced.
        """
        if self.refusal and part in ("whole", "command"):
            raise self.refusal
        key = (part, self.runs, self.own_rows, self.own_laws, self.kept)
        if key not in self.programs:
            body = {
                "whole": [*self._before, self._control, *self._after],
                "sense": self._before,
                "command": [*self._before, self._control],
                "after": self._after,
                "output": self._output,
            }[part]
            until = "fault" if self.runs == 1 else None  # runs side by side do not stop for one of them
            ticks = Loop("ticks", body, streams=("row", "noise", "record"), until=until)
            unused = {"whole": (), "after": LINE, "output": INTEGRATION + LINE}.get(part, INTEGRATION)
            regions = [region for region in self.regions() if region.name not in unused]
            with as_it_was(self.controller):
                self.programs[key] = compile_program(ticks, regions, self.robot.backend, name="the closed loop")
        return self.programs[key]

    @property
    def _before(self) -> list[Stage | Loop]:
        place, positions = ("measured", "line"), ("measured", "positions")
        line = Loop(self.encoders.delay, [Stage(passed_on, place, place, self.runs)], streams=("line",))
        difference = Stage(self.difference, (*positions, "parameters"), positions, self.runs)
        return [
            Stage(self.sense, ("state", "noise", "parameters"), ("measured",), self.runs),
            *([line] if self.encoders.delay else []),
            *([difference] if self.encoders.differenced else []),
        ]

    @property
    def _control(self) -> Stage:
        return Stage(self.control, ("measured", "memory", "row", "law"), ("command", "memory"), self.runs)

    @property
    def _output(self) -> list[Stage | Loop]:
        plant, runs = self.plant, self.runs
        feel = ("state", "torque", "torque_before", self._numbers_of_drives)
        return [
            Stage(self.actuate, ("state", "command", "torque", "parameters"), ("torque", "torque_before"), runs),
            *([Stage(plant.feel, feel, ("felt",), self._width)] if self.channels.keys() & FELT else []),
            Stage(self.record, ("state", "measured", "command", "felt"), ("record",), runs),
        ]

    @property
    def _after(self) -> list[Stage | Loop]:
        integrate = Loop("substeps", self._step, streams=("elapsed",))
        return [*self._output, integrate, Stage(self.watch, ("state", "command", "fault"), ("fault",), self.runs)]

    @property
    def _step(self) -> list[Stage | Loop]:
        plant, numbers, width = self.plant, self._numbers_of_drives, self._width
        drive = ("state", "origin", "torque", "torque_before", "resistance", "earlier", "elapsed", numbers, "steps")
        accelerate = ("state", "turns", "resistance", "efforts", "row", "parameters")
        advance = ("state", "origin", "total", "earlier", "tableau", "efforts", "accelerations", "steps")
        turn = [Stage(plant.turn, ("state",), ("turns",), width)] if plant.knows_turns else []
        stages = [
            *turn,
            Stage(plant.drive, drive, ("efforts",), width),
            Stage(plant.accelerate, accelerate, ("accelerations",), self.runs),
            Stage(plant.advance, advance, ("state", "total", "earlier"), width),
        ]
        return [
            Stage(plant.resist, ("state", "torque", numbers, "steps"), ("resistance",), width),
            Loop(len(TABLEAU), stages, streams=("tableau",)),
            Stage(plant.settle, ("total", "origin", numbers), ("state", "origin", "total"), width),
        ]

    @property
    def _width(self) -> int:
        """Lanes of stages that drives go through: of drives, or of runs."""
        return self.lanes.width * self.runs

    @property
    def _numbers_of_drives(self) -> str:
        return "numbers" if self.lanes.are_wide else "parameters"

    def _given(self, numbers: Scalars) -> Given:
        return with_parameters(self.robot, self.encoders, numbers)


def passed_on(reading: Scalars, waiting: Scalars) -> tuple[Scalars, Scalars]:
    """One place of the line of delayed readings: the one that waits there leaves, and this one waits instead."""
    return waiting, reading
