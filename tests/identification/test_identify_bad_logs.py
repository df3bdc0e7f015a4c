"""Notes of `identify` on poor logs, and logs that it refuses."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arm_logs import LAW, TIME, TRUTH, Array, channels, motions, run, wound, write_arm, write_log
from two_joints import urdf_text

from cutpoint import Drive, LinearSpring, Robot, Rotor
from cutpoint.errors import InputError
from cutpoint.formats import parse_urdf
from cutpoint.identification import Recording
from cutpoint.identification.output import identify


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_arm(tmp_path_factory.mktemp("arm"))


def elbow(name: str, change: Any) -> dict[str, Array]:
    """The good log, of which one channel of the elbow is another."""
    found = channels()
    found[name][:, 1] = change(found[name][:, 1])
    return found


def gaps(x: Array) -> Array:
    return np.where((TIME > 3.0) & (TIME < 3.2), np.nan, x)


@pytest.mark.parametrize(
    ("changed", "note"),
    [
        (lambda: elbow("q", lambda x: np.full_like(x, 0.3)), "q of elbow never changes: was it measured?"),
        (
            lambda: elbow("torque", lambda x: np.clip(x, -9.0, 9.0)),
            "torque of elbow stays at its extreme: was it clipped?",
        ),
        (lambda: elbow("q", gaps), "q of elbow lacks some samples"),
        (lambda: channels() | {"v": np.degrees(motions()[1])}, "times the rate of q: degrees for radians?"),
    ],
)
def test_what_looks_wrong_is_in_the_report(files: Path, tmp_path: Path, changed: Any, note: str):
    status, text = run(files, write_log(tmp_path / "log.csv", changed()), tmp_path / "out")
    assert status == 0, text
    assert note in text
    assert note in " ".join((tmp_path / "out" / "report.html").read_text().split())


def test_what_makes_the_result_doubtful_comes_first(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", elbow("torque", lambda x: -x))
    status, text = run(files, log, tmp_path / "out")
    assert status == 0 and 0 < text.find("warning: signs of ") < text.find("not identified: ")
    assert "torques of elbow look reversed: turned round, they fit what the files predict" in text
    report = " ".join((tmp_path / "out" / "report.html").read_text().split())
    heads = report.find("What makes the result doubtful:"), report.find("Table 1")
    for doubt in ("elbow: the model misses its torque by", "friction or inertia of elbow comes out negative"):
        assert 0 < heads[0] < report.find(doubt) < heads[1]
    assert "is the sign of the torque or of the position reversed?" in report


def test_a_wrong_unit_leads_and_what_follows_from_it_is_counted_and_in_the_report(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", elbow("torque", lambda x: 1e3 * x))
    status, text = run(files, log, tmp_path / "out")
    unit, others = text[: text.index("not identified: ")].split("warning: ")[1:]
    assert status == 0
    told = (
        r"torques are far from what the robot's files predict .*, elbow \d\.\d*e\+03 times: they would fit in mN m: map"
    )
    assert re.match(told, unit)
    assert re.match(r"\d+ further doubts? may follow from this, see the report: correct it first", others)
    assert "elbow: the model misses its torque by" in (tmp_path / "out" / "report.html").read_text()


def test_a_counter_that_was_set_anew_leads_and_what_follows_from_it_is_in_the_report(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", elbow("q", lambda x: np.where(TIME < 3.0, x, x - 0.4)))
    status, text = run(files, log, tmp_path / "out")
    jump, others = text[: text.index("not identified: ")].split("warning: ")[1:]
    assert status == 0
    assert re.match(
        r"positions jump and stay there, .*: q of elbow by -0\.4 rad \(m\) at 3 s: use the log before or", jump
    )
    assert re.match(r"\d+ further doubts? may follow from this, see the report: correct it first", others)
    assert "note: positions jump" not in text


def test_a_torque_that_was_clipped_makes_the_result_doubtful(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", elbow("torque", lambda x: np.clip(x, -9.0, 9.0)))
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated")
    told = [
        [each for each in words if "was it clipped?" in each] for words in (found.doubts, found.causes, found.notes)
    ]
    assert [len(each) for each in told] == [1, 0, 0]


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (lambda x: np.where((TIME < 2.0) | (TIME > 4.0), x, x[np.searchsorted(TIME, 2.0)]), "values stand still while"),
        (lambda x: channels()["torque"][:, 0], "columns are equal"),
    ],
)
def test_torques_that_were_not_measured_are_the_cause_of_other_doubts(files: Path, change: Any, cause: str):
    log = Recording(TIME, ("shoulder", "elbow"), **elbow("torque", change))
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated")
    assert len(found.causes) == 1 and found.causes[0].startswith(cause) and found.doubts[0] == found.causes[0]
    assert not any(cause in note for note in found.notes)


@pytest.mark.parametrize("drives", ["sprung", "rigid"])
def test_encoders_on_both_sides_of_drives_that_bend_do_not_read_the_same(files: Path, drives: str):
    both = channels()
    log = Recording(TIME, ("shoulder", "elbow"), **both, theta=both["q"])
    causes = identify(files / "arm.urdf", log, drives=files / f"{drives}.yaml", friction="stated").causes
    told = (
        "columns are equal, as if one was copied, or both are references: q and theta of shoulder, elbow, whose drives"
    )
    assert [cause.startswith(told) for cause in causes] == ([True] if drives == "sprung" else [])


def test_a_position_that_never_changes_while_the_other_side_moves_is_the_cause_of_other_doubts(files: Path):
    log = Recording(TIME, ("shoulder", "elbow"), **elbow("q", lambda x: 0.0 * x), theta=channels()["q"])
    causes = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated").causes
    assert [cause.partition(": ")[2] for cause in causes] == [
        "q of elbow from 0 to 9.998 s: leave these cells empty, or that part out"
    ]


def test_motors_that_are_mapped_to_each_others_links_make_the_result_doubtful(files: Path):
    both = channels()
    log = Recording(TIME, ("shoulder", "elbow"), **both, theta=both["q"][:, ::-1])
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated")
    for joint in ("shoulder", "elbow"):
        assert any(re.match(rf"theta of '{joint}' is .* times q: ", doubt) for doubt in found.doubts)


def test_a_joint_that_stood_still_is_not_told(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", elbow("q", lambda x: np.full_like(x, 0.3)))
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml")
    assert not any(n.told for n in found.numbers if n.name in ("viscous.elbow", "I_m.elbow"))
    assert any("viscous.elbow" in sentence for sentence in found.untold)


@pytest.mark.parametrize(("share", "is_told"), [(0.0, False), (0.004, True), (0.05, False)])
def test_a_joint_that_only_a_controller_holds_is_noted(files: Path, share: float, is_told: bool):
    q, v, a = (x * [1.0, share] for x in motions())
    log = Recording(TIME, TRUTH.joints, q=q, torque=TRUTH.inverse_dynamics(q, v, a) + LAW.torque(v))
    notes = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated").notes
    assert any(note.startswith("elbow hardly moved, less than 1% as far") for note in notes) is is_told


@pytest.mark.parametrize(("range_", "is_told"), [("0.02", False), ("5", True)])
def test_a_slides_travel_is_judged_by_its_range(files: Path, range_: str, is_told: bool):
    """Metres are not compared with radians."""
    old = '<joint name="elbow" type="revolute">'
    shoulder, elbow = urdf_text().split(old)
    elbow = elbow.replace('lower="-2" upper="2.5"', f'lower="-{range_}" upper="{range_}"')
    text = shoulder + '<joint name="elbow" type="prismatic">' + elbow
    file, arm = files / "slide.urdf", Robot(parse_urdf(text))
    file.write_text(text)
    q, v, a = (x * [1.0, 0.005] for x in motions())
    log = Recording(TIME, arm.joints, q=q, torque=arm.inverse_dynamics(q, v, a) + LAW.torque(v))
    notes = identify(file, log, friction="stated").notes
    assert any(note.startswith("elbow hardly moved") for note in notes) is is_told


def shuffled() -> dict[str, Array]:
    order = np.random.default_rng(2).permutation(TIME.size)
    return {name: x[order] for name, x in ({"t": TIME} | channels()).items()}


@pytest.mark.parametrize(
    ("columns", "joint", "message"),
    [
        (channels, "wrist", r"no driven joint 'wrist'"),
        (lambda: channels() | {"q": np.degrees(channels()["q"])}, "elbow", r"beyond its limits; .* degrees"),
        (
            lambda: channels() | {"q": np.round(1304 * channels()["q"])},
            "elbow",
            r"counts: .* unit: counts, counts_per_turn",
        ),
        (lambda: elbow("torque", lambda x: np.nan * x), "elbow", r"torque of joint 'elbow' holds no number"),
        (lambda: channels() | {"torque": np.zeros_like(channels()["q"])}, "elbow", r"torque never changes"),
        (lambda: elbow("torque", lambda x: np.full_like(x, 0.37)), "elbow", r"torque of elbow never changes .* lock"),
        (
            lambda: elbow("torque", lambda x: 1e-6 * x),
            "elbow",
            r"torque of elbow never changes .* than that of shoulder: was it measured, and in this unit\?\s+Map an",
        ),
        (lambda: {"q": channels()["q"]}, "elbow", r"holds no torque or current"),
        (
            lambda: channels() | {"q": np.zeros_like(TIME[:, None] * [1, 1])},
            "elbow",
            r"no joint moves: q never changes at",
        ),
        (lambda: channels() | {"t": np.zeros_like(TIME)}, "elbow", r"q/torque: "),
    ],
)
def test_what_is_surely_wrong_is_refused(files: Path, tmp_path: Path, columns: Any, joint: str, message: str):
    status, text = run(files, write_log(tmp_path / "log.csv", columns(), ("shoulder", joint)), tmp_path / "out")
    assert status == 1 and re.search(message, text), text
    assert not (tmp_path / "out").exists()


def test_a_log_that_is_not_there_is_named_once(files: Path, tmp_path: Path):
    status, text = run(files, tmp_path / "none.csv", tmp_path / "out")
    assert status == 1 and text.count("none.csv") == 1 and "does not exist; give the path of a file" in text


def test_shuffled_samples_are_put_in_order_and_said(files: Path, tmp_path: Path):
    order = np.random.default_rng(2).permutation(TIME.size)
    shuffled = {name: x[order] for name, x in ({"t": TIME} | channels()).items()}
    found, good = (
        identify(files / "arm.urdf", write_log(tmp_path / name, log), drives=files / "rigid.yaml", friction="stated")
        for name, log in (("shuffled.csv", shuffled), ("good.csv", channels()))
    )
    assert any("samples were sorted by time" in note for note in found.notes)
    assert found.numbers == good.numbers


def test_uneven_times_are_resampled_and_said(files: Path, tmp_path: Path):
    time = TIME + 4e-4 * np.random.default_rng(3).uniform(-1.0, 1.0, TIME.size)
    log = write_log(tmp_path / "log.csv", {"t": time} | channels(time))
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated")
    assert any("resampled to a period of 0.00" in note for note in found.notes)
    assert (found.errors.rms("after", held_out=True) < 0.05 * found.errors.rms("before", held_out=True)).all()


@pytest.mark.parametrize("lost", [[], [7, 1200, 1201]])
def test_stamps_that_scatter_about_even_samples_change_nothing(files: Path, tmp_path: Path, lost: list[int]):
    kept = np.setdiff1d(np.arange(TIME.size), lost)
    stamps = 5.0 + TIME + 4e-5 * np.random.default_rng(3).normal(size=TIME.size)
    clean, scattered = (
        identify(
            files / "arm.urdf",
            write_log(tmp_path / "log.csv", {name: x[kept] for name, x in ({"t": time} | channels()).items()}),
            drives=files / "rigid.yaml",
            friction="stated",
        )
        for time in (TIME, stamps)
    )
    assert any("stamps scatter by 4" in note and "taken as even" in note for note in scattered.notes)
    assert not any("stamps scatter" in note for note in clean.notes)
    for a, b in zip(scattered.numbers, clean.numbers, strict=True):
        assert a.value == pytest.approx(b.value, abs=0.2 * (b.high - b.low)), a.name


def test_stamps_of_uneven_samples_are_kept(files: Path, tmp_path: Path):
    time = uneven(0.05)
    log = write_log(tmp_path / "log.csv", {"t": time} | channels(time))
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated")
    assert not any("stamps scatter" in note for note in found.notes)


def test_currents_count_with_the_drives_torque_constants(files: Path, tmp_path: Path):
    given = channels()
    logs = (given, {"q": given["q"], "current": given["torque"] / 10.0})
    by_torque, by_current = (
        identify(
            files / "arm.urdf", write_log(tmp_path / "log.csv", log), drives=files / "rigid.yaml", friction="stated"
        )
        for log in logs
    )
    for a, b in zip(by_current.numbers, by_torque.numbers, strict=True):
        assert a.value == pytest.approx(b.value, rel=1e-5, abs=1e-6)  # nine digits in the file


def test_springs_come_out_of_currents_as_of_torques(files: Path, tmp_path: Path):
    """What is known of torque constants is not sought again."""
    given = wound()
    currents = {"q": given["q"], "theta": given["theta"], "current": given["torque"] / 10.0}
    by_torque, by_current = (
        identify(
            files / "arm.urdf", write_log(tmp_path / "log.csv", log), drives=files / "sprung.yaml", friction="stated",
            torque_constants=constants,
        )
        for log, constants in ((given, None), (currents, {"shoulder": 10.0, "elbow": 10.0}))
    )  # fmt: skip
    assert [a.name for a in by_current.numbers] == [b.name for b in by_torque.numbers]
    for a, b in zip(by_current.numbers, by_torque.numbers, strict=True):
        assert a.value == pytest.approx(b.value, rel=1e-4, abs=1e-6), a.name  # nine digits in the file


def test_springs_need_both_encoders(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", channels())
    status, text = run(files, log, tmp_path / "out", "--springs")
    assert status == 1 and "springs need positions of both sides" in text


@pytest.mark.parametrize("share", ["-0.1", "0.95", "nan"])
def test_a_hold_out_that_is_no_share_is_refused(files: Path, tmp_path: Path, share: str):
    log = write_log(tmp_path / "log.csv", channels())
    status, text = run(files, log, tmp_path / "out", "--hold-out", share)
    assert status == 1 and "must be a share of the log" in text


@pytest.mark.parametrize("delay", ["nan", "100", "0.5", "-1"])
def test_a_delay_that_is_none_is_refused(files: Path, tmp_path: Path, delay: str):
    log = write_log(tmp_path / "log.csv", channels())
    status, text = run(files, log, tmp_path / "out", "--delay", delay)
    assert status == 1 and re.search(r"torque_delay .* must be shorter than 0.1 s", " ".join(text.split())), text


def test_a_delay_as_long_as_the_log_is_refused():
    short = Recording(TIME[:45], ("shoulder", "elbow"), **{name: x[:45] for name, x in channels().items()})
    with pytest.raises(InputError, match=r"torque_delay 0.09 s must be shorter than the log, .* s by its times;"):
        identify(TRUTH, short, torque_delay=0.09)


def uneven(jitter: float) -> Array:
    return TIME + jitter * TIME[1] * np.random.default_rng(4).uniform(-1.0, 1.0, TIME.size)


@pytest.mark.parametrize("jitter", [0.0, 0.05])
def test_coarse_encoders_are_known_for_what_they_are_at_uneven_times(files: Path, tmp_path: Path, jitter: float):
    """Between samples others are interpolated, whose steps are finer than any encoder's."""
    time = uneven(jitter)
    log = write_log(tmp_path / "log.csv", {"t": time} | wound(time, step=1.5e-3))
    found = identify(files / "arm.urdf", log, drives=files / "sprung.yaml")
    assert not any(n.told for n in found.numbers if n.name.startswith("stiffness"))
    assert any(re.search(r"winds the spring, over half its range, by .* steps", sentence) for sentence in found.untold)


@pytest.mark.parametrize(("lost", "is_bridged"), [(5, True), (7, False)])
@pytest.mark.parametrize("jitter", [0.0, 0.05])
def test_five_lost_samples_are_bridged_however_uneven_times_are(
    files: Path, tmp_path: Path, jitter: float, lost: int, is_bridged: bool
):
    time, kept = uneven(jitter), np.ones(TIME.size, bool)
    for first in range(400, 3200, 1100):
        kept[first : first + lost] = False
    given = {"t": time} | channels(time)
    log = write_log(tmp_path / "log.csv", {name: x[kept] for name, x in given.items()})
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated")
    assert found.recording.complete().all() == is_bridged
    assert any("bridged by splines" in note for note in found.notes) == is_bridged


def test_a_recording_made_in_python_is_suspected_as_a_file_is(files: Path, tmp_path: Path):
    odd = channels() | {"v": np.degrees(motions()[1])}
    logs = Recording(TIME, ("shoulder", "elbow"), **odd), write_log(tmp_path / "log.csv", odd)
    doubts = [identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated").doubts for log in logs]
    said = [[doubt for doubt in each if "times the rate of q" in doubt] for each in doubts]
    assert len(said[0]) == 2 and said[0] == said[1]
    far = Recording(TIME, ("shoulder", "elbow"), **(channels() | {"q": np.degrees(channels()["q"])}))
    with pytest.raises(InputError, match=r"far beyond its limits; this looks like degrees"):
        identify(files / "arm.urdf", far, drives=files / "rigid.yaml")
    slow = Recording(1e3 * TIME, ("shoulder", "elbow"), **channels())
    with pytest.raises(InputError, match=r"a period of 2 s is too long for a log .*: are the times in ms\?"):
        identify(files / "arm.urdf", slow, drives=files / "rigid.yaml")


def test_a_log_in_the_place_of_the_robot_is_named(files: Path):
    log = Recording(TIME, ("shoulder", "elbow"), **channels())
    with pytest.raises(InputError, match=r"identify: robot .* a Robot, or the path of a robot file"):
        identify(log, TRUTH)  # type: ignore[arg-type]


def test_short_gaps_are_bridged_and_counted(files: Path):
    kept = np.random.default_rng(0).random(TIME.size) > 0.2
    kept[[0, -1]] = True
    given = {name: x[kept] for name, x in channels().items()}
    log = Recording(TIME[kept], ("shoulder", "elbow"), **given)
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated")
    (said,) = [note for note in found.notes if ", bridged by splines" in note]
    count = int(re.findall(r"(\d+) of 5000 samples", said)[0])
    # two lost samples or more in a row: 0.2 times 0.36 of them, as chance has it
    assert count == pytest.approx(0.2 * 0.36 * TIME.size, rel=0.3)
    for number in found.numbers:
        if number.name.startswith("coulomb"):
            assert number.told and number.value == pytest.approx(4.0, rel=0.02)


def test_springs_and_rotors_are_not_sought_in_a_stretch_without_torques(files: Path):
    log = wound()
    log["torque"][(TIME > 3.0) & (TIME < 4.0)] = np.nan
    recording = Recording(TIME, ("shoulder", "elbow"), **log)
    found = identify(files / "arm.urdf", recording, drives=files / "sprung.yaml", friction="stated")
    for drive in found.robot.drives.values():
        assert drive.compliance is not None
        assert drive.compliance.deflection(10.0) == pytest.approx(10.0 / 7e3, rel=0.01)
    rotors = [n for n in found.numbers if n.name == "rotor inertia" and n.told]
    assert len(rotors) == 2 and all(n.low < 0.4 < n.high and n.high - n.low < 0.02 for n in rotors)


@pytest.mark.parametrize("drives", ["sprung.yaml", "rigid.yaml"])
def test_encoders_that_differ_in_how_far_a_joint_moves_are_named_with_the_ratio_that_fits(files: Path, drives: str):
    log, said = wound(), []
    for share in (1.0, 100.0 / 101.0, 1.004):
        turned = log | {"theta": log["theta"] * [1.0, share]}
        recording = Recording(TIME, ("shoulder", "elbow"), **turned)
        doubts = identify(files / "arm.urdf", recording, drives=files / drives, friction="stated").doubts
        said.append([doubt for doubt in doubts if "times as far as q" in doubt])
    none, less, more = said
    assert none == []
    assert [re.findall(r"theta of (.*) moves (.*) times .*: is the ratio (.*), not 100, ", x) for x in less + more] == [
        [("elbow", "0.9901", "99.01")],
        [("elbow", "1.004", "100.4")],
    ]


@pytest.mark.parametrize(("delay", "when"), [(5e-4, "later by 0.500 ms"), (-2e-3, "earlier by 2.000 ms")])
def test_which_way_torques_were_moved_is_said_once(files: Path, delay: float, when: str):
    log = Recording(TIME, ("shoulder", "elbow"), **channels())
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated", torque_delay=delay)
    assert [note for note in found.notes if "moved" in note] == [f"torque moved {when}, for all joints alike"]


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        (lambda theta: np.full_like(theta, 0.3), "theta never changes"),
        (lambda theta: theta + 8e-3 * np.sin(200.0 * theta), "kinematic error"),
    ],
)
def test_a_joint_whose_spring_is_not_found_keeps_its_own_and_leaves_the_others_theirs(
    files: Path, tmp_path: Path, changed: Any, why: str
):
    log = wound()
    log["theta"][:, 1] = changed(log["theta"][:, 1])
    recording = Recording(TIME, ("shoulder", "elbow"), **log)
    found = identify(files / "arm.urdf", recording, drives=files / "sprung.yaml", friction="stated")
    (said,) = [note for note in found.notes if "its spring was not identified" in note]
    assert said.startswith("elbow: ") and why in said
    stiffness = {joint: drive.compliance.stiffness for joint, drive in found.robot.drives.items()}  # type: ignore[union-attr]
    assert stiffness == {"shoulder": pytest.approx(7e3, rel=0.02), "elbow": 9e3}
    assert len(found.save(tmp_path)) == 4


@pytest.mark.parametrize(("side", "whose"), [("theta", "motors"), ("q", "links")])
def test_encoders_on_one_side_of_drives_that_bend_are_said_to_stand_for_both(side: str, whose: str):
    seen, bending = wound(), Drive(100.0, Rotor(4e-5), LinearSpring(7e3))
    arm = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, bending))
    log = Recording(TIME, TRUTH.joints, torque=seen["torque"], **{side: seen[side]})
    said = f"only the {whose}' positions were recorded"
    assert any(words.startswith(said) for words in identify(arm, log).notes)
    rigid = arm.with_drives({joint: Drive(100.0) for joint in arm.joints})
    assert not any(words.startswith(said) for words in identify(rigid, log).notes)


def one_sided(missing: str, joint: int) -> dict[str, Array]:
    found = wound()
    found[missing][:, joint] = np.nan
    return found


def test_a_joint_with_one_encoder_leaves_the_others_their_springs(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", one_sided("theta", 1))
    found = identify(files / "arm.urdf", log, drives=files / "sprung.yaml", friction="stated")
    assert any("elbow: theta holds no numbers, so q stands in for it" in note for note in found.notes)
    assert found.drives and set(found.drives.joints) == {"shoulder"}
    stiffness = next(n for n in found.numbers if n.name == "stiffness")
    assert stiffness.joint == "shoulder" and stiffness.low < 7e3 < stiffness.high
    neither = one_sided("theta", 1) | {"q": one_sided("q", 1)["q"]}
    with pytest.raises(InputError, match=r"joint 'elbow': neither q nor theta holds any number: lock the joint"):
        identify(files / "arm.urdf", write_log(tmp_path / "none.csv", neither), drives=files / "sprung.yaml")


def test_a_rotors_position_is_not_taken_for_degrees(files: Path, tmp_path: Path):
    turned = wound()
    turned["theta"] = 100.0 * turned["theta"]
    with pytest.raises(InputError, match=r"the ratio times as far as q, so it is the rotor's: .* side: motor}"):
        identify(files / "arm.urdf", write_log(tmp_path / "log.csv", turned), drives=files / "sprung.yaml")


def test_an_offset_that_no_file_holds_is_said(files: Path, tmp_path: Path):
    pushed = elbow("torque", lambda x: x + 1.5)
    found = identify(files / "arm.urdf", write_log(tmp_path / "log.csv", pushed), drives=files / "rigid.yaml")
    found.save(tmp_path / "out")
    for name in ("report.html", "robot.drives.yaml", "parameters.json"):
        told = " ".join((tmp_path / "out" / name).read_text().split())
        assert re.search(r"1\.[45]\d* N m of elbow(&#x27;|'|&#39;)s torque is an offset", told), name
        assert "of shoulder's torque is an offset" not in told


@pytest.mark.parametrize(("options", "named"), [({"method": "least"}, "method"), ({"solver": "sdp"}, "solver")])
def test_an_argument_that_is_wrong_is_told_before_any_log_is_read(options: Any, named: str):
    with pytest.raises(InputError, match=f"no {named} .*is named") as caught:
        identify("arm.urdf", "missing.csv", **options)
    assert "missing.csv" not in str(caught.value)
