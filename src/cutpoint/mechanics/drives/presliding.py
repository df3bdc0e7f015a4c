"""Presliding friction: contacts deflect like bristles, stick below breakaway and slide above it.

A bristle's strain follows the joint's displacement, not time: the strain after a displacement follows from that before
it in closed form, at any speed.  So these laws limit integration steps only through the frequency of a mass on the
bristles' stiffness, and through its decay by their damping after a reversal.  The differential equations that they
solve are cited at each class.
Strains in rad (m), torques in N m (N), all at the joint's side.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

from cutpoint.errors import InputError
from cutpoint.mechanics.drives.friction import Coulomb, Sliding, Stribeck
from cutpoint.mechanics.drives.saturation import saturation
from cutpoint.scalars import Scalar, absolute, clip, maximum, minimum, where

Halfway = tuple[Scalar, Scalar]
"""Speed, rad/s, and load, N m, half way along a displacement."""

SMALLEST = 1e-30
"""rad, or rad over rad: no way is shorter, for it is divided by."""


class Presliding(ABC):
    """Base class of bristle laws.

    sliding: the law of steady sliding.  distance: strain at breakaway, from rest without load, rad.
    damping: of the bristles while they wind up, N m s/rad.
    """

    sliding: Stribeck | Coulomb
    distance: Scalar
    damping: Scalar

    most_winding: ClassVar[int] = 1
    """What `winding` comes to at most."""

    @property
    def stiffness(self) -> Scalar:
        """Stiffness of the bristles, N m/rad."""
        return self.sliding.plateau(0) / self.distance

    @property
    def compliance(self) -> Scalar:
        """rad/(N m)."""
        return self.distance / self.sliding.plateau(0)

    def torque(self, speed: Scalar, load: Scalar = 0) -> Scalar:
        """xi in steady sliding, N m, for use without a strain."""
        return self.sliding.torque(speed, load)

    def required_torque(self, required: Scalar, speed: Scalar, load: Scalar = 0) -> Scalar:
        return self.sliding.required_torque(required, speed, load)

    def resistance(self, speed: Scalar, load: Scalar = 0) -> Scalar:
        """Resistance in steady sliding, N m s/rad."""
        return self.sliding.resistance(speed, load)

    def share_of_load(self, speed: Scalar) -> Scalar:
        return self.sliding.share_of_load(speed)

    def strained_torque(self, strain: Scalar, speed: Scalar, load: Scalar = 0) -> Scalar:
        """xi of strained bristles, N m.  Their damping acts only while they wind up, so it never drives the motion."""
        return self.stiffness * strain + self.strained_resistance(strain, speed, load) * speed

    def strained_resistance(self, strain: Scalar, speed: Scalar, load: Scalar = 0) -> Scalar:
        """The part of xi that is proportional to speed, N m s/rad."""
        return self.damping * maximum(self.winding(strain, speed, load), 0) + self.sliding.viscosity

    @abstractmethod
    def strain(
        self, before: Scalar, displacement: Scalar, speed: Scalar, load: Scalar = 0, halfway: Halfway | None = None
    ) -> Scalar:
        """Strain after a displacement in one direction, rad.

        speed, load: at its end.  halfway: by default as at its end; the breakaway strain is interpolated linearly
        through both.
        """

    @abstractmethod
    def winding(self, strain: Scalar, speed: Scalar, load: Scalar = 0) -> Scalar:
        """d strain / d displacement at a strain: 1 where all motion winds bristles up, 0 in full sliding, and up to 2
        where LuGre's bristles unwind, which doubles their damping."""

    def _ends(self, speed: Scalar, load: Scalar, halfway: Halfway | None, forwards: Scalar) -> tuple[Scalar, Scalar]:
        """Breakaway strains at the beginning and the end of a displacement, rad."""
        end = self._breakaway(speed, load, forwards)
        return end if halfway is None else 2 * self._breakaway(*halfway, forwards) - end, end

    def _breakaway(self, speed: Scalar, load: Scalar, forwards: Scalar) -> Scalar:
        """Breakaway strain, rad."""
        return self.sliding.dry(speed, load, forwards) * self.compliance


@dataclass(frozen=True)
class LuGre(Presliding):
    """ds/dt = speed - |speed| s / s_b, s_b = dry friction / stiffness.  Canudas de Wit et al. (1995).

    Slides a little at any load: under a vibrating load it drifts where a real contact sticks.
    sliding: the law of steady sliding.  distance: strain at breakaway, s_b, from rest without load, rad.  damping: of
    the bristles while they wind up, N m s/rad.
    """

    sliding: Stribeck | Coulomb
    distance: Scalar
    damping: Scalar

    most_winding = 2

    def strain(
        self, before: Scalar, displacement: Scalar, speed: Scalar, load: Scalar = 0, halfway: Halfway | None = None
    ) -> Scalar:
        forwards = where(displacement < 0, -1, 1)
        start, end = self._ends(speed, load, halfway, forwards)
        return forwards * _followed(forwards * before, start, end, absolute(displacement), (start + end) / 2)

    def winding(self, strain: Scalar, speed: Scalar, load: Scalar = 0) -> Scalar:
        forwards = where(speed < 0, -1, 1)
        return 1 - forwards * strain * (1 / self._breakaway(speed, load, forwards))


@dataclass(frozen=True)
class ElastoPlastic(Presliding):
    """Elastic up to a share of the breakaway strain, then gradually sliding.  Dupont et al. (2002).

    Within Dupont's family, ds/dt = speed (1 - alpha sgn(speed) s / s_b), alpha makes sliding grow in proportion
    to the strain beyond elastic * s_b, which has a closed form.  Loads below that share are held without creep.
    sliding: the law of steady sliding.  distance: strain at breakaway, s_b, from rest without load, rad.  damping: of
    the bristles while they wind up, N m s/rad.  elastic: the share, at least 0 and below 1.
    """

    sliding: Stribeck | Coulomb
    distance: Scalar
    damping: Scalar
    elastic: Scalar

    def strain(
        self, before: Scalar, displacement: Scalar, speed: Scalar, load: Scalar = 0, halfway: Halfway | None = None
    ) -> Scalar:
        forwards = where(displacement < 0, -1, 1)
        start, end = self._ends(speed, load, halfway, forwards)
        before, travel, share = forwards * before, absolute(displacement), self.elastic  # in the direction of motion
        # sliding starts where the strain meets that share of the changing limit
        short, moved = share * start - before, share * (end - start)
        onset = clip(travel * short / maximum(travel - moved, SMALLEST), 0, travel)
        limit = start + (end - start) * onset / maximum(travel, SMALLEST)
        scale = (1 - share) * (limit + end) / 2
        plastic = _followed(before + onset, limit, end, travel - onset, scale)
        elastic = before + travel
        return forwards * where(elastic < share * end, elastic, minimum(plastic, elastic))

    def winding(self, strain: Scalar, speed: Scalar, load: Scalar = 0) -> Scalar:
        forwards = where(speed < 0, -1, 1)
        limit = self._breakaway(speed, load, forwards)
        knee = self.elastic * limit
        return 1 - maximum(forwards * strain - knee, 0) * (1 / (limit - knee))


def _followed(before: Scalar, start: Scalar, end: Scalar, way: Scalar, scale: Scalar) -> Scalar:
    """s after a distance with ds/dx = (limit - s) / scale, the limit varying linearly from start to end."""
    x = maximum(way / scale, SMALLEST)
    gone = saturation(x)
    return end + (before - start) * (1 - gone) - (end - start) * (gone / x)


def steady_sliding(law: Any) -> Any:
    """The law of steady sliding: the bristles' one, or the law itself, which may be the user's own, or None."""
    return law.sliding if isinstance(law, Presliding) else law


def sliding_of(law: Any) -> Sliding | None:
    """The law of steady sliding, with its coefficients.

    Raises InputError for a law of the user's own: it has no coefficients to learn or to identify.
    """
    if law is None or isinstance(law, Sliding | Presliding):
        return steady_sliding(law)
    remedy = "state Coulomb's or Stribeck's law, or bristles on one"
    raise InputError(f"friction law {type(law).__name__} has no coefficients to learn or to identify: {remedy}")
