"""Linear models: derivatives against differences, equilibria, and small motions of the simulated robot."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from linear_oracles import by_differences, fully_coupled, sprung, wheel, with_springs_of_their_own
from scipy.linalg import expm

import cutpoint
from cutpoint import InputError, State
from cutpoint.analysis.plant import kernels_of
from cutpoint.control import PD, slowest_pole, tune
from cutpoint.model import Joint, Limits, Link
from cutpoint.model.build import build
from robot_library import BACKENDS, Array, Robot, assert_close, derivative, robot, states

NAMES = ["xia2019", "mixed", "mixed_floating", "panda_coupled", "full"]


@cache
def library(name: str) -> Robot:
    return fully_coupled() if name == "full" else robot(name)


def assert_rows_close(ours: Array, theirs: Array, tolerance: float) -> None:
    """Equal within tolerance times the largest entry of each row."""
    size = np.abs(theirs).max(axis=1, keepdims=True) + np.abs(theirs).max() * 1e-9
    assert np.abs((ours - theirs) / size).max() <= tolerance


@pytest.mark.parametrize("at", [0, 2, 3])
@pytest.mark.parametrize("name", NAMES)
def test_matrices_are_the_slopes_of_the_plant_at_rest(name, at):
    ours = library(name)
    model = ours.linearize(states(ours).q[at], friction=True)
    A, B = by_differences(ours, model)
    assert_rows_close(model.A, A, 1e-7)
    assert_rows_close(model.B, B, 1e-7)


@pytest.mark.parametrize("name", ["xia2019", "mixed", "full"])
def test_matrices_are_the_slopes_of_the_plant_in_motion(name):
    ours, rng = library(name), np.random.default_rng(5)
    q, v, u = rng.uniform(-1, 1, ours.nq), rng.uniform(-1, 1, ours.nv), rng.uniform(-9, 9, len(ours.drives))
    model = ours.linearize(q, v, u, friction=True)
    A, B = by_differences(ours, model)
    assert_rows_close(model.A, A, 1e-7)
    assert_rows_close(model.B, B, 1e-7)


@pytest.mark.parametrize("name", ["xia2019", "mixed"])
def test_without_friction_only_the_springs_damp(name):
    ours = library(name)
    q = states(ours).q[3]
    assert_close(ours.linearize(q).A, with_springs_of_their_own(ours).linearize(q, friction=True).A)
    assert np.abs(ours.linearize(q).A - ours.linearize(q, friction=True).A).max() > 0.1


@pytest.mark.parametrize("name", ["xia2019", "mixed", "full"])
def test_the_default_operating_point_is_an_equilibrium(name):
    ours = library(name)
    q = states(ours).q[3]
    model = ours.linearize(q, friction=True)
    assert_close(model.point.theta, model.point.q + ours.static_deflection(q))
    assert_close(model.point.motor_torque, ours.gravity_forces(q))
    assert np.abs(model.drift).max() <= 1e-9 * np.abs(model.A).max()


def test_a_floating_base_falls_and_the_drift_says_how():
    ours = library("mixed_floating")
    model = ours.linearize(states(ours).q[3])
    state = (model.point.q, model.point.v, model.point.theta, model.point.theta_dot, model.point.motor_torque)
    a = ours.elastic_forward_dynamics(*state).a
    assert np.abs(a[:3]).max() > 0.1
    assert_close(model.drift[ours.nv : 2 * ours.nv], a)


def test_a_motion_at_constant_speed_accelerates_no_link():
    ours, v = library("xia2019"), np.full(6, 0.7)
    model = ours.linearize(states(ours).q[3], v, friction=True)
    assert_close(model.drift[:6], v)
    assert np.abs(model.drift[6:12]).max() <= 1e-9


def test_every_number_has_its_name():
    ours = library("mixed_floating")
    model = ours.linearize(ours.neutral())
    assert model.A.shape == (len(model.states),) * 2
    assert model.B.shape == (len(model.states), len(model.inputs))
    assert model.C.shape == (len(model.outputs), len(model.states))
    assert model.D.shape == (len(model.outputs), len(model.inputs))
    assert model.inputs == tuple(f"motor_torque.{name}" for name in ours.joints)
    elastic = [name for name, d in ours.drives.items() if d.is_elastic]
    assert [s for s in model.states if s.startswith("theta.")] == [f"theta.{name}" for name in elastic]
    assert sum("[" in s for s in model.states) == 12  # six tangent coordinates of the base and their speeds


def test_outputs_read_states_and_a_rigid_motor_reads_its_link():
    ours = library("mixed")
    model = ours.linearize(ours.neutral())
    rows, states_ = dict(zip(model.outputs, model.C, strict=True)), np.array(model.states)
    for name, drive in ours.drives.items():
        for motor, link in (("theta", "q"), ("theta_dot", "v")):
            seen = states_[rows[f"{motor}.{name}"] == 1.0]
            assert [*seen] == [f"{motor if drive.is_elastic else link}.{name}"]
    assert np.array_equal(model.C.sum(axis=1), np.ones(len(model.outputs)))


@dataclass(frozen=True)
class Constant:
    """The same torque for ever."""

    torque: tuple[float, ...]

    def step(self, memory, measured, reference):
        return memory, np.array([*self.torque])


@pytest.mark.parametrize("name", ["xia2019", "full"])
def test_a_small_step_moves_the_simulated_robot_as_the_model_says(name):
    ours = library(name)
    q, step, duration = np.array([0.3, 0.5, -0.4, 0.2, 0.9, 0.1]), 1e-4 * np.arange(1.0, 7.0), 0.05
    model = ours.linearize(q, friction=True)
    law = Constant(tuple(model.point.motor_torque + step))
    log = cutpoint.simulate(ours, law, duration=duration, initial=State(q=q), accuracy="reference")
    moved = np.concatenate([log[c][-1] for c in ("q", "v", "theta", "theta_dot")])
    rest = np.concatenate([model.point.q, model.point.v, model.point.theta, model.point.theta_dot])
    system = np.zeros((25, 25))  # x' = A x + B u with the constant u as one more state
    system[:24, :24], system[:24, 24] = model.A, model.B @ step
    expected = expm(system * log.time[-1])[:24, 24]
    for part in np.split(np.arange(24), 4):
        assert_close((moved - rest)[part], expected[part], 1e-4)


def test_both_backends_give_the_same_model():
    models = [robot("mixed", backend).linearize(states(robot("mixed")).q[3], friction=True) for backend in BACKENDS]
    assert_close(models[0].A, models[1].A, 1e-12)


def test_gravity_stiffens_or_softens_the_links_as_its_slope():
    ours = library("xia2019")
    q = states(ours).q[3]
    G = np.array([derivative(lambda h, e=e: ours.gravity_forces(q + h * e)) for e in np.eye(6)]).T
    model = ours.linearize(q)
    springs = -model.A[6:12, 12:18]  # M^-1 K, seen from the motors
    assert_close(ours.mass_matrix(q) @ (model.A[6:12, :6] - springs), -G, 1e-8)


def test_other_numbers_in_the_drives_do_not_compile_again():
    base = wheel()
    one, other = sprung(base, 1.0, 100.0), sprung(base, 2.0, 300.0)
    assert kernels_of(one, False) is kernels_of(other, False)
    assert other.linearize([0.0]).A[3, 2] == -150.0


def test_wrong_operating_points_are_refused():
    ours, floating = library("xia2019"), library("mixed_floating")
    with pytest.raises(InputError, match="last axis must be 6"):
        ours.linearize(np.zeros(5))
    with pytest.raises(InputError, match="a single configuration"):
        ours.linearize(np.zeros((2, 6)))
    with pytest.raises(InputError, match=r"v\[3\] is nan"):
        ours.linearize(np.zeros(6), v=[0, 0, 0, np.nan, 0, 0])
    with pytest.raises(InputError, match="motor_torque has shape"):
        ours.linearize(np.zeros(6), motor_torque=np.zeros(7))
    with pytest.raises(InputError, match=r"one entry for each drive, but floating joint '\w+' has coordinates too"):
        floating.linearize(np.zeros(len(floating.joints)))
    with pytest.raises(InputError, match="must be zero: its tangent frame would turn"):
        floating.linearize(floating.neutral(), v=np.ones(floating.nv))


ASKED = {
    "linearize": lambda ours, q: ours.linearize(q),
    "modes": lambda ours, q: ours.modes(q),
    "tune": lambda ours, q: tune(ours, 3.0, q=q),
    "slowest_pole": lambda ours, q: slowest_pole(ours, PD([10.0] * 6, [1.0] * 6), q, 1e-3),
}


@pytest.mark.parametrize("ask", ASKED.values(), ids=ASKED)
def test_a_pose_in_degrees_is_refused_where_limits_show_it(ask):
    arm, q = library("xia2019"), np.array([0.0, 30.0, 60.0, 0.0, 45.0, 0.0])
    bodies = [
        replace(x, joint=replace(x.joint, kind="revolute", limits=Limits(-3.0, 3.0))) for x in arm.mechanism.bodies
    ]
    limited = Robot(replace(arm.mechanism, bodies=tuple(bodies)), arm.drives)
    with pytest.raises(InputError, match=r"'joint2': position 30 rad exceeds .* \[-3, 3\]; this looks like degrees"):
        ask(limited, q)
    ask(limited, np.radians(q))


def test_a_robot_that_cannot_move_is_refused():
    post = Robot(build("post", [Link("base"), Link("top")], [Joint("weld", "fixed", "base", "top")]))
    with pytest.raises(InputError, match="robot 'post' has no joint that moves"):
        post.linearize([])
