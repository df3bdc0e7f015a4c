"""Articulated-body inertia: the symmetric 6 x 6 apparent inertia of a body whose subtree is free to move."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cutpoint.mechanics.bodies.joints import TURN_X, TURN_Y, TURN_Z, Axis, X, Y, Z, dot
from cutpoint.mechanics.bodies.spatial import Inertia, Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.scalars import Scalar, is_plain_zero

UNIT_AXES: list[Axis] = [X, Y, Z, TURN_X, TURN_Y, TURN_Z]


@dataclass(slots=True, eq=False)
class JointRotor:
    """Apparent inertia of a rotor at its joint, kg m2: rigidly geared, or coupled through a damped spring.

    armature: resists the joint's own acceleration.  coupling: ties it to the carrying body's acceleration about z.
    """

    armature: Scalar
    coupling: Scalar


NO_ROTOR = JointRotor(0, 0)


@dataclass(slots=True, eq=False)
class AxisResponse:
    """Acceleration along an axis: `own`, less `share` of each component of its body's acceleration."""

    axis: Axis
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
        m, h_x, J = M.mass, [[*row] for row in M.first_moment.skew()], M.rotational
        upper = [[m * int(j == k) for k in range(3)] + [h_x[k][j] for k in range(3)] for j in range(3)]
        return Articulated(upper + [h_x[j] + [*row] for j, row in enumerate(J)])

    @staticmethod
    def about(axis: Vec3, inertia: Scalar) -> "Articulated":
        """Rotational inertia about one axis through the origin only."""
        turning = [[inertia * a * b for b in axis] for a in axis]
        return Articulated([[0] * 6] * 3 + [[0, 0, 0, *row] for row in turning])

    @staticmethod
    def of_blocks(linear: Mat3, coupling: Mat3, angular: Mat3) -> "Articulated":
        """From blocks: force per linear acceleration, kg; moment per linear, kg m; moment per angular, kg m2."""
        upper = [[*a, *b] for a, b in zip(linear, coupling.T, strict=True)]
        return Articulated(upper + [[*a, *b] for a, b in zip(coupling, angular, strict=True)])

    def __add__(self, B: "Articulated") -> "Articulated":
        return Articulated([[a + b for a, b in zip(r, s, strict=True)] for r, s in zip(self.rows, B.rows, strict=True)])

    def __mul__(self, V: Motion) -> Wrench:
        v = [*V]
        f = [dot(row, v) for row in self.rows]
        return Wrench(Vec3(*f[:3]), Vec3(*f[3:]))

    def along(self, z: Axis) -> Scalar:
        """z^T M z: the inertia along an axis.  Starts from products of z, which recursions have before M."""
        return sum(dot([a * b for b in z], row) for a, row in zip(z, self.rows, strict=True))

    def eliminate(
        self, axes: Sequence[Axis], P: Wrench, tau: Sequence[Scalar], rotors: Sequence[JointRotor]
    ) -> tuple["Articulated", Wrench, list[AxisResponse]]:
        """What a joint that is free to move passes on: remaining inertia and bias wrench, and each axis's response.

        Featherstone (2008) eqs. (7.38)-(7.44) for one axis at a time; each axis may carry a rotor.
        """
        rows, p, steps = [[*row] for row in self.rows], [*P], []
        for z, effort, rotor in zip(axes, tau, rotors, strict=True):
            # the axis: inertia along it, and its acceleration while its body has none
            column = [dot(z, row) for row in rows]
            gain = 1 / (dot(z, column) + rotor.armature)
            own = gain * (effort - dot(z, p))
            # what is left for its carrier: the Schur complement
            column[5] = column[5] + rotor.coupling
            share = [c * gain for c in column]
            for j in range(6):
                p[j] = p[j] + column[j] * own
                for k in range(j, 6):
                    rows[j][k] = rows[k][j] = rows[j][k] - share[j] * column[k]
            if rotor is NO_ROTOR and z in UNIT_AXES:  # exactly, so that the axis vanishes from the trace
                axis = UNIT_AXES.index(z)
                p[axis] = effort
                for k in range(6):
                    rows[axis][k] = rows[k][axis] = 0
            steps.append(AxisResponse(z, own, share))
        return Articulated(rows), Wrench(Vec3(*p[:3]), Vec3(*p[3:])), steps

    def seen_from_parent(self, pose: Pose) -> "Articulated":
        """The same inertia in the parent's frame: U M U^T."""
        R, p_x = pose.rotation, pose.position.skew()
        M, H, J = map(R.congruence, (self.linear, self.coupling, self.angular))
        H_p = H + p_x @ M
        return Articulated.of_blocks(M, H_p, J + p_x @ H.T - H_p @ p_x).symmetrised()

    def carried_along(self, p: Vec3) -> "Articulated":
        """The same inertia in a parallel frame, from which this one is at p: U M U^T.

        Diagonal blocks are computed entry by entry: they are symmetric if this one's are, up to rounding.
        """
        p_x, H = p.skew(), self.coupling
        H_p = H + p_x @ self.linear
        minus_H_p_p_x = Mat3(*(p.cross(row) for row in H_p))
        return Articulated.of_blocks(self.linear, H_p, self.angular + p_x @ H.T + minus_H_p_p_x)

    def symmetrised(self) -> "Articulated":
        """The upper triangle mirrored below the diagonal, where entries differ by rounding only."""
        return Articulated([[self.rows[min(i, j)][max(i, j)] for j in range(6)] for i in range(6)])

    @property
    def T(self) -> "Articulated":
        """The transpose: equal, up to rounding, by symmetry."""
        return Articulated([[*column] for column in zip(*self.rows, strict=True)])

    @property
    def linear(self) -> Mat3:
        return self._block(0, 0)

    @property
    def coupling(self) -> Mat3:
        return self._block(3, 0)

    @property
    def angular(self) -> Mat3:
        return self._block(3, 3)

    def _block(self, i: int, j: int) -> Mat3:
        return Mat3(*(Vec3(*row[j : j + 3]) for row in self.rows[i : i + 3]))


def accelerations(steps: list[AxisResponse], A: Motion) -> list[Scalar]:
    """A joint's accelerations along its axes; were they zero, its body would accelerate with A (less its bias)."""
    a, found = [*A], []
    for step in reversed(steps):
        own = step.own - dot(step.share, a)
        a = [x + z * own if not is_plain_zero(z) else x for x, z in zip(a, step.axis, strict=True)]
        found.append(own)
    return found[::-1]
