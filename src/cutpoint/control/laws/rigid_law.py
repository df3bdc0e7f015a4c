"""Base class of laws for rigid robots: a model with rigid drives, and one side whose encoders they use."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cutpoint.control.interface import Measurement, Reference
from cutpoint.control.laws.model_law import ModelLaw, without_springs
from cutpoint.control.laws.required_velocity import required_rates
from cutpoint.control.laws.side import Side, SidedLaw
from cutpoint.errors import InputError
from cutpoint.mechanics.drives.harmonic_drive import friction_of_both_sides, friction_torque, rigidly_transmitted
from cutpoint.mechanics.required_dynamics import required_inverse_dynamics
from cutpoint.robot_arguments import check_robot


@dataclass(frozen=True, eq=False)
class RigidLaw(SidedLaw, ModelLaw):
    """A law that treats the robot as rigid: the model has no springs, and rotors are armature.

    side: the encoders whose positions and speeds are used as the links'.  The motors' is the default: on elastic
    joints, feedback of the links' excites the spring.
    """

    side: Side = field(default="motor", kw_only=True)

    def __post_init__(self) -> None:
        self.check_side()
        check_robot(type(self).__name__, self.robot)
        if any(drive.is_elastic for drive in self.robot.drives.values()):
            if self.parameters is not None:
                name = type(self).__name__
                raise InputError(
                    f"{name}: parameters must be those of rigid drives; give a robot whose drives are rigid"
                )
            self._set(robot=without_springs(self.robot))
        super().__post_init__()

    def required_motion(self, position_gain: Any, measurement: Measurement, reference: Reference) -> tuple[Any, ...]:
        """q, v, v_r = v_d + Lambda (q_d - q), its derivative a_r, and s = v_r - v.

        Slotine and Li (1987); Xia (2019) eq. (12).  position_gain: Lambda, 1/s.  (n,) each, on the law's side.
        """
        q, v, q_d, v_d = self.seen(measurement, reference)
        v_r, a_r = required_rates(position_gain, (q_d, v_d, reference.a), (q, v))
        return q, v, v_r, a_r, v_r - v

    def required_effort(self, position_gain: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Any]:
        """s, and the rigid model's torques for the required motion, friction included, N m; (n,) each."""
        q, v, v_r, a_r, s = self.required_motion(position_gain, measurement, reference)
        tau = required_inverse_dynamics(self.model.system, [*q], [*v], [*v_r], [*a_r])
        return s, np.array(tau) + np.array(self.friction(v_r, v, tau))

    def friction(self, required: Any, speeds: Any, torques: Any) -> list[Any]:
        """Friction on both sides of rigid drives for required speeds, N m; torques: what moves links and rotors."""
        drives = [d.drive for d in self.model.drives]
        return [friction_of_both_sides(*each) for each in zip(drives, required, speeds, torques, strict=True)]

    def passed_on(self, speeds: Any, torques: Any) -> list[Any]:
        """Motor torques less friction on both sides of rigid drives, N m."""
        drives = [d.drive for d in self.model.drives]
        return [
            rigidly_transmitted(drive, u, v) - friction_torque(drive.link_friction, v)
            for drive, v, u in zip(drives, speeds, torques, strict=True)
        ]
