"""Drives of a measured arm whose reducers are no harmonic drives: what its two encoders tell of them, and what not."""

from functools import cache

import numpy as np
import pytest
from measured import KUKA, kuka_mapping
from scipy.io import loadmat

from cutpoint.identification import Recording, aligned, derivative, low_passed, read_recording
from cutpoint.identification.drives import SpringEstimate, two_encoders

PUBLISHED = (4.5778e6, 7.5189e6, 4.0999e6)
"""N m/rad, the authors' `para.c_rad_ode` of axes 1 to 3."""

BAND = 20.0
"""Hz."""


@cache
def recording(run: str) -> Recording:
    path = KUKA / f"run_{run}.mat"
    return low_passed(aligned(read_recording(path, kuka_mapping(path))), BAND)


def channels(run: str, axis: int) -> dict[str, np.ndarray]:
    """theta, q, and the motor's torque less what its rotor takes, with what friction before the spring would take.

    Rotor inertias are the authors'; no link model is published, so there is no second way to the torque.
    """
    parameters = loadmat(KUKA / f"run_{run}.mat", variable_names=["para"], simplify_cells=True)["para"]
    read, k = recording(run), axis - 1
    inertia = parameters["J_mr"][k] * parameters["u"][k] ** 2
    speed = read["theta_dot"][:, k]
    return {
        "theta": read["theta"][:, k],
        "q": read["q"][:, k],
        "torque": read["torque"][:, k] - inertia * derivative(speed, read.period),
        "viscous": -speed,
        "coulomb": -np.tanh(speed / 0.01),
    }


@cache
def spring(run: str, axis: int) -> SpringEstimate:
    found = channels(run, axis)
    return two_encoders(
        found["theta"],
        found["q"],
        found["torque"],
        recording(run).period,
        250.0,
        resolution=5e-7,
        orders=(),
        laws=["linear"],
        hysteresis=False,
        torque_unknowns={name: found[name] for name in ("viscous", "coulomb")},
    )


def unexplained(axis: int) -> float:
    """What of the deflection's standard deviation on run B the spring of run A leaves."""
    fit, found = spring("a", axis), channels("b", axis)
    own = dict(zip(fit.names, fit.values, strict=True))
    torque = found["torque"] + own["viscous"] * found["viscous"] + own["coulomb"] * found["coulomb"]
    deflection = found["theta"] - found["q"]
    left = deflection - torque / own["stiffness"]
    return float(np.nanstd(left) / np.nanstd(deflection[np.isfinite(left)]))


def test_the_third_axis_bends_alike_in_both_runs():
    first, second = spring("a", 3), spring("b", 3)
    assert not {"stiffness"} & {*first.unidentifiable, *second.unidentifiable}
    apart = abs(first.values[0] - second.values[0])
    assert apart < 2.0 * np.hypot(first.deviations["stiffness"], second.deviations["stiffness"])
    assert unexplained(3) < 0.4


@pytest.mark.parametrize("axis", [2, 3])
def test_stiffness_comes_near_the_published_one_but_does_not_meet_it(axis: int):
    for run in "ab":
        assert PUBLISHED[axis - 1] < spring(run, axis).values[0] < 1.7 * PUBLISHED[axis - 1]


def test_the_second_axis_is_predicted_poorly():
    # two thirds of its deflection follow neither torque nor friction
    assert 0.5 < unexplained(2) < 0.8


def test_the_first_axis_shows_no_stiffness_in_run_a():
    """It bears no weight, and its encoders differ with its position by more than its spring can bend."""
    assert "stiffness" in spring("a", 1).unidentifiable
