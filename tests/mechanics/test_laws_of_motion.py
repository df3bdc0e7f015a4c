"""Laws that any robot's equations of motion keep, at states drawn by hypothesis, on every backend."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from random_trees import placement, rotation
from robot_library import Array, Robot, assert_close, derivative, motions, robot

ROBOTS = [("xia2019", "llvm"), ("xia2019", "numpy"), ("panda", "llvm"), ("panda_coupled", "llvm"), ("mixed", "llvm"),
          ("mixed", "numpy"), ("floating", "llvm")]  # fmt: skip

robots = pytest.mark.parametrize(("name", "backend"), ROBOTS)
drawn = given(data=st.data())


def along(ours: Robot, q: Array, v: Array, a: Array, h: float) -> tuple[Array, Array]:
    """Where a motion is after a time h, to first order: enough for first derivatives at h = 0."""
    return q + h * ours.coordinate_rates(q, v), v + h * a


@robots
@drawn
def test_mass_matrix_is_symmetric_and_positive_definite(name, backend, data):
    ours = robot(name, backend)
    q, v, _ = data.draw(motions(ours))
    M = ours.mass_matrix(q)
    assert np.array_equal(M, M.T)
    assert np.linalg.eigvalsh(M).min() > 0.0
    assert_close(ours.kinetic_energy(q, v), v @ M @ v / 2, 1e-12, scale=1e-300)


@robots
@drawn
def test_torques_are_mass_times_acceleration_plus_bias(name, backend, data):
    ours = robot(name, backend)
    q, v, a = data.draw(motions(ours))
    tau = ours.inverse_dynamics(q, v, a)
    assert_close(ours.mass_matrix(q) @ a + ours.bias_forces(q, v), tau, 1e-12, scale=10.0)
    assert_close(ours.forward_dynamics(q, v, tau), a, 1e-9, scale=1.0)


@robots
@drawn
def test_rate_of_the_mass_matrix_less_twice_c_is_skew(name, backend, data):
    """C is the sum of the bodies' matrices (61); with it, v^T (M' - 2 C) v = 0 holds for each body alone."""
    ours = robot(name, backend)
    q, v, a = data.draw(motions(ours))
    C = ours.coriolis_matrix(q, v)
    rate = derivative(lambda h: ours.mass_matrix(along(ours, q, v, a, h)[0]))
    S = rate - 2 * C
    assert_close(S, -S.T, 1e-9, scale=1.0)


@robots
@drawn
def test_c_times_v_is_the_bias_without_gravity(name, backend, data):
    ours = robot(name, backend)
    q, v, _ = data.draw(motions(ours))
    expected = ours.bias_forces(q, v) - ours.gravity_forces(q)
    assert_close(ours.coriolis_matrix(q, v) @ v, expected, 1e-11, scale=10.0)


@robots
@drawn
def test_power_of_the_torques_is_the_rate_of_energy(name, backend, data):
    ours = robot(name, backend)
    q, v, a = data.draw(motions(ours))

    def energy(h: float) -> Array:
        q_h, v_h = along(ours, q, v, a, h)
        return ours.kinetic_energy(q_h, v_h) + ours.potential_energy(q_h)

    assert_close(derivative(energy), ours.inverse_dynamics(q, v, a) @ v, 1e-9, scale=100.0)


@robots
@drawn
def test_gravity_forces_are_the_slope_of_potential_energy(name, backend, data):
    ours = robot(name, backend)
    q, v, _ = data.draw(motions(ours))
    slope = derivative(lambda h: ours.potential_energy(along(ours, q, v, v, h)[0]))
    assert_close(slope, ours.gravity_forces(q) @ v, 1e-9, scale=100.0)


@drawn
def test_momentum_is_conserved_when_floating_free(data):
    """In zero gravity no torque of the joints changes momentum."""
    ours = robot("weightless")
    q, v, a = data.draw(motions(ours))
    tau = 10.0 * a
    tau[:6] = 0.0
    found = ours.forward_dynamics(q, v, tau)
    rate = derivative(lambda h: ours.momentum(*along(ours, q, v, found, h)))
    assert_close(rate, np.zeros(6), 1e-8, scale=1.0 + np.abs(ours.momentum(q, v)).max() + np.abs(tau).max())


@drawn
def test_weight_is_the_rate_of_momentum_when_floating(data):
    ours = robot("floating")
    q, v, a = data.draw(motions(ours))
    tau = 10.0 * a
    tau[:6] = 0.0
    found = ours.forward_dynamics(q, v, tau)
    rate = derivative(lambda h: ours.momentum(*along(ours, q, v, found, h)))
    weights = [body.mass * ours.gravity for body in ours.mechanism.bodies]
    points = [ours.frame_pose(q, body.name) @ [*body.com, 1.0] for body in ours.mechanism.bodies]
    moment = sum(np.cross(p[:3], w) for p, w in zip(points, weights, strict=True))
    expected = np.concatenate([np.sum(weights, axis=0), moment])
    assert_close(rate, expected, 1e-8, scale=1.0 + np.abs(ours.momentum(q, v)).max() + np.abs(tau).max())


@pytest.mark.parametrize("name", ["xia2019", "tree"])
@pytest.mark.parametrize("seed", [0, 1])
def test_a_tilted_mounting_is_gravity_turned_the_other_way(name, seed):
    ours, tilt = robot(name, "numpy"), np.eye(4)
    tilt[:3, :3] = rotation(np.random.default_rng(seed))
    tilted, turned = ours.with_base(tilt), ours.with_gravity(tilt[:3, :3].T @ ours.gravity)
    q, v, a = np.random.default_rng(seed).normal(0, 2, (3, ours.nv))
    assert_close(tilted.inverse_dynamics(q, v, a), turned.inverse_dynamics(q, v, a), 1e-13)
    assert_close(tilted.forward_dynamics(q, v, a), turned.forward_dynamics(q, v, a), 1e-11)


def test_moving_the_base_without_tilting_it_changes_no_torque():
    ours, moved = robot("xia2019", "numpy"), placement(np.random.default_rng(2))
    moved[:3, :3] = np.eye(3)
    q, v, a = np.random.default_rng(2).normal(0, 2, (3, ours.nv))
    assert_close(ours.with_base(moved).inverse_dynamics(q, v, a), ours.inverse_dynamics(q, v, a), 1e-14)


@pytest.mark.parametrize("name", ["xia2019", "panda_coupled", "floating"])
@drawn
def test_torques_are_linear_in_the_inertial_parameters(name, data):
    ours = robot(name)
    q, v, a = data.draw(motions(ours))
    assert_close(ours.regressor(q, v, a) @ ours.inertial_parameters, ours.inverse_dynamics(q, v, a), 1e-12, scale=10.0)


@pytest.mark.parametrize("name", ["xia2019", "panda_coupled", "floating"])
@drawn
def test_velocity_map_stacks_the_jacobians_of_the_bodies(name, data):
    """Each body's six rows are its Jacobian along axes whose z is the joint's.  Xia (2019) eqs. (40)-(43)."""
    ours = robot(name)
    q, _, _ = data.draw(motions(ours))
    stacked = ours.velocity_map(q).reshape(-1, 6, ours.nv)
    for segment, body, rows in zip(ours.machine.system.segments, ours.mechanism.bodies, stacked, strict=True):
        turn = np.array([[*row] for row in segment.to_user_axes], float)
        if body.joint.kind != "floating":
            assert_close(turn[:, 2], body.joint.axis, 1e-15)
        own = ours.jacobian(q, body.name)
        assert_close(rows, np.vstack([turn.T @ own[:3], turn.T @ own[3:]]), 1e-13, scale=1.0)


@robots
@drawn
def test_speeds_are_the_rates_of_poses(name, backend, data):
    """A frame's Jacobian times v is how its pose moves."""
    ours = robot(name, backend)
    q, v, a = data.draw(motions(ours))
    frame = ours.frames[-1]
    T, V = ours.frame_pose(q, frame), ours.jacobian(q, frame) @ v
    rate = np.linalg.inv(T) @ derivative(lambda h: ours.frame_pose(along(ours, q, v, a, h)[0], frame))
    found = np.array([*rate[:3, 3], rate[2, 1], rate[0, 2], rate[1, 0]])
    assert_close(found, V, 1e-9, scale=1.0)


@robots
@drawn
@pytest.mark.parametrize("expressed_in", ["local", "world", "local_world_aligned"])
def test_accelerations_are_the_rates_of_speeds(name, backend, expressed_in, data):
    """A frame's acceleration is how its Jacobian times v changes, whatever its axes."""
    ours = robot(name, backend)
    q, v, a = data.draw(motions(ours))
    frame = ours.frames[-1]

    def speed(h):
        q_h, v_h = along(ours, q, v, a, h)[:2]
        return ours.jacobian(q_h, frame, expressed_in) @ v_h

    found = ours.frame_acceleration(q, v, a, frame, expressed_in)
    assert_close(found, derivative(speed), 1e-8, scale=1.0 + np.abs(found).max())
