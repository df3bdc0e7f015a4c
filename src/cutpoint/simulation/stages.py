"""What a loop does with the plant between two samples, as stages over memory.

Where all drives are alike, `drive`, `advance` and `settle` are seen from one of them: see `kernels.stepping`.
"""

from dataclasses import dataclass

from cutpoint.definitions import Machine
from cutpoint.mechanics import strains
from cutpoint.mechanics.elastic_forward import Effort, drive_effort, driven_accelerations
from cutpoint.model.drive import Drive
from cutpoint.robot import Robot
from cutpoint.scalars import Scalar, rebuild
from cutpoint.simulation.integrator import stage
from cutpoint.simulation.lanes import Lanes
from cutpoint.simulation.layout import Layout
from cutpoint.simulation.plant import (
    all_rates,
    arrived,
    currents,
    drive_rates,
    has_delay,
    motor_torque,
    own_of,
    own_parts,
    own_rates,
    settled,
    split,
)

Scalars = list[Scalar]


@dataclass(frozen=True, eq=False)
class PlantStages:
    """The stages of one robot; its drives' numbers come first among the parameters."""

    robot: Robot
    layout: Layout
    lanes: Lanes

    def record(self, *regions: Scalars) -> Scalars:
        """What the log keeps of a sample; a command that is still on its way to the motor is not there yet."""
        state, measured, command, torque, before, parameters = regions
        machine = self._machine(parameters)
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
            drives = [self._alike(parameters)]
            own, past = [own_of(drives[0], state)], [own_of(drives[0], origin)]
        else:
            machine = self._machine(parameters)
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
        machine, n = self._machine(parameters), self.layout.n
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
            drive = self._alike(parameters)
            own, past = own_of(drive, total), own_of(drive, origin)
            left = strains.flat(strains.moved(drive, past.strains, past.at, own.at))
            after = [*total[: len(total) - len(left)], *left]
        else:
            after = settled(self._machine(parameters), total, origin)
        return after, after, after

    def _machine(self, parameters: Scalars) -> Machine:
        return self.robot.machine_with(parameters[: len(self.robot.drive_parameters)], lean=True)

    def _alike(self, numbers: Scalars) -> Drive:
        """The one drive that is looked at, with its own numbers."""
        return rebuild(self.robot.machine.drives[0].drive, iter(numbers))
