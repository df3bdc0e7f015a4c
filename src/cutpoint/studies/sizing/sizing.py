"""`sizing`: every drive of a robot against a motion that it repeats."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cutpoint.door import number, path_of, positive
from cutpoint.errors import InputError
from cutpoint.files import replacing
from cutpoint.mechanics.drives.backlash import spring_of
from cutpoint.model.limits import check_configuration
from cutpoint.reporting.numbers import json_bytes, json_values
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_all_driven
from cutpoint.simulation.inputs import check_fits
from cutpoint.studies.sizing.drive_sizing import DriveSizing, drive_sizing
from cutpoint.studies.sizing.load import Load, sampled
from cutpoint.studies.sizing.margins import Margin
from cutpoint.trajectories.trajectory import Moves, check_trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Sizing:
    """All drives against one cycle, a motion of `duration` s and a pause of `dwell` s; load: its samples.

    smooth: drives that fail, if their motors did not follow the gears' kinematic errors; of those that have one.
    """

    robot: str
    duration: float
    dwell: float
    drives: Mapping[str, DriveSizing]
    load: Load
    smooth: Mapping[str, DriveSizing]

    @property
    def holds(self) -> bool:
        """Whether no margin is below 1; limits that are not stated do not count."""
        return not any(found.failures for found in self.drives.values())

    def __repr__(self) -> str:
        failing = ", ".join(joint for joint, found in self.drives.items() if found.failures)
        least = "nothing is stated"
        if self.tightest:
            joint, margin = self.tightest
            least = f"least margin {margin.value:.3g}, {margin.limit} of {joint}"
        return f"Sizing({self.robot!r}: {f'limits broken by {failing}' if failing else 'all hold'}; {least})"

    @cached_property
    def tightest(self) -> tuple[str, Margin] | None:
        """The joint with the smallest margin of all, and that margin; None where nothing is stated."""
        found = [(joint, d.tightest) for joint, d in self.drives.items() if d.tightest is not None]
        return min(found, key=lambda entry: entry[1].value, default=None)

    def plot(self) -> "Figure":
        """Torque over motor speed with all limits, a panel a drive: `found.plot().savefig("check.png")`."""
        from cutpoint.studies.sizing.figure import figure_of

        return figure_of([*self.drives.values()], self.load)

    def save(self, path: str | Path) -> None:
        """Write `results` to a JSON file, whole or not at all."""
        with replacing(path_of("save", path)) as file:
            file.write(json_bytes(self.results()))

    def results(self) -> dict[str, Any]:
        """All of it but the samples, for a JSON file: SI units, null for infinite and for what is not known."""
        results = {
            "robot": self.robot,
            "cycle": {"duration": self.duration, "dwell": self.dwell, "samples": len(self.load.time)},
            "holds": self.holds,
            "drives": {joint: _drive_results(found) for joint, found in self.drives.items()},
            "without_kinematic_error": {joint: _drive_results(found) for joint, found in self.smooth.items()},
        }
        return json_values(results)


def sizing(
    robot: Robot, trajectory: Moves, *, dwell: float = 0.0, period: float = 1e-3, life: float | None = None
) -> Sizing:
    """What a motion, repeated for ever, asks of the robot's drives, and what of that they are allowed.

    Torques are those of `elastic_inverse_dynamics` with friction as in steady sliding, rotors with full coupling
    `quasi_rigid`, the motor's ripple and cogging overcome by its current.  Play is left out: crossed at once,
    it asks more torque the finer it is sampled.  Limits are those of the drives' ratings, limits and motors, and of the
    robot file.

    Args:
        trajectory: one cycle.  A way back that is not in it does not count.
        dwell: s, the pause after it, in its last position: it cools the motor, and slows the gear's average.
        period: s between samples, at most; there are at least 2000 in the motion, 8 in each wave of a rotor's turn
            (as long as that is not more than 500 000 in all), and many more about each drive's worst instants.
        life: h, asked of the gears; it becomes a margin where the ratings tell a life.

    Raises:
        InputError: a trajectory of another size, in degrees by mistake, a floating base, a time that is not positive.
    """
    _check(robot, trajectory, dwell, period, life)
    found = as_driven(robot, trajectory, dwell, period, life)
    rough = [joint for joint, x in found.drives.items() if x.failures and x.drive.kinematic_error is not None]
    if not rough:
        return found
    ideal = {joint: replace(robot.drives[joint], kinematic_error=None) for joint in rough}
    without = as_driven(robot.with_drives(ideal), trajectory, dwell, period, life)
    return replace(found, smooth={joint: without.drives[joint] for joint in rough})


def as_driven(robot: Robot, trajectory: Moves, dwell: float, period: float, life: float | None) -> Sizing:
    """`sizing` of checked arguments, but for what drives would be if they were smooth."""
    load = sampled(_without_play(robot), trajectory, period, dwell)
    for extreme in (load.position.min(axis=0), load.position.max(axis=0)):
        check_configuration(robot.mechanism, extreme.tolist())
    found = {joint: drive_sizing(robot, joint, load, life) for joint in robot.joints}
    return Sizing(robot.name, trajectory.duration, dwell, found, load, smooth={})


def _without_play(robot: Robot) -> Robot:
    tight = {joint: replace(x, compliance=spring_of(x.compliance)) for joint, x in robot.drives.items()}
    return robot if tight == {**robot.drives} else robot.with_drives(tight)


def _check(robot: Robot, trajectory: Moves, dwell: float, period: float, life: float | None) -> None:
    check_all_driven("sizing", robot, "only what a motor moves can be sized; fix it in the robot file")
    check_trajectory("sizing", trajectory)
    positive("sizing", "trajectory.duration", trajectory.duration, "s")
    check_fits("sizing", trajectory, robot)
    dwell = number("sizing", "dwell", dwell, "s")
    if not (np.isfinite(dwell) and dwell >= 0):
        raise InputError(f"sizing: dwell {dwell} s must be finite and not negative", dwell=dwell)
    positive("sizing", "period", period, "s")
    if life is not None:
        positive("sizing", "life", life, "h")


def _drive_results(found: DriveSizing) -> dict[str, Any]:
    return {
        "verdict": found.verdict,
        "life_h": found.life,
        "permitted_peaks": found.permitted_peaks,
        "margins": [{**asdict(m), "margin": m.value, "holds": m.holds} for m in found.margins],
        "missing": found.missing,
        "demand": asdict(found.demand),
    }
