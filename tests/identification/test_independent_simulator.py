"""Drives identified from logs of a simulator that shares no code with cutpoint: a pendulum behind a damped spring."""

import math
from functools import cache

import numpy as np
import pytest
from drive_benches import PERIOD, RATIO, TURN, pendulum

from cutpoint.identification import Recording
from cutpoint.identification.drives import identify_drives, turns

LINK, ROTOR, STIFFNESS, DAMPING = 2.22, 0.4, 7000.0, 3.0
"""kg m2 about the axis, at the joint's side; N m/rad; N m s/rad."""

WEIGHT = 12.0 * 9.81 * 0.4
"""N m, of the pendulum's link, level."""

COULOMB, VISCOUS, SMOOTHING = 3.0, 2.0, 0.02
"""Motor friction: N m, N m s/rad, rad/s."""

WAVE, TURNED = 1e-4, 2.0 * RATIO
"""Kinematic error, rad, and its waves per radian of the joint."""

SUBSTEPS = 20
"""Of the integration, in each period."""


def slopes(state: tuple[float, ...], torque: float) -> tuple[float, ...]:
    """Derivatives of the link's angle and speed, and of the motor's, under the motor's torque, N m."""
    q, v, theta, w = state
    share = 1.0 - WAVE * TURNED * math.cos(TURNED * theta)
    spring = STIFFNESS * (theta - WAVE * math.sin(TURNED * theta) - q) + DAMPING * (share * w - v)
    friction = COULOMB * math.tanh(w / SMOOTHING) + VISCOUS * w
    return v, (spring + WEIGHT * math.cos(q)) / LINK, w, (torque - share * spring - friction) / ROTOR


def after_a_period(state: tuple[float, ...], torque: float) -> tuple[float, ...]:
    """By the classical Runge-Kutta method of order 4, the torque held."""
    h = PERIOD / SUBSTEPS
    for _ in range(SUBSTEPS):
        k1 = slopes(state, torque)
        k2 = slopes(tuple(x + 0.5 * h * k for x, k in zip(state, k1, strict=True)), torque)
        k3 = slopes(tuple(x + 0.5 * h * k for x, k in zip(state, k2, strict=True)), torque)
        k4 = slopes(tuple(x + h * k for x, k in zip(state, k3, strict=True)), torque)
        of = zip(state, k1, k2, k3, k4, strict=True)
        state = tuple(x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d) for x, a, b, c, d in of)
    return state


@cache
def log() -> Recording:
    """8 s of what exact encoders and a PD law of the motor record: torque as commanded, from its stamp on."""
    time = PERIOD * np.arange(8001)
    asked = -0.6 + sum(a * np.sin(TURN * f * time + p) for a, f, p in ((0.7, 0.2, 0.3), (0.2, 0.5, 1.0), (0.1, 0.8, 2)))
    state = (float(asked[0]), 0.0, float(asked[0]) - WEIGHT * math.cos(asked[0]) / STIFFNESS, 0.0)
    before, rows = state[2], []
    for now, speed in zip(asked.tolist(), np.gradient(asked, PERIOD).tolist(), strict=True):
        theta = state[2]
        torque = 3000.0 * (now - theta) + 150.0 * (speed - (theta - before) / PERIOD)
        rows.append((state[0], theta, torque))
        state, before = after_a_period(state, torque), theta
    q, theta, torque = np.array(rows).T[..., None]
    return Recording(time, ("axle",), q=q, theta=theta, torque=torque)


@pytest.mark.parametrize("band", [10.0, 20.0, 40.0])
def test_damping_is_found_in_a_band_narrower_than_the_waves(monkeypatch: pytest.MonkeyPatch, band: float):
    # the waves reach 50 Hz; coarse encoders of motors leave bands like these
    monkeypatch.setattr(turns, "clear_acceleration", lambda *_: (band, 0.0))
    found = identify_drives(pendulum(), log(), 1e-6, torque_delay=0.5 * PERIOD).joints["axle"]
    assert found.spring.damping == pytest.approx(DAMPING, rel=0.005)
    assert found.spring["stiffness"] == pytest.approx(STIFFNESS, rel=1e-4)
    assert found.rotor["inertia"] == pytest.approx(ROTOR, rel=1e-3)
    (wave,) = found.spring.kinematic_error.harmonics
    assert wave.order == 2 and wave.amplitude == pytest.approx(WAVE, rel=1e-2)


def test_damping_is_found_beside_gaps():
    recording = log()
    unknown = (recording.time % 2.0 > 1.5) & (recording.time % 2.0 < 1.7)
    found = identify_drives(
        pendulum(),
        recording.with_channels(lambda values: np.where(unknown[:, None], np.nan, values)),
        1e-6,
        torque_delay=0.5 * PERIOD,
    ).joints["axle"]
    assert found.spring.damping == pytest.approx(DAMPING, rel=0.005)
    assert found.spring["stiffness"] == pytest.approx(STIFFNESS, rel=1e-4)
