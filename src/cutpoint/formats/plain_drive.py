"""What drives a joint that no drive file mentions."""

from cutpoint.mechanics.drives.friction import Coulomb
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import Joint


def drive_of(joint: Joint) -> Drive:
    """The drive of a joint that no drive file mentions: rigid, no gear, and the friction that its robot file states."""
    if joint.damping == 0.0 and joint.friction == 0.0:
        return Drive()
    return Drive(link_friction=Coulomb(joint.friction, joint.damping))
