"""What drives a joint that no drive file mentions."""

from collections.abc import Iterator
from dataclasses import replace

from cutpoint.door import check_kind
from cutpoint.mechanics.drives.friction import Coulomb
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import Joint, Mechanism


def drive_of(joint: Joint) -> Drive:
    """The drive of a joint that no drive file mentions: rigid, ratio 1, and the friction that its robot file states.

    joint: of a mechanism, `robot.mechanism.bodies[k].joint`.  Its `friction`, N m (N), and `damping`, N m s/rad
    (N s/m), become Coulomb friction on the link's side, smoothed as by default; there is none if both are 0.
    Raises InputError for anything but a joint.
    """
    check_kind("drive_of", "joint", joint, Joint, "a Joint, as robot.mechanism.bodies[0].joint")
    if joint.damping == 0.0 and joint.friction == 0.0:
        return Drive()
    return Drive(link_friction=Coulomb(joint.friction, joint.damping))


def drives_of(mechanism: Mechanism) -> dict[str, Drive]:
    """The drives of a robot without a drive file; a leader's has the friction of its followers too."""
    joints = {body.joint.name: body.joint for body in mechanism.bodies}
    return {name: drive_of(_leading(joints[name], mechanism)) for name in mechanism.driven_joints}


def _leading(joint: Joint, mechanism: Mechanism) -> Joint:
    """The joint with the friction of its followers: at its speed it takes the same power as at theirs."""
    damping, friction = joint.damping, joint.friction
    for follower, multiplier in _followers(joint, mechanism):
        damping += multiplier**2 * follower.damping
        friction += abs(multiplier) * follower.friction
    return replace(joint, damping=damping, friction=friction)


def _followers(joint: Joint, mechanism: Mechanism) -> Iterator[tuple[Joint, float]]:
    """Joints whose coordinate is this one's, with their multipliers."""
    for body in mechanism.bodies if mechanism.coupled else ():
        if body.joint.mimic and body.joint.mimic.joint == joint.name:
            yield body.joint, body.joint.mimic.multiplier
