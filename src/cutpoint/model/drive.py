"""A joint's drive: gear, rotor, compliance, friction, limits.  Data only; the laws live in `mechanics/`."""

from dataclasses import dataclass
from typing import Any, Literal, Protocol, runtime_checkable

from cutpoint.model.mechanism import UNLIMITED, Limits


@runtime_checkable
class Compliance(Protocol):
    """A spring law between motor and link, both at the joint's side.

    deflection in rad (m), torque in N m (N); every law is odd and strictly increasing.
    """

    def torque(self, deflection: Any) -> Any: ...
    def deflection(self, torque: Any) -> Any: ...
    def tangent(self, deflection: Any) -> Any: ...
    def energy(self, deflection: Any) -> Any: ...


@runtime_checkable
class KinematicError(Protocol):
    """A deviation e(theta) of the output, rad at the joint's side, periodic in the wave generator's turns."""

    def value(self, theta: Any, ratio: Any) -> Any: ...
    def slope(self, theta: Any, ratio: Any) -> Any: ...
    def steepest(self, ratio: float) -> float: ...
    def motor_position(self, output: Any, ratio: Any) -> Any: ...


@runtime_checkable
class Friction(Protocol):
    """A friction law: torque that opposes a velocity, N m (N) at the joint's side.

    load: torque that the drive transmits, N m; friction grows by `share_of_load` of it.
    resistance: to a change of speed, N m s/rad, never below 0: from the slope up to the torque over the speed, and more
    than the slope in sliding, where that nearly vanishes; treated implicitly in integration steps.
    """

    def torque(self, speed: Any, load: Any = 0) -> Any: ...
    def share_of_load(self, speed: Any) -> Any: ...
    def resistance(self, speed: Any, load: Any = 0) -> Any: ...


@runtime_checkable
class Hysteresis(Protocol):
    """Elements in parallel to a spring that follow its deflection and slip; strains in rad (m), at the joint's side."""

    @property
    def stiffness(self) -> tuple[Any, ...]: ...
    @property
    def reach(self) -> tuple[Any, ...]: ...
    def strains(self, before: tuple[Any, ...], displacement: Any) -> tuple[Any, ...]: ...
    def torque(self, strains: tuple[Any, ...]) -> Any: ...
    def sticking(self, strains: tuple[Any, ...], direction: Any) -> Any: ...
    def energy(self, strains: tuple[Any, ...]) -> Any: ...


@dataclass(frozen=True)
class Harmonic:
    """amplitude * sin(order * angle + phase), with the rotor's angle: of the wave generator, of the motor."""

    order: int
    amplitude: Any
    phase: Any = 0.0


@dataclass(frozen=True)
class Motor:
    """An electric motor with its current control; quantities at the motor's shaft.

    torque_constant: N m of shaft torque per ampere; K_e, V s/rad, is the same number.
    resistance: ohm, between the terminals to which torque_constant refers.  bandwidth: of the current loop, Hz; None
    is an ideal loop.  delay: s between command and current loop, at most a control period.
    current_limit (A) and voltage_limit (V) bound the torque, the latter more tightly at higher speed.
    ripple: waves of the torque, with amplitudes as shares of it.  cogging: waves of torque without current, in N m.
    """

    torque_constant: Any
    resistance: Any = None
    bandwidth: Any = None
    delay: Any = None
    current_limit: Any = None
    voltage_limit: Any = None
    ripple: tuple[Harmonic, ...] = ()
    cogging: tuple[Harmonic, ...] = ()


@dataclass(frozen=True)
class Rotor:
    """The motor's turning part, wave generator included.

    inertia: about its own axis, on the motor's side of the gear, kg m2; at the joint, ratio**2 times that.
    in_link_inertia: whether the carrying link's inertia already includes the rotor; if not, it is added, with its mass
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
class Ratings:
    """The maker's ratings of a gear, at the joint's side, and its motor; None where nothing is stated.

    Torques in N m: rated at rated_speed, average, repeated peak (starts and stops), momentary peak (collisions).
    Speeds of the motor, rad/s.  life: h, at rated torque and rated speed.  continuous_current: A, RMS of the motor's.
    """

    rated_torque: float | None = None
    average_torque: float | None = None
    repeated_peak_torque: float | None = None
    momentary_peak_torque: float | None = None
    rated_speed: float | None = None
    average_speed: float | None = None
    maximum_speed: float | None = None
    life: float | None = None
    continuous_current: float | None = None


@dataclass(frozen=True)
class Drive:
    """A joint's drive.

    ratio: signed motor turns per joint turn (rad per m on a prismatic joint).
    rotor: None if its inertia is unknown or negligible; an elastic drive needs one.
    compliance: None is a rigid drive: link and motor move as one, and the rotor acts as armature.
    damping: of the spring, N m s/rad at the joint's side; None is none.
    link_friction depends on the link's speed, motor_friction on the rotor's over ratio; both at the joint's side.
    limits: of the drive, at the joint's side.
    kinematic_error: by how much an elastic drive's unloaded output lags ratio-true rotation; None is none.
    hysteresis: slipping elements in parallel to the compliance; None is none.
    motor: dynamics between torque command and shaft; None is an ideal torque source.
    ratings: the maker's; used for sizing only.
    """

    ratio: float = 1.0
    rotor: Rotor | None = None
    compliance: Compliance | None = None
    damping: float | None = None
    link_friction: Friction | None = None
    motor_friction: Friction | None = None
    limits: Limits = UNLIMITED
    kinematic_error: KinematicError | None = None
    hysteresis: Hysteresis | None = None
    motor: Motor | None = None
    ratings: Ratings | None = None

    @property
    def is_elastic(self) -> bool:
        """Whether motor and link have coordinates of their own."""
        return self.compliance is not None

    @property
    def has_current_lag(self) -> bool:
        """Whether its motor has a current loop with stated bandwidth."""
        return self.motor is not None and self.motor.bandwidth is not None

    @property
    def is_coupled(self) -> bool:
        """Whether its rotor is a body that its carrier turns along: coupling "full"."""
        return self.rotor is not None and self.rotor.coupling == "full"

    @property
    def reflected_inertia(self) -> Any:
        """Reflected rotor inertia at the joint, ratio**2 times its own, kg m2 (kg); 0 without a rotor."""
        return self.ratio * self.ratio * self.rotor.inertia if self.rotor else 0
