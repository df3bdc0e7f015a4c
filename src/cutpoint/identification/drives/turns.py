"""A joint's spring from its motor's torque, and the rotor from that spring, in turns."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cutpoint.identification.conditioning.filtering import HIGHEST, low_pass_together, noise_cutoff
from cutpoint.identification.drives.acceleration_noise import clear_acceleration, noise_density
from cutpoint.identification.drives.deflections import TorqueReading
from cutpoint.identification.drives.joint_channels import Channels
from cutpoint.identification.drives.joint_torques import corrected, torque_left, transmitted_share
from cutpoint.identification.drives.rotor import RotorEstimate
from cutpoint.identification.drives.scatter import SIGNIFICANT
from cutpoint.identification.drives.spring_estimate import UNCERTAIN, SpringEstimate
from cutpoint.identification.drives.spring_laws import LAWS
from cutpoint.identification.drives.two_encoders import two_encoders
from cutpoint.model.drive import Compliance

SHAPE = ("flexspline",)
"""The law used for springs until the best one is chosen: it includes the linear one."""

WIDER = 2.0
"""Times the frequency at which the deflection or the torque falls below its noise: springs are identified up to there.

Noise of the torque beyond makes springs appear stiffer and less damped.
"""

TURNS = 8
"""Largest number of alternations between spring and rotor; initially wrong friction takes several."""

CONVERGED = 0.5
"""Standard deviations of a rotor: after a smaller change both have converged."""

SAMPLED, ENOUGH = 10.0, 2_000
"""Samples that are kept of filtered channels, per period of the cut-off, and in all at least: more say nothing new."""


class Turn(NamedTuple):
    """A spring, a rotor, and whether the spring separated it from the links."""

    spring: SpringEstimate
    rotor: RotorEstimate
    apart: bool

    @property
    def is_negative(self) -> bool:
        """Whether the rotor is clearly negative."""
        return self.apart and self.rotor["inertia"] < -SIGNIFICANT * self.rotor.deviations["inertia"]


class Turns:
    """Those of one joint, from the spring and the rotor that its link's torque shows.

    resolution: of both encoders together, rad at the joint's side.  stated: the spring of the file, without play.
    """

    def __init__(
        self,
        joint: Channels,
        ratio: float,
        spring: SpringEstimate,
        rotor: RotorEstimate,
        resolution: float,
        stated: Compliance | None,
    ) -> None:
        self._joint, self._ratio, self._spring, self._rotor = joint, ratio, spring, rotor
        self._resolution, self._stated, self._torque = resolution, stated, joint.motor_torque(rotor)
        lead, period, highest = joint.theta - joint.q, joint.period, HIGHEST / joint.period
        still, told = (min(WIDER * noise_cutoff(x, period, otherwise=highest), highest) for x in (lead, self._torque))
        self._band, self._shaking = clear_acceleration(joint.theta, period, min(still, told), still)
        self._noise = noise_density(lead, period, still) * np.sqrt(self._band)
        self._every = max(1, min(int(1.0 / (SAMPLED * self._band * period)), lead.size // ENOUGH))

    def taken(self) -> Turn | None:
        """Until spring and rotor stand still.

        None if they run away, the rotor below zero, or on while the spring is out of sight: the torques of links
        without weight have the shape of their rotors', and with noise they fix only the ratio of stiffness and inertia.
        """
        before = [(self._spring, self._rotor)]
        for _ in range(TURNS - 1):
            found = self._turn(*before[-1], SHAPE, apart=is_seen(before[-1][0]))
            is_lost = found.apart and not (is_seen(found.spring) or _is_near(before[-1][1], found.rotor))
            if found.is_negative or is_lost:
                return None
            settled = len(before) > 1 and any(_is_near(found.rotor, own) for _, own in before)  # or returns to another
            before.append((found.spring, found.rotor))
            if settled:
                break
        found = self._turn(*before[-1], tuple(LAWS), apart=is_seen(before[-1][0]))
        return None if found.is_negative else found

    def with_links_rotor(self) -> Turn:
        """The spring from the torque that the rotor leaves which the link's torque shows; its errors count."""
        return self._turn(self._spring, self._rotor, tuple(LAWS), apart=False)

    def _turn(self, spring: SpringEstimate, rotor: RotorEstimate, laws: Sequence[str], *, apart: bool) -> Turn:
        """The spring from the torque that the rotor leaves, and, if it tells them apart, the rotor from that spring."""
        joint, ratio, period, every, band = self._joint, self._ratio, self._joint.period, self._every, self._band
        share = transmitted_share(spring, joint.theta, ratio)
        left, by = torque_left(rotor, joint.theta, self._torque, period, joint.delay, share)
        channels = joint.theta, joint.q, left, *by.values()
        angle = np.where(np.isfinite(channels).all(axis=0), joint.theta, np.nan)
        theta, q, left, *columns = (x[::every] for x in low_pass_together(channels, period, band))
        by = dict(zip(by, columns, strict=True))
        reading = TorqueReading(
            unknowns=by if apart else {},
            shared_noise={"inertia": rotor["inertia"] * self._shaking**2},
            errors=None if apart else rotor.possible_errors(by),
            transmission=share[::every],
            noise=self._noise,
            band=band,
            angle=angle,
            every=every,
        )
        found = two_encoders(
            theta, q, left, period * every, ratio,
            resolution=self._resolution, laws=laws, reading=reading, stated=None if laws is SHAPE else self._stated,
        )  # fmt: skip
        return Turn(found, corrected(rotor, found) if apart else rotor, apart)


def _is_near(rotor: RotorEstimate, other: RotorEstimate) -> bool:
    """Whether another differs by less than CONVERGED of the first one's standard deviations."""
    return bool((np.abs(rotor.values - other.values) <= CONVERGED * np.sqrt(np.diag(rotor.covariance))).all())


def is_seen(spring: SpringEstimate) -> bool:
    """Whether a spring with too small a deflection to be stated still separates the rotor from the links."""
    return spring.deviations["stiffness"] < UNCERTAIN * spring["stiffness"]
