"""The Lagrangian formulation of Uicker and Kahn, with 4 x 4 homogeneous matrices: a sum of n^4 traces.

Uicker (1967), "Dynamic force analysis of spatial linkages", ASME J. Appl. Mech. 34(2); Kahn and Roth (1971), "The
near-minimum-time control of open-loop articulated kinematic chains", ASME J. Dyn. Syst. Meas. Control 93(3); written
out and counted by Hollerbach (1980), "A recursive Lagrangian formulation of manipulator dynamics and a comparative
study of dynamics formulation complexity", IEEE Trans. Syst. Man Cybern. 10(11).  As there, every coefficient is formed
before velocities multiply it; equal ones (k, l and l, k) are formed once.
"""

from functools import cache

from cutpoint.definitions import matrix_of
from cutpoint.mechanics.bodies.joints import dot
from cutpoint.mechanics.bodies.pseudo_inertia import pseudo_inertia_of
from cutpoint.mechanics.system import System
from cutpoint.scalars import Scalar

Scalars = list[Scalar]
Matrix = list[Scalars]

_Q: Matrix = [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]
"""Times a pose that turns about z by q: the pose's derivative by q."""


def torques(system: System, q: Scalars, v: Scalars, a: Scalars) -> Scalars:
    """Joint torques, N m, of a chain of revolute joints: sums of D_ik a_k, D_ikl v_k v_l and D_i."""
    n = len(system.segments)
    U = _derivatives(system, q)
    J = [pseudo_inertia_of(body.inertia) for body in system.segments]
    UJ = {(j, i): _times(U[j, i], J[j]) for j in range(n) for i in range(j + 1)}
    lift = [*(-system.gravity), 0]
    tau: Scalars = []
    for i in range(n):
        total: Scalar = 0
        for j in range(i, n):
            total = total + dot(lift, [row[3] for row in UJ[j, i]])
        for k in range(n):
            total = total + sum(_trace(U[j, k], UJ[j, i]) for j in range(max(i, k), n)) * a[k]
        for k in range(n):
            for l in range(k, n):
                D_ikl = sum(_trace(U[j, k, l], UJ[j, i]) for j in range(max(i, l), n))
                total = total + D_ikl * (v[k] * v[l] * (1 if k == l else 2))
        tau.append(total)
    return tau


def _derivatives(system: System, q: Scalars) -> dict[tuple[int, ...], Matrix]:
    """U_jk = dW_j / dq_k and U_jkl = dU_jk / dq_l for k <= l <= j, W_j being the pose of link j in the world."""
    A = [matrix_of(body.placement @ body.joint.pose([q_j])) for body, q_j in zip(system.segments, q, strict=True)]

    @cache
    def U(j: int, *by: int) -> Matrix:
        if by and by[-1] == j:
            return _times(U(j, *by[:-1]), _Q)
        return _times(U(j - 1, *by), A[j]) if j else A[0]

    n = range(len(A))
    first = {(j, k): U(j, k) for j in n for k in range(j + 1)}
    return first | {(j, k, l): U(j, k, l) for j in n for l in range(j + 1) for k in range(l + 1)}


def _times(A: Matrix, B: Matrix) -> Matrix:
    columns = [[*column] for column in zip(*B, strict=True)]
    return [[dot(row, column) for column in columns] for row in A]


def _trace(A: Matrix, B: Matrix) -> Scalar:
    """Trace of A B^T."""
    return sum(dot(a, b) for a, b in zip(A, B, strict=True))
