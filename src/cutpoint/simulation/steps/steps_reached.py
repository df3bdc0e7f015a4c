"""Check after a run with fixed steps: whether the states it reached would have needed shorter ones."""

from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from cutpoint.callers import warn
from cutpoint.mechanics.bodies.joints import Floating, Spherical
from cutpoint.mechanics.drives.backlash import spring_of
from cutpoint.mechanics.drives.harmonic_drive import deflection
from cutpoint.robot import Robot
from cutpoint.simulation.log.channels import BASE_SPEEDS, base_of
from cutpoint.simulation.log.log import Log
from cutpoint.simulation.steps.fastest import Limit, fastest_mode, fastest_wave, posture
from cutpoint.simulation.steps.substeps import MOST_SUBSTEPS, SETTINGS, StiffnessWarning

ALLOWED = 2.0
"""How many times faster than foreseen waves may become: less than a whole wave a step, which no step would see."""

STIFFER = 1.3
"""The same of modes, whose errors grow with the fourth power."""

HARDENS = 4.0
"""Times as stiff as at the start: a spring that becomes stiffer than that does so within a step, which must be shorter
by the root of how much."""


class TooFew(NamedTuple):
    """Integration steps per control period that a run would have needed, those that it took, and why."""

    asked: int
    taken: int
    happened: str
    cause: str


def check_steps(robot: Robot, log: Log) -> list[TooFew]:
    """Why, according to the log, shorter steps were needed: waves of fast motors, fast turning of bodies, or modes of
    springs that stiffened."""
    taken, longest, found = log.meta["substeps"], SETTINGS[log.meta["accuracy"]], list[TooFew]()
    if taken >= MOST_SUBSTEPS:
        return found

    def check(happened: str, limit: Limit, step: float, allowed: float) -> None:
        asked = log.meta["control_period"] * limit.rate / step
        if asked > allowed * taken:
            found.append(TooFew(int(np.ceil(asked)), taken, happened, limit.cause))

    if "theta_dot" in log:
        check("reached speeds at which", fastest_wave(robot, log.max("theta_dot")), longest.wave, ALLOWED)
    if (turn := _fastest_turn(robot, log)).rate:
        check("reached speeds at which", turn, longest.turn, 1.0)
    if "theta" in log and "q" in log and (wound := _stiffest(robot, log)):
        mode, stiffer = wound
        check("wound springs until", mode, longest.mode * min(1.0, np.sqrt(HARDENS / stiffer)), STIFFER)
    return found


def warn_of(found: Collection[TooFew], who: str = "the run") -> None:
    """Warns at the user's line, once for each thing that happened; for the cause that needs most steps."""
    for happened in dict.fromkeys(each.happened for each in found):
        asked, taken, _, cause = max(each for each in found if each.happened == happened)
        told = f"{who} {happened} {cause} would take {asked} integration steps per control period"
        warn(f"{told}, but {taken} were taken: give substeps={asked}", StiffnessWarning)


def _fastest_turn(robot: Robot, log: Log) -> Limit:
    """Fastest turning of joints with quaternions, rad/s: of a floating base throughout, of others at the end."""
    best, base = Limit(0.0, "nothing that turns"), base_of(robot)
    if base and all(name in log for name in BASE_SPEEDS):
        omega = np.array([log[name] for name in BASE_SPEEDS[3:]])
        best = Limit(float(np.linalg.norm(omega, axis=0).max()), f"the turning of {base.name!r}")
    end = log.run.end if log.run else None
    for segment in robot.machine.system.segments if end else ():
        if end and isinstance(segment.joint, Spherical | Floating):
            omega = np.asarray(end.v)[segment.v][-3:]
            best = max(best, Limit(float(np.linalg.norm(omega)), f"the turning of {segment.name!r}"))
    return best


def _stiffest(robot: Robot, log: Log) -> tuple[Limit, float] | None:
    """The fastest mode at the largest deflection of the spring that stiffened most relative to the start, and by how
    much; None if none stiffened."""
    drives, theta, q = robot.machine.drives, log["theta"], log["q"]
    if q.shape != theta.shape or not any(d.drive.is_elastic for d in drives):
        return None

    def wound(k: int, sample: int) -> float:
        return float(deflection(drives[k].drive, theta[sample, k], q[sample, k]))

    farthest, stiffer = np.abs(theta - q).argmax(axis=0).tolist(), np.ones(len(drives))
    for k, drive in enumerate(d.drive for d in drives):
        law, spring = drive.compliance, spring_of(drive.compliance)
        if law is not None and spring is not None:
            begun = max(float(law.tangent(wound(k, 0))), float(spring.tangent(0.0)))  # nearly zero within backlash
            stiffer[k] = float(law.tangent(wound(k, farthest[k]))) / begun
    worst = int(stiffer.argmax())
    if stiffer[worst] <= STIFFER:
        return None
    there = np.array([wound(k, farthest[worst]) for k in range(len(drives))])
    pose = robot.neutral()  # of what has no drive, such as a floating base, modes hardly depend on the place
    pose[[d.q for d in drives]] = q[farthest[worst]]
    return fastest_mode(robot, [posture(robot, pose)], there[None]), float(stiffer[worst])
