"""Virtual power under virtual decomposition control, subsystem by subsystem.  Zhu (2010) chapter 3."""

from dataclasses import replace
from typing import Any, NamedTuple

from cutpoint.control.interface import Measurement, Reference
from cutpoint.control.laws.joint_law import JointCommand, JointGains, joint_command
from cutpoint.control.laws.vdc import VDC
from cutpoint.definitions import Machine
from cutpoint.mechanics.bodies.rigid_body import kinetic_energy
from cutpoint.mechanics.bodies.spatial import Wrench
from cutpoint.mechanics.drives.harmonic_drive import DriveState, deflection, friction_torque, required_friction
from cutpoint.mechanics.elastic_forward import elastic_forward_dynamics
from cutpoint.mechanics.inverse_dynamics import BodyMotion, joint_efforts, motions, net_wrenches, transmitted_wrenches
from cutpoint.mechanics.required_dynamics import required_motions, required_wrenches, velocity_feedback
from cutpoint.mechanics.system import Segment
from cutpoint.model.drive import Drive
from cutpoint.scalars import Scalar

Scalars = list[Scalar]
Account = tuple[Scalar, Scalar, Scalar]


class Flows(NamedTuple):
    """Storage (J), dissipation (W) and inflow of virtual power (W) of each subsystem, bodies first, then joints."""

    storage: Any
    dissipation: Any
    inflow: Any


def virtual_power_flows(machine: Machine, state: list[Scalars], law: VDC, m: Measurement, r: Reference) -> Flows:
    """Flows of a plant at `state` (q, v, theta, theta_dot, motor torques) while its law gets m and r."""
    q, v, theta, theta_dot, _ = state
    _, v_r, required_torques = law.required((), m, r)
    speeds, accelerations = ([w.derivative(k) for w in v_r] for k in range(2))
    # the bodies' required motions and wrenches, by the law's model and measurements
    model = replace(law.robot.machine_with(law.parameters).system, armature=(0,) * len(v))
    measured, required = required_motions(model, [*m.q], [*m.v], speeds, accelerations)
    F_r = required_wrenches(model, measured, required, speeds, accelerations, law.body_gain)
    # their actual ones
    plant = replace(machine.system, armature=model.armature)
    a = elastic_forward_dynamics(*machine, *state).a
    actual = motions(plant, q, v, a)
    F = net_wrenches(plant, actual, v, a)
    excess = [wanted - have for wanted, have in zip(F_r, F, strict=True)]
    gains = law.body_gain if law.body_gain is not None else [None] * len(excess)
    bodies = zip(model.segments, gains, plant.segments, required, actual, excess, strict=True)
    accounts = [_body_account(*body) for body in bodies]
    # virtual power from joints to the bodies between them
    passed = joint_efforts(plant, transmitted_wrenches(plant, [x.X for x in actual], excess, {}))
    joint_gains = map(JointGains, law.speed_gain, law.motor_gain, law.spring_gain)
    joints = zip(law.model.drives, machine.drives, joint_gains, strict=True)
    for k, (believed, driven, gain) in enumerate(joints):
        seen = DriveState(*(x[k] for x in m[2:]))
        command = joint_command(believed.drive, seen, r.q[k], v_r[k], required_torques[k], gain)
        at = DriveState(q[driven.q], v[driven.v], theta[k], theta_dot[k])
        tau_r = required_torques[k].tau_r.derivative(0)
        storage, lost = joint_account(driven.drive, at, speeds[driven.v], tau_r, command, gain)
        accounts.append((storage, lost, -(speeds[driven.v] - at.v) * passed[driven.v]))
    return Flows(*([account[k] for account in accounts] for k in range(3)))


def _body_account(
    modelled: Segment, K: Any, body: Segment, required: BodyMotion, actual: BodyMotion, excess: Wrench
) -> Account:
    """Of a body's velocity error: its kinetic energy, what the gain K of the law dissipates, and its inflow."""
    lag = required.V - actual.V
    lost = 0 if K is None else lag.power(velocity_feedback(modelled, K, required.V, actual.V))
    return kinetic_energy(body.inertia, lag), lost, lag.power(excess)


def joint_account(
    drive: Drive, at: DriveState, speed: Scalar, tau_r: Scalar, command: JointCommand, gain: JointGains
) -> tuple[Scalar, Scalar]:
    """Storage and dissipation of a joint: of its rotor's speed error, and of its spring's error of deflection."""
    lag = speed - at.v
    lost = gain.speed * lag * lag + lag * _friction_excess(drive.link_friction, speed, at.v)
    if drive.compliance is None:
        lost = lost + gain.motor * lag * lag + lag * _friction_excess(drive.motor_friction, speed, at.v)
        return drive.reflected_inertia * lag * lag / 2, lost
    behind = drive.compliance.deflection(tau_r) - deflection(drive, at.theta, at.q)
    motor_lag = command.theta_dot - at.theta_dot
    K = drive.compliance.tangent(deflection(drive, at.theta, at.q))
    storage = (K * behind * behind + drive.reflected_inertia * motor_lag * motor_lag) / 2
    lost = lost + gain.spring * K * behind * behind + gain.motor * motor_lag * motor_lag
    return storage, lost + motor_lag * _friction_excess(drive.motor_friction, command.theta_dot, at.theta_dot)


def _friction_excess(law: Any, wanted: Scalar, speed: Scalar) -> Scalar:
    return required_friction(law, wanted, speed) - friction_torque(law, speed)
