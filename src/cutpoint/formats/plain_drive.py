"""What drives a joint that no drive file mentions."""

from cutpoint.door import check_kind
from cutpoint.mechanics.drives.friction import Coulomb
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import Joint


def drive_of(joint: Joint) -> Drive:
    """The drive of a joint that no drive file mentions: rigid, ratio 1, and the friction that its robot file states.

    joint: of a mechanism, `robot.mechanism.bodies[k].joint`.  Its `friction`, N m (N), and `damping`, N m s/rad
    (N s/m), become Coulomb friction on the link's side, smoothed as by default; there is none if both are 0.
    """
    check_kind("drive_of", "joint", joint, Joint, "a Joint, as robot.mechanism.bodies[0].joint")
    if joint.damping == 0.0 and joint.friction == 0.0:
        return Drive()
    return Drive(link_friction=Coulomb(joint.friction, joint.damping))
