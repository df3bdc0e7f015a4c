"""`excitation`: the motion that is most informative about a robot's parameters.

Swevers, Ganseman, Tuekel, De Schutter and Van Brussel (1997), Optimal robot excitation and identification, IEEE Trans.
Robot. Autom. 13(5).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, get_args

from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.door import check_kind, checked_name, positive, whole
from cutpoint.errors import InputError
from cutpoint.identification.excitation.bounds import bounds_of
from cutpoint.identification.excitation.file import read_start, write_csv, write_start
from cutpoint.identification.excitation.information import Criterion, condition_number, log_determinant
from cutpoint.identification.excitation.limits import Box, Use
from cutpoint.identification.excitation.problem import Problem
from cutpoint.identification.excitation.search import Found, search
from cutpoint.identification.excitation.series import FourierSeries
from cutpoint.identification.one_thread import by_one_thread
from cutpoint.robot import Robot
from cutpoint.robot_arguments import STANDS, check_all_driven, check_robot

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FEWEST, MOST = 3, 50
"""Harmonics: with fewer, no motion starts at rest up to the snap."""


@dataclass(frozen=True)
class Quality:
    """Information in a motion: log det(W^T W / N) over N samples, and the condition number of W, columns scaled."""

    log_determinant: float
    condition: float


@dataclass(frozen=True, eq=False)
class Excitation:
    """The best motion found: `trajectory` has `periods` periods.

    before: quality of the first random motion, scaled up to the limits, None if they allow none there; if resumed, of
    the file's motion, with its own limits.  after: of this one.  untold: parameters about which it tells next to
    nothing, too little of the torques being theirs.  starts: number of completed starts.
    """

    robot: Robot = field(repr=False)
    trajectory: FourierSeries = field(repr=False)
    criterion: Criterion
    before: Quality | None
    after: Quality
    limits: tuple[Use, ...] = field(repr=False)
    starts: int
    resumed: bool = False
    untold: tuple[str, ...] = ()

    @property
    def periods(self) -> int:
        """Number of periods."""
        return round(self.trajectory.duration * self.trajectory.base_frequency)

    def save_csv(self, path: str | Path, rate: float = 200.0) -> None:
        """Write the positions, rad (m), at a rate, Hz, as `trajectories.from_csv` reads them.

        Raises InputError for a rate that is not positive, or makes too few steps.
        """
        write_csv(Path(path), self.robot, self.trajectory, rate)

    def plot(self) -> "Figure":
        """Positions, speeds and motor torques of one period with their limits, a row per joint."""
        from cutpoint.identification.excitation.picture import figure_of

        return figure_of(self.robot, self.trajectory, self.limits)


@by_one_thread
def excitation(
    robot: Robot,
    duration: float = 10.0,
    harmonics: int = 5,
    base_frequency: float | None = None,
    *,
    criterion: Criterion = "determinant",
    position: tuple[ArrayLike, ArrayLike] | None = None,
    travel: float = 1.0,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    boxes: Mapping[str, Box] | None = None,
    seconds: float = 30.0,
    starts: int | None = None,
    seed: int = 0,
    resume: str | Path | None = None,
) -> Excitation:
    """The finite Fourier series that is most informative about inertias, rotors and friction, within all limits.

    It starts and ends at rest, speed and acceleration zero; jerk and snap too if a drive is elastic.  It maximises
    det(W^T W), or minimises the condition number, of the regressor W of base parameters, rotor inertias and friction,
    with rows over the joints' torque limits and columns times nominal parameters.  Collisions are not checked.

    A progress bar shows on stderr when the search takes long.  Ctrl-C ends it, with the best motion until then.

    Args:
        duration: s, a whole number of periods of the base frequency.
        harmonics: of the base frequency, 3 at least.
        base_frequency: Hz; by default one period in the whole duration.
        criterion: "determinant", the largest, or "condition", the smallest.
        position: low and high, each a number or one per joint, rad (m).  Like all limits, in addition to those of robot
            and drives; a joint without any is kept within half a turn (1 m) of zero.
        travel: share of the position range that is used, about its middle; at 1 the motion may touch the stops.
        speed: rad/s (m/s), a number or one per joint; as acceleration, rad/s2, and torque, N m, of motors at the joint.
        boxes: where frames must stay, in the world: {"tool": (low, high)}, each (3,), m, infinite where free.
        seconds: the search's time.  starts: largest number of random starts.  seed: of the random starts.
        resume: a JSON file, written after each improvement, and the search's starting point if it exists.

    Raises:
        InputError: an argument is wrong, a joint's speed is not limited, the file tells of another robot or series, or
            no motion within all limits that tells of most parameters was found; it names limit and joint, or a
            parameter.
    """
    check_robot("excitation", robot)
    check_kind("excitation", "boxes", boxes, (Mapping, NoneType), "a mapping of frame names to (low, high)")
    check_kind("excitation", "resume", resume, (str, PathLike, NoneType), "the path of a file")
    check_all_driven("excitation", robot, STANDS)
    duration, harmonics = positive("excitation", "duration", duration, "s"), _harmonics(harmonics)
    frequency = _frequency(duration, base_frequency)
    checked_name("criterion", criterion, get_args(Criterion))
    seconds, seed = positive("excitation", "seconds", seconds, "s"), whole("excitation", "seed", seed, 0)
    starts = starts if starts is None else whole("excitation", "starts", starts)
    bounds = bounds_of(robot, position, speed, acceleration, torque, travel)
    problem = Problem(robot, bounds, boxes or {}, criterion, frequency, harmonics)
    file = None if resume is None else Path(resume)
    begin = None if file is None else read_start(file, robot, frequency, harmonics)

    def keep(z: Array, cost: float) -> None:
        if file is not None:
            write_start(file, robot, problem.series(z, duration), criterion, cost)

    known = None if begin is None else problem.coordinates(begin)
    found = search(problem, known, seconds, starts, seed, keep)
    return _result(robot, problem, duration, found, known)


def _result(robot: Robot, problem: Problem, duration: float, found: Found, known: Array | None) -> Excitation:
    """known: the motion of the resumed file."""
    assert found.z is not None
    first = found.first if known is None else known
    before = None if first is None else _quality(problem, first)
    return Excitation(
        robot,
        problem.series(found.z, duration),
        problem.criterion,
        before,
        _quality(problem, found.z),
        _uses(problem, found.z),
        found.starts,
        known is not None,
        found.untold,
    )


def _quality(problem: Problem, z: Array) -> Quality:
    W = problem.information.regressor(problem.motion(z))
    return Quality(log_determinant(W), condition_number(W))


def _uses(problem: Problem, z: Array) -> tuple[Use, ...]:
    motion = problem.motion(z, fine=True)
    found: list[Use] = []
    for limit in problem.limits:
        x = limit.values(motion)
        columns = zip(limit.names, limit.units, x.min(axis=0), x.max(axis=0), limit.low, limit.high, strict=True)
        found += [Use(limit.kind, name, unit, *map(float, numbers)) for name, unit, *numbers in columns]
    return tuple(found)


def _frequency(duration: float, base_frequency: float | None) -> float:
    if base_frequency is None:
        return 1.0 / duration
    base_frequency = positive("excitation", "base frequency", base_frequency, "Hz")
    periods = duration * base_frequency
    if round(periods) < 1 or abs(periods - round(periods)) > 1e-9 * periods:
        raise InputError(
            f"duration {duration:g} s holds {periods:.6g} periods of the base frequency, {base_frequency:g} Hz: "
            "it must be a whole number for the motion to end at rest",
            periods=periods,
        )
    return base_frequency


def _harmonics(count: int) -> int:
    if whole("excitation", "harmonics", count, FEWEST) > MOST:
        raise InputError(f"harmonics {count} must lie between {FEWEST} and {MOST}", harmonics=count)
    return int(count)
