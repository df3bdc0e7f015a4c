"""Torque read from two encoders, the abstract's first contribution, against the true torque of the closed loop."""

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from cutpoint.mechanics.compliance import Flexspline
from cutpoint.robot import Robot
from cutpoint.simulation import Log
from cutpoint.studies.chain import Array
from cutpoint.studies.paper.bench import Bench
from cutpoint.studies.paper.page import JOINTS, Page, Picture, Table, row
from cutpoint.studies.style import FAINT, LINK, MOTOR, WIDTH

IDEAL = "ideal encoders"
COARSE, FINE = "2^{17} counts on the link", "2^{20} counts on the link"
STIFFER = "ideal encoders, K_{f0} taken 20 % too high"

_MOTOR_COUNTS = 2**13
_SHOWN = 1  # joint 2


def page(bench: Bench) -> Page:
    log, estimates = bench.elastic, estimated(bench)
    errors = {name: torque - log["joint_torque"] for name, torque in estimates.items()}
    blocks = (
        "An encoder on either side of the drive shows how far it bends, and law (2) turns that into the torque the link gets: a torque "
        "sensor without a sensor. Below it is read from the loop of Table 4 with all rungs, against the torque in the simulated "
        f"drive. The motor's encoder has {_MOTOR_COUNTS} counts a motor turn, which the ratio of 100 makes fine at the joint; the link's "
        "encoder sets the resolution.",
        _table(bench, errors),
        _verdict(bench, errors),
        Picture("Figure A4", "Joint 2: (a) the torque of the drive, true and read from two encoders with 2¹⁷ counts on the link; "
                "(b) what the reading is off by.", _figure(log, estimates, errors)),
    )  # fmt: skip
    return Page("torque", "Torque from two encoders", blocks, _results(log, errors))


def estimated(bench: Bench) -> dict[str, Array]:
    """Torques (N, 6) in N m as they are read, by encoder."""
    robot, log = bench.robot, bench.elastic
    theta = quantised(log["theta"], _MOTOR_COUNTS * 100)
    return {
        IDEAL: robot.drive_torque(log["theta"], log["q"]),
        FINE: robot.drive_torque(theta, quantised(log["q"], 2**20)),
        COARSE: robot.drive_torque(theta, quantised(log["q"], 2**17)),
        STIFFER: _stiffer(robot).drive_torque(log["theta"], log["q"]),
    }


def quantised(angle: Array, counts: int) -> Array:
    """An angle as an encoder with this many counts a turn shows it, rad."""
    step = 2 * np.pi / counts
    return step * np.round(angle / step)


def _stiffer(robot: Robot) -> Robot:
    """The robot as one would believe it with springs 20 % too stiff."""
    drives = {}
    for name, drive in robot.drives.items():
        assert isinstance(drive.compliance, Flexspline)
        drives[name] = replace(drive, compliance=replace(drive.compliance, stiffness=1.2 * drive.compliance.stiffness))
    return robot.with_drives(drives)


def _rms(x: Array) -> Array:
    return np.sqrt(np.mean(x**2, axis=0))


def _table(bench: Bench, errors: dict[str, Array]) -> Table:
    rows = [row("true torque", bench.elastic.rms("joint_torque"), 3)]
    rows += [row(f"error: {name}", _rms(error), 3) for name, error in errors.items()]
    return Table("Table A3", "RMS of the joint torque and of what its reading is off by, N m.", ("", *JOINTS), tuple(rows))


def _verdict(bench: Bench, errors: dict[str, Array]) -> str:
    law = bench.robot.drives["joint2"].compliance
    assert isinstance(law, Flexspline)
    step = law.stiffness * 2 * np.pi / 2**17
    return (
        f"With ideal encoders the reading is exact to {np.abs(errors[IDEAL]).max():.0e} N m: it is the plant's own law, so this says that it was "
        f"inverted rightly, and no more. One count of 2¹⁷ on joint 2 is {step:.2f} N m, and the reading is off by "
        f"{_rms(errors[COARSE])[_SHOWN]:.2f} N m RMS, about a count over √12; 2²⁰ counts are eight times better. A drive whose stiffness is "
        f"wrong by a fifth is off by {_rms(errors[STIFFER])[_SHOWN]:.1f} N m on the same joint, more than either: where the drive is not identified "
        "well, a better encoder does not help. Damping, hysteresis and kinematic error, which a real drive has, are not in this plant."
    )


def _figure(log: Log, estimates: dict[str, Array], errors: dict[str, Array]) -> Figure:
    figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(log.time, estimates[COARSE][:, _SHOWN], color=FAINT, lw=0.6, label="read, $2^{17}$ counts")
    left.plot(log.time, log["joint_torque"][:, _SHOWN], color=MOTOR, label="true")
    right.plot(log.time, errors[COARSE][:, _SHOWN], color=FAINT, lw=0.6, label="$2^{17}$ counts")
    right.plot(log.time, errors[FINE][:, _SHOWN], color=MOTOR, lw=0.6, label="$2^{20}$ counts")
    right.plot(log.time, errors[STIFFER][:, _SHOWN], color=LINK, label="$K_{f0}$ 20 % too high")
    left.set(title="(a) joint 2: torque [N m]", xlabel="time [s]")
    right.set(title="(b) joint 2: error [N m]", xlabel="time [s]")
    for axes in (left, right):
        axes.margins(x=0)
        axes.legend(loc="best")
    return figure


def _results(log: Log, errors: dict[str, Array]) -> dict[str, dict[str, object]]:
    off_by = {name: _rms(error) for name, error in errors.items()}
    return {"table_a3": {"unit": "N m", "motor_counts": _MOTOR_COUNTS, "true_rms": log.rms("joint_torque"), "error_rms": off_by}}
