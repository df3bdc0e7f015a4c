"""Filtering and differentiation: what stays, what goes, and what is not known at the edges."""

import numpy as np
import pytest
from machine_logs import PERIOD, positions, recording, times

from cutpoint.errors import InputError
from cutpoint.identification import derivative, low_pass, low_passed, noise_cutoff
from cutpoint.identification.conditioning.filtering import low_pass_together

T = times(4000)
CUTOFF = 20.0


@pytest.mark.parametrize("order", [2, 4, 6])
@pytest.mark.parametrize("frequency", [5.0, 16.0, 20.0, 40.0])
def test_a_sine_keeps_its_phase_and_the_stated_share_of_its_size(order: int, frequency: float):
    sine = np.sin(2.0 * np.pi * frequency * T)
    found = low_pass(sine, PERIOD, CUTOFF, order)
    # the filter's frequencies are warped by the tangent of the bilinear transform
    warped = np.tan(np.pi * frequency * PERIOD) / np.tan(np.pi * CUTOFF * PERIOD)
    share = 1.0 / (1.0 + warped ** (2 * order))
    middle = slice(1000, 3000)
    assert np.allclose(found[middle], share * sine[middle], rtol=0.0, atol=1e-6)


def test_a_component_at_the_cut_off_is_halved():
    found = low_pass(np.cos(2.0 * np.pi * CUTOFF * T), PERIOD, CUTOFF)
    assert np.nanmax(np.abs(found[1000:3000])) == pytest.approx(0.5, abs=1e-6)


def test_edges_and_gaps_are_cut_and_the_rest_is_as_if_they_were_not():
    step = np.where(T < 2.0, 0.0, 1.0)
    whole = low_pass(step, PERIOD, CUTOFF)
    assert np.array_equal(np.isnan(whole), (T < 0.075 - 1e-9) | (T > 3.999 - 0.075 + 1e-9))
    step[1500] = np.nan
    beside = low_pass(step, PERIOD, CUTOFF)
    assert np.isnan(beside[1425:1576]).all()
    assert np.isfinite(beside[[1424, 1576]]).all()
    known = np.isfinite(beside)
    assert np.allclose(beside[known], whole[known], rtol=0.0, atol=0.01)


def test_a_stretch_shorter_than_its_edges_is_not_known():
    assert np.isnan(low_pass(np.ones(150), PERIOD, CUTOFF)).all()
    assert np.isfinite(low_pass(np.ones(151), PERIOD, CUTOFF)).sum() == 1


@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_are_those_of_the_motion(order: int):
    found = derivative(positions(T), PERIOD, order)
    assert np.isnan(found[[0, -1]]).all()
    # central differences of step h err by h^2/6 (h^2/12) of the derivative two orders further
    error = PERIOD**2 / (6.0 * order) * np.abs(positions(T, order + 2)).max()
    assert np.abs(found[1:-1] - positions(T, order)[1:-1]).max() <= 1.01 * error


@pytest.mark.parametrize("noise", [1e-5, 1e-3])
def test_the_default_cut_off_parts_motion_from_noise(noise: float):
    q = positions(T) + noise * np.random.default_rng(11).standard_normal((T.size, 2))
    cutoff = noise_cutoff(q, PERIOD)
    assert 2.3 < cutoff < 40.0
    smooth = low_pass(q, PERIOD, cutoff)
    error = (smooth - positions(T))[1000:3000]
    # white noise of which the share 2 cutoff / rate passes; room for what motion is lost
    assert np.std(error) < 2.0 * noise * np.sqrt(2.0 * cutoff * PERIOD)


@pytest.mark.parametrize("periods", [1, 3, 10, 40])
def test_the_default_cut_off_keeps_the_harmonics_of_a_motion_however_often_it_is_repeated(periods: int):
    t = PERIOD * np.arange(periods * 5000)
    waves = [(k / 5.0, 0.5 / k**2) for k in (1, 2, 4, 5)]
    q = sum(size * np.sin(2.0 * np.pi * f * t + f) for f, size in waves)
    noisy = np.asarray(q)[:, None] + 1e-4 * np.random.default_rng(3).standard_normal((t.size, 1))
    cutoff = noise_cutoff(noisy, PERIOD)
    assert 1.0 < cutoff < 10.0
    smooth, middle = low_pass(np.asarray(q), PERIOD, cutoff), slice(t.size // 4, -t.size // 4)
    # what is lost of the motion is less than what is left of the noise
    assert np.abs(smooth - q)[middle].max() < 1e-4 * np.sqrt(2.0 * cutoff * PERIOD)


@pytest.mark.parametrize(("between", "is_motion"), [(3e-5, True), (0.0, False)])
def test_a_resonance_is_motion_if_what_links_it_to_the_rest_exceeds_the_noise(between: float, is_motion: bool):
    t, rng = PERIOD * np.arange(20_000), np.random.default_rng(4)
    slow, ringing = 0.5 * np.sin(2.0 * np.pi * 0.4 * t), 2e-4 * np.sin(2.0 * np.pi * 32.0 * t)
    white = rng.standard_normal(t.size)
    weak = low_pass(white, PERIOD, 30.0) - low_pass(white, PERIOD, 4.0)
    link = between * np.nan_to_num(weak) / np.nanstd(weak)
    cutoff = noise_cutoff(slow + ringing + link + 1e-5 * rng.standard_normal(t.size), PERIOD)
    assert (cutoff > 32.0) == is_motion


def test_noise_alone_has_no_cut_off_but_the_one_that_is_given():
    noise = np.random.default_rng(8).standard_normal((4000, 1))
    with pytest.raises(InputError, match=r"no column stands out from its noise over 64 samples or more"):
        noise_cutoff(noise, PERIOD)
    assert noise_cutoff(noise, PERIOD, otherwise=50.0) == 50.0


def test_a_channel_that_flickers_while_another_moves_does_not_raise_the_cut_off():
    still = 1e-5 * (np.random.default_rng(5).random(T.size) < 0.3)
    both = np.column_stack([positions(T)[:, 0] + 1e-5 * np.random.default_rng(6).standard_normal(T.size), still])
    assert noise_cutoff(both, PERIOD) == noise_cutoff(both[:, :1], PERIOD)


def test_a_joint_that_moves_does_though_another_turns_a_thousand_times_as_far():
    elbow = 0.1 * positions(T)[:, :1]
    assert noise_cutoff(np.column_stack([300.0 * T, elbow]), PERIOD) == noise_cutoff(elbow, PERIOD)


def test_all_channels_pass_one_filter_so_that_laws_between_them_hold():
    made = recording(4000)
    found = low_passed(made, 3.0)
    known = found.complete()
    assert known.sum() == 4000 - 2 * 500
    # the torque is a sum of others: filtered, it still is
    expected = low_pass(positions(made.time, 2), PERIOD, 3.0) + 2.0 * found["v"]
    assert np.allclose(found["torque"][known], expected[known], rtol=0.0, atol=1e-9)
    assert found.notes[-1] == "low-passed at 3 Hz, zero phase, order 4 in each direction"


@pytest.mark.parametrize("cutoff", [0.0, -1.0, 500.0, np.nan])
def test_a_cut_off_that_is_none_is_refused(cutoff: float):
    with pytest.raises(InputError, match=r"cut-off .* Hz must lie between 0 and 500 Hz, half the sampling rate"):
        low_pass(np.ones(100), PERIOD, cutoff)


def test_a_third_derivative_and_a_cut_off_of_nothing_are_refused():
    with pytest.raises(InputError, match=r"order 3 must be 1 or 2"):
        derivative(np.ones(10), PERIOD, 3)
    with pytest.raises(
        InputError, match=r"no column stands out from its noise over 64 samples or more without a gap, of 100"
    ):
        noise_cutoff(np.ones((100, 2)), PERIOD)


def test_an_equation_of_channels_holds_up_to_the_edges_though_one_begins_later():
    one = np.exp(-5.0 * T) * np.cos(40.0 * T)
    twice = 2.0 * one
    twice[:5], twice[900:903] = np.nan, np.nan
    first, second = low_pass_together([one, twice], PERIOD, 20.0)
    known = np.isfinite(first)
    assert known.sum() > 0.7 * T.size and (known == np.isfinite(second)).all()
    assert np.abs(second - 2.0 * first)[known].max() < 1e-12
    # each by itself begins where it is known: near the start they differ by a share of what the filter cannot know
    alone = [low_pass(x, PERIOD, 20.0) for x in (one, twice)]
    assert np.nanmax(np.abs(alone[1] - 2.0 * alone[0])) > 1e-6
