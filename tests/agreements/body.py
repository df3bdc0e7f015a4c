"""One rigid body: the appendix, and the equations that repeat it for joint base, rotor, output link and arm link."""

import numpy as np
from agreements.registry import Array, Pairs, equations, inertia, matrix, motion, pose, six, wrench
from random_trees import rotation
from transcript import appendix, joint

from cutpoint.definitions import matrix_of
from cutpoint.mechanics.articulated import Articulated
from cutpoint.mechanics.rigid_body import net_wrench
from cutpoint.mechanics.spatial import STILL, Vec3

Body = tuple[float, Array, Array]


def random_body(rng: np.random.Generator) -> Body:
    """Mass, centroid, and tensor about it."""
    A = rng.normal(size=(3, 3))
    return rng.uniform(0.5, 3.0), rng.normal(size=3), A @ A.T


def left_out(body: Body, omega: Array) -> Array:
    """The term m |r|^2 (omega x) of (61) that our C goes without: skew, and nothing to the body's own velocity."""
    m, r, _ = body
    return np.block([[np.zeros((3, 6))], [np.zeros((3, 3)), m * (r @ r) * appendix.cross(omega)]])


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
    body, omega = random_body(rng), rng.normal(size=3)
    ours = matrix(lambda V: net_wrench(inertia(*body), Vec3(*omega), motion(V), STILL))
    return [(ours + left_out(body, omega), appendix.C(*body, omega)), (left_out(body, omega) @ [0, 0, 0, *omega], np.zeros(6))]


@equations("(62)")
def weight(rng):
    (m, r, I), R_BI, g = random_body(rng), rotation(rng), rng.normal(size=3)
    at_rest = net_wrench(inertia(m, r, I), Vec3(0, 0, 0), STILL, motion(np.concatenate([R_BI @ g, np.zeros(3)])))
    return [(six(at_rest), appendix.G(m, r, R_BI, g))]


@equations("(6)", "(7)", "(8)", "(47)", "(59)")
def net_wrenches(rng):
    body, R_BI, g, (V, V_dot) = random_body(rng), rotation(rng), rng.normal(size=3), rng.normal(size=(2, 6))
    A = motion(V_dot + np.concatenate([R_BI @ g, np.zeros(3)]))
    ours = net_wrench(inertia(*body), motion(V).angular, motion(V), A)
    return [(six(ours), appendix.net_wrench(*body, R_BI, g, V, V_dot))]


@equations("(15)", "(16)", "(17)", "(50)")
def required_net_wrenches(rng) -> Pairs:
    """Without gains: no law of the package feeds body velocities back."""
    body, R_BI, g, (V, V_r, V_r_dot) = random_body(rng), rotation(rng), rng.normal(size=3), rng.normal(size=(3, 6))
    A_r = motion(V_r_dot + np.concatenate([R_BI @ g, np.zeros(3)]))
    ours = six(net_wrench(inertia(*body), motion(V).angular, motion(V_r), A_r)) + left_out(body, V[3:]) @ V_r
    return [(ours, joint.required_net_wrench(*body, R_BI, g, V, V_r, V_r_dot, np.zeros((6, 6))))]
