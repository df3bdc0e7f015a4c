"""One rigid body: the appendix, and the equations that repeat it for joint base, rotor, output link and arm link."""

import numpy as np

from agreements.registry import Array, equations, inertia, mat3, matrix, motion, pose, six, wrench
from cutpoint.definitions import matrix_of
from cutpoint.mechanics.bodies.articulated import Articulated
from cutpoint.mechanics.bodies.joints import Revolute
from cutpoint.mechanics.bodies.rigid_body import acceleration_gradient, net_wrench
from cutpoint.mechanics.bodies.spatial import AT_ORIGIN, Motion, Vec3
from cutpoint.mechanics.required_dynamics import velocity_feedback
from cutpoint.mechanics.system import Segment
from cutpoint.model.mechanism import WORLD
from random_trees import rotation
from transcript import appendix, joint

Body = tuple[float, Array, Array]


def random_body(rng: np.random.Generator) -> Body:
    """Mass, centroid, and tensor about it."""
    A = rng.normal(size=(3, 3))
    return rng.uniform(0.5, 3.0), rng.normal(size=3), A @ A.T


def cost(body: Body, omega: Array, V: Array, V_dot: Array, weight: Array) -> Array:
    """Our net wrench; V and V_dot as the paper has them, V_dot being component by component."""
    A = np.concatenate([V_dot[:3] + weight + np.cross(omega, V[:3]), V_dot[3:]])
    U = acceleration_gradient(Vec3(*A[3:]), Vec3(*omega), Vec3(*V[3:]))
    return six(net_wrench(inertia(*body), Motion(Vec3(*A[:3]), Vec3(*A[3:])), U))


def left_out(body: Body, omega: Array) -> Array:
    """What our C has less than (61), a multiple of (omega x): skew, and nothing to the body's own velocity."""
    _, _, I = body
    return np.block([[np.zeros((3, 6))], [np.zeros((3, 3)), np.trace(I) / 2 * appendix.cross(omega)]])


@equations("(63)")
def cross(rng):
    a, b = rng.normal(size=(2, 3))
    skew = [[*row] for row in Vec3(*a).skew()]
    return [([*Vec3(*a).cross(Vec3(*b))], appendix.cross(a) @ b), (skew, appendix.cross(a))]


@equations("(32)")
def transformation(rng):
    R, p = rotation(rng), rng.normal(size=3)
    X, U = pose(R, p), appendix.U(appendix.pose(R, p))
    return [(matrix(lambda F: X.inward(wrench(F))), U), (matrix(lambda V: X.outward(motion(V))), U.T)]


@equations("(33)")
def pose_matrix(rng):
    R, p = rotation(rng), rng.normal(size=3)
    return [(matrix_of(pose(R, p)), appendix.pose(R, p))]


@equations("(60)")
def inertia_matrix(rng):
    body = random_body(rng)
    M = inertia(*body)
    return [(matrix(lambda V: M * motion(V)), appendix.M(*body)), (Articulated.of(M).rows, appendix.M(*body))]


@equations("(61)")
def coriolis_matrix(rng):
    body, omega, nothing = random_body(rng), rng.normal(size=3), np.zeros(6)
    ours = np.column_stack([cost(body, omega, unit, nothing, nothing[:3]) for unit in np.eye(6)])
    skew = left_out(body, omega)
    return [(ours + skew, appendix.C(*body, omega)), (skew, -skew.T), (skew @ [0, 0, 0, *omega], nothing)]


@equations("(62)")
def weight(rng):
    body, R_BI, g, nothing = random_body(rng), rotation(rng), rng.normal(size=3), np.zeros(6)
    return [(cost(body, nothing[:3], nothing, nothing, R_BI @ g), appendix.G(*body[:2], R_BI, g))]


@equations("(6)", "(7)", "(8)", "(47)", "(59)")
def net_wrenches(rng):
    body, R_BI, g, (V, V_dot) = random_body(rng), rotation(rng), rng.normal(size=3), rng.normal(size=(2, 6))
    return [(cost(body, V[3:], V, V_dot, R_BI @ g), appendix.net_wrench(*body, R_BI, g, V, V_dot))]


@equations("(15)", "(16)", "(17)", "(50)")
def required_net_wrenches(rng):
    """With a gain in the body's own axes, which are not those of its joint."""
    body, R_BI, g, (V, V_r, V_r_dot) = random_body(rng), rotation(rng), rng.normal(size=3), rng.normal(size=(3, 6))
    A, turn = rng.normal(size=(6, 6)), rotation(rng)
    segment = Segment("body", WORLD, AT_ORIGIN, Revolute(), inertia(*body), slice(0, 1), slice(0, 1), mat3(turn))
    own = np.kron(np.eye(2), turn)
    pulled = own @ six(velocity_feedback(segment, A @ A.T, motion(own.T @ V_r), motion(own.T @ V)))
    ours = cost(body, V[3:], V_r, V_r_dot, R_BI @ g) + left_out(body, V[3:]) @ V_r + pulled
    return [(ours, joint.required_net_wrench(*body, R_BI, g, V, V_r, V_r_dot, A @ A.T))]
