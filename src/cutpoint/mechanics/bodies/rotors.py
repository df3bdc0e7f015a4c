"""Rotors as bodies: balanced, axisymmetric, carried by the link that carries the joint.

A rotor turns about the joint's axis with ratio * theta_dot relative to its carrier.  The carrier's inertia includes the
rotor at rest; what remains is the angular momentum J ratio theta_dot of its spin, along the axis.
Xia (2019) eqs. (4), (7), (10).
"""

from dataclasses import dataclass

from cutpoint.mechanics.bodies.spatial import ZERO, Inertia, Mat3, Pose, Vec3, Wrench
from cutpoint.model.drive import Rotor
from cutpoint.scalars import Scalar


@dataclass(frozen=True, eq=False)
class Spin:
    """A rotor with full coupling.

    joint: index of the segment that it drives; carrier: of the one that carries it.  axis: the joint's, in the
    carrier's frame.  inertia: J, about the axis.  geared: J ratio, its angular momentum at unit joint speed, kg m2.
    elastic: whether its speed is a coordinate of its own.
    """

    joint: int
    carrier: int
    axis: Vec3
    inertia: Scalar
    geared: Scalar
    elastic: bool

    def reaction(self, omega: Vec3, speed: Scalar, acceleration: Scalar) -> Wrench:
        """Wrench of the carrier, turning with omega, on the rotor for its change of spin.  Xia (2019) eqs. (7), (11).

        speed and acceleration are the rotor's over ratio.
        """
        momentum = self.axis * (self.geared * speed)
        return Wrench(ZERO, self.axis * (self.geared * acceleration) + omega.cross(momentum))

    def along(self, omega: Vec3) -> Scalar:
        """J ratio times omega along the axis: angular momentum of the rotor due to its carrier, at the joint's side.

        With an angular acceleration: the motor torque that it takes, N m.  Xia (2019) eq. (4).
        """
        return self.geared * self.axis.dot(omega)


def axis_of(placement: Pose) -> Vec3:
    """The joint's z axis in its carrier's frame."""
    return Vec3(*(row.z for row in placement.rotation))


def standing_still(rotor: Rotor, placement: Pose) -> Inertia:
    """Inertia in the carrier's frame of a rotor at rest, for a carrier whose inertia does not include it yet."""
    h, J = Vec3(0, 0, rotor.mass * rotor.position), rotor.transverse + rotor.mass * rotor.position * rotor.position
    rotational = Mat3(Vec3(J, 0, 0), Vec3(0, J, 0), Vec3(0, 0, rotor.inertia))
    return Inertia(rotor.mass, h, rotational).seen_from_parent(placement)
