"""Single samples that are no measurements do not reach the fit, and everything else does."""

import numpy as np
import pytest
from arm_logs import LAW, TIME, TRUTH, channels, motions

from cutpoint import Coulomb, Drive, Robot
from cutpoint.identification import Recording, identify
from cutpoint.identification.logs.spikes import without_spikes

RNG = np.random.default_rng(4)


def recorded(**changed: np.ndarray) -> Recording:
    return Recording(TIME, TRUTH.joints, **(channels() | changed))


@pytest.mark.parametrize("name", ["q", "torque"])
@pytest.mark.parametrize("size", [2.0, -20.0])
def test_samples_that_stand_alone_are_replaced_by_their_neighbours_and_counted(name: str, size: float):
    clean = channels()[name]
    spiked = clean.copy()
    # where friction turns round, a torque bends by more than the smaller spikes stand out
    bend = np.abs(np.diff(clean[:, 1], 2, prepend=0, append=0))
    calm = [k for k in range(10, TIME.size - 10, 8) if bend[k - 3 : k + 4].max() < 0.1]
    where = np.random.default_rng(4).choice(calm, 20, replace=False)
    spiked[where, 1] += size
    found = without_spikes(recorded(**{name: spiked}))
    rule = "20 spikes, over 10 times as far from the neighbours as most samples; interpolated"
    assert found.notes == (f"{name} of elbow: {rule}",)
    untouched = np.delete(np.arange(TIME.size), where)
    assert np.array_equal(found[name][untouched], clean[untouched])
    assert np.abs(found[name] - clean).max() < 0.1 * abs(size)


@pytest.mark.parametrize("kind", ["steps", "coarse", "held", "noise", "gaps"])
def test_steps_coarse_encoders_held_values_noise_and_gaps_are_no_spikes(kind: str):
    torque = channels()["torque"]
    changed = {
        "steps": torque + 30.0 * (np.sin(7.0 * TIME) > 0.0)[:, None],
        "coarse": np.round(torque / 2.0) * 2.0,
        "held": torque[(np.arange(TIME.size) // 10) * 10],
        "noise": torque + RNG.normal(size=torque.shape),
        "gaps": np.where((np.arange(TIME.size) % 997 < 40)[:, None], np.nan, torque),
    }[kind]
    before = recorded(torque=changed)
    assert without_spikes(before) is before


@pytest.mark.parametrize("every", [1, 2, 5])
@pytest.mark.parametrize("smoothing", [0.005, 0.02, 0.05, 0.2])
def test_friction_that_turns_round_without_noise_is_no_spike(smoothing: float, every: int):
    q, v, a = motions()
    torque = TRUTH.inverse_dynamics(q, v, a) + Coulomb(4.0, 3.0, smoothing).torque(v)
    exact = Recording(TIME[::every], TRUTH.joints, q=q[::every], torque=torque[::every])
    assert without_spikes(exact) is exact


def test_spikes_are_found_at_uneven_times_and_late_samples_are_none():
    rng = np.random.default_rng(0)
    time = np.sort(TIME + 0.25 * TIME[1] * rng.normal(size=TIME.size))
    time[100::150] = time[99::150][: time[100::150].size] + 5e-3 * TIME[1]
    time = np.unique(time - time[0])
    clean = Recording(time, TRUTH.joints, **channels(time))
    assert without_spikes(clean) is clean
    torque = np.array(clean["torque"])
    where = np.arange(40, time.size - 40, 400)
    torque[where, 1] += 20.0
    found = without_spikes(Recording(time, TRUTH.joints, q=clean["q"], torque=torque))
    assert len(found.notes) == 1 and found.notes[0].startswith("torque of elbow: ")
    assert (np.abs(found["torque"] - clean["torque"])[where, 1] < 2.0).mean() > 0.8


def test_friction_is_found_in_spite_of_spikes():
    spiked = channels()["torque"].copy()
    spiked[RNG.choice(TIME.size, 30, replace=False)] += 300.0
    robot = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, Drive(link_friction=LAW)))
    found = identify(robot, recorded(torque=spiked), friction="stated")
    for number in found.numbers:
        if number.name.startswith("coulomb"):
            assert number.value == pytest.approx(LAW.coulomb, rel=0.02)
