"""The virtual-decomposition feedforward compensator, rung by rung.  Xia (2019) sections II.C and III.C, fig. 9."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws.model_law import ModelLaw
from cutpoint.definitions import Machine
from cutpoint.door import check_choice
from cutpoint.mechanics.drives import strains
from cutpoint.mechanics.drives.harmonic_drive import DriveState, friction_of_both_sides
from cutpoint.mechanics.drives.motor import torque_for
from cutpoint.mechanics.elastic_forward import drive_states
from cutpoint.mechanics.elastic_inverse import Options, elastic_inverse_dynamics
from cutpoint.mechanics.inverse_dynamics import inverse_dynamics

Rung = Literal["gravity", "rigid", "rotor", "friction", "elastic"]
RUNGS: tuple[Rung, ...] = ("gravity", "rigid", "rotor", "friction", "elastic")


@dataclass(frozen=True, eq=False)
class Feedforward(ModelLaw):
    """Motor torque of the desired motion; each rung (level of detail) includes those before it.

    gravity: gravity torques.  rigid: plus the links' dynamics, (29)-(31), (44)-(47), and rotors that rigid drives turn.
    rotor: plus the other rotors' inertia (56).  friction: plus friction (54)-(55).  elastic: all of these through the
    elastic drives, with a reference for the motor, q_d plus the deflection (2), from which nearly all of the
    improvement comes; with kinematic error, hysteresis, presliding, ripple and cogging where the drives have them.
    Rotors with full coupling act on their carriers as if their drives were rigid, so that four derivatives suffice.
    """

    rung: Rung = "elastic"

    def __post_init__(self) -> None:
        check_choice("Feedforward", "rung", self.rung, RUNGS)
        super().__post_init__()

    @property
    def makes_motor_reference(self) -> bool:  # type: ignore[override]
        """Whether its command holds the motors' reference: with rung "elastic"."""
        return self.rung == "elastic"

    def start(self) -> Any:
        """The drives' strains along the desired motion, zero at its start."""
        return [0.0] * len(self.robot.strain_names) if self.rung == "elastic" else ()

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        machine = self.model
        if self.rung == "elastic":
            return self._elastic(machine, memory, measurement, reference)
        tau = self._rigid(machine, reference)
        return memory, Command(tau, tau)

    def _elastic(
        self, machine: Machine, memory: Any, measurement: Measurement, reference: Reference
    ) -> tuple[Any, Command]:
        """Feedforward through elastic drives, with strains that follow the desired motion one period behind."""
        drives = [d.drive for d in machine.drives]
        held = strains.drive_by_drive(drives, memory)
        q, *rates = ([*x] for x in reference[:5])
        options = Options(quasi_rigid=True)
        u = elastic_inverse_dynamics(machine.system, machine.drives, q, *rates, options=options, strains=held)
        torque = np.array([torque_for(*x) for x in zip(drives, u.motor_torque, u.theta, strict=True)])
        command = Command(torque, torque, np.array(u.theta), np.array(u.theta_dot))
        if not memory:
            return memory, command
        ends = drive_states(machine.drives, q, reference.v, u.theta, u.theta_dot)
        moved = [
            strains.flat(strains.moved(drive, before, _a_period_ago(end, measurement.period), end))
            for drive, before, end in zip(drives, held, ends, strict=True)
        ]
        return strains.gathered(moved), command

    def _rigid(self, machine: Machine, reference: Reference) -> Any:
        q, v, a = [*reference.q], [*reference.v], [*reference.a]
        if self.rung == "gravity":
            v = a = [0] * self.robot.nv
        tau = inverse_dynamics(machine.system, q, v, a)
        height = RUNGS.index(self.rung)
        with_rotors, with_friction = (height >= RUNGS.index(rung) for rung in ("rotor", "friction"))
        for k, d in enumerate(machine.drives):
            friction = friction_of_both_sides(d.drive, v[k], v[k], tau[k]) if with_friction else 0
            if with_rotors and d.drive.is_elastic:  # a rigid drive's rotor is armature already
                tau[k] = tau[k] + d.drive.reflected_inertia * a[k]
            tau[k] = tau[k] + friction
        return np.array(tau)


def _a_period_ago(now: DriveState, period: Any) -> DriveState:
    """The drive's state a period ago, extrapolated backwards at constant speeds."""
    return now._replace(q=now.q - period * now.v, theta=now.theta - period * now.theta_dot)
