"""Frequency responses: against SciPy, against dynamic stiffness, and where one joint peaks and dips."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from linear_oracles import fully_coupled, sprung, wheel
from scipy import signal

from cutpoint import Drive, InputError, LinearSpring, Robot, Rotor
from cutpoint.analysis import frequency_response
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from robot_library import assert_close, derivative, robot, states

WHEEL = wheel(inertia=0.8)
positive = st.floats(-1.0, 1.0).map(lambda x: 10.0**x)


@pytest.mark.parametrize("damping", [None, 3.0])
def test_responses_are_scipys_of_the_same_matrices(damping):
    model = sprung(WHEEL, 0.5, 2e3, damping).linearize([0.0])
    f = np.geomspace(0.5, 50.0, 40)
    found = frequency_response(model, f, "axle")
    for name, ours in (("theta_dot", found.motor_velocity), ("v", found.link_velocity)):
        row = [model.outputs.index(f"{name}.axle")]
        numerator, denominator = signal.ss2tf(model.A, model.B, model.C[row], model.D[row])
        _, theirs = signal.freqs(numerator[0], denominator, 2 * np.pi * f)
        assert np.abs(ours / theirs - 1).max() <= 1e-8


@pytest.mark.parametrize("at", [0, 3])
def test_responses_are_the_inverse_of_dynamic_stiffness(at):
    arm = robot("xia2019")
    q, f = states(arm).q[at], np.geomspace(3.0, 400.0, 30)
    lead = zip(arm.drives.values(), arm.static_deflection(q), strict=True)
    K = np.diag([derivative(lambda h, d=d, x=x: d.compliance.torque(x + h), 1e-5) for d, x in lead])
    G = np.array([derivative(lambda h, e=e: arm.gravity_forces(q + h * e)) for e in np.eye(6)]).T
    M, J = arm.mass_matrix(q), 0.114 * np.eye(6)
    model = arm.linearize(q)
    for k, joint in enumerate(arm.joints):
        found = frequency_response(model, f, joint)
        for s, motor, link in zip(2j * np.pi * f, found.motor_velocity, found.link_velocity, strict=True):
            moved = np.linalg.inv(np.block([[s**2 * M + K + G, -K], [-K, s**2 * J + K]]))[:, 6 + k]
            assert abs(motor / (s * moved[6 + k]) - 1) <= 1e-6
            assert abs(link / (s * moved[k]) - 1) <= 1e-6


@given(J=positive, K=positive.map(lambda x: 1e3 * x), M=st.just(0.8))
def test_one_joint_dips_where_its_motor_is_locked_and_peaks_at_its_mode(J, K, M):
    dip, peak = np.sqrt(K / M) / (2 * np.pi), np.sqrt(K * (1 / M + 1 / J)) / (2 * np.pi)
    found = frequency_response(sprung(WHEEL, J, K).linearize([0.0]), [dip / 2, dip, 2 * peak], "axle")
    assert_close(found.antiresonances, [dip])
    assert_close(found.resonances, [peak])
    assert abs(found.motor_velocity[1]) <= 1e-9 * abs(found.motor_velocity[0])
    assert_close(abs(found.link_velocity[1]), 2 * np.pi * dip / K, 1e-9)  # the spring alone bears the torque


def test_far_below_all_modes_motor_and_link_are_one_inertia():
    found = frequency_response(sprung(WHEEL, 0.5, 1e4).linearize([0.0]), [1e-2], "axle")
    s = 2j * np.pi * 1e-2
    assert abs(found.motor_velocity[0] * s * 1.3 - 1) <= 1e-6
    assert abs(found.link_velocity[0] * s * 1.3 - 1) <= 1e-6


def test_behind_a_rigid_drive_motor_and_link_move_as_one():
    ours = robot("mixed")
    assert not ours.drives["joint0"].is_elastic
    found = frequency_response(ours.linearize(np.zeros(ours.nq)), np.geomspace(1, 100, 9), "joint0")
    assert np.array_equal(found.motor_velocity, found.link_velocity)


def test_what_is_damped_too_much_to_peak_is_not_marked():
    K = 100.0
    marked = {
        zeta: frequency_response(
            sprung(WHEEL, 0.8, K, damping=2 * zeta * np.sqrt(K * 0.4)).linearize([0.0]), [0.1, 100.0], "axle"
        ).resonances.size
        for zeta in (0.05, 0.69, 0.73)
    }
    assert marked == {0.05: 1, 0.69: 1, 0.73: 0}


@pytest.mark.parametrize("joint", [f"joint{k}" for k in range(1, 7)])
def test_marks_are_where_the_curve_turns(joint):
    arm = fully_coupled()
    found = frequency_response(arm.linearize(np.full(6, 0.4)), np.geomspace(1.0, 1000.0, 4000), joint)
    f, size = found.frequencies, np.abs(found.motor_velocity)
    inner = size[1:-1]
    peaks = f[1:-1][(inner > size[:-2]) & (inner > size[2:])]
    dips = f[1:-1][(inner < size[:-2]) & (inner < size[2:])]
    assert len(found.resonances) >= 1
    for turning, marks in ((peaks, found.resonances), (dips, found.antiresonances)):
        for each in turning:
            assert np.abs(marks / each - 1).min() < 0.05


def test_modes_that_a_motor_hardly_moves_are_not_marked():
    modes = robot("xia2019").modes(np.radians([0, 30, 60, 0, 45, 0]))  # the forearm's plane is upright
    found = frequency_response(modes.model, [1.0, 1000.0], "joint1")
    own = [k for k in range(6) if modes.participation[k, 0] > 0.5]
    assert_close(found.resonances, modes.frequencies[own])
    assert len(own) == len(found.antiresonances) == 1


def test_wrong_frequencies_and_joints_are_refused():
    model = sprung(WHEEL, 1.0, 100.0).linearize([0.0])
    with pytest.raises(InputError, match="no driven joint is named 'elbow'; there are: 'axle'"):
        frequency_response(model, [1.0], "elbow")
    for wrong in ([], [0.0, 1.0], [-1.0], [np.inf], 3.0, [[1.0]], ["fast"]):
        with pytest.raises(InputError, match="frequencies must be"):
            frequency_response(model, wrong, "axle")


def test_a_frequency_that_is_an_undamped_resonance_is_refused():
    """Exactly, at 1 rad/s, or as near as its own eigenvalues are computed."""
    modes = robot("xia2019").modes(np.full(6, 0.3))
    exactly = sprung(wheel(inertia=1.0), 1.0, 0.5).linearize([0.0]), "axle", 1.0 / (2 * np.pi)
    for model, joint, f in [exactly, *((modes.model, "joint2", f) for f in modes.frequencies)]:
        with pytest.raises(InputError, match=r"Hz is an undamped resonance; shift it slightly, or state a damping"):
            frequency_response(model, [1.0, f], joint)
        assert np.isfinite(frequency_response(model, [1.0, 1.001 * f], joint).motor_velocity).all()


@pytest.mark.parametrize("damping", [0.005, 0.05])
def test_a_resonance_of_a_light_link_is_marked_though_its_zero_is_near(damping):
    """Rotor over link is 256, so that they lie 0.2 % apart: the motor hardly shows it, the link does."""
    found = frequency_response(sprung(wheel(1e-3), 0.256, 1e4, damping).linearize([0.0]), [100.0, 1000.0], "axle")
    locked = np.sqrt(1e4 / 1e-3) / (2 * np.pi)
    assert found.antiresonances == pytest.approx([locked], rel=1e-5)
    assert found.resonances == pytest.approx([locked * np.sqrt(1 + 1e-3 / 0.256)], rel=1e-5)


@pytest.mark.parametrize("offset", [0.0, 2e-3])
def test_what_another_joint_rings_with_is_no_mark_of_a_rigid_drive(offset):
    """Two axes at right angles: they hardly move each other, and the only sharp pole is not this joint's."""
    links = [Link("base"), *(Link(f"l{k}", 1.0, np.array([offset, 0.0, offset]), 0.05 * np.eye(3)) for k in range(2))]
    axes = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    joints = [Joint(f"j{k}", "continuous", links[k].name, links[k + 1].name, axis=axis) for k, axis in enumerate(axes)]
    arm = Robot(build("two", links, joints), {"j1": Drive(100.0, Rotor(1e-5), LinearSpring(1e4), damping=1.0)})
    model = arm.with_gravity([0.0, 0.0, 0.0]).linearize(np.zeros(2))
    rigid, elastic = (frequency_response(model, [1.0, 1000.0], joint) for joint in arm.joints)
    assert not rigid.resonances.size and not rigid.antiresonances.size
    assert len(elastic.resonances) == len(elastic.antiresonances) == 1
