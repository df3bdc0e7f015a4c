"""Virtual decomposition control.  Xia (2019) eqs. (12)-(28), in the corrected reading; Zhu (2010) chapter 3.

Each law below is written for quantities at the joint's side: tau_r is ell tau_t of (26), k_vq and k_vkappa act on
speeds of the joint.
"""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cutpoint.control.gains import gain_matrices
from cutpoint.control.interface import SENSED, Command, Measurement, Reference
from cutpoint.control.laws import command_filter
from cutpoint.control.laws.joint_law import JointGains, RequiredTorque, joint_command, required_drive_torque
from cutpoint.control.laws.model_law import ModelLaw, check_no_full_coupling
from cutpoint.control.laws.required_velocity import required_velocity
from cutpoint.definitions import Machine
from cutpoint.door import check_choice
from cutpoint.errors import InputError
from cutpoint.mechanics.elastic_forward import drive_states
from cutpoint.mechanics.link_motion import link_motion, torques_on_links
from cutpoint.mechanics.required_dynamics import quasi_rigid, required_efforts
from cutpoint.scalars import Jet, value_of


@dataclass(frozen=True, eq=False)
class VDC(ModelLaw):
    """Virtual decomposition control of rigid and bending joints.  Xia (2019) eqs. (12)-(28); Zhu (2010).

    position_gain: Lambda, 1/s.  speed_gain: k_vq, of the link's speed, N m s/rad.  motor_gain: k_vkappa, of the motor's
    speed, N m s/rad.  spring_gain: beta, of the spring's deflection, 1/s.  Each is one number or one for each drive.
    body_gain: K_B, K_T of each body, on (v, omega) in its own axes: a number, (6,), (6, 6) or one (6, 6) per body;
    None omits it and relies on k_vq.
    derivatives: source of the required torque's derivatives, which an elastic drive's kappa_r needs: "model", from link
    acceleration and jerk according to the spring's deflection and the model, or "filter", from a critically damped
    command filter of filter_bandwidth (Hz).  Neither differences encoders.  The filter must stay well below the drives'
    own modes: its lag excites them there, and only a spring_gain well above position_gain damps them; see `tune`.
    Friction is compensated by value, in the direction of required speeds and with its size at actual ones: where it is
    known it only adds damping, even friction that falls as speed grows.
    Rotors with full coupling act on their carriers as if their drives were rigid; if these are elastic, derivatives
    must be "filter".
    """

    position_gain: Any
    speed_gain: Any
    motor_gain: Any
    spring_gain: Any
    body_gain: Any = None
    derivatives: Literal["model", "filter"] = "model"
    filter_bandwidth: Any = 20.0

    makes_motor_reference = True

    def __post_init__(self) -> None:
        super().__post_init__()
        law = type(self).__name__
        names = ("position_gain", "speed_gain", "motor_gain", "spring_gain")
        self._keep_gains(*names, size=self.size, positive=("position_gain",))
        if self.body_gain is not None:
            bodies = len(self.robot.mechanism.bodies)
            self._set(body_gain=gain_matrices(law, "body_gain", self.body_gain, bodies))
        self._check_derivatives(law)
        self._keep_gains("filter_bandwidth", size=1, positive=("filter_bandwidth",))

    def _check_derivatives(self, law: str) -> None:
        drives = [*self.robot.drives.items()]
        check_choice(law, "derivatives", self.derivatives, ("model", "filter"))
        rigid = [name for name, drive in drives if not drive.is_elastic]
        if self.derivatives == "model" and 0 < len(rigid) < len(drives):
            why = f"the drive of {rigid[0]!r} is rigid, so no deflection tells what accelerates its link"
            raise InputError(f"{law}: {why}; use AdaptiveVDC, or in Python derivatives='filter'", joint=rigid[0])
        if self.derivatives == "model":
            check_no_full_coupling(law, self.robot, "derivatives='filter'")

    @property
    def needs(self) -> tuple[str, ...]:
        """Measurement fields that the law reads."""
        return SENSED if self._bends else ("q", "v")

    @property
    def _bends(self) -> bool:
        return any(drive.is_elastic for drive in self.robot.drives.values())

    @property
    def model(self) -> Machine:
        """The machine with this law's drive parameters; with body gains, in the bodies' own frames."""
        return self.robot.machine_with(self.parameters, lean=self.body_gain is None)

    def start(self) -> Any:
        """State of the command filter; () without one: for rigid drives, and for derivatives from the model."""
        return command_filter.start(self.size) if self._bends and self.derivatives == "filter" else ()

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        memory, v_r, tau_r = self.required(memory, measurement, reference)
        m, drives = measurement, self.model.drives
        states = drive_states(drives, m.q, m.v, m.theta, m.theta_dot)
        joint_gains = map(JointGains, self.speed_gain, self.motor_gain, self.spring_gain)
        subsystems = zip(drives, states, reference.q, v_r, tau_r, joint_gains, strict=True)
        commands = [joint_command(d.drive, *subsystem) for d, *subsystem in subsystems]
        torque, theta, theta_dot, _ = (np.array(x) for x in zip(*commands, strict=True))
        return memory, Command(torque, 0, theta, theta_dot)

    def required(
        self, memory: Any, measurement: Measurement, reference: Reference
    ) -> tuple[Any, list[Jet], list[RequiredTorque]]:
        """Next memory, required velocity of each joint, and the torque that its drive must exert.

        Xia (2019) eqs. (12), (14)-(20), (26).
        """
        machine, m, r = self.model, measurement, reference
        if self._bends and self.derivatives == "model":
            tau = torques_on_links(*machine, m.q, m.v, m.theta, m.theta_dot)
            a, jerk = (np.array(x) for x in link_motion(machine.system, [*m.q], [*m.v], tau))
            v_r = required_velocity(self.position_gain, r[:5], (m.q, m.v, a, jerk))
            q, v = ([Jet(*x) for x in zip(*rates, strict=True)] for rates in ((m.q, m.v, a), (m.v, a, jerk)))
            return memory, v_r, self._required_torque(machine, q, v, v_r)
        v_r = required_velocity(self.position_gain, r[:3], (m.q, m.v))
        tau_r = self._required_torque(machine, [*m.q], [*m.v], v_r)
        if not self._bends:
            return memory, v_r, [RequiredTorque(Jet(x), rotor) for x, rotor in tau_r]
        commands = [x for x, _ in tau_r]
        memory, filtered = command_filter.step(memory, commands, math.tau * self.filter_bandwidth[0], m.period)
        pairs = zip(tau_r, filtered, strict=True)
        return memory, v_r, [RequiredTorque(Jet(x, *z.derivatives[1:]), rotor) for (x, rotor), z in pairs]

    def _required_torque(self, machine: Machine, q: list[Any], v: list[Any], v_r: list[Jet]) -> list[Any]:
        """tau_r of each drive, with as many derivatives as the actual motion has, and torques of rotors."""
        speeds, accelerations = _with_orders_of(q[0], v_r)
        system = quasi_rigid(machine.system)
        tau, rotors = required_efforts(system, q, v, speeds, accelerations, self.body_gain)
        asked = zip([d.drive for d in machine.drives], tau, speeds, v, self.speed_gain, strict=True)
        tau_r = [required_drive_torque(*each) for each in asked]
        return [RequiredTorque(t, value_of(rotor)) for t, rotor in zip(tau_r, rotors, strict=True)]


def _with_orders_of(q: Any, v_r: list[Jet]) -> tuple[list[Any], list[Any]]:
    """Required speeds and accelerations: jets where positions are jets, otherwise numbers."""
    if isinstance(q, Jet):
        return [Jet(*x.derivatives[:-1]) for x in v_r], [x.rate() for x in v_r]
    return [x.derivative(0) for x in v_r], [x.derivative(1) for x in v_r]
