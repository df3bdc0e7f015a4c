"""The closed loop as stages over memory: sense, control, actuate, record, integrate.

What the stages read and write are flat lists of scalars; `kernels.program` compiles them into one function that runs
any number of control periods, or runs them as they are where nothing can be compiled.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cutpoint.control.interface import Command, Measurement, Reference, as_command
from cutpoint.definitions import Machine
from cutpoint.kernels import Loop, Program, Region, Stage, compile_program
from cutpoint.mechanics import strains
from cutpoint.mechanics.elastic import Effort, drive_effort, driven_accelerations
from cutpoint.mechanics.motor import within_limits
from cutpoint.robot import Robot
from cutpoint.scalars import Scalar, clip, leaves, rebuild, where, with_float_leaves
from cutpoint.simulation.integrator import TABLEAU, stage
from cutpoint.simulation.lanes import Lanes
from cutpoint.simulation.plant import (
    all_rates,
    arrived,
    currents,
    drive_rates,
    has_delay,
    is_uniform,
    motor_torque,
    own_of,
    own_parts,
    own_rates,
    settled,
    sizes,
    split,
)
from cutpoint.simulation.sensors import Encoders

Array = NDArray[np.float64]
Scalars = list[Scalar]

BEYOND = 1e6
"""A state (rad, rad/s, m, m/s) larger than this has diverged."""


INTEGRATION = ("origin", "total", "tableau", "elapsed", "efforts", "accelerations", "numbers", "steps")
"""Regions that only the fixed steps use."""


@dataclass(frozen=True)
class Layout:
    """Where things stand in the regions: n drives, nv speeds; how long a state and a sample's noise are."""

    n: int
    nv: int
    state: int
    noise: int

    @property
    def row(self) -> int:
        """Per control period: time, reference with four derivatives, disturbance, noise."""
        return 1 + 5 * self.n + self.nv + self.noise

    def reference(self, row: Scalars) -> Reference:
        """The links' reference of a row; until a law makes a better one, the motors' is the same."""
        q, v, a, jerk, snap = (array_of(row[1 + k * self.n : 1 + (k + 1) * self.n]) for k in range(5))
        return Reference(q, v, a, jerk, snap, q, v)

    def disturbance(self, row: Scalars) -> Scalars:
        return row[1 + 5 * self.n : 1 + 5 * self.n + self.nv]

    def normals(self, row: Scalars) -> Scalars:
        return row[1 + 5 * self.n + self.nv :]


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """One robot, one controller and one set of sensors as stages.

    memory: the controller's memory at the start, a record.  parameters: numbers of drives, controller, sensors, torque
    limits, then the control period.  programs: those compiled so far for loops of this structure.
    """

    robot: Robot
    controller: Any
    encoders: Encoders
    memory: Any
    period: float
    programs: dict[str, Program]

    @cached_property
    def layout(self) -> Layout:
        n, parts = len(self.robot.drives), sizes(self.robot.machine)
        return Layout(n, parts.v, sum(parts), 2 * n if self.encoders.is_noisy else 0)

    @cached_property
    def lanes(self) -> Lanes:
        """All drives side by side where they are alike."""
        return Lanes.of(self.layout.n, is_uniform(self.robot.machine))

    @cached_property
    def channels(self) -> dict[str, int]:
        """What is recorded each period, with its length, in order."""
        n, nv = self.layout.n, self.layout.nv
        return {
            **sizes(self.robot.machine)._asdict(), "measured_q": n, "measured_theta": n, "measured_v": n,
            "measured_theta_dot": n, "command_torque": n, "feedforward_torque": n, "motor_reference": n,
            "motor_speed_reference": n, "motor_torque": n, "joint_torque": n, "friction_torque": nv,
        }  # fmt: skip

    def parameters(self, limits: Array) -> Array:
        parts = [leaves(self.controller), leaves(self.encoders), limits, [self.period]]
        return np.concatenate([self.robot.drive_parameters, *(np.array(p, float) for p in parts)])

    def regions(self) -> list[Region]:
        n, record = self.layout.n, sum(self.channels.values())
        state, lanes = self.layout.state, self.lanes
        laned = {
            "state": state, "origin": state, "total": state, "torque": n, "torque_before": n, "efforts": 4 * n,
            "accelerations": self.layout.nv + n,
            "numbers": len(self.robot.drive_parameters) if lanes.are_wide else 0,
        }  # fmt: skip
        sizes = {
            "row": self.layout.row, "sensing": len(self.encoders.memory(*[[0.0] * n] * 4)), "measured": 4 * n,
            "memory": len(leaves(self.memory)),
            "command": 4 * n, "elapsed": 1, "parameters": len(self.parameters(np.zeros(n))), "tableau": 2,
            "record": record, "fault": 1, "steps": 1,
        }  # fmt: skip
        drives = [Region(name, lanes.size(size), lanes.width) for name, size in laned.items()]
        return drives + [Region(name, size) for name, size in sizes.items()]

    def numbers(self) -> Array:
        """The drives' parameters lane by lane, where all drives are alike."""
        if not self.lanes.are_wide:
            return np.zeros(0)
        by_field = self.robot.drive_parameters.reshape(self.layout.n, -1).T.ravel()
        return np.array(self.lanes.padded(by_field, repeat=True))

    def initial_memory(self) -> Array:
        return np.array(leaves(self.memory), float)

    # stages

    def sense(self, state: Scalars, sensing: Scalars, row: Scalars, parameters: Scalars) -> tuple[Scalars, Scalars]:
        machine, _, encoders, _, period = self._numbers(parameters)
        places = [own.at for own in own_parts(machine, self.lanes.dense(state))]
        sample = [getattr(at, name) for name in ("q", "theta", "v", "theta_dot") for at in places]
        return encoders.measure(sample, sensing, self.layout.normals(row), period)

    def control(self, measured: Scalars, memory: Scalars, row: Scalars, parameters: Scalars) -> tuple[Scalars, Scalars]:
        """Command: torque, the part of it that is feedforward, motor reference and its speed."""
        _, controller, _, _, period = self._numbers(parameters)
        before = rebuild(self.memory, iter(memory))
        after, command = controller.step(before, *self.seen(measured, row, period))
        return self.command_of(as_command(command), row), leaves(with_float_leaves(after))

    def actuate(
        self, state: Scalars, command: Scalars, torque: Scalars, parameters: Scalars
    ) -> tuple[Scalars, Scalars]:
        """What motors are told, within what drive, current and voltage allow, N m; and what they were told before."""
        machine, _, _, limits, _ = self._numbers(parameters)
        own = own_parts(machine, self.lanes.dense(state))
        motors = zip(machine.drives, own, command[: self.layout.n], limits, strict=True)
        told = [clip(within_limits(d.drive, u, own.at.theta_dot), -limit, limit) for d, own, u, limit in motors]
        return self.lanes.padded(told), torque

    def record(self, *regions: Scalars) -> Scalars:
        """What the log keeps of a sample; a command that is still on its way to the motor is not there yet."""
        state, measured, command, torque, before, parameters = regions
        machine = self._numbers(parameters)[0]
        shaft, driving, friction = [], [], [0] * machine.system.nv
        state, torque, before = (self.lanes.dense(region) for region in (state, torque, before))
        for d, own, u, old in zip(machine.drives, own_parts(machine, state), torque, before, strict=True):
            shaft.append(motor_torque(d.drive, own, old if has_delay(d.drive) else u)[0])
            effort = drive_effort(d.drive, own.at, shaft[-1], own.strains)
            driving.append(effort.transmitted)
            friction[d.v] = effort.transmitted - effort.on_link
        return [*state, *measured, *command, *shaft, *driving, *friction]

    def drive(self, *regions: Scalars) -> Scalars:
        """What the drives do, field by field; where they are alike, seen from one of them."""
        state, origin, torque, before, elapsed, parameters, steps = regions
        if self.lanes.are_wide:
            drives = [rebuild(self.robot.machine.drives[0].drive, iter(parameters))]
            own, past = [own_of(drives[0], state)], [own_of(drives[0], origin)]
        else:
            machine = self._numbers(parameters)[0]
            drives = [d.drive for d in machine.drives]
            own, past = own_parts(machine, state), own_parts(machine, origin)
        fields: list[Scalars] = []
        for d, now, start, u, old in zip(drives, own, past, torque, before, strict=True):
            effort, electric = drive_rates(d, now, start, arrived(d, u, old, elapsed[0], steps[0]))
            fields.append([effort.on_link, effort.left, effort.alpha, *(electric or [0])])
        return [x for field in zip(*fields, strict=True) for x in field]

    def accelerate(self, *regions: Scalars) -> Scalars:
        """Accelerations of links, then of motors, under what the drives do."""
        state, found, row, parameters = regions
        machine, n = self._numbers(parameters)[0], self.layout.n
        found, s = self.lanes.dense(found), split(machine, self.lanes.dense(state))
        on_link, left, alpha = (found[k * n : (k + 1) * n] for k in range(3))
        efforts = [Effort(*x, None) for x in zip(on_link, left, alpha, strict=True)]
        pushed = self.layout.disturbance(row)
        a, theta_ddot = driven_accelerations(*machine, s.q, s.v, s.theta_dot, efforts, pushed)
        return self.lanes.padded([*a, *theta_ddot])

    def advance(self, *regions: Scalars) -> tuple[Scalars, Scalars]:
        """One stage of an integration step; where all drives are alike, seen from one of them."""
        state, origin, total, tableau, found, accelerations, steps = regions
        h = steps[0]
        if self.lanes.are_wide:
            (a, alpha), drive = accelerations, self.robot.machine.drives[0].drive
            k = own_rates(drive, state, a, alpha, found[3])
        else:
            machine, n, nv = self.robot.machine, self.layout.n, self.layout.nv
            electric = [x for d, x in zip(machine.drives, found[3 * n :], strict=True) if currents(d.drive)]
            s = split(machine, state)
            k = [*all_rates(machine, s, accelerations[:nv], accelerations[nv:], electric), *[0] * len(s.strains)]
        return stage(k, origin, total, tableau, h)

    def settle(self, total: Scalars, origin: Scalars, parameters: Scalars) -> tuple[Scalars, Scalars, Scalars]:
        """The step's result, with the strains that it has left, is the next step's start; as seen by `drive`."""
        if self.lanes.are_wide:
            drive = rebuild(self.robot.machine.drives[0].drive, iter(parameters))
            own, past = own_of(drive, total), own_of(drive, origin)
            left = strains.flat(strains.moved(drive, past.strains, past.at, own.at))
            after = [*total[: len(total) - len(left)], *left]
        else:
            after = settled(self._numbers(parameters)[0], total, origin)
        return after, after, after

    def watch(self, state: Scalars) -> Scalars:
        """Not zero once the state has diverged or is not finite."""
        fault: Scalar = 0
        for x in self.lanes.dense(state):
            fault = where(x * x < BEYOND * BEYOND, fault, 1)
        return [fault]

    # programs

    def program(self, part: Literal["whole", "sense", "command", "after", "output"]) -> Program:
        """The compiled loop, or a part of what happens each sample.

        sense: before the controller.  command: sense, and the controller.  after: all that follows.  output: what
        follows, but for integration.  Raises TraceError for a whole or a command whose controller cannot be traced.
        """
        if part not in self.programs:
            body = {
                "whole": [*self._before, self._control, *self._after],
                "sense": self._before,
                "command": [*self._before, self._control],
                "after": self._after,
                "output": self._after[:2],
            }[part]
            ticks = Loop("ticks", body, streams=("row", "record"), until="fault")
            integrates = part in ("whole", "after")
            regions = [region for region in self.regions() if integrates or region.name not in INTEGRATION]
            self.programs[part] = compile_program(ticks, regions, backend=self.robot.backend)
        return self.programs[part]

    @property
    def _before(self) -> list[Any]:
        return [Stage(self.sense, ("state", "sensing", "row", "parameters"), ("measured", "sensing"))]

    @property
    def _control(self) -> Stage:
        return Stage(self.control, ("measured", "memory", "row", "parameters"), ("command", "memory"))

    @property
    def _after(self) -> list[Any]:
        numbers = "numbers" if self.lanes.are_wide else "parameters"
        drive = ("state", "origin", "torque", "torque_before", "elapsed", numbers, "steps")
        advance = ("state", "origin", "total", "tableau", "efforts", "accelerations", "steps")
        stages = [
            Stage(self.drive, drive, ("efforts",), self.lanes.width),
            Stage(self.accelerate, ("state", "efforts", "row", "parameters"), ("accelerations",)),
            Stage(self.advance, advance, ("state", "total"), self.lanes.width),
        ]
        step = [
            Loop(len(TABLEAU), stages, streams=("tableau",)),
            Stage(self.settle, ("total", "origin", numbers), ("state", "origin", "total"), self.lanes.width),
        ]
        return [
            Stage(self.actuate, ("state", "command", "torque", "parameters"), ("torque", "torque_before")),
            Stage(
                self.record, ("state", "measured", "command", "torque", "torque_before", "parameters"), ("record",)
            ),
            Loop("substeps", step, streams=("elapsed",)),
            Stage(self.watch, ("state",), ("fault",)),
        ]

    # views

    def seen(self, measured: Any, row: Any, period: Scalar) -> tuple[Measurement, Reference]:
        """What a controller is given."""
        n = self.layout.n
        q, theta, v, theta_dot = (array_of(measured[k * n : (k + 1) * n]) for k in range(4))
        return Measurement(row[0], period, q, v, theta, theta_dot), self.layout.reference(row)

    def command_of(self, command: Command, row: Any) -> Scalars:
        """A command as it is recorded: without a motor reference of its own, the links' is the motors'."""
        n, reference = self.layout.n, self.layout.reference(row)
        theta = reference.theta if command.theta is None else command.theta
        theta_dot = reference.theta_dot if command.theta_dot is None else command.theta_dot
        return [x for part in (command.torque, command.feedforward, theta, theta_dot) for x in _each(part, n)]

    def _numbers(self, parameters: Scalars) -> tuple[Machine, Any, Encoders, Scalars, Scalar]:
        """Machine, controller, encoders, torque limits, period with these numbers in them."""
        numbers = iter(parameters)
        machine = self.robot.machine_with([next(numbers) for _ in self.robot.drive_parameters], lean=True)
        controller, encoders = rebuild(self.controller, numbers), rebuild(self.encoders, numbers)
        return machine, controller, encoders, [next(numbers) for _ in range(self.layout.n)], next(numbers)


def array_of(numbers: Any) -> Any:
    """Numbers as an array, of objects when they are traced, so that laws can be written with array arithmetic."""
    plain = all(isinstance(x, float) for x in numbers)
    array = np.empty(len(numbers), dtype=float if plain else object)
    array[:] = numbers
    return array


def _each(part: Any, n: int) -> list[Any]:
    """One entry a drive, from one each or one for all."""
    array = np.asarray(part)
    return [array[()]] * n if array.ndim == 0 else [*part]
