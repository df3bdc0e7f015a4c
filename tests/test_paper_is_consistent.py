"""The transcript of the paper agrees with itself, with Newton's laws and with the paper's own Table 3."""

import numpy as np
import pytest

from paper import DEFINITIONS, EQUATIONS, appendix, arm, data, joint, manipulator, simulation

STEP = 1e-30  # of a complex step: its square is nothing, so the derivative is exact
STATES = [np.zeros((3, 6)), *np.random.default_rng(0).uniform(-2, 2, (4, 3, 6)), np.full((3, 6), 1e-9)]

MASS, CENTROID = 1.7, np.array([0.2, -0.1, 0.3])
INERTIA = np.array([[0.5, 0.1, 0.05], [0.1, 0.6, -0.02], [0.05, -0.02, 0.7]])


def derivative(function, at):
    """Exact derivative of an array-valued function, by a complex step."""
    return np.imag(function(at + 1j * STEP)) / STEP


def rotation(t):
    """A body that turns about the world's z and about its own x."""
    c, s, d, e = np.cos(t), np.sin(t), np.cos(2 * t + 0.3), np.sin(2 * t + 0.3)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, d, -e], [0, e, d]])


def position(t):
    return np.array([np.sin(t), 0.3 * t**2, np.cos(1.7 * t)])


def velocity(t):
    linear = np.array([np.cos(t), 0.6 * t, -1.7 * np.sin(1.7 * t)])
    return np.concatenate([rotation(t).T @ linear, rotation(t).T @ [0, 0, 1] + [2, 0, 0]])


def world_momentum(t):
    """Linear momentum, and angular momentum about the world's origin."""
    R, V = rotation(t), velocity(t)
    P = MASS * R @ (V[:3] + appendix.cross(V[3:]) @ CENTROID)
    return np.concatenate([P, appendix.cross(position(t) + R @ CENTROID) @ P + R @ INERTIA @ V[3:]])


def test_every_number_is_transcribed_or_a_definition_but_not_both():
    assert {f"({i})" for i in range(1, 64)} == set(EQUATIONS) | set(DEFINITIONS)
    assert not set(EQUATIONS) & set(DEFINITIONS)


def test_every_corrected_reading_reaches_the_registry():
    for function in {equation.function for equation in EQUATIONS.values()}:
        told = [e.correction for e in EQUATIONS.values() if e.function is function and e.correction]
        assert bool(told) == ("Corrected" in function.__doc__), function.__name__


@pytest.mark.parametrize("t", [0.0, 0.4, 2.0])
def test_net_wrench_is_the_rate_of_momentum_plus_the_weight_borne(t):
    R, p = rotation(t), position(t)
    weight = MASS * data.G_UP
    rate = derivative(world_momentum, t) + np.concatenate([weight, appendix.cross(p + R @ CENTROID) @ weight])
    in_body = np.concatenate([R.T @ rate[:3], R.T @ (rate[3:] - appendix.cross(p) @ rate[:3])])
    F_star = appendix.net_wrench(MASS, CENTROID, INERTIA, R.T, data.G_UP, velocity(t), derivative(velocity, t))
    np.testing.assert_allclose(F_star, in_body, rtol=0, atol=1e-13)


def test_coriolis_matrix_is_skew():
    C = appendix.C(MASS, CENTROID, INERTIA, np.array([0.3, -1.2, 2.0]))
    np.testing.assert_allclose(C + C.T, 0, atol=1e-15)


def test_wrench_transformation_keeps_power():
    rng = np.random.default_rng(1)
    U = appendix.U(appendix.pose(rotation(0.7), position(0.7)))
    F_B, V_T = rng.normal(size=(2, 6))
    np.testing.assert_allclose((U @ F_B) @ V_T, F_B @ (U.T @ V_T), rtol=1e-13)


@pytest.mark.parametrize("state", STATES)
def test_closed_angular_velocities_equal_the_recursion(state):
    q, q_dot, _ = state
    recursion = [V[3:] for V in arm.body_velocities(q, q_dot)]
    np.testing.assert_allclose(arm.angular_velocities(q, q_dot), recursion, atol=1e-14)


@pytest.mark.parametrize("state", STATES)
def test_body_velocities_are_the_derivatives_of_the_poses(state):
    q, q_dot, _ = state
    for i, V in enumerate(arm.body_velocities(q, q_dot), start=1):
        T = arm.pose_between(q, 0, i)
        twist = np.linalg.inv(T) @ derivative(lambda s, i=i: arm.pose_between(q + s * q_dot, 0, i), 0.0)
        np.testing.assert_allclose(twist[:3, 3], V[:3], atol=1e-14)
        np.testing.assert_allclose(twist[:3, :3], appendix.cross(V[3:]), atol=1e-14)


@pytest.mark.parametrize("state", STATES)
def test_body_accelerations_are_the_derivatives_of_the_velocities(state):
    q, q_dot, q_ddot = state
    rates = derivative(lambda s: np.array(arm.body_velocities(q + s * q_dot, q_dot + s * q_ddot)), 0.0)
    np.testing.assert_allclose(arm.body_accelerations(q, q_dot, q_ddot), rates, atol=1e-13)


@pytest.mark.parametrize("state", STATES)
def test_generalised_velocity_stacks_end_effector_and_bodies(state):
    q, q_dot, _ = state
    V_O = manipulator.end_effector_velocity(arm.J_q(q), q_dot)
    stacked = manipulator.V_b(V_O, arm.body_velocities(q, q_dot))
    assert arm.J_ba(q).shape == (42, 6)
    np.testing.assert_allclose(arm.J_ba(q) @ q_dot, stacked, atol=1e-14)


def test_extended_jacobian_reproduces_joints_and_bodies_where_it_exists():
    q, q_dot, _ = STATES[1]
    V_O = manipulator.end_effector_velocity(arm.J_q(q), q_dot)
    whole = manipulator.V_e(V_O, q_dot, arm.body_velocities(q, q_dot))
    np.testing.assert_allclose(manipulator.joint_velocity(arm.J_q(q), V_O), q_dot, atol=1e-12)
    np.testing.assert_allclose(arm.J_e(q) @ V_O, whole, atol=1e-12)


def test_jacobian_has_rank_four_where_the_trajectory_starts():
    assert np.linalg.matrix_rank(arm.J_q(np.zeros(6))) == 4


@pytest.mark.parametrize("state", STATES)
def test_contact_wrench_costs_its_projection_on_the_jacobian(state):
    q, q_dot, q_ddot = state
    F_O = np.array([1.0, -2.0, 3.0, 0.4, 0.5, -0.6])
    F_e = appendix.U(arm.pose_between(q, 6, 7)) @ F_O
    cost = arm.joint_torques(q, q_dot, q_ddot, F_e) - arm.joint_torques(q, q_dot, q_ddot)
    np.testing.assert_allclose(cost, arm.J_q(q).T @ F_O, atol=1e-12)


def test_torques_do_the_work_that_becomes_energy():
    q, q_dot, q_ddot = STATES[2]

    def energy(s):
        at, rates = q + s * q_dot, q_dot + s * q_ddot
        bodies = zip(data.MASSES, data.CENTROIDS, data.MOMENTS, arm.body_velocities(at, rates), strict=True)
        kinetic = sum(V @ appendix.M(m, r, I * np.eye(3)) @ V / 2 for m, r, I, V in bodies)
        heights = [(arm.pose_between(at, 0, i + 1) @ [*data.CENTROIDS[i], 1])[:3] @ data.G_UP for i in range(6)]
        return kinetic + data.MASSES @ heights

    assert arm.joint_torques(q, q_dot, q_ddot) @ q_dot == pytest.approx(derivative(energy, 0.0), rel=1e-12)


def test_required_wrenches_at_the_actual_motion_are_the_actual_ones():
    q, q_dot, q_ddot = STATES[3]
    required = arm.required_wrenches(q, q_dot, q_dot, q_ddot, 7.0 * np.eye(6), np.zeros(6))
    np.testing.assert_allclose([F[5] for F in required], arm.joint_torques(q, q_dot, q_ddot), atol=1e-13)


def test_control_law_satisfies_the_balances_it_comes_from():
    rng = np.random.default_rng(2)
    T_star, T_F, D_star, B_star = rng.normal(size=(4, 6))
    B_U_T, B_U_D = (appendix.U(appendix.pose(rotation(t), position(t))) for t in (0.2, 1.1))
    T_F_qr = joint.required_drive_wrench(T_star, T_F)
    B_F = joint.required_base_wrench(B_star, B_U_T, T_F_qr, B_U_D, D_star)
    tau_t = joint.drive_torque(data.ELL, T_F_qr, 0.3, 2.0, 0.5, 0.4)
    tau = joint.control_torque(tau_t, 1.5, 0.7, 0.9, 0.1, D_star)
    np.testing.assert_allclose(joint.output_link_balance(T_F, T_F_qr), T_star, atol=1e-14)
    np.testing.assert_allclose(joint.base_balance(B_F, B_U_T, T_F_qr, B_U_D, D_star), B_star, atol=1e-14)
    assert joint.required_output_axis_torque(data.ELL, tau_t, 2.0, 0.5, 0.4, 0.3) == pytest.approx(T_F_qr[5])
    assert joint.required_rotor_axis_torque(tau, tau_t, 1.5, 0.7, 0.9, 0.1) == pytest.approx(D_star[5])


def test_required_torques_without_errors_are_the_actual_ones():
    assert joint.required_output_axis_torque(100.0, 0.4, 2.0, 0.5, 0.5, 0.3) == joint.output_axis_torque(
        100.0, 0.4, 0.3
    )
    assert joint.required_rotor_axis_torque(0.9, 0.4, 2.0, 0.5, 0.5, 0.3) == joint.rotor_axis_torque(0.9, 0.4, 0.3)


@pytest.mark.parametrize("torque", [0.0, 1e-9, -3.0, 45.0])
def test_flexspline_law_and_its_inverse_undo_each_other(torque):
    deflection = joint.deflection_of_torque(torque, 0.02, 16e3)
    assert joint.flexspline_torque(deflection, 0.02, 16e3) == pytest.approx(torque, rel=1e-13)


def test_motor_torque_is_the_control_torque_of_an_ideal_drive():
    """(28) corrected and (27) agree where the motor follows its reference and the rotor only spins."""
    tau_f, kappa_ddot, xi = 20.0, 3.0, 0.05
    D_F = np.array([0, 0, 0, 0, 0, simulation.rotor_inertia_torque(data.I_M, kappa_ddot)])
    control = joint.control_torque(tau_f / data.ELL, 1.0, 0.0, 0.0, xi, D_F)
    assert joint.motor_torque(data.I_M, kappa_ddot, tau_f, data.ELL, xi) == pytest.approx(control, rel=1e-14)


@pytest.mark.parametrize("order", [0, 1, 2, 3])
@pytest.mark.parametrize("t", [0.0, 2.5, 10.0])
def test_trajectory_derivatives_follow_one_another(order, t):
    lower = derivative(lambda s: simulation.trajectory(s, data.Q_D, data.T_END, order), t)
    np.testing.assert_allclose(simulation.trajectory(t, data.Q_D, data.T_END, order + 1), lower, atol=1e-14)


def test_trajectory_runs_from_rest_to_rest():
    q = np.array([[simulation.trajectory(t, data.Q_D, data.T_END, k) for k in range(3)] for t in (0.0, data.T_END)])
    np.testing.assert_allclose(q, [np.zeros((3, 6)), [data.Q_D, np.zeros(6), np.zeros(6)]], atol=1e-15)


def torques_along_the_trajectory(samples=501, **kwargs):
    times = np.linspace(0, data.T_END, samples)
    motions = [[simulation.trajectory(t, data.Q_D, data.T_END, k) for k in range(3)] for t in times]
    return np.array([arm.joint_torques(*motion, **kwargs) for motion in motions])


def rms(values):
    return np.sqrt(np.mean(values**2, axis=0))


def test_a_thousandth_of_the_torques_makes_table_3():
    """RMS of 0.1 % of the torque, N mm: what a uniform mismatch of that size between two programs would print."""
    np.testing.assert_allclose(rms(torques_along_the_trajectory()), [0.10, 22.58, 8.91, 0.64, 2.28, 0.00], atol=0.006)


def test_the_printed_centroid_of_link_6_contradicts_table_3():
    printed = rms(torques_along_the_trajectory(101, centroids=data.CENTROIDS_AS_PRINTED))
    ours = rms(torques_along_the_trajectory(101))
    paper = data.TABLE_3_MILLI
    assert ours[1] / ours[2] == pytest.approx(paper[1] / paper[2], rel=0.02)
    assert printed[1] / printed[2] > 1.3 * paper[1] / paper[2]
