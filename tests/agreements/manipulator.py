"""The paper's arm: section III."""

import numpy as np

import robot_library
from agreements.body import left_out
from agreements.registry import Array, equations, six, wrench
from cutpoint import Robot
from cutpoint.mechanics import inverse_dynamics as recursion
from cutpoint.mechanics.bodies.rigid_body import net_wrench
from cutpoint.mechanics.kinematics import body_velocities, joint_poses
from cutpoint.mechanics.required_dynamics import required_inverse_dynamics
from transcript import arm, data, joint, manipulator
from transcript.appendix import U, pose

BODIES = [(data.MASSES[i], data.CENTROIDS[i], data.MOMENTS[i] * np.eye(3)) for i in range(6)]


def robot() -> Robot:
    return robot_library.robot("xia2019")


def system():
    return robot().machine.system


def motion_of(rng: np.random.Generator) -> Array:
    """q, q_dot, q_ddot."""
    return rng.uniform(-3, 3, (3, 6))


@equations("(29)", "(31)", "(48)", "(49)")
def velocities(rng):
    q, q_dot, _ = motion_of(rng)
    return [([six(V) for V in body_velocities(system(), q, q_dot)], arm.body_velocities(q, q_dot))]


@equations("(30)")
def velocities_at_cuts(rng):
    q, q_dot, _ = motion_of(rng)
    V, pairs = body_velocities(system(), q, q_dot), []
    for i in range(1, 6):
        X = system().segments[i].placement
        turned_back = np.kron(
            np.eye(2), np.array([[*row] for row in X.rotation])
        )  # our cut's axes are the next joint's
        cut = U(pose(np.eye(3), data.TRANSLATIONS[i]))
        pairs.append((turned_back @ six(X.outward(V[i - 1])), manipulator.cut_velocity(cut, six(V[i - 1]))))
    return pairs


@equations("(34)", "(35)", "(36)")
def rotations(rng):
    q, *_ = motion_of(rng)
    first, middle, last = manipulator.rotations_1_2, manipulator.rotations_3_4, manipulator.rotations_5_6
    ours = [[[*row] for row in X.rotation] for X in joint_poses(system(), q)]
    return [(ours, (*first(*q[:2]), *middle(*q[2:4]), *last(*q[4:])))]


@equations("(37)", "(38)")
def jacobian(rng):
    q, q_dot, _ = motion_of(rng)
    J = robot().jacobian(q, "tool")
    return [(J, arm.J_q(q)), (J @ q_dot, manipulator.end_effector_velocity(arm.J_q(q), q_dot))]


@equations("(40)", "(41)")
def generalised_velocity(rng):
    q, q_dot, _ = motion_of(rng)
    J_ba = np.vstack([robot().jacobian(q, "tool"), robot().velocity_map(q)])
    J_q = arm.J_q(q)
    stacked = manipulator.V_b(manipulator.end_effector_velocity(J_q, q_dot), arm.body_velocities(q, q_dot))
    return [(J_ba, arm.J_ba(q)), (J_ba @ q_dot, stacked)]


@equations("(42)")
def whole_velocity(rng):
    q, q_dot, _ = motion_of(rng)
    ours = np.concatenate([robot().jacobian(q, "tool") @ q_dot, q_dot, robot().velocity_map(q) @ q_dot])
    return [(ours, manipulator.V_e(arm.J_q(q) @ q_dot, q_dot, arm.body_velocities(q, q_dot)))]


@equations("(43)")
def extended_jacobian(rng):
    """What velocity_map gives, read from the end-effector's side: where J_q is regular, as at these states."""
    q, *_ = motion_of(rng)
    J_a = np.linalg.inv(robot().jacobian(q, "tool"))
    return [(np.vstack([np.eye(6), J_a, robot().velocity_map(q) @ J_a]), arm.J_e(q))]


@equations("(44)", "(45)", "(46)", "(9)", "(18)", "(23)", "(51)", "(52)", "(53)")
def wrenches_inward(rng):
    """From any net wrenches, actual or required: the recursion does not know which it is given."""
    q, *_ = motion_of(rng)
    F_star, F_e = rng.normal(size=(6, 6)), rng.normal(size=6)
    found = recursion.transmitted_wrenches(
        system(), joint_poses(system(), q), [wrench(F) for F in F_star], {"link6": wrench(F_e)}
    )
    return [([six(F) for F in found], arm.inward_wrenches(q, [*F_star], F_e))]


@equations("(11)", "(20)", "(25)")
def joint_bases(rng):
    """A link that carries the next joint's base; the reduced model's rotor presses on nothing, its wrench is 0."""
    q, *_ = motion_of(rng)
    F_star, X = rng.normal(size=(6, 6)), joint_poses(system(), q)
    F = [six(F_i) for F_i in recursion.transmitted_wrenches(system(), X, [wrench(F_i) for F_i in F_star], {})]
    U = [arm.U(arm.pose_between(q, i, i + 1)) for i in range(1, 6)]
    nothing = np.eye(6), np.zeros(6)
    kept = [joint.base_balance(F[i], U[i], F[i + 1], *nothing) for i in range(5)]
    asked = [joint.required_base_wrench(F_star[i], U[i], F[i + 1], *nothing) for i in range(5)]
    return [(F_star[:5], kept), (F[:5], asked)]


@equations("(5)", "(14)")
def one_joint_further(rng):
    """A body's velocity and its rate, from its parent's; the net wrenches of the whole arm follow from them."""
    q, q_dot, q_ddot = motion_of(rng)
    moved = recursion.motions(system(), q, q_dot, q_ddot)
    F_star = [net_wrench(segment.inertia, m.A, m.U) for segment, m in zip(system().segments, moved, strict=True)]
    expected = arm.net_wrenches(q, q_dot, q_ddot)
    return [([six(m.V) for m in moved], arm.body_velocities(q, q_dot)), ([*map(six, F_star)], expected)]


def whole_arm(rng):
    """All of section III at once: torques, with a contact, and required ones at another motion than the arm's own."""
    q, q_dot, q_ddot = motion_of(rng)
    F_e = rng.normal(size=6)
    found = robot().inverse_dynamics(q, q_dot, q_ddot, {"link6": -F_e})
    q_dot_r, q_ddot_r = rng.normal(size=(2, 6))
    V, V_r = arm.body_velocities(q, q_dot), arm.body_velocities(q, q_dot_r)
    required = arm.required_wrenches(q, q_dot, q_dot_r, q_ddot_r, np.zeros((6, 6)), np.zeros(6))
    more = [left_out(B, v[3:]) @ v_r for B, v, v_r in zip(BODIES, V, V_r, strict=True)]
    extra = arm.inward_wrenches(q, more, np.zeros(6))
    ours = required_inverse_dynamics(system(), q, q_dot, q_dot_r, q_ddot_r)
    theirs = [F[5] - F_more[5] for F, F_more in zip(required, extra, strict=True)]
    return [(found, arm.joint_torques(q, q_dot, q_ddot, F_e)), (ours, theirs)]
