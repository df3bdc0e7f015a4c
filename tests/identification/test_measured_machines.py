"""Logs of real machines, stored beside the repository; `conftest.py` reports if they are missing."""

from pathlib import Path

import numpy as np
import pytest
from measured import EMPS, KUKA, UR10, UR10_MAPPING, emps_mapping, kuka_mapping

from cutpoint.identification import aligned, derivative, joined, low_passed, noise_cutoff, read_recording, skews


@pytest.mark.parametrize("run", ["run_a.mat", "run_b.mat"])
def test_the_link_encoders_of_an_arm_are_three_milliseconds_late(run: str):
    recording = read_recording(KUKA / run, kuka_mapping(KUKA / run))
    found = skews(recording)
    assert list(found) == ["A1", "A2", "A3"]
    for skew in found.values():
        assert 2.75e-3 <= skew.delay <= 3.15e-3
        assert 0.0 < skew.uncertainty < 0.25e-3


def test_both_runs_together_tell_the_delay_of_each():
    runs = [read_recording(KUKA / run, kuka_mapping(KUKA / run)) for run in ("run_a.mat", "run_b.mat")]
    both, *each = (skews(recording) for recording in (joined(runs), *runs))
    for joint, skew in both.items():
        for alone in each:
            assert abs(skew.delay - alone[joint].delay) < skew.uncertainty + alone[joint].uncertainty


@pytest.mark.parametrize("run", ["run_a.mat", "run_b.mat"])
def test_alignment_takes_away_the_deflection_that_only_the_delay_showed(run: str):
    recording = read_recording(KUKA / run, kuka_mapping(KUKA / run))
    deflection = {}
    for name, each in (("as read", recording), ("aligned", aligned(recording))):
        deflection[name] = np.nanmax(each["theta"] - each["q"], axis=0) - np.nanmin(each["theta"] - each["q"], axis=0)
    # shared/data/README.md: 0.12-0.16 deg as read, 0.015-0.038 deg aligned
    assert (deflection["as read"][:3] > np.radians(0.12)).all()
    assert (deflection["aligned"][:3] < np.radians(0.038)).all()


def test_joints_without_a_link_encoder_are_noted():
    notes = read_recording(KUKA / "run_a.mat", kuka_mapping(KUKA / "run_a.mat")).notes
    still = "; ".join(f"q of {joint} from 0 to 10 s" for joint in ("A4", "A5", "A6"))
    assert notes[0].startswith("values stand still while the joint moves") and f": {still}: leave these" in notes[0]
    assert notes[1:] == tuple(f"{name} of A4, A5, A6 never changes: was it measured?" for name in ("q", "v"))


def test_a_slide_that_is_driven_by_a_voltage_is_read():
    recording = read_recording(EMPS, emps_mapping())
    assert recording.time.size == 24841
    assert recording.period == pytest.approx(1e-3, rel=1e-9)
    assert recording.notes == ()


def test_the_conditioned_slide_gives_the_mass_and_friction_that_its_authors_found():
    smooth = low_passed(read_recording(EMPS, emps_mapping()), cutoff=60.0)
    v, a = (derivative(smooth["q"], smooth.period, order)[:, 0] for order in (1, 2))
    used = smooth.complete() & np.isfinite(a)
    regressors = np.column_stack([a, v, np.sign(v), np.ones_like(v)])[used]
    found = np.linalg.lstsq(regressors, smooth["torque"][used, 0], rcond=None)[0]
    # Janot, Gautier, Brunot (2019): kg, N s/m, N, N; their filters differ, so a few percent
    assert found == pytest.approx([95.1089, 203.5034, 20.39, -3.16], rel=0.03)


def test_a_bag_without_its_metadata_is_read(tmp_path: Path):
    mapping = tmp_path / "ur10.yaml"
    mapping.write_text(UR10_MAPPING)
    recording = read_recording(UR10, mapping)
    assert recording.joints[2] == "elbow_joint"
    assert recording.time.size == 3441
    assert np.median(np.diff(recording.time)) == pytest.approx(8e-3)
    assert set(recording.channels) == {"q", "v", "current"}
    assert recording.notes == ()


def test_published_speeds_are_the_rates_of_published_positions():
    recording = low_passed(read_recording(UR10).resampled(8e-3), cutoff=10.0)
    rates, speeds = derivative(recording["q"], recording.period), recording["v"]
    both = np.isfinite(rates) & np.isfinite(speeds)
    assert both.mean() > 0.95
    assert np.std((rates - speeds)[both]) < 0.1 * np.std(speeds[both])


def test_the_default_cut_off_lies_above_the_motion_and_below_half_of_the_rate():
    recording = read_recording(EMPS, emps_mapping())
    assert 5.0 < noise_cutoff(recording["q"], recording.period) < 400.0
