"""Modes of drives: against SciPy on differences, against M, J and K, and against the textbook's one joint."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from linear_oracles import by_differences, fully_coupled, sprung, wheel, with_springs_of_their_own
from scipy.linalg import eigh, eigvals

from cutpoint import Drive, Harmonic, InputError, KinematicError, LinearSpring, MaxwellSlip, Rotor, State, simulate
from cutpoint.analysis import Modes
from cutpoint.control import Command
from random_trees import tree_of_every_kind
from robot_library import Array, Robot, assert_close, derivative, robot, states

WHEEL = wheel(inertia=0.8)
positive = st.floats(-1.0, 1.0).map(lambda x: 10.0**x)


def ringing(poles: Array, count: int) -> Array:
    """The `count` fastest of what oscillates, Hz."""
    return np.sort(np.abs(poles[poles.imag > 1e-6 * np.abs(poles).max()]))[-count:] / (2 * np.pi)


def hold_still(memory, measurement, reference):
    return memory, Command(np.zeros(1))


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("at", range(5))
def test_modes_of_the_papers_arm_are_eigenvalues_of_its_differences(at, friction):
    arm = robot("xia2019")
    found = arm.modes(states(arm).q[at], friction=friction)
    plant = arm if friction else with_springs_of_their_own(arm)
    A, _ = by_differences(plant, found.model)
    assert len(found.frequencies) == 6
    assert_close(found.frequencies, ringing(eigvals(A), 6), 1e-6)


def test_modes_of_fully_coupled_rotors_are_eigenvalues_of_their_differences():
    arm = fully_coupled()
    found = arm.modes(states(arm).q[3])
    A, _ = by_differences(arm, found.model)
    assert_close(found.frequencies, ringing(eigvals(A), 6), 1e-6)
    assert (found.damping > 1e-3).all()


@pytest.mark.parametrize("at", range(5))
def test_undamped_modes_solve_the_problem_of_m_j_and_k(at):
    arm = robot("xia2019")
    q = states(arm).q[at]
    found = arm.modes(q)
    drives = [*arm.drives.values()]
    lead = zip(drives, arm.static_deflection(q), strict=True)
    K = np.diag([derivative(lambda h, d=d, x=x: d.compliance.torque(x + h), 1e-5) for d, x in lead])
    G = np.array([derivative(lambda h, e=e: arm.gravity_forces(q + h * e)) for e in np.eye(6)])
    inertia = np.block([[arm.mass_matrix(q), np.zeros((6, 6))], [np.zeros((6, 6)), np.eye(6) * 0.114]])
    squares, shapes = eigh(np.block([[K + (G + G.T) / 2, -K], [-K, K]]), inertia)
    assert_close(found.frequencies, np.sqrt(squares[-6:]) / (2 * np.pi), 1e-8)
    for k in range(6):  # shapes up to a factor
        ours, theirs = np.r_[found.link[k], found.motor[k]], shapes[:, 6 + k]
        factor = (theirs @ ours) / (theirs @ theirs)
        assert_close(np.abs(ours - factor * theirs), np.zeros(12), 1e-6, scale=1.0)
        strain = np.diag(K) * (theirs[6:] - theirs[:6]) ** 2
        assert_close(found.participation[k], strain / strain.sum(), 1e-6)


def assert_is_eigenvector(found: Modes) -> None:
    """s^2 (link, motor) is what the model's accelerations make of the shape."""
    n = found.link.shape[1]
    names = {name: k for k, name in enumerate(found.model.states)}
    elastic = [k for k, name in enumerate(found.model.joints) if f"theta.{name}" in names]
    for k, (f, zeta) in enumerate(zip(found.frequencies, found.damping, strict=True)):
        s = 2 * np.pi * f * complex(-zeta, np.sqrt(1 - zeta**2))
        position = np.r_[found.link[k], np.zeros(n), found.motor[k, elastic], np.zeros(len(elastic))]
        position[n : 2 * n], position[2 * n + len(elastic) :] = s * found.link[k], s * found.motor[k, elastic]
        assert np.abs(found.model.A @ position - s * position).max() <= 1e-8 * abs(s) ** 2


@pytest.mark.parametrize("seed", [3, 57, 76])
def test_every_drive_has_its_mode_on_trees_that_fall_and_swing(seed):
    """Columns that are zero but for rounding, of what gravity does not touch, spoil no eigenvector."""
    free = Robot(tree_of_every_kind(seed))
    drive = Drive(100.0, Rotor(1e-3), LinearSpring(2e4), damping=2.0)
    ours = free.with_drives(dict.fromkeys(free.joints, drive))
    for q in ours.random(seed, 5):
        found = ours.modes(q)
        assert len(found.frequencies) == len(ours.drives)
        assert_is_eigenvector(found)


@pytest.mark.parametrize(
    ("name", "friction"), [("xia2019", False), ("xia2019", True), ("mixed", False), ("mixed_floating", True)]
)
def test_shapes_are_eigenvectors_with_a_largest_entry_of_one(name, friction):
    ours = robot(name)
    found = ours.modes(states(ours).q[3], friction=friction)
    assert_is_eigenvector(found)
    assert len(found.frequencies) >= 1
    assert_close(np.abs(np.hstack([found.link, found.motor])).max(axis=1), np.ones(len(found.frequencies)))
    assert_close(found.participation.sum(axis=1), np.ones(len(found.frequencies)))


@pytest.mark.parametrize("name", ["mixed", "mixed_floating"])
def test_each_elastic_drive_brings_one_mode_and_rigid_ones_none(name):
    ours = robot(name).with_gravity([0.0, 0.0, 0.0])
    found = ours.modes(states(ours).q[3])
    elastic = np.array([d.is_elastic for d in ours.drives.values()])
    assert len(found.frequencies) == found.elastic == elastic.sum()
    assert found.remark == ""
    assert (found.participation[:, ~elastic] == 0.0).all()
    links = found.link[:, [d.v for d in ours.machine.drives]]
    assert_close(np.abs(found.motor - links)[:, ~elastic], np.zeros_like(links[:, ~elastic], float), 1e-12, scale=1.0)
    # the rest of the poles: everything turning freely, at no frequency
    rest = np.sort(np.abs(found.poles))[: 2 * ours.nv]
    assert rest.max() <= 1e-4 * np.abs(found.poles).max()


def test_swinging_under_gravity_is_no_drive_mode():
    found = robot("xia2019").modes([0.0, -np.pi / 2, 0.0, 0.0, 0.0, 0.0])  # hanging straight down
    slow = found.poles[(found.poles.imag > 1.0) & (np.abs(found.poles) < 10.0)]
    assert slow.size == 3  # rad/s: a pendulum about joints 2, 3 and 5, whose rotors turn along
    assert found.frequencies.min() * 2 * np.pi > 100.0
    assert len(found.frequencies) == 6


@given(J=positive, K=positive.map(lambda x: 1e3 * x), M=st.just(0.8))
def test_one_joint_rings_at_the_textbooks_frequency(J, K, M):
    found = sprung(WHEEL, J, K).modes([0.3])
    assert_close(found.frequencies, [np.sqrt(K * (1 / M + 1 / J)) / (2 * np.pi)])
    assert_close(found.damping, [0.0], scale=1.0)
    assert abs(found.motor[0, 0] / found.link[0, 0] * J / M + 1) <= 1e-9


@given(J=positive, K=positive.map(lambda x: 1e3 * x), zeta=st.floats(0.001, 0.95))
def test_a_damped_spring_has_the_textbooks_damping_ratio(J, K, zeta):
    reduced = 0.8 * J / (0.8 + J)
    found = sprung(WHEEL, J, K, damping=2 * zeta * np.sqrt(K * reduced)).modes([0.0])
    assert_close(found.frequencies, [np.sqrt(K / reduced) / (2 * np.pi)], 1e-8)
    assert_close(found.damping, [zeta], 1e-8)


def test_an_overdamped_drive_is_not_listed_but_told():
    found = sprung(WHEEL, 1.0, 100.0, damping=1e3).modes([0.0])
    assert found.frequencies.shape == (0,)
    assert found.remark == "1 of 1 drive modes are overdamped, or are slower than 1e-06 of the fastest pole"
    assert str(found) == found.remark


def test_friction_that_locks_the_link_leaves_the_motor_on_its_spring():
    found = sprung(WHEEL, 0.5, 2e3, viscous=1e7).modes([0.0], friction=True)
    assert_close(found.frequencies, [np.sqrt(2e3 / 0.5) / (2 * np.pi)], 1e-3)


@pytest.mark.parametrize("drives", [{}, {"joint1": Drive(ratio=100.0)}])
def test_a_rigid_robot_has_no_drive_modes_and_says_so(drives):
    rigid = Robot(robot("xia2019").mechanism, drives)
    found = rigid.modes(np.zeros(6))
    assert found.frequencies.shape == found.damping.shape == (0,)
    assert found.link.shape == found.motor.shape == found.participation.shape == (0, 6)
    assert "no drive bends" in str(found)
    with pytest.raises(InputError, match="no drive bends"):
        found.plot()


def test_both_sides_of_a_rigid_drive_are_drawn_in_phase():
    figure = robot("xia2019").with_drives({"joint4": Drive(ratio=100.0)}).modes(np.full(6, 0.5)).plot()
    for k in range(6):
        link, motor = (line.get_ydata() for line in figure.axes[2 * k + 1].get_lines()[:2])
        apart = np.nanmax(np.abs(np.subtract(link, motor)))
        assert apart == 0.0 if k == 3 else apart >= 90.0


def test_the_joint_that_bends_most_is_named_first():
    found = robot("xia2019").modes(np.zeros(6))
    for k in range(6):
        named = found.joints_of(k)
        assert [*named.values()] == sorted(named.values(), reverse=True)
        assert next(iter(named)) == found.model.joints[int(found.participation[k].argmax())]
        assert next(iter(named)) in str(found).splitlines()[k]


def test_stiffer_drives_ring_higher():
    slow, fast = sprung(WHEEL, 1.0, 100.0), sprung(WHEEL, 1.0, 400.0)
    assert_close(fast.modes([0.0]).frequencies, 2 * slow.modes([0.0]).frequencies)


def test_wrong_configurations_are_refused():
    with pytest.raises(InputError, match="last axis must be 6"):
        robot("xia2019").modes([0.0])
    with pytest.raises(InputError, match=r"q\[1\] is inf"):
        robot("xia2019").modes([0.0, np.inf, 0, 0, 0, 0])


def test_swinging_under_its_weight_is_no_mode_of_a_drive_with_kinematic_error():
    """There motor and link turn differently though no spring bends."""
    arm = robot("xia2019")
    erring = KinematicError((Harmonic(2, 2e-4, 0.4),))
    arm = arm.with_drives({name: replace(d, kinematic_error=erring) for name, d in arm.drives.items()})
    for q in arm.random(seed=0, size=20):
        found = arm.modes(q)
        assert len(found.frequencies) == 6
        assert found.frequencies.min() > 20.0


def test_hysteresis_that_sticks_raises_the_frequency_by_what_is_said():
    elements = MaxwellSlip((3e3, 1e3), (1e-4, 2e-4))
    arm = WHEEL.with_drives({"axle": Drive(1.0, Rotor(0.5), LinearSpring(5e3), hysteresis=elements)})
    found = arm.modes([0.0])
    assert found.stiffening == pytest.approx(1.8)
    assert found.remark.endswith("it makes springs up to 1.80 times as stiff, and frequencies higher")
    wound = State(np.zeros(1), np.zeros(1), np.array([1e-6]), np.zeros(1))  # rad, a hundredth of what lets them slip
    log = simulate(arm, hold_still, duration=0.5, initial=wound, control_period=1e-4, hold=True)
    deflection = (log["theta"] - log["q"])[:, 0]
    crossings = log.time[1:][np.diff(np.sign(deflection)) > 0]
    rung = 1 / np.diff(crossings).mean()
    assert rung == pytest.approx(np.sqrt(1.8) * found.frequencies[0], rel=1e-3)
