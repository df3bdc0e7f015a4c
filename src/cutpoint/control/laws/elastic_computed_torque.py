"""Computed torque for elastic joints: feedback linearisation by elastic inverse dynamics.  De Luca (1988)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import SENSED, Command, Measurement, Reference
from cutpoint.control.laws.model_law import ModelLaw, check_no_full_coupling
from cutpoint.errors import InputError
from cutpoint.mechanics.elastic_inverse import elastic_inverse_dynamics
from cutpoint.mechanics.link_motion import link_motion, torques_on_links


@dataclass(frozen=True, eq=False)
class ElasticComputedTorque(ModelLaw):
    """Motor torques that give the links the snap s_d + sum of k_i e^(i), e = q_d - q and three of its derivatives.

    De Luca (1988); De Luca and Book (2016) section 11.1.4.  bandwidth: rad/s, the place of all four poles of each
    joint's error; one number or one for each drive.  Acceleration and jerk of the links come from the springs'
    deflection and the model.  It cancels the full model, so it is only as good as the model and the sensors; friction
    enters by value, without its rates.
    """

    bandwidth: Any

    needs = SENSED

    def __post_init__(self) -> None:
        super().__post_init__()
        rigid = [name for name, drive in self.robot.drives.items() if not drive.is_elastic]
        if rigid:
            remedy = "give it a compliance and a rotor, or use ComputedTorque"
            raise InputError(f"ElasticComputedTorque: the drive of {rigid[0]!r} is rigid; {remedy}")
        check_no_full_coupling("ElasticComputedTorque", self.robot, "coupling 'reduced'")
        self._keep_gains("bandwidth", size=self.size, positive=("bandwidth",))

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        machine, m, r, w = self.model, measurement, reference, self.bandwidth
        tau = torques_on_links(*machine, m.q, m.v, m.theta, m.theta_dot)
        a, jerk = (np.array(x) for x in link_motion(machine.system, [*m.q], [*m.v], tau))
        # (s + w)^4 = s^4 + 4 w s^3 + 6 w^2 s^2 + 4 w^3 s + w^4
        snap = r.snap + 4 * w * (r.jerk - jerk) + 6 * w * w * (r.a - a)
        snap = snap + w * w * w * (4 * (r.v - m.v) + w * (r.q - m.q))
        u = elastic_inverse_dynamics(*machine, *([*x] for x in (m.q, m.v, a, jerk, snap)))
        return memory, Command(np.array(u.motor_torque))
