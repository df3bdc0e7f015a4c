"""The virtual-decomposition feedforward compensator, rung by rung.  Xia (2019) sections II.C and III.C, fig. 9."""

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.law import Law
from cutpoint.errors import InputError
from cutpoint.mechanics.elastic import Options, elastic_inverse_dynamics
from cutpoint.mechanics.harmonic_drive import friction_torque
from cutpoint.mechanics.inverse_dynamics import inverse_dynamics
from cutpoint.robot import Robot

Rung = Literal["gravity", "rigid", "rotor", "friction", "elastic"]
RUNGS: tuple[Rung, ...] = ("gravity", "rigid", "rotor", "friction", "elastic")


@dataclass(frozen=True)
class Feedforward(Law):
    """Motor torque of the desired motion, as truly as the rung says; each rung adds to the one before.

    gravity: what holds the links.  rigid: and moves them, (29)-(31), (44)-(47).  rotor: and spins the rotors (56).
    friction: and overcomes friction (54)-(55).  elastic: all of it through the bending drives, with the motor's own
    reference, q_d plus the deflection (2), in which nearly all of the elastic gain lies.  Rotors with full coupling act
    on what carries them as if their drives did not bend, which asks for no more than four derivatives.
    parameters: numbers of the drives, those of the robot unless given (see `Robot.drive_parameters`).
    """

    robot: Robot
    rung: Rung = "elastic"
    parameters: Any = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if self.rung not in RUNGS:
            raise InputError(f"Feedforward: rung {self.rung!r} must be one of {', '.join(RUNGS)}", rung=self.rung)
        if self.robot.nv != len(self.robot.joints):
            raise InputError("Feedforward: a floating base has no motor; its motion is not in the reference")
        if self.parameters is None:
            object.__setattr__(self, "parameters", self.robot.drive_parameters)

    @property
    def makes_motor_reference(self) -> bool:  # type: ignore[override]
        return self.rung == "elastic"

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        machine, still = self.robot.machine_with(self.parameters), [0] * self.robot.nv
        q, v, a = [*reference.q], [*reference.v], [*reference.a]
        if self.rung == "elastic":
            rates = (v, a, [*reference.jerk], [*reference.snap])
            u = elastic_inverse_dynamics(machine.system, machine.drives, q, *rates, options=Options(quasi_rigid=True))
            torque = np.array(u.motor_torque)
            return memory, Command(torque, torque, np.array(u.theta), np.array(u.theta_dot))
        if self.rung == "gravity":
            v, a = still, still
        tau = inverse_dynamics(machine.system, q, v, a)
        height = RUNGS.index(self.rung)
        for k, d in enumerate(machine.drives):
            if height >= RUNGS.index("rotor") and d.drive.is_elastic:  # a rigid drive's rotor is armature already
                tau[k] = tau[k] + d.drive.reflected_inertia * a[k]
            if height >= RUNGS.index("friction"):
                for law in (d.drive.link_friction, d.drive.motor_friction):
                    tau[k] = tau[k] + friction_torque(law, v[k])
        return memory, Command(np.array(tau), np.array(tau))
