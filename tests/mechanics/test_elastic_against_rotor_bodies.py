"""Accelerations of robots whose joints bend, against dense algebra over Pinocchio and trees with rotors as bodies."""

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from cutpoint import Drive, Flexspline, LinearSpring, Rotor
from cutpoint.model import WORLD, Joint, Link
from cutpoint.model.build import build
from robot_library import BACKENDS, Array, Robot, assert_close, frictionless, robot, states
from twins import Twin, pinocchio_of, se3


def motor_states(ours: Robot, seed: int = 1) -> tuple[Array, ...]:
    """Motors near their links, where springs bend as in use; their speeds, and torques."""
    rng = np.random.default_rng(seed)
    q, v, _ = states(ours)
    driven_q, driven_v = ([getattr(d, x) for d in ours.machine.drives] for x in "qv")
    theta = q[:, driven_q] + rng.uniform(-2e-3, 2e-3, (len(q), len(driven_q)))
    theta[0] = q[0, driven_q]
    return q, v, theta, v[:, driven_v] + rng.normal(0, 0.1, theta.shape), rng.uniform(-40, 40, theta.shape)


def spring_torques(ours: Robot, q: Array, v: Array, theta: Array, theta_dot: Array) -> Array:
    """Written for itself: law (2), its linear case, and the damping."""
    found = np.zeros(len(ours.drives))
    for k, (d, driven) in enumerate(zip(ours.drives.values(), ours.machine.drives, strict=True)):
        bend, rate = theta[k] - q[driven.q], theta_dot[k] - v[driven.v]
        if isinstance(d.compliance, LinearSpring):
            found[k] = d.compliance.stiffness * bend
        elif isinstance(d.compliance, Flexspline):
            c = d.compliance.hardening
            found[k] = np.tan(bend * c * d.compliance.stiffness) / c
        found[k] += (d.damping or 0.0) * rate
    return found


def dense(ours: Robot, q: Array, v: Array, theta: Array, theta_dot: Array, motor_torque: Array) -> tuple[Array, Array]:
    """Spong (1987): M a + bias = tau - xi_link, J theta'' = u - tau - xi_motor, solved with all of M at once."""
    twin, drives = Twin(ours, pinocchio_of(ours.mechanism)), [*ours.drives.values()]
    tau, spring = -twin.bias_forces(q, v), spring_torques(ours, q, v, theta, theta_dot)
    M, alpha = twin.mass_matrix(q), np.zeros(len(drives))
    for k, (d, driven) in enumerate(zip(drives, ours.machine.drives, strict=True)):
        speed = theta_dot[k] if d.is_elastic else v[driven.v]
        u = motor_torque[k] - (d.motor_friction.torque(speed) if d.motor_friction else 0.0)
        reflected = d.ratio**2 * d.rotor.inertia if d.rotor else 0.0
        if d.is_elastic:
            alpha[k] = (u - spring[k]) / reflected
        else:
            M[driven.v, driven.v] += reflected
        tau[driven.v] += spring[k] if d.is_elastic else u
        tau[driven.v] -= d.link_friction.torque(v[driven.v]) if d.link_friction else 0.0
    a = np.linalg.solve(M, tau)
    rigid = [k for k, d in enumerate(drives) if not d.is_elastic]
    alpha[rigid] = a[[ours.machine.drives[k].v for k in rigid]]
    return a, alpha


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", ["xia2019", "mixed", "mixed_floating"])
def test_accelerations_are_those_of_the_reduced_model(name, backend):
    ours = robot(name, backend)
    for state in zip(*motor_states(ours), strict=True):
        a, alpha = dense(ours, *state)
        found = ours.elastic_forward_dynamics(*state)
        assert_close(found.a, a)
        assert_close(found.theta_ddot, alpha)


def with_rotor_bodies(ours: Robot) -> Twin:
    """The same tree in Pinocchio, each joint's parent also carrying a rotor that spins about the joint's axis.

    On a prismatic joint the rotor spins across the slide.
    """
    model = pinocchio_of(ours.mechanism)
    for body in ours.mechanism.bodies:
        axis = np.array(body.joint.axis)
        spin = np.roll(axis, 1) if body.joint.kind == "prismatic" else axis
        tensor = ours.drives[body.joint.name].rotor.inertia * np.outer(spin, spin)
        parent = 0 if body.parent == WORLD else body.parent + 1
        joint = pin.JointModelRevoluteUnaligned(spin)
        index = model.addJoint(parent, joint, se3(body.placement), f"{body.joint.name}_rotor")
        model.appendBodyToJoint(index, pin.Inertia(0.0, np.zeros(3), tensor), pin.SE3.Identity())
    return Twin(ours, model)


def full_accelerations(
    ours: Robot, q: Array, v: Array, theta: Array, theta_dot: Array, u: Array
) -> tuple[Array, Array]:
    """Of links, and of rotors over ratio; springs pull on links, and on shafts with 1 / ratio of that."""
    twin, ratio = with_rotor_bodies(ours), np.array([d.ratio for d in ours.drives.values()])
    tau = spring_torques(ours, q, v, theta, theta_dot)
    n = ours.nv
    spin = np.concatenate([v, ratio * theta_dot]), np.concatenate([tau, (u - tau) / ratio])
    a = pin.aba(twin.model, twin.data, np.concatenate([q, ratio * theta]), *spin)
    return a[:n], a[n:] / ratio


def crossed_chain() -> Robot:
    """Slides and turns so crossed that no rotor's axis ever turns with what carries it: there the models are one."""
    x, y, z = np.eye(3)
    axes = {"slide1": x, "turn2": z, "slide3": z, "turn4": x}
    joints, links = [], [Link("base")]
    for k, (name, axis) in enumerate(axes.items()):
        links.append(Link(name, 1.0 + k, np.array([0.1, 0.2, -0.1]), np.diag([0.03, 0.04, 0.05])))
        kind = "prismatic" if name.startswith("slide") else "revolute"
        placement = np.eye(4)
        placement[:3, 3] = 0.3 * y
        joints.append(Joint(f"{name}_joint", kind, links[k].name, name, placement, axis))
    mechanism = build("crossed", links, joints)
    springs = [LinearSpring(4e3), Flexspline(3e3, 0.03), LinearSpring(5e3), Flexspline(2e3, 0.1)]
    drives = [Drive(ratio=20.0 + k, rotor=Rotor(1e-4), compliance=spring) for k, spring in enumerate(springs)]
    return Robot(mechanism, dict(zip([joint.name for joint in joints], drives, strict=True)))


def test_rotors_as_bodies_that_never_turn_with_their_carrier_change_nothing():
    ours = crossed_chain()
    for state in zip(*motor_states(ours), strict=True):
        a, alpha = full_accelerations(ours, *state)
        found = ours.elastic_forward_dynamics(*state)
        assert_close(found.a, a)
        assert_close(found.theta_ddot, alpha)


def geared(ratio: float, **rotor: Any) -> Robot:
    """The paper's arm with the reflected inertias it has, but at another ratio."""
    arm = frictionless(robot("xia2019"))
    rotors = {name: Rotor(d.reflected_inertia / ratio**2, **rotor) for name, d in arm.drives.items()}
    return arm.with_drives({name: Drive(ratio, rotors[name], d.compliance) for name, d in arm.drives.items()})


@pytest.mark.parametrize("ratio", [3.0, -100.0])
def test_full_coupling_is_rotors_as_bodies_exactly(ratio):
    ours = geared(ratio, coupling="full", in_link_inertia=False)
    for state in zip(*motor_states(ours), strict=True):
        a, alpha = full_accelerations(ours, *state)
        found = ours.elastic_forward_dynamics(*state)
        assert_close(found.a, a)
        assert_close(found.theta_ddot, alpha)


def test_the_reduced_model_is_the_limit_of_rotors_as_bodies():
    """What it leaves out falls as 1 / ratio; at a ratio of 1e11 nothing is left."""
    apart = []
    for ratio in (1e3, 1e4, 1e11):
        ours = geared(ratio)
        state = [x[3] for x in motor_states(ours)]
        a, alpha = full_accelerations(ours, *state)
        found = ours.elastic_forward_dynamics(*state)
        apart.append(np.abs(found.a - a).max() / np.abs(a).max())
        assert_close(found.theta_ddot, alpha, max(1e-8, 10 / ratio))
    assert 8.0 < apart[0] / apart[1] < 12.0
    assert apart[2] < 1e-10
