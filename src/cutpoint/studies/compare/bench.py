"""The bench for all laws: an arm, its move and its payload."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import positive
from cutpoint.errors import InputError, unknown_name
from cutpoint.formats.catalogue.catalogue import catalogue_drive
from cutpoint.model.tool import tool_frame_of
from cutpoint.robot import Robot
from cutpoint.robots import xia2019
from cutpoint.studies.compare.there_and_back import ThereAndBack
from cutpoint.studies.drive_effects import GEARS
from cutpoint.studies.paper.printed import GOAL
from cutpoint.studies.sizing.margins import travel_of
from cutpoint.trajectories import Trajectory, cycloid

USUAL, SLOW, FAST = 3.0, 10.0, 1.0
"""Time of a move from home to goal, s, and of the way back."""

STROKE, SHARE = 1.0, 0.25
"""Travel of a joint from home: rad, at most this share of its range."""

CSG = ("CSG-14-100", "CSG-17-100", "CSG-20-100", "CSG-25-100", "CSG-32-100")
"""Gears of one series by size."""

RADIUS = 0.05
"""Radius of a payload, a ball, m."""


@dataclass(frozen=True, eq=False)
class Bench:
    """home and goal (n,), rad; payload: rated, kg, at `frame`; bandwidth of the PD that all are matched to, Hz;
    control_period, s; gears: the catalogue's, one a drive, for the scenario of whole drives."""

    robot: Robot
    home: Array
    goal: Array
    frame: str
    payload: float
    gears: tuple[str, ...]
    bandwidth: float
    control_period: float

    def move(self, duration: float) -> Trajectory:
        """From home to goal and back, `duration` s each way."""
        return ThereAndBack(cycloid(self.goal, duration, self.home))

    def loaded(self, share: float) -> Robot:
        """The arm holding this share of the rated payload."""
        mass = share * self.payload
        return self.robot.with_payload(mass, np.zeros(3), 0.4 * mass * RADIUS**2 * np.eye(3), self.frame)


def bench_of(
    robot: Robot,
    *,
    bandwidth: float = 4.0,
    control_period: float = 1e-3,
    payload: float | None = None,
    frame: str | None = None,
) -> Bench:
    """A bench for any arm of revolute joints with elastic drives.

    The paper's arm, with all its joints, makes the paper's move; others go from the middle of their joints' travel, see
    `travel_of`, by STROKE rad, at most SHARE of the travel, every second joint backwards.
    payload: rated, kg; 2 for the paper's arm and 3 for others.  frame: what it hangs on; by default `tool_frame_of` it.

    Raises:
        InputError: a joint that slides, a coordinate without a drive, a rigid drive, a frame that does not exist, or a
            payload, a bandwidth or a period that is not positive.
    """
    _check(robot)
    bandwidth = positive("compare", "bandwidth", bandwidth, "Hz")
    control_period = positive("compare", "control_period", control_period, "s")
    papers = xia2019()
    mine = (robot.name, robot.joints) == (papers.name, papers.joints)
    payload = positive("compare", "payload", (2.0 if mine else 3.0) if payload is None else payload, "kg")
    if frame is not None and frame not in robot.frames:
        raise unknown_name("frame", frame, robot.frames)
    home, goal = (np.zeros(6), np.array(GOAL)) if mine else _ends(robot)
    gears = GEARS if mine else gears_for(robot, home, goal)
    return Bench(robot, home, goal, frame or tool_frame_of(robot.mechanism), payload, gears, bandwidth, control_period)


def _check(robot: Robot) -> None:
    sliding = robot.mechanism.sliding
    if robot.nv != len(robot.joints):
        raise InputError(f"compare: {robot.name!r} has coordinates without a drive; fix its base")
    for name, drive in robot.drives.items():
        if name in sliding:
            raise InputError(f"compare: joint {name!r} slides; errors are compared as angles: lock it", joint=name)
        if not drive.is_elastic:
            remedy = "laws are compared on joints that bend: give it a rotor and a compliance in the drive file"
            raise InputError(f"compare: the drive of {name!r} is rigid; {remedy}", joint=name)


def _ends(robot: Robot) -> tuple[Array, Array]:
    # its workspace is unknown: a joint without one of its limits moves about 0, if the other allows that
    home, half = np.array([travel_of(each, np.zeros(1)) for each in robot.limits.values()]).T
    return home, home + np.minimum(STROKE, SHARE * 2 * half) * (-1.0) ** np.arange(len(home))


def gears_for(robot: Robot, home: Array, goal: Array) -> tuple[str, ...]:
    """For each drive the smallest gear that may repeat its joint's effort limit, or the torque of a fast move; the
    largest where none may."""
    fitting = [[name for name in CSG if _peak(name) >= torque] for torque in _needed(robot, home, goal)]
    return tuple(names[0] if names else CSG[-1] for names in fitting)


def overtaxed(bench: Bench) -> tuple[str, ...]:
    """Joints that may need more than their gears' repeated peak torque."""
    needed = zip(bench.robot.joints, bench.gears, _needed(bench.robot, bench.home, bench.goal), strict=True)
    return tuple(joint for joint, gear, torque in needed if _peak(gear) < torque)


def _peak(gear: str) -> float:
    """Repeated peak torque, N m."""
    ratings = catalogue_drive(gear).ratings
    return ratings.repeated_peak_torque or 0.0 if ratings else 0.0


def _needed(robot: Robot, home: Array, goal: Array) -> Any:
    """Torque that each joint may need, N m."""
    move = cycloid(goal, FAST, home)(np.linspace(0, FAST, 101))
    torque = np.abs(robot.inverse_dynamics(move.q, move.v, move.a)).max(axis=0)
    effort = np.array([limits.effort for limits in robot.limits.values()])
    return np.where(np.isfinite(effort), effort, torque)
