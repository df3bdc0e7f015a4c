"""Adaptive control of the whole rigid robot, the classical baseline.  Slotine and Li (1987)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws.adaptation import unless_saturated
from cutpoint.control.laws.rigid_law import RigidLaw
from cutpoint.mechanics.bodies.pseudo_inertia import nominal_sizes
from cutpoint.mechanics.bodies.rigid_body import parameters_of
from cutpoint.mechanics.regressor import required_rotor_torques, required_torque_regressor


@dataclass(frozen=True, eq=False)
class SlotineLi(RigidLaw):
    """tau = Y(q, v, v_r, a_r) p + K s + friction(v_r, v), p' = Gamma Y^T s; s = v_r - v, v_r = v_d + Lambda (q_d - q).

    position_gain: Lambda, 1/s.  speed_gain: K, N m s/rad.  rate: adaptation gain relative to the bodies' nominal
    sizes, 1/J.  It learns inertial parameters, without bounds; friction and the torques due to rotors' spin, which Y p
    leaves out (see `Robot.regressor`), are the model's.
    torque_limit (n,): motor limits in N m at the joint, by default those that robot and drives state.  Nothing is
    learnt while a motor's command exceeds its limit.
    """

    position_gain: Any
    speed_gain: Any
    rate: Any = 1.0
    torque_limit: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep_gains("position_gain", "speed_gain", size=self.size)
        self._keep_gains("rate", size=1)
        self._keep_torque_limit()

    def start(self) -> Any:
        """The model's inertial parameters, ten per body."""
        return [*self.robot.inertial_parameters]

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        q, v, v_r, a_r, s = self.required_motion(self.position_gain, measurement, reference)
        system = self.robot.machine_with(self.parameters).system
        Y = required_torque_regressor(system, [*q], [*v], [*v_r], [*a_r])
        rotors = required_rotor_torques(system, [*q], [*v], [*v_r], [*a_r])
        tau = [sum((y * p for y, p in zip(row, memory, strict=True)), x) for row, x in zip(Y, rotors, strict=True)]
        torque = np.array(tau) + np.array(self.friction(v_r, v, tau)) + self.speed_gain * s
        power = [sum((y * x for y, x in zip(column, s, strict=True)), 0) for column in zip(*Y, strict=True)]
        sizes = [x for body in system.segments for x in nominal_sizes(parameters_of(body.inertia))]
        step = measurement.period * self.rate[0]
        learnt = [p + step * size * size * x for p, x, size in zip(memory, power, sizes, strict=True)]
        return unless_saturated(learnt, memory, torque, self.torque_limit), Command(torque)
