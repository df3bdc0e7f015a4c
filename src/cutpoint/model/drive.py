"""What drives a joint: gear, rotor, compliance, friction, limits.  Data only; the laws live in `mechanics/`."""

from dataclasses import dataclass
from typing import Any, Literal, Protocol

from cutpoint.model.mechanism import UNLIMITED, Limits


class Compliance(Protocol):
    """A spring law between motor and link, both at the joint's side.

    deflection in rad (m), torque in N m (N); every law is odd and strictly increasing.
    """

    def torque(self, deflection: Any) -> Any: ...
    def deflection(self, torque: Any) -> Any: ...
    def tangent(self, deflection: Any) -> Any: ...
    def energy(self, deflection: Any) -> Any: ...


class KinematicError(Protocol):
    """A deviation e(theta) of the output, rad at the joint's side, periodic in the wave generator's turns."""

    def value(self, theta: Any, ratio: Any) -> Any: ...
    def slope(self, theta: Any, ratio: Any) -> Any: ...
    def steepest(self, ratio: float) -> float: ...
    def motor_position(self, output: Any, ratio: Any) -> Any: ...


class Friction(Protocol):
    """A friction law: torque that opposes a velocity, N m (N) at the joint's side."""

    def torque(self, speed: Any) -> Any: ...


@dataclass(frozen=True)
class Rotor:
    """The motor's turning part, wave generator included.

    inertia: about its own axis, on the motor's side of the gear, kg m2; felt at the joint, ratio**2 times that.
    in_link_inertia: whether the carrying link's inertia already holds the rotor; if not, it is added, with its mass
    (kg), its inertia across the axis, `transverse` (kg m2), and its centre at `position` (m) along the joint's axis.
    coupling: "reduced" counts the kinetic energy of its own spin only (Spong 1987); "full" makes it a balanced,
    axisymmetric body that its carrier turns along, gyroscopic torques included.
    """

    inertia: float
    in_link_inertia: bool = True
    mass: float = 0.0
    transverse: float = 0.0
    position: float = 0.0
    coupling: Literal["reduced", "full"] = "reduced"


@dataclass(frozen=True)
class Drive:
    """A joint's drive.

    ratio: signed motor turns per joint turn (rad per m on a prismatic joint).
    rotor: None where its inertia is not known or does not matter; an elastic drive needs one.
    compliance: None is a rigid drive: link and motor are one, and the rotor acts as armature.
    damping: of the spring, N m s/rad at the joint's side; None is none.
    link_friction acts on the link's speed, motor_friction on the rotor's over ratio; both at the joint's side.
    limits: of the drive, at the joint's side.
    torque_constant: N m of shaft torque per ampere.
    kinematic_error: what an elastic drive's output deviates from ratio-true rotation; None is none.
    """

    ratio: float = 1.0
    rotor: Rotor | None = None
    compliance: Compliance | None = None
    damping: float | None = None
    link_friction: Friction | None = None
    motor_friction: Friction | None = None
    limits: Limits = UNLIMITED
    torque_constant: float | None = None
    kinematic_error: KinematicError | None = None

    @property
    def is_elastic(self) -> bool:
        """Whether motor and link have coordinates of their own."""
        return self.compliance is not None

    @property
    def reflected_inertia(self) -> Any:
        """Rotor inertia felt at the joint, ratio**2 times its own, kg m2 (kg); 0 without a rotor."""
        return self.ratio * self.ratio * self.rotor.inertia if self.rotor else 0
