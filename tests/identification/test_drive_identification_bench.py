"""Single drives: laws of springs, torque constants, frequency responses, loops with a locked output."""

import re
import sys
from functools import cache

import numpy as np
import pytest
from drive_benches import PERIOD, RATIO, STEP, TURN, one_joint, shaken, wound
from scipy.signal import cont2discrete, dlsim

import cutpoint
from cutpoint.errors import InputError
from cutpoint.identification import low_pass
from cutpoint.identification.drives import (
    SpringEstimate,
    TorqueReading,
    TwoMasses,
    fit_response,
    locked_output,
    motor_response,
    motor_side,
    two_encoders,
)
from cutpoint.identification.drives.columns import strain_columns
from cutpoint.identification.drives.scatter import covariance
from cutpoint.identification.drives.two_encoders import AS_STATED
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring
from cutpoint.model.drive import Compliance

T = PERIOD * np.arange(8000)
SPRINGS = {
    "linear": cutpoint.LinearSpring(12e3),
    "flexspline": cutpoint.Flexspline(16e3, 0.04),
    "catalogue": cutpoint.CatalogueSpring(13e3, 22e3, 30e3, 7.0, 25.0),
}


def channels(spring, seed: int = 0, torque_scale: float = 30.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """theta and q as encoders show them, and the torque."""
    torque = torque_scale * (0.6 * np.sin(TURN * 0.5 * T) + 0.4 * np.sin(TURN * 1.3 * T + 1.0))
    q = 0.5 * np.sin(TURN * 0.2 * T) + 1e-3 * seed
    theta = q + spring.deflection(torque) + 2e-4
    return np.round(theta * RATIO / STEP) * STEP / RATIO, np.round(q / STEP) * STEP, torque


@pytest.mark.parametrize("law", SPRINGS)
def test_the_law_that_the_spring_follows_is_chosen_and_its_curve_found(law: str):
    theta, q, torque = channels(SPRINGS[law])
    found = two_encoders(theta, q, torque, PERIOD, RATIO, hysteresis=False, damping=False)
    assert found.law == law
    at = np.linspace(2.0, 28.0, 14)
    expected = SPRINGS[law].deflection(at)
    assert np.allclose(found.compliance.deflection(at), expected, rtol=0.0, atol=0.002 * expected.max())
    assert found.offset == pytest.approx(2e-4, abs=0.1 * STEP)
    assert found.kinematic_error is None
    assert found.unidentifiable["kinematic_error"].startswith("no wave stands out from the noise: at order 2, one of")


def test_a_law_that_predicts_every_part_better_is_chosen_however_unequal_the_parts_are():
    spring, far = SPRINGS["flexspline"], T // 0.8 == 3
    torque = np.where(far, 32.0, 8.0) * np.sin(TURN * 1.3 * T)
    theta = spring.deflection(torque) + 1e-6 * np.random.default_rng(0).normal(size=T.size)
    found = two_encoders(theta, 0.0 * T, torque, PERIOD, RATIO, orders=[], hysteresis=False, damping=False)
    assert found.prediction["flexspline"] < 0.1 * found.prediction["linear"]
    assert found.law == "flexspline"


@pytest.mark.parametrize("seed", [3, 12, 19])
def test_corners_that_fit_the_noise_of_a_linear_spring_are_not_taken_for_a_catalogues(seed: int):
    """By cross-validation with corners that all blocks chose, the spring of seed 12 had three stiffnesses."""
    rng = np.random.default_rng(seed)
    t, rates, phases = T[:4000], rng.uniform(0.2, 2.0, (5, 1)), rng.uniform(0.0, 7.0, (5, 1))
    torque = 12.0 * np.sin(TURN * rates * t + phases).sum(axis=0)
    q = 0.3 * np.sin(0.7 * TURN * rates * t + phases).sum(axis=0)
    noise = rng.normal(size=t.size)
    noise = low_pass(np.concatenate([noise[::-1], noise, noise[::-1]]), PERIOD, 15.0)[t.size : 2 * t.size]
    theta = q + torque / 1e4 + 2e-5 * noise / np.std(noise)
    assert two_encoders(theta, q, torque, PERIOD, RATIO, resolution=1e-6, orders=[]).law == "linear"


def wound_slowly(noise: float, seed: int, stated: Compliance | None = None) -> SpringEstimate:
    """A catalogue's spring found from 28 N m, little beyond its last corner at 25, and encoders' noise, rad.

    stated: the one that a file states; encoders have fine steps then, to tell it.
    """
    spring, t = cutpoint.CatalogueSpring(10e3, 16e3, 30e3, 7.0, 25.0), np.arange(0.0, 20.0, 1e-3)
    torque = 28.0 * np.sin(0.8 * np.pi * t) * np.cos(0.1 * np.pi * t)
    theta = spring.deflection(torque) + noise * np.random.default_rng(seed).normal(size=t.size)
    nothing = {"orders": [], "hysteresis": False, "damping": False}
    return two_encoders(
        theta, 0.0 * t, torque, 1e-3, RATIO, resolution=1e-5 if stated else noise, stated=stated, **nothing
    )


def test_a_law_whose_last_stiffness_is_lost_in_noise_is_not_chosen():
    assert wound_slowly(1e-5, 1).law == "catalogue"
    assert wound_slowly(2e-4, 1).law == "flexspline"


@pytest.mark.parametrize(
    ("stated", "is_kept"),
    [
        (cutpoint.CatalogueSpring(10e3, 16e3, 30e3, 7.0, 25.0), True),
        (cutpoint.CatalogueSpring(11e3, 17.6e3, 33e3, 7.7, 27.5), False),
        (cutpoint.CatalogueSpring(9e3, 14.4e3, 27e3, 6.3, 22.5), False),
        (cutpoint.CatalogueSpring(20e3, 16e3, 9e3, 7.0, 25.0), False),
        (cutpoint.LinearSpring(12e3), False),
        (cutpoint.Flexspline(10e3, 0.03), False),
    ],
)
def test_a_files_curve_is_kept_where_no_other_law_predicts_better(stated: Compliance, is_kept: bool):
    found = wound_slowly(2e-4, 1, stated)
    assert found.law == "flexspline"
    assert (found.unidentifiable.get("stiffness") == AS_STATED) == is_kept


@pytest.mark.parametrize(("share", "is_kept"), [(1.0, True), (1.1, False), (0.9, False)])
def test_a_catalogues_curve_is_kept_beside_one_of_its_kind(share: float, is_kept: bool):
    """Torque ends within the second segment: other numbers than those that were fitted predict as well."""
    truth, t = cutpoint.CatalogueSpring(10e3, 16e3, 30e3, 7.0, 25.0), np.arange(0.0, 20.0, 1e-3)
    torque = 20.0 * np.sin(0.8 * np.pi * t) * np.cos(0.1 * np.pi * t)
    theta = truth.deflection(torque) + 2e-5 * np.random.default_rng(1).normal(size=t.size)
    stated = cutpoint.CatalogueSpring(*(share * x for x in vars(truth).values()))
    nothing = {"orders": [], "hysteresis": False, "damping": False, "laws": ["catalogue"]}
    found = two_encoders(theta, 0.0 * t, torque, 1e-3, RATIO, resolution=1e-5, stated=stated, **nothing)
    assert (found.unidentifiable.get("stiffness") == AS_STATED) == is_kept


def test_a_files_wave_generator_is_kept_beside_its_spring():
    spring = HarmonicSpring(cutpoint.Flexspline(16e3, 0.04), cutpoint.WaveGenerator(24e3, 0.1, RATIO, 1.0))
    nothing = {"orders": [], "hysteresis": False, "damping": False}
    found = two_encoders(*channels(spring), PERIOD, RATIO, stated=spring, **nothing)
    assert found.unidentifiable["stiffness"] == AS_STATED


def test_intervals_hold_the_stiffnesses_of_a_spring_that_is_wound_little_beyond_its_last_corner():
    found = [each for each in (wound_slowly(1e-4, seed) for seed in range(6)) if each.law == "catalogue"]
    for name, truth in {"k1": 10e3, "k2": 16e3, "k3": 30e3}.items():
        errors = np.array([(each[name] - truth) / each.deviations[name] for each in found])
        assert len(errors) >= 4 and np.sqrt(np.mean(errors**2)) < 2.0


def test_a_curve_that_torque_never_winds_from_zero_is_said_to_be_extrapolated():
    theta, q, torque = channels(SPRINGS["catalogue"])
    aside = torque - 50.0
    theta = theta + SPRINGS["catalogue"].deflection(aside) - SPRINGS["catalogue"].deflection(torque)
    thing, nothing = "curve near zero torque", {"hysteresis": False, "damping": False}
    found = two_encoders(theta, q, aside, PERIOD, RATIO, laws=["catalogue"], **nothing)
    assert found.unidentifiable[thing].startswith("torque was never below 2")
    assert thing not in two_encoders(theta, q, aside, PERIOD, RATIO, laws=["linear"], **nothing).unidentifiable
    assert thing not in two_encoders(*channels(SPRINGS["catalogue"]), PERIOD, RATIO, **nothing).unidentifiable


def test_deviations_cover_the_errors_that_the_encoders_make():
    errors = []
    for seed in range(12):
        found = two_encoders(*channels(SPRINGS["linear"], seed), PERIOD, RATIO, laws=["linear"], hysteresis=False)
        errors.append((found.values[0] - 12e3) / found.deviations["stiffness"])
    assert 0.3 < np.sqrt(np.mean(np.square(errors))) < 2.5


def test_elements_that_two_fits_share_count_once_as_uncertainty(monkeypatch: pytest.MonkeyPatch):
    """Hysteresis that the noise does not exclude is the same, whether four or eight elements are offered."""
    time = 1e-3 * np.arange(6000)
    torque = 40.0 * np.sin(1.7 * time + 0.3) + 15.0 * np.sin(4.1 * time + 2.0) + 8.0 * np.sin(23.0 * time)
    q = 0.8 * np.sin(1.7 * time) + 0.5 * np.sin(4.1 * time + 1.0)
    theta = q + torque / 5e3 + 2e-5 * np.random.default_rng(15).normal(size=time.size)
    deviations = []
    for offered in ((0, 8), (0, 4, 8)):
        monkeypatch.setattr(sys.modules[two_encoders.__module__], "OFFERED", offered)
        found = two_encoders(theta, q, torque, 1e-3, RATIO, resolution=1e-6, laws=["linear"])
        deviations.append(found.deviations["stiffness"])
    assert deviations[0] > 0.4  # 0.2 without hysteresis
    assert deviations[1] == pytest.approx(deviations[0], rel=0.05)


@pytest.mark.parametrize("frequency", [5.0, 50.0])
def test_damping_is_found_however_fast_the_spring_swings(frequency: float):
    torque = 20.0 * np.sin(TURN * 0.5 * T) + 10.0 * np.sin(TURN * frequency * T)
    stiffness, damping = 12e3, 6.0
    # K x + D x' = torque, wave by wave
    shift = damping * TURN / stiffness * np.array([0.5, frequency])
    sizes = np.array([20.0, 10.0]) / (stiffness * np.hypot(1.0, shift))
    lead = sum(a * np.sin(TURN * f * T - np.arctan(s)) for a, f, s in zip(sizes, (0.5, frequency), shift, strict=True))
    found = two_encoders(lead, 0.0 * T, torque, PERIOD, RATIO, laws=["linear"], orders=[], hysteresis=False)
    assert found.damping == pytest.approx(damping, rel=2e-3)
    assert found["stiffness"] == pytest.approx(stiffness, rel=1e-4)


def test_damping_is_not_told_where_what_hides_the_spring_would_pass_for_it():
    """Noise of the encoders turns 30 N m s/rad into some 11 with a deviation of 2, beside a spring of +- 60 %."""
    stiffness, damping, frequency = 1e3, 30.0, 30.0
    torque, shift = 10.0 * np.sin(TURN * frequency * T), damping * TURN * frequency / stiffness
    lead = 10.0 / (stiffness * np.hypot(1.0, shift)) * np.sin(TURN * frequency * T - np.arctan(shift))
    lead += 1e-3 * np.random.default_rng(0).normal(size=T.size)
    found = two_encoders(lead, 0.0 * T, torque, PERIOD, RATIO, laws=["linear"], orders=[], hysteresis=False)
    assert abs(found["damping"] - damping) > 4.0 * found.deviations["damping"] < found["damping"]
    assert found.damping is None
    assert found.unidentifiable["damping"].endswith("cannot be told from zero while the spring is not told")


def test_noise_of_the_torque_does_not_stiffen_a_spring_whose_encoders_are_known():
    """Fitted as if torque of this noise were known, the spring would come out 1 + (noise / torque)^2 times as stiff."""
    found, naive = [], []
    for seed in range(8):
        theta, q, torque = channels(SPRINGS["linear"], seed)
        size = 0.2 * torque.std()
        noisy = torque + size * np.random.default_rng(seed).normal(size=torque.size)
        for stiffness, noise in ((found, STEP / np.sqrt(12.0)), (naive, np.inf)):
            estimate = two_encoders(
                theta,
                q,
                noisy,
                PERIOD,
                RATIO,
                laws=["linear"],
                hysteresis=False,
                damping=False,
                reading=TorqueReading(noise=noise),
            )
            stiffness.append((estimate["stiffness"], estimate.deviations["stiffness"]))
    values, deviations = np.array(found).T
    assert values.mean() == pytest.approx(12e3, abs=3.0 * deviations.mean() / np.sqrt(values.size))
    assert np.mean(naive, axis=0)[0] == pytest.approx(12e3 * 1.04, rel=0.005)


def test_what_few_samples_tell_has_intervals_that_hold_as_often_as_they_say():
    """A spring that is wound for 80 ms, with noise of the torque that changes within 20 ms."""
    rng, pulse = np.random.default_rng(5), 30.0 * np.exp(-(((T - 2.0) / 0.04) ** 2))
    hits = 0
    for _ in range(50):
        noise = np.convolve(rng.normal(size=T.size), np.ones(20) / 20.0, "same")
        q = 0.5 * np.sin(TURN * 0.2 * T)
        theta = q + pulse / 12e3 + 1e-5 * noise
        found = two_encoders(theta, q, pulse, PERIOD, RATIO, laws=["linear"], orders=[], hysteresis=False)
        hits += abs(found["stiffness"] - 12e3) < 2.0 * found.deviations["stiffness"]
    assert 42 < hits < 50


def test_what_a_fit_of_many_unknowns_leaves_of_white_noise_tells_its_size():
    rng = np.random.default_rng(3)
    columns, noise = rng.normal(size=(4000, 400)), rng.normal(size=4000)
    spread = covariance(columns, noise - columns @ np.linalg.lstsq(columns, noise, rcond=None)[0])
    assert np.trace(spread) == pytest.approx(np.trace(np.linalg.inv(columns.T @ columns)), rel=0.1)


def test_encoders_that_are_exchanged_are_told_by_a_lead_that_goes_against_the_torque():
    theta, q, torque = channels(SPRINGS["linear"])
    found = two_encoders(q, theta, torque, PERIOD, RATIO, laws=["linear"])
    asked = r"the motor's lead opposes the torque, correlation -1.00: are q and theta swapped, or is a sign reversed"
    assert re.match(asked, found.unidentifiable["stiffness"])


@pytest.mark.parametrize("faint", [0.0, 1e-200, 1e-150])
def test_a_column_with_hardly_anything_in_it_tells_nothing_and_leaves_the_others_as_they_are(faint):
    rng = np.random.default_rng(0)
    columns, noise = rng.normal(size=(1000, 2)), rng.normal(size=1000)
    alone, beside = covariance(columns, noise), covariance(np.column_stack([columns, faint * noise]), noise)
    assert beside[2, 2] == np.inf
    np.testing.assert_allclose(beside[:2, :2], alone, rtol=1e-12)


@pytest.mark.parametrize("band", [20.0, 40.0])
def test_waves_that_a_filter_weakens_come_out_at_their_size(band: float):
    time = PERIOD * np.arange(20000)
    theta = 0.5 * np.sin(0.4 * np.pi * time)  # waves of order 2 at up to 20 Hz
    torque = 50.0 * np.sin(0.9 * np.pi * time)
    lead = torque / 8e3 + 1e-4 * np.sin(2.0 * RATIO * theta + 0.3)
    channels = [theta, theta - lead + 1e-6 * np.random.default_rng(0).normal(size=time.size), torque]
    smooth = [low_pass(x, PERIOD, band) for x in channels]
    found = two_encoders(
        *smooth, PERIOD, RATIO, resolution=1e-6, orders=[2], hysteresis=False, reading=TorqueReading(band=band)
    )
    assert found.kinematic_error
    assert found.kinematic_error.harmonics[0].amplitude == pytest.approx(1e-4, rel=0.02)


def test_a_spring_that_torque_hardly_winds_is_declared_unidentifiable():
    for scale, told in ((0.7, False), (2.0, True), (10.0, True)):
        found = two_encoders(*channels(SPRINGS["linear"], 0, scale), PERIOD, RATIO, laws=["linear"], resolution=STEP)
        assert ("stiffness" not in found.unidentifiable) == told
        assert (found.counts > 20.0) == told
    few = two_encoders(*channels(SPRINGS["linear"], 0, 2.0), PERIOD, RATIO, laws=["linear"], resolution=STEP)
    assert few["stiffness"] == pytest.approx(12e3, abs=2.0 * few.deviations["stiffness"])
    assert few.deviations["stiffness"] > 0.5 / few.counts * 12e3


def test_a_spring_whose_deflection_is_all_noise_is_declared_unidentifiable():
    torque = 1e-3 * np.sin(TURN * 0.5 * T)
    q = 0.5 * np.sin(TURN * 0.2 * T)
    theta = q + STEP * np.random.default_rng(0).normal(size=T.size)
    found = two_encoders(theta, q, torque, PERIOD, RATIO, laws=["linear"], resolution=STEP)
    assert "stiffness" in found.unidentifiable


def test_unknown_samples_do_not_count():
    theta, q, torque = channels(SPRINGS["linear"])
    torque[100:300], q[4000:4010] = np.nan, np.nan
    found = two_encoders(theta, q, torque, PERIOD, RATIO, laws=["linear"], hysteresis=False)
    assert found.values[0] == pytest.approx(12e3, rel=1e-3)


def turning(time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A motor's angle, the torque that it bears, and its own."""
    rate, phase = TURN * np.array([0.4, 1.1, 2.3]), np.random.default_rng(4).uniform(0.0, TURN, 3)
    angle = time[:, None] * rate + phase
    theta, speed, acceleration = ((0.3 * rate**k * np.sin(angle + k * np.pi / 2)).sum(axis=1) for k in range(3))
    load = 12.0 * np.sin(theta) + 3.0 * np.sin(TURN * 0.7 * time)
    return theta, load, 0.15 * acceleration + load + 2.0 * np.tanh(speed / 0.05) + 0.8 * speed


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_current_tells_the_torque_constant_beside_inertia_and_friction(sign: float):
    theta, load, torque = turning(T)
    found = motor_side(theta, load, PERIOD, RATIO, current=sign * torque / (RATIO * 0.07), cutoff=30.0)
    assert found.torque_constant == pytest.approx(sign * 0.07, rel=2e-3)
    assert found.inertia == pytest.approx(0.15 / RATIO**2, rel=5e-3)
    assert found.friction is not None
    assert found.friction.coulomb == pytest.approx(2.0, rel=0.02)
    assert found.friction.viscous == pytest.approx(0.8, rel=0.05)
    assert abs(found["delay"]) < 0.1 * PERIOD


@pytest.mark.parametrize(("kind", "worth"), [("torque", 1.0), ("current", 0.1), ("current", -0.1)])
def test_noise_in_a_torque_or_current_does_not_shorten_its_delay(kind: str, worth: float):
    (theta, load, _), (_, _, torque) = turning(T), turning(T + 1e-3)
    noises = (np.random.default_rng(seed).normal(scale=2.0, size=T.size) for seed in range(8))
    found = [motor_side(theta, load, PERIOD, RATIO, cutoff=30.0, **{kind: (torque + x) / worth}) for x in noises]
    assert np.mean([each["delay"] for each in found]) == pytest.approx(1e-3, abs=0.15e-3)
    assert all(abs(each["delay"] - 1e-3) < 2.0 * each.deviations["delay"] for each in found)


def test_a_motor_that_does_not_accelerate_tells_no_inertia():
    theta = 0.5 * T
    load = 3.0 * np.sin(TURN * 0.7 * T)
    noise = 0.1 * np.random.default_rng(1).standard_normal(T.size)
    found = motor_side(theta, load, PERIOD, RATIO, torque=load + 2.0 + noise, cutoff=30.0, delay=0.0)
    assert "rotor inertia" in found.unidentifiable


@cache
def response(stiffness: float):
    return motor_response(*shaken(one_joint(stiffness), 20.0), PERIOD)


@pytest.mark.parametrize("stiffness", [2000.0, 8000.0])
def test_one_encoder_and_the_torque_tell_stiffness_damping_and_rotor(stiffness: float):
    fit = fit_response(response(stiffness), 0.5)
    assert fit.masses.stiffness == pytest.approx(stiffness, rel=0.01)
    assert fit.masses.rotor == pytest.approx(0.2, rel=0.01)
    assert fit.masses.damping == pytest.approx(3.0, rel=0.05)
    for name, true in (("stiffness", stiffness), ("rotor", 0.2), ("damping", 3.0)):
        assert abs(np.log(getattr(fit.masses, name) / true)) < 5.0 * fit.deviations[name]
    assert fit.masses.antiresonance == pytest.approx(np.sqrt(stiffness / 0.5) / TURN, rel=0.005)
    below = fit_response(response(stiffness), 0.5, high=150.0)
    assert below.masses.stiffness == pytest.approx(stiffness, rel=0.02)


@pytest.mark.parametrize("damping", [6.0, 10.0])
def test_a_well_damped_spring_is_found_too(damping: float):
    """Its antiresonance hardly shows, and the search has a second place to end in."""
    period, K, link, rotor = 1e-3, 12e3, 0.5, 0.2
    A = [[0, 0, 1, 0], [0, 0, 0, 1], *([k / J for k in (-K, K, -damping, damping)] for J in (rotor,))]
    A += [[k / link for k in (K, -K, damping, -damping)]]
    B, C = [[0.0], [0.0], [1 / rotor], [0.0]], [[1.0, 0.0, 0.0, 0.0]]
    exact = cont2discrete((np.array(A, float), np.array(B), np.array(C), np.zeros((1, 1))), period)
    t, rng, step = period * np.arange(20000), np.random.default_rng(0), TURN / 2**17 / 100
    torque = 20.0 * np.sin(TURN * (t + 5.0 * t**2))
    theta = dlsim(exact, torque)[1].ravel()
    theta = np.round((theta + step * rng.standard_normal(t.size)) / step) * step
    fit = fit_response(motor_response(theta, torque + 0.5 * rng.standard_normal(t.size), period), link, low=3.0)
    for name, true in (("stiffness", K), ("rotor", rotor), ("damping", damping)):
        assert abs(np.log(getattr(fit.masses, name) / true)) < max(0.01, 5.0 * fit.deviations[name])


@pytest.mark.parametrize(("torque", "coulomb"), [(60.0, 5.0), (20.0, 5.0)])
def test_deviations_include_what_dry_friction_does_to_a_response(torque: float, coulomb: float):
    K, D, rotor, link, period, steps = 12e3, 3.0, 0.2, 0.5, 1e-3, 5
    A = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-K / rotor, K / rotor, -D / rotor, D / rotor], [K, -K, D, -D]])
    A[3] /= link
    B, C = np.array([[0.0], [0.0], [1.0 / rotor], [0.0]]), np.eye(4)
    E, F, *_ = cont2discrete((A, B, C, np.zeros((4, 1))), period / steps)
    t, x, shown = period * np.arange(20000), np.zeros(4), list[float]()
    drive = torque * np.sin(TURN * (t + 5.0 * t**2))
    for own in drive.tolist():
        shown.append(x[0])
        for _ in range(steps):
            x = E @ x + F[:, 0] * (own - coulomb * np.tanh(x[2] / 0.01))
    step = TURN / 2**17 / RATIO
    fit = fit_response(motor_response(np.round(np.array(shown) / step) * step, drive, period), link, low=3.0)
    for name, true in (("stiffness", K), ("rotor", rotor)):
        assert abs(np.log(getattr(fit.masses, name) / true)) < 2.0 * fit.deviations[name] < 0.08


def test_the_measured_response_is_that_of_two_masses_under_a_held_torque():
    found = response(8000.0)
    band = (found.frequencies > 3.0) & (found.frequencies < 300.0)
    model = TwoMasses(0.5, 0.2, 8000.0, 3.0, 0.5, 1.5).position_response(found.frequencies, PERIOD)
    off = np.abs(found.response / model - 1.0)[band]
    assert np.median(off) < 0.02
    assert (found.coherence[band] > 0.9).mean() > 0.9


TORQUE = 40.0 * np.sin(TURN * np.arange(3000) / 1000.0)
SLIPPING = cutpoint.MaxwellSlip((1200.0, 700.0), (1e-4, 4e-4))


@cache
def loops(gap: float):
    spring = cutpoint.LinearSpring(16e3)
    angle = wound(cutpoint.Backlash(spring, gap) if gap else spring, SLIPPING, TORQUE)
    return locked_output(np.round(angle / 6e-7) * 6e-7, TORQUE, 8e-3, RATIO, rated_torque=40.0, resolution=6e-7)


def test_a_locked_output_shows_stiffness_hysteresis_loss_and_lost_motion():
    found = loops(0.0)
    assert found.spring.law == "linear"
    assert float(found.spring.compliance.tangent(0.0)) == pytest.approx(16e3, rel=0.005)
    # both elements slip: 2 (1200 1e-4 + 700 4e-4) / 16000
    assert found.hysteresis_loss == pytest.approx(5.0e-5, rel=0.05)
    assert found.lost_motion == pytest.approx(2.0 * 0.03 * 40.0 / 16e3, rel=0.1)
    assert found.spring.hysteresis is not None
    assert found.spring.hysteresis.friction == pytest.approx(SLIPPING.friction, rel=0.1)
    assert found.backlash == 0.0
    assert "backlash" in found.unidentifiable


@pytest.mark.parametrize("loss", [0.0, 1e-4])
@pytest.mark.parametrize("noise", [0.1, 1.0])
def test_noise_of_a_loop_is_in_the_deviations_of_what_is_lost_in_it(loss: float, noise: float):
    """A crossing of single samples is off by the torque's noise over the stiffness; a window has more of them."""
    t, truth, found = 0.01 * np.arange(4000), {"hysteresis_loss": loss, "lost_motion": 2.4 / 1e4}, []
    torque = 60.0 * 2.0 / np.pi * np.arcsin(np.sin(TURN * t / 20.0))
    angle = np.round((torque / 1e4 - 0.5 * loss * np.sign(np.gradient(torque))) / 1e-6) * 1e-6
    for seed in range(8):
        shown = torque + noise * np.random.default_rng(seed).normal(size=t.size)
        found.append(locked_output(angle, shown, 0.01, RATIO, rated_torque=40.0, laws=["linear"]))
    assert {"hysteresis_loss" in each.unidentifiable for each in found} == {loss == 0.0}
    for name, true in truth.items():
        errors = np.array([(getattr(each, name) - true) / each.deviations[name] for each in found])
        assert np.sqrt(np.mean(errors**2)) < 1.7
        assert np.mean([each.deviations[name] for each in found]) < 0.7 * noise / 1e4


@pytest.mark.parametrize("lacking", ["theta", "torque"])
def test_samples_of_a_loop_that_are_not_known_are_left_out(lacking: str):
    angle = np.round(wound(cutpoint.LinearSpring(16e3), SLIPPING, TORQUE) / 6e-7) * 6e-7
    given = {"theta": angle, "torque": TORQUE.copy()}
    given[lacking][[100, 2000]] = np.nan
    found = locked_output(**given, period=8e-3, ratio=RATIO, rated_torque=40.0, resolution=6e-7)
    whole = loops(0.0)
    assert found.hysteresis_loss == pytest.approx(whole.hysteresis_loss, rel=0.01)
    assert found.lost_motion == pytest.approx(whole.lost_motion, rel=0.01)


def test_motion_that_would_be_lost_beyond_the_sweeps_is_not_told():
    angle = np.round(wound(cutpoint.LinearSpring(16e3), SLIPPING, TORQUE) / 6e-7) * 6e-7
    found = locked_output(angle, TORQUE, 8e-3, RATIO, rated_torque=2000.0, resolution=6e-7)
    assert found.lost_motion is None
    assert re.match(r"it is read at 60 N m, but the sweeps end at 36 N m", found.unidentifiable["lost_motion"])


def test_a_play_shows_between_the_loops_and_beside_the_spring():
    found = loops(6e-4)
    assert found.backlash == pytest.approx(6e-4, rel=0.1)
    assert found.lost_motion == pytest.approx(6e-4 + 2.0 * 0.03 * 40.0 / 16e3, rel=0.1)
    outer = np.abs(found.torque) > 10.0
    assert np.median(found.stiffness[outer]) == pytest.approx(16e3, rel=0.05)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: two_encoders(T, T[1:], T, PERIOD, RATIO),
            r"channels must be \(N,\), with one N; shapes are theta .*, q ",
        ),
        (lambda: two_encoders(T, T, T, PERIOD, RATIO), r"torque and deflection must both change to show a spring"),
        (lambda: two_encoders(T[:9], T[:9], T[:9], PERIOD, RATIO), r"9 complete samples are too few: 500 are needed"),
        (lambda: two_encoders(T, 0 * T, T, PERIOD, RATIO, laws=["steel"]), r"no spring law is named 'steel'"),
        (lambda: motor_side(T, T, PERIOD, RATIO), r"give either torque or current"),
        (lambda: motor_response(T, T, PERIOD, 1e-3), r"a window of 1 samples must have at least 32"),
        (lambda: motor_response(T, T, 0.0), r"period 0.0 s must be positive"),
        (lambda: motor_response("abc", T, PERIOD), r"motor_response: theta must be numbers, got 'abc'"),
        (lambda: motor_side(T, "abc", PERIOD, RATIO, torque=T), r"motor_side: joint_torque must be numbers, got 'abc'"),
        (lambda: motor_side(T, T, PERIOD, 0.0, torque=T), r"motor_side: ratio 0.0 must be finite and not zero"),
        (lambda: two_encoders(T, T, T, PERIOD, 0.0), r"two_encoders: ratio 0.0 must be finite and not zero"),
        (lambda: locked_output(T, T, -1.0, RATIO), r"locked_output: period -1.0 s must be positive"),
        (lambda: fit_response(response(8000.0), "x"), r"fit_response: link_inertia must be one number, kg m2, got 'x'"),
        (lambda: locked_output(T, T, PERIOD, RATIO, rated_torque=-5.0), r"rated_torque -5.0 N m must be positive"),
        (lambda: fit_response(response(8000.0), 0.0), r"link_inertia 0.0 kg m2 must be positive"),
        (lambda: fit_response(response(8000.0), 0.5, low=600.0), r"0 coherent frequencies"),
        (lambda: locked_output(1e-4 * T, T + 1.0, PERIOD, RATIO), r"torque runs from 1 to .* both sides of zero"),
        (lambda: locked_output(1e-4 * T, T - T[0], PERIOD, RATIO), r"torque runs from 0 to .* both sides of zero"),
    ],
)
def test_what_shows_no_drive_is_refused(call, message: str):
    with pytest.raises(InputError, match=message):
        call()


def test_strains_along_a_recording_are_those_of_the_law_sample_by_sample():
    slip, rng = cutpoint.MaxwellSlip((1.0, 1.0, 1.0), (1e-5, 1e-4, 3e-4)), np.random.default_rng(0)
    way = np.cumsum(1e-4 * rng.standard_normal(500))
    known = rng.random(500) < 0.9
    known[0] = True
    strains, at, expected = (0.0,) * 3, way[0], []
    for x in np.where(known, way, np.nan).tolist():
        if np.isfinite(x):  # where it is unknown, the strain is held
            strains, at = slip.strains(strains, x - at), x
        expected.append(strains)
    found = strain_columns(np.where(known, way, np.nan), np.array(slip.reach))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)
