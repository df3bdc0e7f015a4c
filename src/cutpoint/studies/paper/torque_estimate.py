"""Torque read from two encoders, the abstract's first contribution, against the true torque of the closed loop."""

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.compliance import Flexspline
from cutpoint.reporting.page import Page, Picture, Table, row
from cutpoint.reporting.style import INK, LINK, MOTOR, SPRING, WIDTH
from cutpoint.robot import Robot
from cutpoint.simulation import Log
from cutpoint.studies.paper import whole_drive_torque
from cutpoint.studies.paper.bench import Bench
from cutpoint.studies.paper.printed import JOINTS
from cutpoint.studies.paper.table_3 import rms

IDEAL = "ideal encoders"
COARSE, FINE = "2^{17} counts on the link", "2^{20} counts on the link"
STIFFER = "ideal encoders, K_{f0} taken 20 % too high"

_MOTOR_COUNTS = 2**13
_SHOWN = 1  # joint 2
_ZOOM = (4.0, 4.06)  # s


def page(bench: Bench) -> Page:
    log, estimates = bench.elastic, estimated(bench)
    errors = {name: torque - log["joint_torque"] for name, torque in estimates.items()}
    whole = whole_drive_torque.reading(bench)
    blocks = (
        "An encoder on either side of the drive shows how far it bends, and law (2) turns that into the torque the "
        "link gets: a torque sensor without a sensor. Below it is read from the loop of Table 4 with all rungs, "
        f"against the torque in the simulated drive. The motor's encoder has {_MOTOR_COUNTS} counts a motor turn, "
        "which the ratio of 100 makes fine at the joint; the link's encoder sets the resolution.",
        _table(bench, errors),
        _verdict(bench, errors),
        Picture(
            "Figure A4",
            "Joint 2: (a) the torque of the drive, true and as read with a stiffness 20 % too high; "
            "(b) true and as read with 2^{17} counts on the link, while the link vibrates; (c) what "
            "the readings are off by.",
            _figure(log, estimates, errors),
        ),
        whole_drive_torque.table(whole),
        whole_drive_torque.remark(whole),
    )
    results = _results(log, errors) | {"table_a8": whole_drive_torque.results(whole)}
    return Page("torque", "Torque from two encoders", blocks, results)


def estimated(bench: Bench) -> dict[str, Array]:
    """Torques (N, 6) in N m as they are read, by encoder."""
    robot, log = bench.robot, bench.elastic
    theta = robot.from_rotor(angle=quantised(robot.to_rotor(angle=log["theta"]), _MOTOR_COUNTS))
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


def _table(bench: Bench, errors: dict[str, Array]) -> Table:
    rows = [row("true torque", bench.elastic.rms("joint_torque"), 3)]
    rows += [row(f"error: {name}", rms(error), 3) for name, error in errors.items()]
    return Table(
        "Table A3", "RMS of the joint torque and of what its reading is off by, N m.", ("", *JOINTS), tuple(rows)
    )


def _verdict(bench: Bench, errors: dict[str, Array]) -> str:
    law = bench.robot.drives["joint2"].compliance
    assert isinstance(law, Flexspline)
    count, largest = 2 * np.pi / 2**17, bench.elastic.max("joint_torque")[_SHOWN]
    return (
        "With ideal encoders the reading is the torque itself: it is the plant's own law, so this says that it is "
        f"evaluated rightly, and no more. One count of 2^{{17}} on joint 2 is worth {count * law.stiffness:.2f} N m "
        f"at rest and {count * law.tangent(law.deflection(largest)):.2f} N m at its largest torque, where (2) is "
        f"stiffer; the reading is off by {rms(errors[COARSE])[_SHOWN]:.2f} N m RMS. 2^{{20}} counts are "
        f"{rms(errors[COARSE])[_SHOWN] / rms(errors[FINE])[_SHOWN]:.1f} times better and not eight times, for then "
        "the motor's encoder is the coarser of the two. A "
        f"stiffness taken a fifth too high is off by {rms(errors[STIFFER])[_SHOWN]:.1f} N m on the same joint, "
        "because the tangent of (2) magnifies it: a drive that is not identified well is not saved by its encoders. "
        "Hysteresis and kinematic error, which a real drive has, are not in this plant; below they are."
    )


def _figure(log: Log, estimates: dict[str, Array], errors: dict[str, Array]) -> Figure:
    figure = Figure(figsize=(WIDTH, 3.7), layout="constrained")
    whole, zoom, error = figure.subplots(1, 3)
    time, true, near = log.time, log["joint_torque"][:, _SHOWN], (log.time >= _ZOOM[0]) & (log.time <= _ZOOM[1])
    whole.plot(time, estimates[STIFFER][:, _SHOWN], color=LINK, lw=0.5, alpha=0.8)
    whole.plot(time, true, color=MOTOR, lw=0.6)
    zoom.plot(time[near], true[near], color=MOTOR, lw=1.6)
    zoom.step(time[near], estimates[COARSE][near, _SHOWN], color=INK, lw=1.0, where="mid")
    error.plot(time, errors[COARSE][:, _SHOWN], color=INK, lw=0.5)
    error.plot(time, errors[FINE][:, _SHOWN], color=SPRING, lw=0.5)
    whole.set(title="(a) torque [N m]", xlabel="time [s]")
    zoom.set(title="(b) the same, 60 ms of it", xlabel="time [s]")
    error.set(title="(c) error [N m]", xlabel="time [s]")
    for axes in (whole, zoom, error):
        axes.margins(x=0)
    _legend(figure)
    return figure


def _legend(figure: Figure) -> None:
    names = {
        "true": MOTOR,
        "read, $2^{17}$ counts": INK,
        "read, $2^{20}$ counts": SPRING,
        "read, $K_{f0}$ 20 % too high": LINK,
    }
    lines = [Line2D([], [], color=colour, lw=2) for colour in names.values()]
    figure.legend(lines, [*names], loc="outside lower center", ncols=4)


def _results(log: Log, errors: dict[str, Array]) -> dict[str, dict[str, object]]:
    off_by = {name: rms(error) for name, error in errors.items()}
    return {
        "table_a3": {
            "unit": "N m",
            "motor_counts": _MOTOR_COUNTS,
            "true_rms": log.rms("joint_torque"),
            "error_rms": off_by,
        }
    }
