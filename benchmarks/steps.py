"""Cost of each drive effect in an integration step: ns per step of the closed loop, against linear elastic drives.

python benchmarks/steps.py      prints its table alone

A run with many integration steps a control period less one with few is integration alone: what the controller, sensors
and the call cost cancels.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from run_sections import steps as table_of

import cutpoint
from cutpoint import Backlash, ElastoPlastic, Grease, LinearSpring
from cutpoint.formats.catalogue.catalogue import catalogue_drive
from cutpoint.model import Drive, Motor
from cutpoint.simulation.plant import lengths
from cutpoint.studies import drive_effects as effects
from cutpoint.studies.cost.timing import in_turns
from cutpoint.trajectories import cycloid

PERIODS, FEW, MANY = 20, 100, 300
"""Control periods of a run, and integration steps in each."""

PASSES = 5
"""Over all runs, in turns; the least of each counts."""

GOAL = np.deg2rad([90.0, 60.0, 60.0, 90.0, 60.0, 90.0])

Change = Callable[[Drive, Drive], Drive]
"""A drive on a linear spring, and the arm's with the catalogue's laws: the former with something of the latter."""


def taken(*fields: str) -> Change:
    """These fields as the catalogue has them."""
    return lambda drive, maker: replace(drive, **{name: getattr(maker, name) for name in fields})


def bristles(drive: Drive, maker: Drive) -> Drive:
    law = ElastoPlastic(maker.motor_friction, effects.DISTANCE, effects.BRISTLE_DAMPING, effects.ELASTIC)
    return replace(drive, motor_friction=law)


def leaning_and_cold(drive: Drive, maker: Drive) -> Drive:
    grease = Grease(effects.TEMPERATURE, effects.THINNING)
    return replace(drive, motor_friction=replace(maker.motor_friction, asymmetry=effects.LEANING, grease=grease))


def play(drive: Drive, maker: Drive) -> Drive:
    return replace(drive, compliance=Backlash(drive.compliance, 3e-4))


def lag(drive: Drive, maker: Drive) -> Drive:
    return replace(drive, motor=Motor(0.1, bandwidth=effects.BANDWIDTH, delay=effects.DELAY))


def waves(drive: Drive, maker: Drive) -> Drive:
    return replace(drive, motor=effects.motor_with(maker, (effects.RIPPLE,)))


def limits(drive: Drive, maker: Drive) -> Drive:
    return replace(drive, motor=Motor(0.1, resistance=1.0, current_limit=20.0, voltage_limit=48.0))


def full(drive: Drive, maker: Drive) -> Drive:
    """All at once but for backlash, which harmonic drives do not have."""
    drive = taken("compliance", "kinematic_error", "hysteresis")(drive, maker)
    law = leaning_and_cold(drive, maker).motor_friction
    motor = effects.motor_with(maker, (effects.LAG, effects.RIPPLE))
    motor = replace(motor, resistance=1.0, current_limit=20.0, voltage_limit=48.0)
    return replace(bristles(drive, replace(maker, motor_friction=law)), motor=motor)


LINEAR = "linear elastic drives"
EFFECTS: dict[str, Change] = {
    LINEAR: taken(),
    "stiffness curve": taken("compliance"),
    "backlash": play,
    "kinematic error": taken("kinematic_error"),
    "hysteresis": taken("hysteresis"),
    "gear friction under load": taken("motor_friction"),
    "gear friction, asymmetric and cold": leaning_and_cold,
    "gear friction as bristles": bristles,
    "Stribeck friction of the link": taken("link_friction"),
    "current loop and delay": lag,
    "ripple and cogging": waves,
    "current and voltage limits": limits,
    "all but backlash and Stribeck": full,
}
"""Each alone on linear elastic drives, but for the last."""


def arm(change: Change) -> cutpoint.Robot:
    """The paper's arm on the catalogue's gears of its drives' sizes, as far as changed."""
    robot, drives = cutpoint.robots.xia2019(), {}
    for (name, own), gear in zip(robot.drives.items(), effects.GEARS, strict=True):
        maker = replace(catalogue_drive(gear), link_friction=own.link_friction)
        linear = replace(own, compliance=LinearSpring(maker.compliance.k1), link_friction=None)
        drives[name] = change(linear, maker)
    return robot.with_drives(drives)


def steps() -> list[dict]:
    """A row an effect."""
    arms = {name: arm(change) for name, change in EFFECTS.items()}
    law = cutpoint.control.tune(next(iter(arms.values())), 5.0)  # rotors and links are the same in all
    calls = {(name, n): run_of(robot, law, n) for name, robot in arms.items() for n in (FEW, MANY)}
    passes = [in_turns(calls) for _ in range(PASSES)]
    least = {key: min(times[key].least for times in passes) for key in calls}
    found = []
    for name, robot in arms.items():
        nanoseconds = (least[name, MANY] - least[name, FEW]) / (PERIODS * (MANY - FEW))
        found.append({"effect": name, "nanoseconds": nanoseconds, "states": sum(lengths(robot.machine))})
    return found


def run_of(robot: cutpoint.Robot, law: cutpoint.control.PD, substeps: int) -> Callable[[], object]:
    trajectory = cycloid(GOAL, PERIODS * 1e-3)
    run = partial(cutpoint.simulate, robot, law, trajectory, substeps=substeps)
    run()
    return run


if __name__ == "__main__":
    print(table_of(steps()))
