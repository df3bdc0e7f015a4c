"""The comparison of control laws: equal stiffness, the worst run, reported refusals, and a report that reloads."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from typer.testing import CliRunner

import cutpoint
from cutpoint.commands import app
from cutpoint.control import PD, ComputedTorque
from cutpoint.control.stability.sampled_loop import small_signal
from cutpoint.errors import CutpointError, InputError
from cutpoint.model.tool import tool_frame_of
from cutpoint.reporting import standing
from cutpoint.studies.compare import bench_of, panda, run
from cutpoint.studies.compare.contenders import CONTENDERS
from cutpoint.studies.compare.findings import findings
from cutpoint.studies.compare.matching import Match
from cutpoint.studies.compare.page import pages_of
from cutpoint.studies.compare.results import Results
from cutpoint.studies.compare.runs import Outcome, Score
from cutpoint.studies.compare.tables import refusals
from robot_library import robot

ARM = cutpoint.robots.xia2019()
PERIOD = 1e-3


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("compare")
    run(folder, seeds=2, laws=("vdc_filter",), scenarios=("nominal", "friction", "fast"), progress=False)
    return folder


@pytest.fixture(scope="module")
def results(folder: Path) -> Any:
    return json.loads((folder / "results.json").read_text(encoding="utf-8"))


def test_a_page_counts_its_runs(folder: Path, tmp_path: Path):
    run(tmp_path, seeds=1, laws=(), scenarios=("nominal",), progress=False)
    pages = [(place / "index.html").read_text(encoding="utf-8") for place in (folder, tmp_path)]
    assert "there are 2 runs, and the worst counts." in pages[0] and "there is 1 run." in pages[1]
    assert all("Errors are RMS over time and all joints together." in page for page in pages)


def test_long_work_says_how_far_it_is_where_nobody_sees_a_bar(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(standing, "EVERY", 0.0)
    for progress in (True, False):
        run(tmp_path, seeds=1, laws=(), scenarios=("nominal",), progress=progress)
        told = capsys.readouterr().err.splitlines()
        assert told[:1] == ["tuning PD, 0 % done"] * progress
        assert told[-1:] == ["as modelled: PD, 100 % done"] * progress


def test_laws_are_as_stiff_as_the_pd_within_a_hundredth(results):
    pd, vdc = (np.array(results["comparison"]["laws"][key]["stiffness"]) for key in ("pd", "vdc_filter"))
    assert np.exp(np.mean(np.log(vdc / pd))) == pytest.approx(1, abs=0.01)
    law = cutpoint.control.tune(ARM, results["settings"]["bandwidth"], damping=1.0)
    np.testing.assert_allclose(pd, law.kp, rtol=1e-6)


def test_what_is_matched_of_super_twisting_is_its_linear_part(tmp_path: Path):
    found = run(tmp_path, laws=("twisting",), scenarios=("nominal",), progress=False)["comparison"]["laws"]
    law = found["twisting"]
    assert law["runs"] and law["refused"] == "" and law["share"] == pytest.approx(1, abs=0.01)


def test_the_worst_of_a_scenario_is_the_largest_of_its_runs(results):
    scenarios = results["comparison"]["scenarios"]
    assert scenarios.keys() == {"nominal", "friction", "fast"}
    for scenario, count in (("nominal", 1), ("friction", 2), ("fast", 1)):
        for outcome in scenarios[scenario]["laws"].values():
            assert len(outcome["runs"]) == count
            for name in ("rms", "peak", "torque"):
                assert outcome["worst"][name] == max(x[name] for x in outcome["runs"])
            assert all(0 < x["rms"] < x["peak"] for x in outcome["runs"])


def test_the_best_of_a_scenario_has_the_least_worst_error(results):
    for scenario in results["comparison"]["scenarios"].values():
        worst = {key: outcome["worst"]["rms"] for key, outcome in scenario["laws"].items()}
        assert scenario["best"] == min(worst, key=lambda key: worst[key])


def test_a_law_without_a_model_does_not_feel_that_the_model_is_wrong(results):
    scenarios = results["comparison"]["scenarios"]
    for key, feels in (("pd", False), ("vdc_filter", True)):
        (nominal,), wrong = (scenarios[s]["laws"][key]["runs"] for s in ("nominal", "friction"))
        assert (wrong == [nominal] * 2) is not feels


def test_the_report_tells_what_the_numbers_say(folder, results):
    text = (folder / "index.html").read_text(encoding="utf-8")
    assert "INCOMPLETE" not in text and results["settings"]["complete"]
    scenarios = results["comparison"]["scenarios"]
    fast = {key: outcome["worst"]["rms"] for key, outcome in scenarios["fast"]["laws"].items()}
    assert scenarios["fast"]["best"] == "vdc_filter"
    assert f"1 s ({fast['vdc_filter']:.1f})" in text
    assert f"1 s ({fast['pd'] / fast['vdc_filter']:.2f} times less)" in text
    assert all((folder / "figures" / f"figure_k{k}.png").read_bytes().startswith(b"\x89PNG") for k in (1, 2, 3))


@pytest.fixture(scope="module")
def stiff(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """At nearly twice the usual bandwidth: more than computed torque can hold."""
    folder = tmp_path_factory.mktemp("stiff")
    run(folder, bench_of(ARM, bandwidth=7.5), laws=("computed",), scenarios=("fast",), progress=False)
    return json.loads((folder / "results.json").read_text(encoding="utf-8")), folder


def test_a_law_that_does_not_hold_is_told_and_runs_elsewhere_and_is_not_ranked(stiff):
    results, folder = stiff
    law = results["comparison"]["laws"]["computed"]
    assert "does not hold at this pose" in law["refused"] and law["runs"]
    assert law["bandwidth"] < 7.5 and law["share"] < 0.99
    fast = results["comparison"]["scenarios"]["fast"]
    assert fast["laws"]["computed"]["worst"]["rms"] < fast["laws"]["pd"]["worst"]["rms"] and fast["best"] == "pd"
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "computed torque is refused at equal stiffness" in page
    assert page.count("; * does not hold at equal stiffness") == 4  # beside each table


def test_what_an_interruption_leaves_is_written_and_marked(tmp_path, monkeypatch):
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("cutpoint.studies.compare.study.outcome", interrupted)
    results = run(tmp_path, laws=(), scenarios=("fast",), progress=False)
    assert not results["settings"]["complete"]
    assert results["comparison"]["laws"].keys() == {"pd"} and not results["comparison"]["scenarios"]["fast"]["laws"]
    assert "INCOMPLETE: interrupted after 0 of 1" in (tmp_path / "index.html").read_text(encoding="utf-8")


def test_of_scenarios_that_were_not_run_nothing_is_said(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("cutpoint.studies.compare.study.step_times", Mock(side_effect=KeyboardInterrupt))
    run(tmp_path, laws=(), scenarios=("fast",))
    assert "Errors by law and scenario\nNo scenario was run." in capsys.readouterr().out
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "Table K1" in page and "No scenario was run." in page and "Each scenario" not in page


def test_small_signal_stiffness_of_a_pd_is_its_gains():
    kp, kd = np.linspace(100, 600, 6), np.linspace(1, 6, 6)
    for side in ("motor", "link"):
        found = small_signal(ARM, PD(kp, kd, side=side), np.full(6, 0.3), PERIOD)
        # differences of some hundred N m over 2e-6: rounding leaves some 1e-8 of N m/rad
        np.testing.assert_allclose(found.stiffness, kp, rtol=1e-6)
        np.testing.assert_allclose(found.damping, kd, rtol=1e-6)


def test_small_signal_stiffness_of_computed_torque_is_inertia_times_gain_where_nothing_weighs():
    weightless, q = ARM.with_gravity(np.zeros(3)), np.full(6, 0.3)
    rotors = np.array([drive.reflected_inertia for drive in ARM.drives.values()])
    inertia = np.diag(ARM.mass_matrix(q)) + rotors
    found = small_signal(weightless, ComputedTorque(weightless, 500.0, 40.0), q, PERIOD)
    np.testing.assert_allclose(found.stiffness, 500.0 * inertia, rtol=1e-6)
    np.testing.assert_allclose(found.damping, 40.0 * inertia, rtol=1e-6)


def test_a_move_comes_back_and_its_derivatives_are_those_of_its_positions():
    move, step = bench_of(ARM).move(1.0), 1e-6
    np.testing.assert_allclose(move(2.0).q, move(0.0).q, atol=1e-15)
    for t in (0.3, 1.4, 1.9):
        ahead, behind = move.derivatives(t + step), move.derivatives(t - step)
        scale = np.abs(move.derivatives(t)[1:]).max()
        np.testing.assert_allclose((ahead - behind)[:-1] / (2 * step), move.derivatives(t)[1:], atol=1e-6 * scale)


def limited(arm: cutpoint.Robot, *limits: tuple[float, float], effort: float = np.inf) -> cutpoint.Robot:
    """Joints within these limits that their drives state, in order."""
    bounds = (cutpoint.Limits(lower, upper, effort=effort) for lower, upper in limits)
    return arm.with_drives({k: replace(d, limits=x) for (k, d), x in zip(arm.drives.items(), bounds, strict=True)})


def papers_arm_without_its_last_joint() -> cutpoint.Robot:
    return cutpoint.load(cutpoint.robots.XIA2019_URDF, cutpoint.robots.XIA2019_DRIVES, lock={"joint6": 0.0})


def test_a_move_stays_within_the_limits_of_drives_and_joints_of_which_one_may_be_open():
    limits = [(-0.1, 0.3), (4.0, np.inf), (-np.inf, -4.0), (-10.0, np.inf), (-np.inf, np.inf)]
    bench = bench_of(limited(papers_arm_without_its_last_joint(), *limits))
    middle, half = bench.home, np.abs(bench.goal - bench.home)
    np.testing.assert_allclose(middle, [0.1, 4 + np.pi, -4 - np.pi, 0, 0], atol=1e-15)
    np.testing.assert_allclose(half, [0.1, 1, 1, 1, 1])
    places = bench.move(1.0)(np.linspace(0, 2, 41)).q
    for q, (lower, upper) in zip(places.T, limits, strict=True):
        assert (q >= lower).all() and (q <= upper).all()


def test_gears_that_may_not_repeat_what_their_joints_need_are_told(tmp_path):
    strong = limited(papers_arm_without_its_last_joint(), *[(-1, 1)] * 5, effort=2000.0)
    for arm, told in ((ARM, ""), (strong, ", and may not repeat what is needed at joint1, joint2, joint3,")):
        run(tmp_path, bench_of(arm), laws=(), scenarios=("fast",), progress=False)
        text = (tmp_path / "index.html").read_text(encoding="utf-8")
        assert f"Gears of the whole drives are of the catalogue{told or ';'}" in text


def found(**worst: tuple[float, float]) -> Results:
    """RMS errors as modelled and with sensors, of laws at equal stiffness, but for one whose name ends in _other."""
    laws = {contender.key: contender for contender in CONTENDERS}
    results = Results()
    for k, scenario in enumerate(("nominal", "sensors")):
        results.outcomes[scenario] = {
            key.removesuffix("_other"): Outcome((Score(x[k], 20.0, 1.0),)) for key, x in worst.items()
        }
    for name in worst:
        key, still = name.removesuffix("_other"), np.ones(6)
        results.matches[key] = Match(laws[key], 4.0, None, still, still, 1.0, "no" if key != name else "")
    return results


def test_laws_of_ours_that_did_not_run_are_not_said_to_lose():
    assert not any("virtual decomposition" in told for told in findings(found(pd=(10.0, 20.0), pid=(20.0, 30.0))))
    assert not any("virtual decomposition" in told for told in findings(found(vdc=(10.0, 20.0))))
    assert any("leads all other laws" in told for told in findings(found(pd=(10.0, 20.0), vdc=(1.0, 30.0))))


def test_laws_at_another_stiffness_are_not_ranked_in_what_is_said():
    told = " ".join(findings(found(pd=(10.0, 20.0), pid=(10.0, 30.0), robust_other=(10.0, 90.0))))
    assert "multiply the error of PID by 3.00, the most" in told
    told = findings(found(pd=(9.0, 9.0), feedforward_other=(3.0, 3.0), vdc=(1.0, 3.0), vdc_filter=(2.0, 3.0)))
    assert not any("of the error of PD + feedforward" in sentence for sentence in told)


def test_it_is_told_which_laws_follow_what_drives_remember():
    drives = {
        name: replace(drive, hysteresis=cutpoint.MaxwellSlip((1e3,), (1e-4,))) for name, drive in ARM.drives.items()
    }
    for arm, times in ((ARM, 0), (ARM.with_drives(drives), 1)):
        _, errors, _ = pages_of(bench_of(arm), found(pd=(10.0, 20.0)), 1)
        assert sum("of the laws only the feedforward follows them" in str(block) for block in errors.blocks) == times


@pytest.mark.parametrize(("name", "frame"), [("panda", "panda_hand_tcp"), ("xia2019", "tool"), ("ur10", "tool0")])
def test_a_payload_hangs_where_the_tool_is_whatever_fingers_are_beyond_it(name, frame):
    assert tool_frame_of(robot(name).mechanism) == frame


def test_pandas_drives_may_repeat_what_its_joints_may():
    arm = panda()
    bench = bench_of(arm)
    efforts = [body.joint.limits.effort for body in arm.mechanism.bodies if body.joint.name in arm.joints]
    assert len(arm.joints) == 7 and bench.frame == "panda_hand_tcp" and bench.payload == 3
    for drive, effort in zip(arm.drives.values(), efforts, strict=True):
        assert drive.is_elastic and drive.ratings is not None
        assert (drive.ratings.repeated_peak_torque or 0) >= effort


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: bench_of(ARM, payload=-1.0), r"compare: payload -1.0 kg must be positive"),
        (lambda: bench_of(ARM, payload="x"), r"compare: payload must be one number, kg, got 'x'"),
        (lambda: bench_of(ARM, control_period=-1e-3), r"compare: control_period -0.001 s must be positive"),
        (lambda: bench_of(ARM, bandwidth=0.0), r"compare: bandwidth 0.0 Hz must be positive"),
        (lambda: bench_of(ARM, frame="nose"), r"no frame is named 'nose'"),
        (lambda: bench_of(cutpoint.load(cutpoint.robots.XIA2019_URDF)), r"drive of 'joint1' is rigid"),
        (lambda: run(Path("x"), laws=("magic",), progress=False), r"no law is named 'magic'; there are: 'pd'"),
        (lambda: run(Path("x"), scenarios=("rain",), progress=False), r"no scenario is named 'rain'"),
    ],
)
def test_what_cannot_be_compared_is_refused_with_its_cause(wrong, message):
    with pytest.raises(InputError, match=message):
        wrong()


def test_the_command_refuses_before_it_runs(tmp_path):
    found = CliRunner().invoke(app, ["compare", "xia2019", "--payload", "0", "--output", str(tmp_path / "new")])
    assert isinstance(found.exception, CutpointError) and not (tmp_path / "new").exists()


def test_a_law_for_which_no_bandwidth_was_found_is_not_said_to_have_been_tried_at_others():
    none, still = np.full(6, np.nan), np.ones(6)
    for bandwidth, stiffness, said in (
        (np.nan, none, "stiff; it does not run."),
        (4.0, still, "factor of four serves"),
    ):
        match = Match(CONTENDERS[1], bandwidth, None, stiffness, stiffness, np.nan, "never as stiff")
        (sentence,) = refusals(Results({CONTENDERS[1].key: match}))
        assert said in sentence
