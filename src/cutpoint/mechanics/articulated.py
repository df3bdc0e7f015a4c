"""Articulated inertia: the symmetric 6 x 6 matrix by which a body resists, with all that hangs on it free to move."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cutpoint.mechanics.spatial import Inertia, Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.scalars import Scalar


@dataclass(slots=True, eq=False)
class Yield:
    """How one axis gives way: its own acceleration, and the share it takes of each component of its body's."""

    axis: int
    own: Scalar
    share: list[Scalar]


class Articulated:
    """Rows and columns in the order of a motion: three linear, three angular."""

    __slots__ = ("rows",)

    def __init__(self, rows: list[list[Any]]) -> None:
        self.rows = rows

    @staticmethod
    def of(M: Inertia) -> "Articulated":
        """A rigid body's M_B.  Xia (2019) eq. (60)."""
        m, h_x, h = M.mass, [[*row] for row in M.first_moment.skew()], M.rotational
        upper = [[m * int(j == k) for k in range(3)] + [h_x[k][j] for k in range(3)] for j in range(3)]
        return Articulated(upper + [h_x[j] + [*row] for j, row in enumerate(h)])

    def __add__(self, B: "Articulated") -> "Articulated":
        return Articulated([[a + b for a, b in zip(r, s, strict=True)] for r, s in zip(self.rows, B.rows, strict=True)])

    def __mul__(self, V: Motion) -> Wrench:
        v = [*V]
        f = [sum((r[k] * v[k] for k in range(1, 6)), r[0] * v[0]) for r in self.rows]
        return Wrench(Vec3(*f[:3]), Vec3(*f[3:]))

    def give_way(
        self, free: Sequence[int], P: Wrench, tau: Sequence[Scalar], armature: Sequence[Scalar]
    ) -> tuple["Articulated", Wrench, list[Yield]]:
        """Let the free axes move, one by one: what is left of inertia and bias wrench, and how each axis gave way.

        Featherstone (2008) eqs. (7.38)-(7.44) for one axis at a time; armature is a rotor's inertia on that axis.
        """
        rows, p, steps = [[*row] for row in self.rows], [*P], []
        for axis, effort, I_m in zip(free, tau, armature, strict=True):
            column = [rows[k][axis] for k in range(6)]
            gain = 1 / (column[axis] + I_m)
            share = [c * gain for c in column]
            own = gain * (effort - p[axis])
            for j in range(6):
                p[j] = p[j] + column[j] * own
                for k in range(j, 6):
                    rows[j][k] = rows[k][j] = rows[j][k] - share[j] * column[k]
            if _is_zero(I_m):  # exactly, so that the axis vanishes from the trace
                p[axis] = effort
                for k in range(6):
                    rows[axis][k] = rows[k][axis] = 0
            steps.append(Yield(axis, own, share))
        return Articulated(rows), Wrench(Vec3(*p[:3]), Vec3(*p[3:])), steps

    def seen_from_parent(self, X: Pose) -> "Articulated":
        """The same resistance, felt at the parent's frame: U M U^T."""
        R, p_x = X.rotation, X.position.skew()
        M, H, J = (R @ self._block(i, j) @ R.T for i, j in ((0, 0), (3, 0), (3, 3)))
        H_p = H + p_x @ M
        J_p = J + p_x @ H.T - H_p @ p_x
        rows = [[*a, *b] for a, b in zip(M, H_p.T, strict=True)] + [[*a, *b] for a, b in zip(H_p, J_p, strict=True)]
        return Articulated([[rows[min(i, j)][max(i, j)] for j in range(6)] for i in range(6)])

    def _block(self, i: int, j: int) -> Mat3:
        return Mat3(*(Vec3(*row[j : j + 3]) for row in self.rows[i : i + 3]))


def accelerations(steps: list[Yield], A: Motion) -> list[Scalar]:
    """Accelerations of the free axes of a body whose frame, they at rest, would accelerate with A."""
    a, found = [*A], {}
    for step in reversed(steps):
        found[step.axis] = step.own - sum((step.share[k] * a[k] for k in range(1, 6)), step.share[0] * a[0])
        a[step.axis] = a[step.axis] + found[step.axis]
    return [found[step.axis] for step in steps]


def _is_zero(x: Scalar) -> bool:
    return isinstance(x, (int, float)) and x == 0
