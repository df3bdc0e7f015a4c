"""Torque read from two encoders on drives with everything on: its bound, its parts, and what readings keep to."""

from typing import NamedTuple

import numpy as np

from cutpoint.analysis import TorqueBound, followed_hysteresis, torque_bound
from cutpoint.arrays import Array
from cutpoint.control import Feedforward
from cutpoint.reporting.page import Table, row
from cutpoint.simulation import Sensors, simulate
from cutpoint.studies.drive_effects import EFFECTS, with_effects
from cutpoint.studies.paper.bench import PERIOD, Bench, pd
from cutpoint.studies.paper.printed import JOINTS

COUNTS = 2**20, 2**17
"""Of the encoders, a turn: on the link, on the motor."""

LOOSE = 1.5

COVERED = 99.9
"""Percentile of the errors that a bound is held against."""


class Reading(NamedTuple):
    """Errors of readings (N, 6), N m: plain, and with hysteresis followed; and the bound of the plain ones."""

    plain: Array
    followed: Array
    bound: TorqueBound

    @property
    def covered(self) -> Array:
        """Share of samples within the bound, by joint."""
        return np.mean(np.abs(self.plain) <= self.bound.total, axis=0)

    @property
    def observed(self) -> Array:
        """99.9th percentile of the error's size, by joint, N m."""
        return np.percentile(np.abs(self.plain), COVERED, axis=0)

    @property
    def left(self) -> Array:
        """The same of what is left where hysteresis is followed."""
        return np.percentile(np.abs(self.followed), COVERED, axis=0)

    @property
    def looseness(self) -> Array:
        """How many times larger the bound is than it must be: 1 over the 99.9th percentile of error over bound."""
        return 1 / np.percentile(np.abs(self.plain) / self.bound.total, COVERED, axis=0)


def reading(bench: Bench) -> Reading:
    """The move of section IV on drives with all effects, their torque read through encoders."""
    robot = with_effects(bench.robot, EFFECTS)
    ratio = np.array([abs(drive.ratio) for drive in robot.drives.values()])
    on_link, on_motor = (2 * np.pi / counts for counts in COUNTS)
    encoders = Sensors(on_link, on_motor / ratio)
    law = pd() + Feedforward(robot, "elastic")
    log = simulate(robot, law, bench.reference, control_period=PERIOD, sensors=encoders)
    theta, q = log["measured_theta"], log["measured_q"]
    read = robot.drive_torque(theta, q)
    bound = torque_bound(robot, theta, q, encoders, record=True)
    followed = read + followed_hysteresis(robot, theta, q)
    return Reading(read - log["joint_torque"], followed - log["joint_torque"], bound)


def table(found: Reading) -> Table:
    """What makes readings of whole drives wrong, and how far."""
    parts = {name: part.max(axis=0) for name, part in vars(found.bound).items()}
    rows = [row(f"bound: {name}", part, 3) for name, part in parts.items() if part.any()]
    rows += [
        row("bound, all parts", found.bound.total.max(axis=0), 3),
        row("error, 99.9th percentile", found.observed, 3),
        row("error with hysteresis followed", found.left, 3),
        row("samples within the bound, %", 100 * found.covered, 2),
        row("bound over error", found.looseness, 2),
    ]
    caption = (
        f"Drives with all effects of the next page, encoders of {COUNTS[0]} counts on the link and {COUNTS[1]} on the "
        "motor: what a reading of their torque can be off by at most, N m, with its parts, and what it is off by. The "
        "last line is 1 over the 99.9th percentile of error over bound."
    )
    return Table("Table A8", caption, ("", *JOINTS), tuple(rows))


def remark(found: Reading) -> str:
    """What limits the reading."""
    limits = found.bound.largest_part
    often = max(set(limits), key=limits.count)
    gains = (found.observed / found.left)[found.looseness < LOOSE]
    loose = [joint for joint, times in zip(JOINTS, found.looseness, strict=True) if times >= LOOSE]
    hardly = f" The bound adds up worst cases, and is loose on {' and '.join(loose)}, hardly bent." if loose else ""
    return (
        f"Of a whole drive the encoders see the spring alone. The part that limits the reading most is {often} on "
        f"{limits.count(often)} of {len(limits)} joints; friction, ripple and the current loop lie on the motor's side "
        "of the spring and do not enter. Kinematic error is taken off with the plant's own waves. Letting the elements "
        "of hysteresis follow the measured deflection brings the error of drives that bend down by factors of "
        f"{gains.min():.1f} to {gains.max():.1f}: what is left is the encoders' resolution, if the elements are known."
        f"{hardly}"
    )


def results(found: Reading) -> dict[str, object]:
    return {
        "unit": "N m",
        "bound": found.bound.total.max(axis=0),
        "error_percentile_99.9": found.observed,
        "error_percentile_99.9_hysteresis_followed": found.left,
        "samples_within_bound": found.covered,
        "bound_over_error": found.looseness,
    }
