"""Results of the laws of a catalogue drive, measured as its maker measures a gear."""

from functools import cached_property

import numpy as np

from cutpoint.arrays import Array
from cutpoint.formats.catalogue.catalogue import catalogue_drive, catalogue_friction, catalogue_gear
from cutpoint.formats.catalogue.friction import InputFriction
from cutpoint.formats.catalogue.sheets import CatalogueGear
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.model.drive import Drive
from cutpoint.model.units import RPM
from cutpoint.studies.drive.loop import Loop, cycle

SMALL = 0.04
"""Of the rated torque: what lost motion is measured with.  Harmonic Drive, HFUS-2A manual 1019658, page 52."""


class Specimen:
    """A drive of the catalogue on the test bench.

    gear: its sheet.  drive: its laws.  friction: at the input, with what of it is an estimate.
    """

    def __init__(self, name: str) -> None:
        self.gear: CatalogueGear = catalogue_gear(name)
        self.drive: Drive = catalogue_drive(name)
        self.friction: InputFriction = catalogue_friction(name)

    @property
    def spring(self) -> CatalogueSpring | None:
        spring = self.drive.compliance
        assert spring is None or isinstance(spring, CatalogueSpring)
        return spring

    @property
    def load(self) -> float | None:
        """The torque that the sheet measures at, N m: rated, or the largest that it states."""
        gear = self.gear
        if gear.ratings:
            return gear.ratings.rated
        if gear.output and gear.output.maximum_torque:
            return gear.output.maximum_torque
        return max(torque for _, torque, _ in gear.efficiency.points) if gear.efficiency else None

    @property
    def chords(self) -> tuple[float, float]:
        """Stiffness from zero to T1 and from T1 to T2, N m/rad."""
        spring = self.spring
        assert spring is not None
        first, second = (float(spring.deflection(t)) for t in (spring.t1, spring.t2))
        return float(spring.t1) / first, float(spring.t2 - spring.t1) / (second - first)

    @cached_property
    def loop(self) -> Loop | None:
        """Between plus and minus the load, wave generator blocked."""
        return cycle(self.drive, self.load) if self.spring and self.load else None

    @cached_property
    def lost_motion(self) -> float | None:
        """Between the ends of a loop to 4 % of the rated torque, rad."""
        return cycle(self.drive, SMALL * self.load).span if self.spring and self.load and self.gear.ratings else None

    def error(self, angle: Array) -> Array:
        """Kinematic error at angles of the wave generator, rad; (n,)."""
        law, ratio = self.drive.kinematic_error, self.drive.ratio
        return np.zeros_like(angle) if law is None else np.asarray(law.value(angle / ratio, ratio), float)

    @property
    def accuracy(self) -> float:
        """Peak to peak over a turn of the wave generator, rad."""
        return float(np.ptp(self.error(np.linspace(0.0, 2 * np.pi, 1441))))

    def running_torque(self, rpm: float) -> float:
        """At the input without load, N m."""
        return self._friction(rpm, 0.0) / abs(self.drive.ratio)

    def efficiency(self, rpm: float, torque: float) -> float:
        """Power out over power in."""
        return torque / (torque + self._friction(rpm, torque))

    @property
    def knows_speed(self) -> bool:
        """Whether friction at speed is known, not only the torque that starts it."""
        return self.friction.slope is not None

    @property
    def knows_load(self) -> bool:
        return self.knows_speed and self.friction.per_load is not None

    @property
    def is_fitted(self) -> bool:
        """Whether friction was fitted to efficiencies, for want of running torques."""
        return self.gear.efficiency is not None and self.gear.running is None

    def _friction(self, rpm: float, load: float) -> float:
        law = self.drive.motor_friction
        return 0.0 if law is None else float(law.torque(rpm * RPM / abs(self.drive.ratio), load))
