"""Adaptive virtual decomposition control: every subsystem learns its own parameters.  Zhu (2010) chapters 3 and 4."""

import math
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.laws import adaptation, command_filter
from cutpoint.control.laws.joint_law import JointGains, RequiredTorque, joint_command, required_drive_torque
from cutpoint.control.laws.joint_parameters import JointPower, adapted, nominal, with_numbers
from cutpoint.control.laws.required_velocity import required_velocity
from cutpoint.control.laws.vdc import VDC
from cutpoint.definitions import Machine
from cutpoint.door import check_choice
from cutpoint.errors import InputError
from cutpoint.mechanics.bodies.pseudo_inertia import nominal_sizes
from cutpoint.mechanics.bodies.rigid_body import body_regressor, inertia_of, parameters_of
from cutpoint.mechanics.bodies.spatial import ZERO, Pose
from cutpoint.mechanics.elastic_forward import drive_states
from cutpoint.mechanics.inverse_dynamics import BodyMotion
from cutpoint.mechanics.required_dynamics import efforts_between, quasi_rigid, required_motions
from cutpoint.mechanics.system import Segment
from cutpoint.model.drive import Drive
from cutpoint.scalars import Jet, Scalar


class Estimates(NamedTuple):
    """Current estimates: ten numbers or a factor of the pseudo-inertia for each body, and each drive's parameters."""

    bodies: Any
    joints: Any
    filters: Any


@dataclass(frozen=True, eq=False)
class AdaptiveVDC(VDC):
    """VDC whose bodies and joints learn while they move: inertial parameters, friction, rotor inertia, compliance.

    The gains are those of `VDC`; required torques are differentiated by its command filter.
    update: "projection" keeps every number within `uncertainty` of the model's, Zhu (2010): a share of it for masses
    and joints, of mass * radius for first moments, of mass * radius**2 for all six of an inertia, with the radius of
    gyration about the joint's frame.  A slender body's small inertia may thus be estimated below zero.  "natural" keeps
    bodies physical, without bounds on them, Lee, Kwon and Park (2018); joint parameters are projected in both.
    body_rate and joint_rate: adaptation gains relative to nominal sizes, 1/J.  `tune` finds rates that preserve the
    loop's damping; much higher ones make estimates and motion oscillate.
    torque_limit (n,): motor limits in N m at the joint, by default those that robot and drives state.  Nothing is
    learnt while a motor's command exceeds its limit.
    Compliance is learnt as 1/K, of linear springs; other springs stay as the model has them.
    """

    update: Literal["projection", "natural"] = "projection"
    body_rate: Any = 1.0
    joint_rate: Any = 1.0
    uncertainty: Any = 0.5
    torque_limit: Any = None
    derivatives: Literal["filter"] = "filter"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_choice("AdaptiveVDC", "update", self.update, ("projection", "natural"))
        if self.derivatives != "filter":
            raise InputError("AdaptiveVDC: derivatives must be 'filter': a model that is being learnt has no jerk")
        self._keep_gains("body_rate", "joint_rate", "uncertainty", size=1)
        self._keep_torque_limit()
        if self.uncertainty.dtype != object and self.uncertainty[0] >= 1:
            rule = "must be below 1, so that masses, stiffness and friction stay positive"
            raise InputError(f"AdaptiveVDC: uncertainty {self.uncertainty[0]} {rule}")

    @property
    def model(self) -> Machine:
        """The machine with its bodies' own inertias: each learns its own."""
        return self.robot.machine_with(self.parameters)

    def start(self) -> Estimates:
        """The model's own parameters."""
        bodies = [parameters_of(segment.inertia) for segment in self.model.system.segments]
        if self.update == "natural":
            bodies = [adaptation.factor(p) for p in bodies]
        joints = [nominal(d.drive) for d in self.model.drives]
        return Estimates(bodies, joints, command_filter.start(self.size))

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        v_r = required_velocity(self.position_gain, reference[:3], (measurement.q, measurement.v))
        drives = self.model.drives
        believed = [with_numbers(d.drive, x) for d, x in zip(drives, memory.joints, strict=True)]
        tau, rotors, bodies = self._bodies(memory.bodies, believed, measurement, v_r)
        asked = zip(believed, tau, (x.derivative(0) for x in v_r), measurement.v, self.speed_gain, strict=True)
        tau_r = [required_drive_torque(*each) for each in asked]
        omega = math.tau * self.filter_bandwidth[0]
        filters, filtered = command_filter.step(memory.filters, tau_r, omega, measurement.period)
        m, told, joints = measurement, [], []
        # each joint: its motor command, and its parameter update
        states = drive_states(drives, m.q, m.v, m.theta, m.theta_dot)
        for k, (drive, at) in enumerate(zip(believed, states, strict=True)):
            gain = JointGains(self.speed_gain[k], self.motor_gain[k], self.spring_gain[k])
            torque = RequiredTorque(Jet(tau_r[k], *filtered[k].derivatives[1:]), rotors[k])
            told.append(joint_command(drive, at, reference.q[k], v_r[k], torque, gain))
            speed, acceleration = v_r[k].derivatives
            power = JointPower(at, speed, acceleration, tau_r[k], told[k].theta_dot, told[k].theta_ddot)
            rule = (self.joint_rate[0], self.uncertainty[0], measurement.period)
            joints.append(adapted(drives[k].drive, memory.joints[k], power, *rule))
        torque, theta, theta_dot, _ = (np.array(x) for x in zip(*told, strict=True))
        learnt, before = [bodies, joints], [memory.bodies, memory.joints]
        bodies, joints = adaptation.unless_saturated(learnt, before, torque, self.torque_limit)
        return Estimates(bodies, joints, filters), Command(torque, 0, theta, theta_dot)

    def _bodies(
        self, estimates: Any, drives: list[Drive], m: Measurement, v_r: list[Jet]
    ) -> tuple[list[Scalar], list[Scalar], list[Any]]:
        """Torques on the links, rotor torques, both N m, and each body's new estimate; drives: as estimated."""
        armature = tuple(0 if drive.is_elastic else drive.reflected_inertia for drive in drives)
        system = quasi_rigid(replace(self.model.system, armature=armature))
        modelled = system.segments
        believed = [inertia_of(self._inertial(x)) for x in estimates]
        segments = tuple(replace(own, inertia=M) for own, M in zip(modelled, believed, strict=True))
        system = replace(system, segments=segments)
        speeds, accelerations = zip(*(x.derivatives for x in v_r), strict=True)
        actual, required = required_motions(system, [*m.q], [*m.v], speeds, accelerations)
        # torques of the required motion with each body's estimated parameters, and their update
        tau, rotors = efforts_between(system, actual, required, speeds, accelerations, self.body_gain)
        powers = map(body_powers, actual, required)
        bodies = zip(modelled, estimates, powers, strict=True)
        return tau, rotors, [self._learnt(body, estimate, s, m.period) for body, estimate, s in bodies]

    def inertial_parameters(self, memory: Estimates) -> Array:
        """(10 n,): the current estimates for all bodies, in the order of `Robot.inertial_parameters`."""
        found: list[Scalar] = []
        for segment, estimate in zip(self.model.system.segments, memory.bodies, strict=True):
            own = inertia_of(self._inertial(estimate))
            found += parameters_of(own.seen_from_parent(Pose(segment.to_user_axes, ZERO)))
        return np.array(found)

    def _inertial(self, estimate: Any) -> list[Scalar]:
        """A body's ten parameters, in the machine's own frame, from its estimate in memory."""
        return adaptation.inertial_of_factor(estimate) if self.update == "natural" else [*estimate]

    def _learnt(self, body: Segment, estimate: Any, s: list[Scalar], period: Scalar) -> Any:
        rate, share = self.body_rate[0], self.uncertainty[0]
        if self.update == "natural":
            return adaptation.natural(estimate, s, rate, period)
        nominal_p = parameters_of(body.inertia)
        numbers = zip(estimate, s, nominal_p, nominal_sizes(nominal_p), strict=True)
        return [
            adaptation.projected(p, s_k, rate * size * size, p_0 - share * size, p_0 + share * size, period)
            for p, s_k, p_0, size in numbers
        ]


def body_powers(own: BodyMotion, wanted: BodyMotion) -> list[Scalar]:
    """Power error per unit of each of a body's ten parameters, W: W^T (V_r - V).  Zhu (2010) eq. (3.49)."""
    lag = wanted.V - own.V
    return [lag.power(Y) for Y in body_regressor(wanted.A, own.V.angular, wanted.V.angular)]
