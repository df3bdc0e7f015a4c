"""The cuts of virtual decomposition, what passes through them, and independence of the subsystems."""

from collections import namedtuple
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutpoint import Coulomb, Drive, Flexspline, LinearSpring, Rotor, definitions
from cutpoint.control import Feedforward, Reference
from cutpoint.kernels import Graph, graph_of
from robot_library import Array, Robot, assert_close, derivative, motions, robot

ROBOTS = [("xia2019", "llvm"), ("xia2019", "numpy"), ("panda", "llvm"), ("tree", "numpy"), ("floating", "llvm")]


def test_the_papers_arm_has_twelve_subsystems_and_eleven_cuts():
    ours = robot("xia2019")
    assert [s.kind for s in ours.subsystems] == ["joint", "link"] * 6
    assert len(ours.cuts) == 11
    names = [s.name for s in ours.subsystems]
    assert [(cut.inner, cut.outer) for cut in ours.cuts] == [*pairwise(names)]


@pytest.mark.parametrize("name", ["panda", "tree", "floating", "talos"])
def test_every_cut_joins_two_subsystems_and_none_is_left_alone(name):
    ours = robot(name)
    names = {s.name for s in ours.subsystems}
    assert {n for cut in ours.cuts for n in (cut.inner, cut.outer)} == names
    roots = sum(body.parent == -1 for body in ours.mechanism.bodies)
    assert len(ours.cuts) == len(names) - roots


@pytest.mark.parametrize(("name", "backend"), ROBOTS)
@given(data=st.data())
def test_virtual_power_flows_cancel_at_every_cut(name, backend, data):
    """What passes a cut leaves one subsystem and enters the other: each subsystem's balance closes with both.

    A link keeps what enters and does not leave: the rate of its energy.  A joint adds torque times speed.
    """
    ours = robot(name, backend)
    q, v, a = data.draw(motions(ours))
    flows = dict(zip([(cut.inner, cut.outer) for cut in ours.cuts], ours.power_flows(q, v, a), strict=True))
    tau, scale = ours.inverse_dynamics(q, v, a), 1.0 + max(map(abs, flows.values()))
    entering = {s.name: sum(p for (_, outer), p in flows.items() if outer == s.name) for s in ours.subsystems}
    leaving = {s.name: sum(p for (inner, _), p in flows.items() if inner == s.name) for s in ours.subsystems}
    for body, segment in zip(ours.mechanism.bodies, ours.machine.system.segments, strict=True):
        worked = tau[segment.v] @ v[segment.v]
        kept = derivative(lambda h, body=body: energy_of(ours, body, q + h * ours.coordinate_rates(q, v), v + h * a))
        if body.joint.kind == "floating":  # nothing carries it: the six virtual torques enter by no cut
            assert_close(worked - leaving[body.name], kept, 1e-9, scale=scale)
            continue
        assert_close(entering[body.name] - leaving[body.name], kept, 1e-9, scale=scale)
        if body.parent != -1:
            assert_close(leaving[body.joint.name] - entering[body.joint.name], worked, 1e-11, scale=scale)
        else:  # the base at rest passes no power
            assert_close(leaving[body.joint.name], worked, 1e-11, scale=scale)


def energy_of(ours: Robot, body: Any, q: Array, v: Array) -> float:
    """Of one body alone, kinetic and potential."""
    V, T = ours.jacobian(q, body.name) @ v, ours.frame_pose(q, body.name)
    at_com = V[:3] + np.cross(V[3:], body.com)
    height = -(T @ [*body.com, 1.0])[:3] @ ours.gravity
    return body.mass * (at_com @ at_com / 2 + height) + V[3:] @ body.inertia @ V[3:] / 2


SPRUNG = Drive(100.0, Rotor(1e-5), LinearSpring(1e4), link_friction=Coulomb(0.3, 0.1, 0.05))
OTHERS = {
    "flexspline": Drive(100.0, Rotor(1e-5), Flexspline(1e4, 0.05), link_friction=Coulomb(0.3, 0.1, 0.05)),
    "rigid": Drive(100.0, Rotor(1e-5)),
    "stiffer": Drive(100.0, Rotor(1e-5), LinearSpring(2e4), link_friction=Coulomb(0.3, 0.1, 0.05)),
    "motor friction, other ratio": Drive(-50.0, Rotor(1e-5), LinearSpring(1e4), motor_friction=Coulomb(0.3, 0.1, 0.05)),
}


def inverse_graph(ours: Robot) -> Graph:
    """Motor torque and motor reference of each drive as an output of its own, with all numbers folded in."""
    by_joint, law = namedtuple("ByJoint", ours.joints), Feedforward(ours)

    def traced(**motion: Any) -> Any:
        _, command = law.step((), None, Reference(**motion, theta=None, theta_dot=None))
        return by_joint(*map(list, zip(command.torque, command.theta, command.theta_dot, strict=True)))

    return graph_of(traced, **dict.fromkeys(("q", "v", "a", "jerk", "snap"), ours.nv))


def forward_graph(ours: Robot) -> Graph:
    """Motors' accelerations, and the drives' torques on the links."""
    by_joint = namedtuple("ByJoint", ours.joints)

    def traced(q: Any, v: Any, theta: Any, theta_dot: Any, motor_torque: Any) -> Any:
        state = {"q": q, "v": v, "theta": theta, "theta_dot": theta_dot, "motor_torque": motor_torque}
        alpha = definitions.elastic_forward_dynamics(ours.machine, **state).theta_ddot
        return by_joint(*([x, y] for x, y in zip(alpha, definitions.drive_torque(ours.machine, theta, q), strict=True)))

    return graph_of(traced, **dict.fromkeys(("q", "v", "theta", "theta_dot", "motor_torque"), ours.nv))


@pytest.mark.parametrize("graph", [inverse_graph, forward_graph])
@pytest.mark.parametrize("changed", range(6))
@pytest.mark.parametrize("kind", [k for k in OTHERS if k != "rigid"])
def test_changing_one_drive_leaves_every_other_subsystem_as_it_was(graph, changed, kind):
    """Node for node: the same graph of the same inputs, for every drive but the changed one."""
    arm = robot("xia2019")
    before = arm.with_drives(dict.fromkeys(arm.joints, SPRUNG))
    after = before.with_drives({arm.joints[changed]: OTHERS[kind]})
    old, new = graph(before), graph(after)
    for k, name in enumerate(arm.joints):
        assert (old.fingerprint(name) == new.fingerprint(name)) == (k != changed)


@pytest.mark.parametrize("changed", range(6))
def test_the_others_need_the_same_even_of_a_drive_that_no_longer_bends(changed):
    """Backward, a rigid drive's rotor is felt by all links as armature; the motions that the others need stay."""
    arm = robot("xia2019")
    before = arm.with_drives(dict.fromkeys(arm.joints, SPRUNG))
    after = before.with_drives({arm.joints[changed]: OTHERS["rigid"]})
    old, new = inverse_graph(before), inverse_graph(after)
    for k, name in enumerate(arm.joints):
        assert (old.fingerprint(name) == new.fingerprint(name)) == (k != changed)


@pytest.mark.parametrize("name", ["xia2019", "tree"])
def test_a_payload_on_the_last_link_leaves_every_links_motion_as_it_was(name):
    ours = robot(name)
    laden = ours.with_payload(2.0, [0.0, 0.0, 0.1], np.eye(3) * 0.01, ours.mechanism.bodies[-1].name)

    def velocities(of: Robot) -> str:
        return graph_of(lambda q: definitions.velocity_map(of.machine, q), q=of.nq).fingerprint()

    assert velocities(ours) == velocities(laden)
