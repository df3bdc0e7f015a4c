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

    De Luca (1988); De Luca and Book (2016) section 11.1.4.  bandwidth: rad/s, the place of two poles of each joint's
    error; frequency, rad/s, and damping ratio of the other two, which are in the same place by default.  One number or
    one for each drive.  Far below a spring's resonance, the other two cost robustness: the law then cancels nearly all
    of the spring's own force.
    Acceleration and jerk of the links come from the springs' deflection and the model.  It cancels the full model, so
    it is only as good as the model and the sensors; friction enters by value, without its rates.
    """

    bandwidth: Any
    frequency: Any = None
    damping: Any = 1.0

    needs = SENSED

    def __post_init__(self) -> None:
        super().__post_init__()
        rigid = [name for name, drive in self.robot.drives.items() if not drive.is_elastic]
        if rigid:
            remedy = "give it a compliance and a rotor, or use ComputedTorque"
            raise InputError(f"ElasticComputedTorque: the drive of {rigid[0]!r} is rigid; {remedy}")
        check_no_full_coupling("ElasticComputedTorque", self.robot, "coupling 'reduced'")
        if self.frequency is None:
            self._set(frequency=self.bandwidth)
        self._keep_gains("bandwidth", "frequency", "damping", size=self.size, positive=("bandwidth", "frequency"))

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        machine, m, r = self.model, measurement, reference
        tau = torques_on_links(*machine, m.q, m.v, m.theta, m.theta_dot)
        a, jerk = (np.array(x) for x in link_motion(machine.system, [*m.q], [*m.v], tau))
        k_q, k_v, k_a, k_jerk = self._feedback
        snap = r.snap + k_jerk * (r.jerk - jerk) + k_a * (r.a - a) + k_v * (r.v - m.v) + k_q * (r.q - m.q)
        u = elastic_inverse_dynamics(*machine, *([*x] for x in (m.q, m.v, a, jerk, snap)))
        return memory, Command(np.array(u.motor_torque))

    @property
    def _feedback(self) -> tuple[Any, ...]:
        """Coefficients of (s + w)^2 (s^2 + 2 zeta W s + W^2), from the constant one to that of s^3."""
        w, W, zeta = self.bandwidth, self.frequency, self.damping
        return (w * W) ** 2, 2 * w * W * (W + zeta * w), W * W + 4 * zeta * w * W + w * w, 2 * (w + zeta * W)
