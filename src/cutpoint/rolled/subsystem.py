"""A body with its joint of one coordinate and the rotor that its parent carries, in its own axes or in the world's."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cutpoint.mechanics.bodies.joints import JointMotion
from cutpoint.mechanics.bodies.rotors import Spin, axis_of
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Pose, Vec3
from cutpoint.mechanics.bodies.turning import about_z
from cutpoint.mechanics.system import Segment
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


@dataclass(frozen=True)
class OneAxis(JointMotion):
    """Rotates about z by turn q (rad), and translates along it by slide q (m): every joint with one coordinate."""

    turn: Scalar
    slide: Scalar

    @property
    def axes(self) -> tuple[tuple[Scalar, ...], ...]:
        return ((0, 0, self.slide, 0, 0, self.turn),)

    def pose(self, q: Scalars) -> Pose:
        return Pose(about_z(self.turn * q[0]), Vec3(0, 0, self.slide * q[0]))


@dataclass(frozen=True)
class Along(JointMotion):
    """Such a joint along any unit vector z, where only its motion is needed."""

    z: Vec3
    turn: Scalar
    slide: Scalar

    @property
    def axes(self) -> tuple[tuple[Scalar, ...], ...]:
        return ((*self.z * self.slide, *self.z * self.turn),)


@dataclass(frozen=True)
class Subsystem:
    """A body with its joint, and the rotor that its parent carries: armature and spin, 0 and None where there is none.

    behind: the spin of one behind a spring.  number, last: the body's, and the highest number of one that it carries;
    numbers are in depth-first order.
    """

    body: Segment
    armature: Scalar
    spin: Spin | None
    number: Scalar
    last: Scalar
    behind: Spin | None = None

    def along_the_world(self, X: Pose) -> "Subsystem":
        """The same along the world's axes.  X: its own axes in the world's, and its place in its parent along those."""
        R, z, joint = X.rotation, axis_of(X), self.body.joint
        assert isinstance(joint, OneAxis)
        along, inertia = Along(z, joint.turn, joint.slide), self.body.inertia.seen_from_parent(Pose(R, ZERO))
        body = replace(self.body, placement=Pose(IDENTITY, X.position), joint=along, inertia=inertia)
        spins = {"spin": self.spin, "behind": self.behind}
        return replace(self, body=body, **{name: spin and replace(spin, axis=z) for name, spin in spins.items()})
