"""Files of an excitation: the best series so far, to resume from, and positions over time, for a robot to follow."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.door import positive
from cutpoint.errors import InputError
from cutpoint.files import check_readable, replacing
from cutpoint.identification.excitation.series import FourierSeries
from cutpoint.joint_units import at_joints
from cutpoint.robot import Robot
from cutpoint.trajectories import Trajectory

VERSION = 1

LEAST_STEPS = 10
"""Least number of rows of a trajectory in a file."""

FREQUENCY = "base frequency in Hz"
"""Without one, it is that of one period in the whole duration."""

LARGEST_FILE = 10_000_000
"""Bytes: far more than the coefficients of a hundred joints need."""


def write_start(path: Path, robot: Robot, series: FourierSeries, criterion: str, cost: float) -> None:
    """Writes a series within all limits, and its cost under a criterion, see `judged`, in SI units, atomically."""
    sheet = {
        "cutpoint_excitation": VERSION,
        "robot": robot.name,
        "joints": list(robot.joints),
        "duration_s": series.duration,
        "base_frequency_Hz": series.base_frequency,
        "criterion": criterion,
        "cost": cost,
        "centre": series.centre.tolist(),
        "sine": series.sine.tolist(),
        "cosine": series.cosine.tolist(),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as file:
        file.write(json.dumps(sheet, indent=1, ensure_ascii=False, allow_nan=False).encode())


def read_start(path: Path, robot: Robot, base_frequency: float, harmonics: int) -> FourierSeries | None:
    """The series in a file written by `write_start`; None if there is no file yet.

    Raises InputError: another kind of file, or one with other joints, harmonics or another base frequency.
    """
    if not path.exists():
        return None
    check_readable(path, LARGEST_FILE)
    try:
        sheet = json.loads(path.read_bytes())
        joints, version = sheet["joints"], sheet["cutpoint_excitation"]
        frequency = float(sheet["base_frequency_Hz"])
        centre, sine, cosine = (np.array(sheet[key], dtype=np.float64) for key in ("centre", "sine", "cosine"))
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError) as error:
        raise InputError(f"file is not an excitation written by cutpoint: {error!r}", place=path) from error
    fits = {
        "version": (version, VERSION),
        "joints": (joints, list(robot.joints)),
        FREQUENCY: (frequency, base_frequency),
        "shapes of coefficients": (
            [centre.shape, sine.shape, cosine.shape],
            [(robot.nv,), (harmonics, robot.nv), (harmonics, robot.nv)],
        ),
    }
    _check(path, fits, [centre, sine, cosine])
    return FourierSeries(1.0 / base_frequency, base_frequency, centre, sine, cosine)


def _check(path: Path, fits: dict[str, tuple[Any, Any]], coefficients: list[Array]) -> None:
    for what, (found, wanted) in fits.items():
        if found != wanted:
            remedy = "to start afresh, name another file (resume=) or folder (--output)"
            if what == FREQUENCY:
                remedy = f"give the duration (--duration) that it had, or --base-frequency {found:g}; {remedy}"
            raise InputError(f"its {what}, {found!r}, must be {wanted!r} to resume from it; {remedy}", place=path)
    if not all(np.isfinite(x).all() for x in coefficients):
        raise InputError("its coefficients must be finite", place=path)


def write_csv(path: Path, robot: Robot, trajectory: Trajectory, rate: float) -> None:
    """Positions, rad (m), at a rate, Hz, with the units in the first line, as `trajectories.from_csv` reads them."""
    count = round(trajectory.duration * positive("save_csv", "rate", rate, "Hz"))
    if count < LEAST_STEPS:
        rule = f"makes {count} steps of {trajectory.duration:g} s: it must make {LEAST_STEPS} or more"
        raise InputError(f"save_csv: rate {rate} Hz {rule}", rate=rate)
    times = np.linspace(0.0, trajectory.duration, count + 1)
    columns = [f"{name} [{unit}]" for name, unit in at_joints(robot, "rad").items()]
    rows = [",".join(["t [s]", *columns])]
    for t, q in zip(times, trajectory.derivatives(times, 0)[0], strict=True):
        rows.append(",".join([f"{t:.9g}", *(f"{x:.12g}" for x in q)]))
    with replacing(path) as file:
        file.write(("\n".join(rows) + "\n").encode())
