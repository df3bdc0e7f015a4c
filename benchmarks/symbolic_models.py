"""Robots in CasADi's symbols, for one who wants speed from code generation: zeros and ones of constants structural.

Everything is in body frames, and nothing is shared with cutpoint but the robot's numbers: the file's, or those that
cutpoint has moved to where they cost least.
"""

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from cutpoint.mechanics.bodies.spatial import Mat3
from cutpoint.mechanics.system import System
from cutpoint.model import Mechanism

SNAP = 1e-11
"""Numbers this close to a whole one, as files round them, count as whole."""

SX = ca.SX


@dataclass(frozen=True, eq=False)
class Body:
    """R, p: pose in the parent; z: axis, moved frame; h: first moment; I: inertia about the frame's origin."""

    parent: int
    R: SX
    p: SX
    z: SX
    m: float | SX
    h: SX
    I: SX


@dataclass(frozen=True, eq=False)
class Chain:
    """A robot at some q; gravity in the world's frame."""

    bodies: list[Body]
    gravity: SX


def constant(A) -> SX:
    A = np.asarray(A, float)
    return ca.sparsify(SX(ca.DM(np.where(np.abs(A - np.round(A)) < SNAP, np.round(A), A))))


def cross(a: SX, b: SX) -> SX:
    return skew(a) @ b


def skew(a: SX) -> SX:
    zero = SX(1, 1)
    return ca.vertcat(ca.horzcat(zero, -a[2], a[1]), ca.horzcat(a[2], zero, -a[0]), ca.horzcat(-a[1], a[0], zero))


def as_filed(mechanism: Mechanism, q: SX) -> Chain:
    """With the frames and inertias of the robot's file."""
    found = []
    for i, body in enumerate(mechanism.bodies):
        z, c = np.asarray(body.joint.axis), np.asarray(body.com)
        K = np.cross(np.eye(3), z).T * -1
        turn = constant(np.eye(3) - np.outer(z, z)) * ca.cos(q[i]) + constant(K) * ca.sin(q[i])
        R = constant(body.placement[:3, :3]) @ (turn + constant(np.outer(z, z)))
        about_origin = body.inertia + body.mass * (c @ c * np.eye(3) - np.outer(c, c))
        p, h = constant(body.placement[:3, 3]), constant(body.mass * c)
        found.append(Body(body.parent, R, p, constant(z), body.mass, h, constant(about_origin)))
    return Chain(found, constant(mechanism.gravity))


def as_framed(system: System, q: SX) -> Chain:
    """With a system's own frames and inertias; all joints revolute, about z."""
    found = []
    for i, body in enumerate(system.segments):
        zero = getattr(body.joint, "zero", 0.0)
        angle = q[i] + (zero if abs(zero) > SNAP else 0)
        c, s = ca.cos(angle), ca.sin(angle)
        turn = ca.sparsify(ca.blockcat([[c, -s, 0], [s, c, 0], [0, 0, 1]]))
        R, p = constant(matrix(body.placement.rotation)) @ turn, constant([*body.placement.position])
        M = body.inertia
        own = float(M.mass), constant([*M.first_moment]), constant(matrix(M.rotational))
        found.append(Body(body.parent, R, p, constant([0, 0, 1]), *own))
    return Chain(found, constant([*system.gravity]))


def matrix(rows: Mat3) -> list[list[float]]:
    return [[*row] for row in rows]


def with_parameters(chain: Chain, p: SX) -> Chain:
    """With other masses, first moments and inertias, ten a body in cutpoint's order."""
    found = []
    for i, body in enumerate(chain.bodies):
        m, *h, xx, xy, xz, yy, yz, zz = ca.vertsplit(p[10 * i : 10 * i + 10])
        I = ca.blockcat([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        found.append(replace(body, m=m, h=ca.vertcat(*h), I=I))
    return Chain(found, chain.gravity)
