"""What laws for rigid robots share: a model whose drives do not bend, and one side that they look at."""

from dataclasses import dataclass, field
from typing import Any, Literal

from cutpoint.control.interface import Measurement, Reference
from cutpoint.control.model_law import ModelLaw, stiffened
from cutpoint.door import check_kind
from cutpoint.errors import InputError
from cutpoint.mechanics.harmonic_drive import friction_torque, rigidly_transmitted
from cutpoint.robot import Robot


@dataclass(frozen=True, eq=False)
class RigidLaw(ModelLaw):
    """A law that takes the robot for rigid: its drives' springs are left out of the model, rotors are armature.

    side: the encoders whose positions and speeds it takes for the links'.  The motors' is the default: on joints that
    bend, feedback of the links' excites the spring.
    """

    side: Literal["motor", "link"] = field(default="motor", kw_only=True)

    def __post_init__(self) -> None:
        if self.side not in ("motor", "link"):
            raise InputError(f"{type(self).__name__}: side {self.side!r} must be 'motor' or 'link'")
        check_kind(type(self).__name__, "robot", self.robot, Robot, "a Robot (cutpoint.load reads files)")
        if any(drive.is_elastic for drive in self.robot.drives.values()):
            if self.parameters is not None:
                name = type(self).__name__
                raise InputError(f"{name}: parameters are numbers of rigid drives; give a robot whose drives are rigid")
            self._set(robot=stiffened(self.robot))
        super().__post_init__()

    @property
    def needs(self) -> tuple[str, ...]:
        """What it must be told by sensors."""
        return ("theta", "theta_dot") if self.side == "motor" else ("q", "v")

    def seen(self, measurement: Measurement, reference: Reference) -> tuple[Any, Any, Any, Any]:
        """Positions and speeds of its side, as they are and as they shall be."""
        m, r = measurement, reference
        if self.side == "motor":
            return m.theta, m.theta_dot, r.theta, r.theta_dot
        return m.q, m.v, r.q, r.v

    def friction(self, speeds: Any, loads: Any) -> list[Any]:
        """What friction on both sides of rigid drives takes, N m."""
        drives = [d.drive for d in self.model.drives]
        return [
            friction_torque(drive.link_friction, v) + friction_torque(drive.motor_friction, v, load)
            for drive, v, load in zip(drives, speeds, loads, strict=True)
        ]

    def passed_on(self, speeds: Any, torques: Any) -> list[Any]:
        """What friction on both sides of rigid drives leaves of motor torques for the links, N m."""
        drives = [d.drive for d in self.model.drives]
        return [
            rigidly_transmitted(drive, u, v) - friction_torque(drive.link_friction, v)
            for drive, v, u in zip(drives, speeds, torques, strict=True)
        ]
