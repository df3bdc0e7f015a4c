"""Stages over memory that record and integrate the plant between two samples.

If all drives are uniform, stages of drives are written for one of them: see `kernels.programs.stepping`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cutpoint.arrays import Array
from cutpoint.definitions import Machine
from cutpoint.mechanics.bodies.joints import Revolute
from cutpoint.mechanics.drives import strains
from cutpoint.mechanics.drives.harmonic_drive import friction_torque
from cutpoint.mechanics.elastic_forward import DriveEffort, drive_effort, driven_accelerations
from cutpoint.mechanics.linearly_implicit import from_memory, resistance, resisted
from cutpoint.model.drive import Drive
from cutpoint.robot import Robot
from cutpoint.scalars import Angle, Scalar, cos, rebuild, sin, where
from cutpoint.simulation.loop.lanes import Lanes
from cutpoint.simulation.loop.layout import Layout
from cutpoint.simulation.loop.step import GAMMA, added_speeds, stage
from cutpoint.simulation.plant import (
    Own,
    all_rates,
    arrived,
    by_drive,
    currents,
    drive_rates,
    is_uniform,
    own_of,
    own_rates,
    rigid_load,
    settled,
    shaft_and_current,
    split,
)

Scalars = list[Scalar]


@dataclass(frozen=True, eq=False)
class PlantStages:
    """The stages of one robot; its drives' numbers come first among the parameters.

    Quantities of an integration step: origin is its initial state, total its result so far; torque the motors' commands
    since the sample, before those until then; resistance the drives' resistance throughout the step, efforts their
    torques at this stage; earlier the speeds added by earlier stages, for the implicit part; elapsed the time from the
    sample to the step's middle, s, and steps its length; tableau this stage's row.
    """

    robot: Robot
    layout: Layout
    lanes: Lanes

    def feel(self, state: Scalars, torque: Scalars, before: Scalars, parameters: Scalars) -> Scalars:
        """Torques at the shaft, through the drive, and lost to the friction of the link and of the motor.

        A delayed command has no effect yet.
        """
        felt: list[Scalars] = []
        for d, own, u, old in zip(*self._drives(parameters, state), torque, before, strict=True):
            delay = d.motor.delay if d.motor else None
            shaft, _ = shaft_and_current(d, own, u if delay is None else where(delay > 0, old, u))
            effort = drive_effort(d, own.at, shaft, own.strains)
            tau = effort.transmitted
            rubbing = friction_torque(d.motor_friction, own.at.theta_dot, tau, own.strains.motor)
            felt.append([shaft, tau, tau - effort.on_link, rubbing if d.is_elastic else shaft - tau])
        return _by_field(felt)

    def record(self, state: Scalars, measured: Scalars, command: Scalars, felt: Scalars) -> Scalars:
        """The recorded quantities of a sample."""
        machine, felt, n = self.robot.machine, self.lanes.dense(felt), self.layout.n
        friction: Scalars = [0] * machine.system.nv
        for d, xi in zip(machine.drives, felt[2 * n : 3 * n], strict=True):
            friction[d.v] = xi
        return [*self.lanes.dense(state), *measured, *command, *felt[: 2 * n], *friction, *felt[3 * n :]]

    def numbers(self) -> Array:
        """The drives' parameters lane by lane, if all drives are uniform."""
        if not self.lanes.are_wide:
            return np.zeros(0)
        by_field = self.robot.drive_parameters.reshape(self.layout.n, -1).T.ravel()
        return np.array(self.lanes.padded(by_field, repeat=True))

    def resist(self, state: Scalars, torque: Scalars, parameters: Scalars, steps: Scalars) -> Scalars:
        """The drives' resistance over a step that starts here."""
        drives = zip(*self._drives(parameters, state), torque, strict=True)
        span = GAMMA * steps[0]
        return _by_field([[*resistance(d, x.at, x.strains, span, rigid_load(d, x, u))] for d, x, u in drives])

    @cached_property
    def knows_turns(self) -> bool:
        """Whether sines and cosines are computed before the accelerations: all at once, if drives are uniform."""
        are_alike = self.lanes.are_wide or is_uniform(self.robot.machine)
        return are_alike and not self.robot.machine.system.has_followers

    def turn(self, state: Scalars) -> Scalars:
        """Sines and cosines of the drives' positions."""
        q = state[: 1 if self.lanes.are_wide else self.layout.n]
        return [*map(sin, q), *map(cos, q)]

    def drive(
        self,
        state: Scalars,
        origin: Scalars,
        torque: Scalars,
        before: Scalars,
        resistance: Scalars,
        earlier: Scalars,
        elapsed: Scalars,
        parameters: Scalars,
        steps: Scalars,
    ) -> Scalars:
        """Drive torques at this stage, including the implicit resistance terms."""
        drives, own = self._drives(parameters, state)
        _, past = self._drives(parameters, origin)
        held, added = _by_drive(resistance, len(drives)), _by_drive(earlier[: 2 * len(drives)], len(drives))
        found: list[Scalars] = []
        for d, now, start, u, old, h, speeds in zip(drives, own, past, torque, before, held, added, strict=True):
            effort, electric = drive_rates(d, now, start, arrived(d, u, old, elapsed[0], steps[0]))
            effort = resisted(d, effort, from_memory(d, h), speeds)
            found.append([effort.on_link, effort.net, *(electric or [0])])
        return _by_field(found)

    def accelerate(
        self, state: Scalars, turns: Scalars, resistance: Scalars, efforts: Scalars, row: Scalars, parameters: Scalars
    ) -> Scalars:
        """Accelerations of links, then of motors, under the drives' torques."""
        machine, n = self._machine(parameters), self.layout.n
        s = split(machine, self.lanes.dense(state))
        found: list[DriveEffort] = []
        numbers = (_by_drive(self.lanes.dense(region), n) for region in (resistance, efforts))
        for d, held, (on_link, net, _) in zip(machine.drives, *numbers, strict=True):
            h = from_memory(d.drive, held)
            found.append(DriveEffort(on_link, net, None, h.mobility, h.inertia, h.follows))
        q, pushed = self._angles(s.q, self.lanes.dense(turns)), self.layout.disturbance(row)
        a, theta_ddot = driven_accelerations(*machine, q, s.v, s.theta_dot, found, pushed)
        return self.lanes.padded([*a, *theta_ddot])

    def advance(
        self,
        state: Scalars,
        origin: Scalars,
        total: Scalars,
        earlier: Scalars,
        tableau: Scalars,
        efforts: Scalars,
        accelerations: Scalars,
        steps: Scalars,
    ) -> tuple[Scalars, Scalars, Scalars]:
        """End of a stage: the next stage's state, the result so far, and the speeds that it adds in later stages."""
        if self.lanes.are_wide:
            (a, alpha), drive = accelerations, self.robot.machine.drives[0].drive
            k, driven = own_rates(drive, state, a, alpha, efforts[2]), [a, alpha]
        else:
            machine, n, nv = self.robot.machine, self.layout.n, self.layout.nv
            electric = [x for d, x in zip(machine.drives, efforts[2 * n :], strict=True) if currents(d.drive)]
            s = split(machine, state)
            k = [*all_rates(machine, s, accelerations[:nv], accelerations[nv:], electric), *[0] * len(s.strains)]
            driven = [*(accelerations[d.v] for d in machine.drives), *accelerations[nv:]]
        h = steps[0]
        return *stage(state, k, origin, total, tableau, h), added_speeds(driven, earlier, tableau, h)

    def settle(self, total: Scalars, origin: Scalars, parameters: Scalars) -> tuple[Scalars, Scalars, Scalars]:
        """Makes the step's result, with updated strains, the initial state of the next step."""
        if self.lanes.are_wide:
            drive = self._alike(parameters)
            own, past = own_of(drive, total), own_of(drive, origin)
            left = strains.flat(strains.moved(drive, past.strains, past.at, own.at))
            after = [*total[: len(total) - len(left)], *left]
        else:
            after = settled(self._machine(parameters), total, origin)
        return after, after, after

    def _angles(self, q: Scalars, turns: Scalars) -> Scalars:
        """Coordinates; those of revolute joints as sines and cosines, if these have been computed."""
        if not self.knows_turns:
            return q
        n, segments = self.layout.n, self.robot.machine.system.segments
        turning = {s.q.start for s in segments if isinstance(s.joint, Revolute)}
        return [Angle(turns[k], turns[n + k]) if k in turning else x for k, x in enumerate(q)]

    def _drives(self, parameters: Scalars, state: Scalars) -> tuple[list[Drive], list[Own]]:
        """The drives and their parts of a state; if they are uniform, the current one."""
        if self.lanes.are_wide:
            drive = self._alike(parameters)
            return [drive], [own_of(drive, state)]
        machine = self._machine(parameters)
        return [d.drive for d in machine.drives], by_drive(machine, state)

    def _machine(self, parameters: Scalars) -> Machine:
        return self.robot.machine_with(parameters[: len(self.robot.drive_parameters)], lean=True)

    def _alike(self, numbers: Scalars) -> Drive:
        """The current drive, with its own numbers."""
        return rebuild(self.robot.machine.drives[0].drive, iter(numbers))


def _by_field(found: list[Scalars]) -> Scalars:
    """Drives' numbers side by side, field by field."""
    return [x for field in zip(*found, strict=True) for x in field]


def _by_drive(numbers: Scalars, n: int) -> list[tuple[Scalar, ...]]:
    """The inverse: each drive's own numbers."""
    return [*zip(*(numbers[k : k + n] for k in range(0, len(numbers), max(1, n))), strict=True)]
