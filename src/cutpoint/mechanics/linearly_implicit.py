"""A drive in a step of a linearly implicit integrator: resistances act on the unknown acceleration.

Friction and the spring's damping change with speed by D (N m s/rad), which may make the drive arbitrarily stiff.  A
stage of a step h solves  J k = effort - D (s k + earlier stages' added speed), s = gamma h,  for the acceleration k: D
adds to inertia, and is computed once, at the start of the step; see `simulation.loop.step`.

With friction D_l of the link and D_m of the motor, damping d, transmission t, and the net torques tau_l and tau_m on
link and rotor while neither accelerates:

    rotor    J theta'' = tau_m - s D_m theta'' - t s d (t theta'' - a)
    so       theta'' = mobility tau_m + follows a,  mobility = 1 / (J + s (D_m + d t^2)),  follows = s d t mobility
    link     M a = tau_l + s d (t theta'' - a) - s D_l a = tau_l + follows tau_m - inertia a
    with     inertia = s (D_l + d (1 - follows t))

All quantities at the joint's side.
"""

from typing import Any, NamedTuple

from cutpoint.mechanics.drives.harmonic_drive import DriveState, friction_resistance, transmission, transmitted_torque
from cutpoint.mechanics.drives.strains import Strains
from cutpoint.mechanics.elastic_forward import DriveEffort
from cutpoint.model.drive import Drive
from cutpoint.scalars import Scalar


class Resistance(NamedTuple):
    """Resistance to a drive's motion over a step.

    link, motor: D of friction on either side, N m s/rad.  transmission: from the motor's speed to the spring end's.
    mobility: of the rotor, its resistance included, 1/(kg m2).  inertia: added to the link's own by resistance, kg m2.
    follows: share of the link's acceleration that the spring's damping passes on to the rotor.
    """

    link: Any = 0
    motor: Any = 0
    transmission: Any = 1
    mobility: Any = 0
    inertia: Any = 0
    follows: Any = 0


def is_resisted(drive: Drive) -> bool:
    """Whether a drive has friction or damping."""
    return not all(x is None for x in (drive.link_friction, drive.motor_friction, drive.damping))


def resistance(drive: Drive, at: DriveState, strains: Strains, span: Scalar, load: Scalar = 0) -> Resistance:
    """Resistance of a drive over a step from here.  span: gamma h, s.  load: torque that a rigid one transmits, N m."""
    link, damping = friction_resistance(drive.link_friction, at.v, 0, strains.link), drive.damping
    if not drive.is_elastic:
        link = link + friction_resistance(drive.motor_friction, at.v, load, strains.motor)
        return Resistance(link, inertia=span * link)
    load = transmitted_torque(drive, at, strains.spring)
    motor = friction_resistance(drive.motor_friction, at.theta_dot, load, strains.motor)
    if damping is None:
        return Resistance(link, motor, mobility=1 / (drive.reflected_inertia + span * motor), inertia=span * link)
    t = transmission(drive, at.theta)
    mobility = 1 / (drive.reflected_inertia + span * (motor + damping * t * t))
    follows = span * damping * t * mobility
    inertia = span * (link + damping * (1 - follows * t))
    return Resistance(link, motor, transmission=t, mobility=mobility, inertia=inertia, follows=follows)


def from_memory(drive: Drive, numbers: tuple[Scalar, ...]) -> Resistance:
    """A resistance from its numbers; terms that this drive cannot have are left out of the equations."""
    found = Resistance(*numbers)
    if not is_resisted(drive):
        return Resistance(mobility=found.mobility)
    if drive.damping is not None:
        return found
    is_link_free = drive.is_elastic and drive.link_friction is None
    return found._replace(inertia=0 if is_link_free else found.inertia, follows=0)


def resisted(drive: Drive, effort: DriveEffort, resists: Resistance, earlier: tuple[Scalar, Scalar]) -> DriveEffort:
    """The effort in a stage while the link does not accelerate, and the implicit resistance terms.

    earlier: speeds of link and motor added by earlier stages, rad/s.
    """
    if not is_resisted(drive):
        return effort
    effort = effort._replace(mobility=resists.mobility, inertia=resists.inertia, follows=resists.follows)
    on_link, net = effort.on_link - resists.link * earlier[0], effort.net
    if not drive.is_elastic:
        return effort._replace(on_link=on_link)
    net = net - resists.motor * earlier[1]
    if drive.damping is not None:
        wound = drive.damping * (resists.transmission * earlier[1] - earlier[0])
        net = net - resists.transmission * wound
        on_link = on_link + wound + resists.follows * net
    return effort._replace(on_link=on_link, net=net)
