"""One drive against its limits."""

from dataclasses import dataclass

import numpy as np

from cutpoint.model import Drive
from cutpoint.robot import Robot
from cutpoint.studies.sizing import duty
from cutpoint.studies.sizing.demand import Demand, demand_of
from cutpoint.studies.sizing.load import Load
from cutpoint.studies.sizing.margins import Margin, margins_of, travel_of
from cutpoint.trajectories.arrays import durations


@dataclass(frozen=True)
class DriveSizing:
    """One drive against its limits.

    slides: on a prismatic joint, where torques are forces, N.  margins: to every limit that is stated.  missing: names
    of the ratings that are not.  life: h, None where the ratings that it needs are missing, infinite for a drive that
    does not turn.  permitted_peaks: how often the longest stay above the repeated peak torque may occur; None if there
    is no such stay, it exceeds the momentary peak torque, or the first rating is missing.
    """

    joint: str
    drive: Drive
    slides: bool
    demand: Demand
    margins: tuple[Margin, ...]
    missing: tuple[str, ...]
    life: float | None
    permitted_peaks: float | None

    @property
    def failures(self) -> tuple[Margin, ...]:
        """Margins below 1."""
        return tuple(margin for margin in self.margins if not margin.holds)

    @property
    def tightest(self) -> Margin | None:
        """The smallest margin; None where nothing is stated to hold the drive against."""
        return min(self.margins, key=lambda margin: margin.value, default=None)

    @property
    def verdict(self) -> str:
        """holds, fails, or unrated: nothing is stated to hold it against."""
        if not self.margins:
            return "unrated"
        return "fails" if self.failures else "holds"


def allowed(sizing: DriveSizing, limit: str) -> float:
    """A drive's limit of this name; infinite if it is not stated."""
    return next((margin.allowed for margin in sizing.margins if margin.limit == limit), np.inf)


def drive_sizing(robot: Robot, joint: str, load: Load, life: float | None) -> DriveSizing:
    """The drive of a joint.  life: h, as `sizing` is asked for."""
    k, drive, limits = robot.joints.index(joint), robot.drives[joint], robot.limits[joint]
    slides = joint in robot.mechanism.sliding
    travel = travel_of(limits, load.position[:, k])
    demand = demand_of(load, k, travel[0])
    margins, missing = margins_of(drive, demand, limits, travel, slides)
    reached = _life(drive, demand)
    if life is not None and reached is not None:
        margins.append(Margin("life", "h", reached, life))
    return DriveSizing(joint, drive, slides, demand, (*margins,), (*missing,), reached, _peaks(drive, load, k))


def _life(drive: Drive, demand: Demand) -> float | None:
    rated = drive.ratings
    if rated is None or rated.life is None or rated.rated_torque is None or rated.rated_speed is None:
        return None
    return duty.life(
        (rated.life, rated.rated_torque, rated.rated_speed), demand.average_torque, demand.mean_motor_speed
    )


def _peaks(drive: Drive, load: Load, k: int) -> float | None:
    rated, torque = drive.ratings, load.output_torque[:, k]
    if rated is None or rated.repeated_peak_torque is None:
        return None
    if rated.momentary_peak_torque is not None and np.abs(torque).max() > rated.momentary_peak_torque:
        return None  # the rule is for peaks up to that
    return duty.permitted_peaks(durations(load.time), torque, load.motor_speed[:, k], rated.repeated_peak_torque)
