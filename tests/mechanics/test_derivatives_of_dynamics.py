"""Derivatives of a robot's dynamics: against Pinocchio, against jets, against differences, and against each other."""

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from test_against_pinocchio import twin_of

from cutpoint import Drive, LinearSpring, Rotor, derivatives, robots
from cutpoint.derivatives.sweeps import elastic_forward_dynamics
from cutpoint.drive_slopes import STATE
from cutpoint.errors import InputError
from cutpoint.model import Link
from cutpoint.model.build import build
from large_robots import chain
from random_trees import random_tree, tree_of_every_kind
from robot_library import BACKENDS, Array, Robot, assert_close, derivative, robot, states
from twins import Twin

CASES = [("ur10", "llvm"), ("ur10", "numpy"), ("panda", "llvm"), ("xia2019", "llvm"), ("tree", "numpy")]
CASES += [("floating", "numpy")]

both = pytest.mark.parametrize(("name", "backend"), CASES)


def square(twin: Twin, matrix: Any) -> Array:
    """A matrix of Pinocchio's, rows and columns in our order."""
    return twin.ours(twin.ours(matrix).T).T


def symmetric(upper: Any) -> Array:
    """What Pinocchio fills above the diagonal only."""
    return np.triu(upper) + np.triu(upper, 1).T


def weight(robot: Robot) -> float:
    """N: what sums of torques over bodies are measured by where they cancel, at 1 m."""
    return 10.0 * sum(body.mass for body in robot.mechanism.bodies)


@both
def test_inverse_dynamics(name: str, backend: str) -> None:
    twin = twin_of(name, backend)
    s = states(twin.robot)
    for *ours, q, v, a in zip(*derivatives.inverse_dynamics(twin.robot, *s), *s, strict=True):
        pin.computeRNEADerivatives(twin.model, twin.data, *twin.theirs(q, v, a))
        theirs = (twin.data.dtau_dq, twin.data.dtau_dv, symmetric(twin.data.M))
        # at rest, torques of gravity may cancel in d_q
        for x, y, scale in zip(ours, theirs, (weight(twin.robot), 0.0, 0.0), strict=True):
            assert_close(x, square(twin, y), scale=scale)


@both
def test_forward_dynamics(name: str, backend: str) -> None:
    twin = twin_of(name, backend)
    s = states(twin.robot)
    for *ours, q, v, tau in zip(*derivatives.forward_dynamics(twin.robot, *s), *s, strict=True):
        pin.computeABADerivatives(twin.model, twin.data, *twin.theirs(q, v, tau))
        theirs = (twin.data.ddq_dq, twin.data.ddq_dv, symmetric(twin.data.Minv))
        # what a torque of the weight's size makes of accelerations
        scales = (weight(twin.robot) * np.abs(theirs[2]).max(), 0.0, 0.0)
        for x, y, scale in zip(ours, theirs, scales, strict=True):
            assert_close(x, square(twin, y), scale=scale)


SLIDING = ("revolute", "prismatic", "helical", "revolute")
TREES = [*map(tree_of_every_kind, range(4)), chain(5, SLIDING), chain(7, SLIDING[1:]), random_tree(3, 8)]
"""Of every kind of joint, and of such with one axis each, of which the mechanics have rules of their own."""


@pytest.mark.parametrize("seed", range(len(TREES)))
def test_slopes_of_every_joint_kind_are_those_of_integration(seed: int) -> None:
    ours = Robot(TREES[seed], backend="numpy")
    rng = np.random.default_rng(seed)
    q, (v, a) = ours.random(seed), rng.uniform(-2, 2, (2, ours.nv))
    unit = np.eye(ours.nv)

    def moved(t: float) -> Array:
        return ours.integrate(q, unit, t)

    inverse, forward = derivatives.inverse_dynamics(ours, q, v, a), derivatives.forward_dynamics(ours, q, v, a)
    assert_close(inverse.d_q.T, derivative(lambda t: ours.inverse_dynamics(moved(t), v, a)), 1e-8)
    assert_close(inverse.d_v.T, derivative(lambda t: ours.inverse_dynamics(q, v + t * unit, a)), 1e-8)
    assert_close(inverse.d_a, ours.mass_matrix(q), 1e-12)
    assert_close(forward.d_q.T, derivative(lambda t: ours.forward_dynamics(moved(t), v, a)), 1e-8)
    assert_close(forward.d_v.T, derivative(lambda t: ours.forward_dynamics(q, v + t * unit, a)), 1e-8)
    assert_close(forward.d_tau @ inverse.d_a, unit, 1e-10)


def test_coordinates_that_follow_others_count_with_their_leaders() -> None:
    ours = robot("panda_coupled", "numpy")
    q, v, a = (x[3] for x in states(ours))
    unit = np.eye(ours.nv)
    found, forward = derivatives.inverse_dynamics(ours, q, v, a), derivatives.forward_dynamics(ours, q, v, a)
    assert_close(found.d_q.T, derivative(lambda t: ours.inverse_dynamics(q + t * unit, v, a)), 1e-8)
    assert_close(found.d_a, ours.mass_matrix(q), 1e-12)
    assert_close(forward.d_q.T, derivative(lambda t: ours.forward_dynamics(q + t * unit, v, a)), 1e-8)


# robots whose joints bend


def elastic_state(robot: Robot, seed: int) -> tuple[Array, ...]:
    """q, v, theta, theta_dot, motor_torque with springs under some load."""
    rng = np.random.default_rng(seed)
    drives, driven = len(robot.drives), [d.q for d in robot.machine.drives]
    q, v = robot.random(rng), rng.uniform(-1, 1, robot.nv)
    theta = q[driven] + rng.uniform(-1e-3, 1e-3, drives)
    return q, v, theta, rng.uniform(-1, 1, drives), rng.uniform(-20, 20, drives)


@pytest.mark.parametrize("name", ["xia2019", "mixed", "mixed_floating", "rigid", "damped"])
def test_elastic_forward_dynamics_are_what_jets_make_of_them(name: str) -> None:
    ours = robot(name, "numpy")
    for seed in range(3):
        state = dict(zip(STATE, elastic_state(ours, seed), strict=True))
        found, jets = derivatives.elastic_forward_dynamics(ours, **state), elastic_forward_dynamics(ours, **state)
        for x, y in zip(found, jets, strict=True):
            assert_close(x, y, 1e-12, scale=1.0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_robots_without_drives_have_derivatives_too(backend: str) -> None:
    ours = Robot(chain(3, ("helical",)), backend=backend)
    q, v, none = ours.random(1), np.ones(3), np.zeros(0)
    found = derivatives.elastic_forward_dynamics(ours, q, v, none, none, none)
    rigid = derivatives.forward_dynamics(ours, q, v, np.zeros(3))
    assert_close(found.d_a_d_q, rigid.d_q, 1e-13)
    assert [x.shape for x in found[2:5]] == [(3, 0)] * 3
    still = derivatives.forward_dynamics(ours, q, 0 * v, 0 * v)
    assert_close(ours.linearize(q).A[3:, :3], still.d_q, 1e-13)


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_snap_of_links_is_felt_through_springs_by_rotors(backend: str) -> None:
    ours = robot("linear", backend)
    q, v, a, jerk, snap = np.random.default_rng(1).uniform(-1, 1, (5, 3, ours.nv))
    found = derivatives.elastic_inverse_dynamics(ours, q, v, a, jerk, snap)
    (drive, *_) = ours.drives.values()
    softness = drive.reflected_inertia / drive.compliance.stiffness
    # theta'' = q'' + tau'' / K, and tau'' holds M snap
    assert_close(found.d_snap, softness * ours.mass_matrix(q), 1e-13)
    assert found.d_q.shape == (3, ours.nv, ours.nv) and found.d_higher == ()


OPTIONS = {
    "flexspline": {},
    "linear": {},
    "mixed_floating": {"quasi_rigid": True},
    "friction": {"friction_rates": True},
}


@pytest.mark.parametrize(("name", "options"), OPTIONS.items())
def test_elastic_inverse_dynamics_are_their_differences(name: str, options: dict[str, bool]) -> None:
    ours = robot(name, "numpy")
    rng, unit = np.random.default_rng(2), np.eye(ours.nv)
    # fast enough that friction, smoothed within 0.05 rad/s, is smooth over the steps of the differences
    q, rates = ours.random(rng), [rng.choice([-1, 1], ours.nv) * rng.uniform(1.0, 1.5, ours.nv) for _ in range(4)]
    found = derivatives.elastic_inverse_dynamics(ours, q, *rates, **options)

    def torque(q: Array, *rates: Array) -> Array:
        return ours.elastic_inverse_dynamics(q, *rates, **options)[0]

    assert_close(found.d_q.T, derivative(lambda t: torque(ours.integrate(q, unit, t), *rates)), 1e-8)
    for k, d_rate in enumerate(found[1:5]):
        moved = derivative(lambda t, k=k: torque(q, *rates[:k], rates[k] + t * unit, *rates[k + 1 :]))
        assert_close(d_rate.T, moved, 1e-8, scale=np.abs(found.d_a).max())


def test_rotors_with_full_coupling_take_further_rates() -> None:
    arm = driven_by_full_coupling()
    needed = arm.derivatives_needed
    rng, unit = np.random.default_rng(3), np.eye(arm.nv)
    q, *rates = rng.uniform(-1, 1, (needed + 1, arm.nv))
    found = derivatives.elastic_inverse_dynamics(arm, q, *rates)
    assert needed > 4 and len(found.d_higher) == needed - 4
    moved = derivative(lambda t: arm.elastic_inverse_dynamics(q, *rates[:-1], rates[-1] + t * unit).motor_torque)
    assert_close(found.d_higher[-1].T, moved, 1e-8, scale=np.abs(found.d_snap).max())
    with pytest.raises(InputError, match=r"derivative_\d+ missing: rotors with full coupling take"):
        derivatives.elastic_inverse_dynamics(arm, q, *rates[:-1])


def driven_by_full_coupling() -> Robot:
    arm = robots.xia2019()
    drive = Drive(100.0, Rotor(1.14e-5, coupling="full"), compliance=LinearSpring(8e3))
    return Robot(arm.mechanism, {name: drive for name in arm.joints[:2]}, backend="numpy")


# calls


def test_batches_broadcast_and_bad_input_is_named() -> None:
    ours = robot("ur10")
    q, v, a = states(ours)
    found = derivatives.inverse_dynamics(ours, q[:, None], v[0], a)
    assert {x.shape for x in found} == {(7, 7, 6, 6)}
    assert np.array_equal(found.d_q[2, 4], derivatives.inverse_dynamics(ours, q[2], v[0], a[4]).d_q)
    with pytest.raises(InputError, match=r"inverse_dynamics_derivatives: v has shape \(5,\)"):
        derivatives.inverse_dynamics(ours, q[0], v[0, :5], a[0])
    with pytest.raises(InputError, match=r"q\[2\] is nan"):
        derivatives.forward_dynamics(ours, [0.0, 0.0, np.nan, 0.0, 0.0, 0.0], v[0], a[0])


def test_drives_are_inputs_of_the_kernels() -> None:
    bare = robot("xia2019", "numpy")
    state = elastic_state(bare, 0)
    derivatives.elastic_forward_dynamics(bare, *state)
    names = [port.name for port in bare.kernel("elastic_forward_dynamics_derivatives").graph.inputs]
    assert names == ["q", "v", "theta", "theta_dot", "motor_torque", "parameters"]


def test_a_robot_without_joints_has_empty_derivatives() -> None:
    stone = Robot(build("stone", [Link("base", 1.0, np.zeros(3), np.eye(3))], []))
    for found in (derivatives.inverse_dynamics(stone, [], [], []), derivatives.forward_dynamics(stone, [], [], [])):
        assert [x.size for x in found] == [0, 0, 0]
