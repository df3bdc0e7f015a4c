"""The controller's sensors: resolution, noise, delay, and speeds from positions."""

from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, Log, Sensors, simulate
from cutpoint.control import PD, Measurement, Reference
from cutpoint.simulation.loop.noise import Noise
from cutpoint.trajectories import quintic
from robot_library import frictionless, robot

PERIOD = 1e-3
SOFT = PD([200.0] * 6, [20.0] * 6)
PATH = quintic(np.full(6, 0.4), 0.2)
SIDES = ("q", "theta")


def run(duration: float = 0.1, **sensors: Any) -> Log:
    return simulate(robot("xia2019"), SOFT, PATH, duration, PERIOD, sensors=Sensors(**sensors), substeps=20)


@pytest.mark.parametrize(
    ("periods", "backend"), [(0, "llvm"), (1, "llvm"), (4, "llvm"), (300, "llvm"), (0, "numpy"), (4, "numpy")]
)
def test_a_delay_of_k_periods_shifts_every_measurement_by_k_samples(periods, backend):
    ours, sensors = frictionless(robot("xia2019", backend)), Sensors(delay=periods * PERIOD)
    log = simulate(ours, PD([2.0] * 6, [0.2] * 6), PATH, periods * PERIOD + 0.02, PERIOD, sensors=sensors, substeps=4)
    for name in ("q", "v", "theta", "theta_dot"):
        seen, true = log[f"measured_{name}"], log[name]
        assert np.array_equal(seen[periods:], true[: len(true) - periods])
        assert np.array_equal(seen[:periods], np.repeat(true[:1], periods, axis=0))


class Branching:
    """A law that cannot be compiled."""

    def step(self, memory: None, measured: Measurement, reference: Reference) -> tuple[None, np.ndarray]:
        return memory, np.array([2.0 * error if error > 0 else error for error in reference.theta - measured.theta])


@pytest.mark.filterwarnings("ignore::cutpoint.simulation.UntracedControllerWarning")
@pytest.mark.parametrize(
    ("law", "accuracy"), [(Branching(), "standard"), (Branching(), "reference"), (SOFT, "reference")]
)
def test_a_delay_of_several_periods_is_for_every_law_and_integrator(law: Any, accuracy: Any):
    ours, sensors = frictionless(robot("xia2019")), Sensors(delay=3 * PERIOD)
    log = simulate(ours, law, PATH, 0.01, PERIOD, sensors=sensors, accuracy=accuracy)
    assert np.array_equal(log["measured_theta"][3:], log["theta"][:-3])
    assert np.ptp(log["theta"][3:], axis=0).all()


def test_resolution_rounds_positions_to_the_nearest_step():
    steps = {"q": 1e-4, "theta": np.linspace(1e-5, 6e-5, 6)}
    log = run(link_resolution=steps["q"], motor_resolution=steps["theta"])
    for name in SIDES:
        seen, true = log[f"measured_{name}"], log[name]
        assert np.abs(seen / steps[name] - np.round(seen / steps[name])).max() < 1e-9
        assert (np.abs(seen - true) <= steps[name] * (0.5 + 1e-9)).all()
        assert np.ptp(seen - true) > 0.0


def test_noise_has_its_deviation_and_comes_again_with_its_seed():
    log, again, other = (run(0.2, link_noise=1e-4, motor_noise=1e-5, seed=seed) for seed in (1, 1, 2))
    for name, deviation in zip(SIDES, (1e-4, 1e-5), strict=True):
        noise = log[f"measured_{name}"] - log[name]
        assert noise.std() == pytest.approx(deviation, rel=0.1)
        assert abs(noise.mean()) < 0.2 * deviation
        assert np.array_equal(log[f"measured_{name}"], again[f"measured_{name}"])
        assert not np.array_equal(log[f"measured_{name}"], other[f"measured_{name}"])


def noise_beside(seeds: list[int], samples: int, size: int, backend: str) -> np.ndarray:
    rows = np.empty((samples, size * len(seeds)))
    Noise(seeds, size, backend).fill(rows)
    return rows


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_noise_is_normal_and_nothing_repeats(backend):
    """Moments of N numbers are within 5 of their standard deviations, sqrt(1, 2, 15, 96 / N); tails as normal ones."""
    noise = noise_beside([1, 2], 20000, 6, backend)
    assert noise.shape == (20000, 12)
    for power, moment, variance in ((1, 0, 1), (2, 1, 2), (3, 0, 15), (4, 3, 96)):
        assert np.abs(np.mean(noise**power, axis=0) - moment).max() < 5 * np.sqrt(variance / len(noise))
    assert np.mean(np.abs(noise) > 3) == pytest.approx(0.0027, rel=0.15)
    assert np.abs(np.corrcoef(noise.T) - np.eye(12)).max() < 5 / np.sqrt(len(noise))
    assert np.abs(np.corrcoef(noise[1:, 0], noise[:-1, 0])[0, 1]) < 5 / np.sqrt(len(noise))
    assert len(np.unique(noise)) == noise.size


@pytest.mark.parametrize("samples", [1, 511, 512, 1300])
def test_a_longer_run_begins_with_the_noise_of_a_shorter(samples):
    whole = noise_beside([3, 4, 5], 2000, 7, "llvm")
    assert np.array_equal(noise_beside([3, 4, 5], samples, 7, "llvm"), whole[:samples])
    assert np.array_equal(noise_beside([4], samples, 7, "llvm"), whole[:samples, 1::3])
    numpys = noise_beside([4], samples, 7, "numpy")
    assert np.allclose(numpys, whole[:samples, 1::3], rtol=1e-13, atol=1e-14)  # of angles up to 2 pi, near a zero


def test_runs_without_noise_draw_none():
    assert noise_beside([1, 2], 10, 0, "llvm").shape == (10, 0)


def test_sides_have_noise_of_their_own():
    log = run(link_noise=1e-4)
    assert np.array_equal(log["measured_theta"], log["theta"])
    assert not np.array_equal(log["measured_q"], log["q"])


@pytest.mark.parametrize("periods", [0, 2])
def test_differenced_speeds_are_what_positions_as_measured_tell(periods):
    log = run(speeds="differenced", motor_resolution=1e-5, delay=periods * PERIOD)
    for position, speed in (("measured_q", "measured_v"), ("measured_theta", "measured_theta_dot")):
        np.testing.assert_allclose(log[speed][1:], np.diff(log[position], axis=0) / PERIOD, rtol=0, atol=1e-9)
        assert np.array_equal(log[speed][0], np.zeros(6))


@pytest.mark.parametrize(
    ("sensors", "message"),
    [
        ({"delay": 1.5e-3}, "delay 0.0015 s must be a whole number of control periods of 0.001 s"),
        ({"delay": -1e-3}, "delay -0.001 s must be a whole number of control periods of 0.001 s, 0 or more"),
        ({"delay": np.nan}, "delay nan s must be a whole number"),
        (
            {"delay": 42.0},
            r"delay 42 s is 4.2e\+04 control periods of 0.001 s, with 6 drives at most 41666 are supported",
        ),
        ({"link_resolution": 0.0}, "link_resolution 0.0 must be positive"),
        (
            {"motor_resolution": 17},
            r"motor_resolution 17 is more than a turn, .*; a 17-bit encoder has steps of 2 pi",
        ),
        ({"motor_noise": [1e-4] * 5}, "one number, or one for each of 6 drives"),
        ({"speeds": "guessed"}, "speeds 'guessed' must be 'true' or 'differenced'"),
    ],
)
def test_sensors_that_make_no_sense_are_refused(sensors, message):
    with pytest.raises(InputError, match=message):
        run(**sensors)
