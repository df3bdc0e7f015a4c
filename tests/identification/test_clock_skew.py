"""Delays between channels of one motion."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from machine_logs import JOINTS, PERIOD, positions, times

import cutpoint
from cutpoint.errors import InputError
from cutpoint.identification import Recording, aligned, arm_torque, clock_skew, single_joint_torque, skews

T = times(4000)
DELAYS = (0.0, 0.37e-3, -2.9e-3, 21.3e-3)


def noise(size: float, seed: int = 2) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(T.size)


@pytest.mark.parametrize("delay", DELAYS)
def test_a_delay_is_found_between_samples(delay: float):
    found = clock_skew(positions(T - delay)[:, 0], positions(T)[:, 0], PERIOD)
    assert found.delay == pytest.approx(delay, abs=1e-8)


@pytest.mark.parametrize("delay", DELAYS)
def test_the_uncertainty_covers_the_error_that_noise_makes(delay: float):
    errors = []
    for seed in range(20):
        x = positions(T - delay)[:, 0] + noise(1e-3, seed)
        found = clock_skew(x, positions(T)[:, 0], PERIOD)
        errors.append((found.delay - delay) / found.uncertainty)
        # noise s over N samples of speed v leaves s / (|v| sqrt(N))
        expected = 1e-3 / np.sqrt(np.sum(positions(T, 1)[:, 0] ** 2))
        assert 0.4 * expected < found.uncertainty < 2.5 * expected
    assert 0.4 < np.sqrt(np.mean(np.square(errors))) < 2.0


def test_gain_offset_and_slow_drift_are_no_delay():
    x = 1.02 * positions(T - 3e-3)[:, 0] + 0.4 + 2e-3 * np.cos(np.pi * T / T[-1])
    assert clock_skew(x, positions(T)[:, 0], PERIOD).delay == pytest.approx(3e-3, abs=0.2e-3)


def test_the_delay_changes_its_sign_with_the_order_of_the_channels():
    x, y = positions(T - 3e-3)[:, 0], positions(T)[:, 0]
    assert clock_skew(y, x, PERIOD).delay == pytest.approx(-clock_skew(x, y, PERIOD).delay, abs=1e-8)


def test_unknown_samples_do_not_count():
    x, y = positions(T - 3e-3)[:, 0], positions(T)[:, 0]
    x[500:600] = np.nan
    y[2000:2010] = np.nan
    assert clock_skew(x, y, PERIOD).delay == pytest.approx(3e-3, abs=1e-7)


@pytest.mark.parametrize("delay", DELAYS)
def test_the_torque_of_a_single_joint_shows_its_delay_as_surely_as_it_says(delay: float):
    q, v, a = (positions(T - delay, order)[:, 0] for order in range(3))
    torque = 2.0 * a + 5.0 * v + 3.0 * np.tanh(v / 0.03) + 20.0 * np.sin(q)
    found = [clock_skew(torque + noise(0.3, k), positions(T)[:, 0], PERIOD, single_joint_torque) for k in range(12)]
    errors = [(each.delay - delay) / each.uncertainty for each in found]
    assert 0.4 < np.sqrt(np.mean(np.square(errors))) < 2.0
    assert max(each.uncertainty for each in found) < 2e-3


def test_a_delay_that_the_law_can_imitate_is_uncertain():
    x, y = positions(T - 3e-3)[:, 0] + noise(1e-3), positions(T)[:, 0]
    plain = clock_skew(x, y, PERIOD)
    # y + k y' is y a little later
    imitated = clock_skew(x, y, PERIOD, lambda y, rate, _: np.column_stack([y, rate]))
    assert imitated.uncertainty > 10.0 * plain.uncertainty
    assert abs(imitated.delay - 3e-3) < 4.0 * imitated.uncertainty


def test_the_torque_of_an_arm_shows_its_delay_though_other_joints_move():
    robot = cutpoint.robots.xia2019()
    n, delay = len(robot.drives), 4e-3
    time = 2.0 * T[:1500]

    def motion(late: float, order: int) -> np.ndarray:
        rates = 1.0 + 0.1 * np.arange(n)
        return np.column_stack([rate**order * positions(rate * (time - late), order)[:, 0] for rate in rates])

    torque = robot.inverse_dynamics(*(motion(delay, order) for order in range(3)))[:, 1]
    torque = torque + noise(0.01 * np.std(torque))[: time.size]
    found = clock_skew(torque, motion(0.0, 0), 2.0 * PERIOD, arm_torque(robot, list(robot.drives)[1]))
    assert abs(found.delay - delay) < 4.0 * found.uncertainty
    assert found.uncertainty < 0.2e-3


def made(delay: float, moving: Callable[[np.ndarray], np.ndarray] = positions) -> Recording:
    """A machine whose second link encoder is late and whose first one shows nothing."""
    q, v = moving(T - delay), positions(T - delay, 1)
    q[:, 0] = v[:, 0] = 0.0
    return Recording(T, JOINTS, q=q, v=v, theta=positions(T), torque=positions(T, 2))


def test_alignment_brings_link_encoders_to_the_motors_clock_and_says_so():
    found = aligned(made(3.1e-3))
    known = found.complete()
    assert known.sum() == T.size - 4
    assert np.allclose(found["q"][known, 1], positions(T)[known, 1], rtol=0.0, atol=1e-6)
    assert np.allclose(found["v"][known, 1], positions(T, 1)[known, 1], rtol=0.0, atol=1e-5)
    assert np.array_equal(found["theta"], positions(T))
    assert not found["q"][:, 0].any()
    words = "q, v moved earlier: elbow by 3.100 +- 0.000 ms; intervals do not include the error of this"
    assert found.notes == (words,)
    assert abs(skews(found)["elbow"].delay) < 1e-7


def bent(friction_on_motor: float, delay: float) -> Recording:
    """A machine whose drives bend under inertia, gravity and dry friction behind the spring."""

    def link(time: np.ndarray) -> np.ndarray:
        return positions(time) - 2e-5 * load(time)

    def load(time: np.ndarray) -> np.ndarray:
        q, v, a = (positions(time, order) for order in range(3))
        return 2.0 * a + 20.0 * np.sin(q) + 15.0 * np.tanh(v / 0.05)

    torque = load(T) + friction_on_motor * np.tanh(positions(T, 1) / 0.05)
    return Recording(T, JOINTS, q=link(T - delay), theta=positions(T), torque=torque)


@pytest.mark.parametrize("friction_on_motor", [0.0, 15.0])
def test_deflection_is_not_corrected_as_if_it_were_a_delay(friction_on_motor: float):
    machine = bent(friction_on_motor, delay=0.0)
    found = aligned(machine)
    assert np.array_equal(found["q"], machine["q"])
    assert found.notes[-1].startswith("q not moved, as no delay stands out: shoulder (")


def test_currents_tell_how_drives_bend_as_torques_do():
    machine = bent(0.0, delay=0.0)
    currents = replace(machine, torque=None, current=0.1 * np.array(machine["torque"]))
    for own, other in zip(skews(machine).values(), skews(currents).values(), strict=True):
        assert own.delay == pytest.approx(other.delay, rel=1e-6)
        assert own.uncertainty == pytest.approx(other.uncertainty, rel=1e-6)


@pytest.mark.parametrize("friction_on_motor", [0.0, 15.0])
def test_a_delay_of_a_drive_that_bends_lies_within_its_uncertainty(friction_on_motor: float):
    for skew in skews(bent(friction_on_motor, delay=3e-3)).values():
        assert abs(skew.delay - 3e-3) < 2.0 * skew.uncertainty
        assert skew.uncertainty < 0.5e-3


def test_delays_that_agree_are_one_clocks():
    found = aligned(bent(15.0, delay=3e-3))
    each = re.findall(r"(?:shoulder|elbow) by ([\d.]+) \+- [\d.]+ ms", found.notes[-1])
    assert len(each) == 2 and each[0] == each[1] and float(each[0]) == pytest.approx(3.0, abs=0.3)


def test_delays_that_differ_stay_each_joints_own():
    q = np.column_stack([positions(T - late)[:, k] for k, late in enumerate((2e-3, 5e-3))])
    found = aligned(Recording(T, JOINTS, q=q, theta=positions(T)))
    assert [float(x) for x in re.findall(r"by ([\d.]+)", found.notes[-1])] == [2.0, 5.0]


def test_a_delay_that_is_known_is_taken_as_it_is():
    found = aligned(made(2e-3), {"elbow": 2e-3})
    known = found.complete()
    assert np.allclose(found["q"][known, 1], positions(T)[known, 1], rtol=0.0, atol=1e-12)
    with pytest.raises(InputError, match=r"no joint 'wrist' was recorded; there are: shoulder, elbow"):
        aligned(made(2e-3), {"wrist": 2e-3})
    with pytest.raises(InputError, match=r"none of current was recorded; there are: q, theta, v, torque"):
        aligned(made(2e-3), {"elbow": 2e-3}, ["current"])


@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        (T[:90], T[:90], r"0 common samples are too few to find a delay: at least 100 are needed"),
        (T, np.ones(T.size), r"a channel never changes: it shows no delay"),
        (np.ones(T.size), T, r"a channel never changes: it shows no delay"),
        (T, T[:-1], r"channels of shapes \(4000,\) and \(3999,\) must be \(N,\) and \(N,\) or \(N, joints\)"),
        (
            positions(T - 0.08)[:, 0],
            positions(T)[:, 0],
            r"no delay up to 0.05 s fits best: are both channels of the same motion\?",
        ),
    ],
)
def test_what_shows_no_delay_is_refused(x: np.ndarray, y: np.ndarray, message: str):
    with pytest.raises(InputError, match=message):
        clock_skew(x, y, PERIOD)


def test_joints_that_do_not_move_show_no_delay():
    still = Recording(T, JOINTS, q=np.zeros((T.size, 2)), theta=positions(T))
    with pytest.raises(InputError, match=r"no joint moves in both 'q' and 'theta': nothing shows a delay"):
        aligned(still)
