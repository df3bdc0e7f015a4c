"""A nonlinear disturbance observer around any law.  Mohammadi, Tavakoli, Marquez and Hashemzadeh (2013)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.law import Wrapper, as_law, check_drives, needs_of
from cutpoint.control.laws.rigid_law import RigidLaw
from cutpoint.mechanics.forward_dynamics import forward_dynamics
from cutpoint.scalars import clip, where


@dataclass(frozen=True, eq=False)
class DisturbanceObserver(RigidLaw, Wrapper):
    """A law whose torque is corrected by d, an estimate of the disturbance that the rigid model does not explain.

    d = z + Y v and z' = -Y (the model's acceleration under torque and d), so that d' = Y M^-1 (disturbance - d), Y
    being the gain, N m s/rad; Mohammadi et al. (2013) with p(v) = Y v.  Since d is subtracted from the law's torque
    u, the model accelerates under u itself: d is Y times the lead of the measured speed over the model's.
    gain / inertia is the bandwidth, rad/s, with which a joint's disturbance is tracked.  Sampled, the observer diverges
    once the largest eigenvalue of Y M^-1 reaches 2 / control period: for one joint that is its bandwidth, for several
    coupled joints the bandwidths must stay lower.
    The model is rigid, so that the springs' deflection counts as a disturbance: around an accurate elastic feedforward
    on soft drives an observer can increase the error.
    It corrects nothing once the law reports a fault, so that a `Guard` inside keeps its word.
    torque_limit (n,): motor limits in N m at the joint, by default those that robot and drives state.  The model gets
    u - d clipped to them, so that d does not wind up while the motors saturate.
    """

    law: Any
    gain: Any
    torque_limit: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set(law=as_law(self.law))
        self._keep_gains("gain", size=self.size)
        self._keep_torque_limit()
        check_drives(self.law, self.robot.joints)

    @property
    def needs(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys((*super().needs, *needs_of(self.law))))

    def start(self) -> Any:
        """z / Y, rad/s, whether the first step is done, and the law's memory."""
        return [0.0] * self.size, 0.0, self.inner_start()

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        inner, command = self.inner_step(memory[2], measurement, reference)
        q, v, _, _ = self.seen(measurement, reference)
        z = np.array([where(memory[1] > 0, x, -speed) for x, speed in zip(memory[0], v, strict=True)])
        d = self.gain * (z + v)
        corrected = command.torque - d
        if self.reports_faults:
            corrected = [where(command.fault > 0, *x) for x in zip(command.torque, corrected, strict=True)]
        torque = [clip(u, -most, most) for u, most in zip(corrected, self.torque_limit, strict=True)]
        a = np.array(forward_dynamics(self.model.system, [*q], [*v], self.passed_on(v, np.array(torque) + d)))
        return ([*(z - measurement.period * a)], 1.0, inner), command._replace(torque=np.array(torque))
