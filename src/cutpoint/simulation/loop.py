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
from cutpoint.mechanics.elastic import driving_torques, link_friction
from cutpoint.robot import Robot
from cutpoint.scalars import Scalar, clip, leaves, rebuild, where, with_float_leaves
from cutpoint.simulation.integrator import TABLEAU, stage
from cutpoint.simulation.plant import rates, split
from cutpoint.simulation.sensors import Encoders

Array = NDArray[np.float64]
Scalars = list[Scalar]

BEYOND = 1e6
"""A state (rad, rad/s, m, m/s) larger than this has diverged."""


INTEGRATION = ("origin", "total", "tableau")
"""Regions that only the fixed steps use."""


@dataclass(frozen=True)
class Layout:
    """Where things stand in the regions; n drives, nq coordinates, nv speeds."""

    n: int
    nq: int
    nv: int
    noise: int

    @property
    def state(self) -> int:
        return self.nq + self.nv + 2 * self.n

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
    limits, then control period and step.  programs: those compiled so far for loops of this structure.
    """

    robot: Robot
    controller: Any
    encoders: Encoders
    memory: Any
    period: float
    programs: dict[str, Program]

    @cached_property
    def layout(self) -> Layout:
        n = len(self.robot.drives)
        return Layout(n, self.robot.nq, self.robot.nv, 2 * n if self.encoders.is_noisy else 0)

    @cached_property
    def channels(self) -> dict[str, int]:
        """What is recorded each period, with its length, in order."""
        n, nq, nv = self.layout.n, self.layout.nq, self.layout.nv
        return {
            "q": nq, "v": nv, "theta": n, "theta_dot": n, "measured_q": n, "measured_theta": n, "measured_v": n,
            "measured_theta_dot": n, "command_torque": n, "feedforward_torque": n, "motor_reference": n,
            "motor_speed_reference": n, "motor_torque": n, "joint_torque": n, "friction_torque": nv,
        }  # fmt: skip

    def parameters(self, limits: Array, substeps: int) -> Array:
        parts = [leaves(self.controller), leaves(self.encoders), limits, [self.period, self.period / substeps]]
        return np.concatenate([self.robot.drive_parameters, *(np.array(p, float) for p in parts)])

    def regions(self) -> list[Region]:
        n, record = self.layout.n, sum(self.channels.values())
        sizes = {
            "state": self.layout.state, "origin": self.layout.state, "total": self.layout.state, "row": self.layout.row,
            "sensing": len(self.encoders.memory(*[[0.0] * n] * 4)), "measured": 4 * n,
            "memory": len(leaves(self.memory)),
            "command": 4 * n, "torque": n, "parameters": len(self.parameters(np.zeros(n), 1)), "tableau": 2,
            "record": record, "fault": 1,
        }  # fmt: skip
        return [Region(name, size) for name, size in sizes.items()]

    def initial_memory(self) -> Array:
        return np.array(leaves(self.memory), float)

    # stages

    def sense(self, state: Scalars, sensing: Scalars, row: Scalars, parameters: Scalars) -> tuple[Scalars, Scalars]:
        machine, _, encoders, _, (period, _) = self._numbers(parameters)
        s = split(machine, state)
        links = [s.q[d.q] for d in machine.drives], [s.v[d.v] for d in machine.drives]
        motors = [self._motor(d, own, link) for d, own, link in zip(machine.drives, s.theta, links[0], strict=True)]
        speeds = [self._motor(d, own, link) for d, own, link in zip(machine.drives, s.theta_dot, links[1], strict=True)]
        sample = [*links[0], *motors, *links[1], *speeds]
        return encoders.measure(sample, sensing, self.layout.normals(row), period)

    def control(self, measured: Scalars, memory: Scalars, row: Scalars, parameters: Scalars) -> tuple[Scalars, Scalars]:
        """Command: torque, the part of it that is feedforward, motor reference and its speed."""
        _, controller, _, _, (period, _) = self._numbers(parameters)
        before = rebuild(self.memory, iter(memory))
        after, command = controller.step(before, *self.seen(measured, row, period))
        return self.command_of(as_command(command), row), leaves(with_float_leaves(after))

    def actuate(self, command: Scalars, parameters: Scalars) -> Scalars:
        """Motor torque within its limits, N m."""
        limits = self._numbers(parameters)[3]
        return [clip(u, -limit, limit) for u, limit in zip(command[: self.layout.n], limits, strict=True)]

    def record(
        self, state: Scalars, measured: Scalars, command: Scalars, torque: Scalars, parameters: Scalars
    ) -> Scalars:
        machine, n = self._numbers(parameters)[0], self.layout.n
        s = split(machine, state)
        driving = driving_torques(machine.drives, *s, torque)
        friction = link_friction(machine.system, machine.drives, s.v)
        seen = [*measured[:n], *measured[n : 2 * n], *measured[2 * n : 3 * n], *measured[3 * n :]]
        return [*state, *seen, *command, *torque, *driving, *friction]

    def advance(self, *regions: Scalars) -> tuple[Scalars, Scalars]:
        """One stage of an integration step."""
        state, origin, total, tableau, torque, row, parameters = regions
        machine, *_, (_, h) = self._numbers(parameters)
        k = rates(machine, state, torque, self.layout.disturbance(row))
        return stage(k, origin, total, tableau, h)

    def settle(self, total: Scalars) -> tuple[Scalars, Scalars]:
        """The step's result is the next step's start."""
        return total, total

    def watch(self, state: Scalars) -> Scalars:
        """Not zero once the state has diverged or is not finite."""
        fault: Scalar = 0
        for x in state:
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
        advance = ("state", "origin", "total", "tableau", "torque", "row", "parameters")
        step = [
            Loop(len(TABLEAU), [Stage(self.advance, advance, ("state", "total"))], streams=("tableau",)),
            Stage(self.settle, ("total",), ("state", "origin")),
        ]
        return [
            Stage(self.actuate, ("command", "parameters"), ("torque",)),
            Stage(self.record, ("state", "measured", "command", "torque", "parameters"), ("record",)),
            Loop("substeps", step),
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

    def _numbers(self, parameters: Scalars) -> tuple[Machine, Any, Encoders, Scalars, Scalars]:
        """Machine, controller, encoders, torque limits, (period, step) with these numbers in them."""
        numbers = iter(parameters)
        machine = self.robot.machine_with([next(numbers) for _ in self.robot.drive_parameters])
        controller, encoders = rebuild(self.controller, numbers), rebuild(self.encoders, numbers)
        return machine, controller, encoders, [next(numbers) for _ in range(self.layout.n)], [*numbers]

    @staticmethod
    def _motor(driven: Any, own: Scalar, link: Scalar) -> Scalar:
        return own if driven.drive.is_elastic else link


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
