"""Drive torques as a linear function of the drives' coefficients: stiffness, damping, rotor inertia, friction.

The coefficients c of a drive, those that it has, in this order, at the joint's side: inertia of the rotor (kg m2),
stiffness of the spring at rest and damping (N m/rad, N m s/rad), coefficients of the link's friction, then of the
motor's.  A hardening spring law is linear in one coefficient, its scale, when the shape of its curve is held fixed.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

from cutpoint.mechanics.drives.harmonic_drive import DriveState, deflection, transmission
from cutpoint.mechanics.drives.presliding import sliding_of
from cutpoint.mechanics.system import Driven
from cutpoint.model.drive import Drive
from cutpoint.scalars import Scalar


class DriveRegressor(NamedTuple):
    """Torques on the links, link @ c, and motor torques, motor @ c, one row a drive: N m for each unit of c.

    An elastic drive's rows include everything but hysteresis, load-dependent friction, and the effect of the carrier's
    motion on a fully coupled rotor.  A rigid drive's motor row lacks the torque on its link, which has no deflection to
    tell it, and its link row is empty.
    """

    link: Any
    motor: Any


class Column(NamedTuple):
    """One coefficient: its name, its value, and the torque per unit of it on either side, N m."""

    name: str
    value: Scalar
    link: Scalar
    motor: Scalar


def drive_regressor(
    drives: Sequence[Driven], states: Sequence[DriveState], accelerations: Sequence[Scalar]
) -> DriveRegressor:
    """Rows of all drives side by side.  accelerations: of the motors, rad/s2.  Xia (2019) eqs. (2), (54)-(56)."""
    found = [columns(d.drive, at, a) for d, at, a in zip(drives, states, accelerations, strict=True)]
    width, start = sum(map(len, found)), 0
    link, motor = ([[0] * width for _ in found] for _ in range(2))
    for k, own in enumerate(found):
        link[k][start : start + len(own)] = [column.link for column in own]
        motor[k][start : start + len(own)] = [column.motor for column in own]
        start += len(own)
    return DriveRegressor(link, motor)


def columns(drive: Drive, at: DriveState, acceleration: Scalar) -> list[Column]:
    """A drive's coefficients, in their order."""
    found: list[Column] = []
    if drive.rotor is not None:
        found.append(Column("inertia", drive.reflected_inertia, 0, acceleration))
    if drive.compliance is not None:
        stiffness, turns = drive.compliance.tangent(0), transmission(drive, at.theta)
        shape = drive.compliance.torque(deflection(drive, at.theta, at.q)) / stiffness
        found.append(Column("stiffness", stiffness, shape, turns * shape))
        if drive.damping is not None:
            rate = turns * at.theta_dot - at.v
            found.append(Column("damping", drive.damping, rate, turns * rate))
    for side, law, speed in (
        ("link", drive.link_friction, at.v),
        ("motor", drive.motor_friction, at.theta_dot if drive.is_elastic else at.v),
    ):
        sliding = sliding_of(law)
        if sliding is not None:
            on_link = side == "link" and drive.is_elastic
            for name, x in zip(sliding.coefficients, sliding.columns(speed), strict=True):
                value = getattr(sliding, name)
                found.append(Column(f"{side}_{name}", value, -x if on_link else 0, 0 if on_link else x))
    return found
