"""Several logs of one machine, used as one."""

import re
from pathlib import Path

import numpy as np
import pytest
from arm_logs import LAW, TIME, TRUTH, channels, motions, run, wound, write_arm, write_log

from cutpoint.errors import InputError
from cutpoint.identification import Recording, identify_rigid, joined
from cutpoint.identification.output import identify
from cutpoint.identification.output.numbers import Number

JOINTS, HALF = TRUTH.joints, TIME.size // 2


def recording(start: int = 0, end: int | None = None, **changed: object) -> Recording:
    """A stretch of the arm's log, from its own zero of time."""
    parts = {name: x[start:end] for name, x in channels().items()}
    return Recording(**{"time": TIME[start:end] - TIME[start], "joints": JOINTS, **parts, **changed})


def halves() -> list[Recording]:
    return [recording(0, HALF), recording(HALF)]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_arm(tmp_path_factory.mktemp("arm"))


def test_each_sample_stays_and_nothing_is_known_between():
    both = joined(halves())
    known = both.complete()
    np.testing.assert_array_equal(both["q"][known], recording()["q"])
    pause = np.diff(both.time[known]).max()
    assert pause == pytest.approx(1.0 + both.period, abs=1.5 * both.period)
    assert not known[HALF : -(TIME.size - HALF)].any()


def test_one_recording_joined_is_itself():
    alone = joined([recording()])
    np.testing.assert_array_equal(alone.time, recording().time)
    np.testing.assert_array_equal(alone["torque"], recording()["torque"])


def test_a_log_in_two_parts_tells_what_it_tells_whole():
    whole, parts = (identify_rigid(TRUTH, x) for x in (recording(), joined(halves())))
    for one, other in zip(whole.parameters, parts.parameters, strict=True):
        assert one.name == other.name
        assert other.low - other.value < one.value - other.value < other.high - other.value


def one_moves(joint: int) -> Recording:
    """The other joint is held at an angle of its own."""
    q, v, a = motions()
    moves = np.arange(2) == joint
    q, v, a = np.where(moves, q, 0.3), np.where(moves, v, 0.0), np.where(moves, a, 0.0)
    noise = np.random.default_rng(joint).normal(size=(2, *q.shape))
    torque = TRUTH.inverse_dynamics(q, v, a) + LAW.torque(v) + 0.01 * noise[1]
    return Recording(TIME, JOINTS, q=q + 1e-6 * noise[0], torque=torque)


def test_logs_that_each_move_one_joint_tell_together_what_neither_tells(files: Path):
    logs = [one_moves(0), one_moves(1)]
    model = files / "arm.urdf", files / "rigid.yaml"

    def told(*given: Recording) -> set[str]:
        found = identify(model[0], given, drives=model[1], hold_out=0.0)
        return {number.name for number in found.numbers if number.told}

    first, second, both = told(logs[0]), told(logs[1]), told(*logs)
    assert "coulomb.elbow" not in first
    assert "coulomb.shoulder" not in second
    assert first | second <= both
    assert {"coulomb.elbow", "coulomb.shoulder"} <= both


def test_springs_are_found_from_parts_as_from_the_whole(files: Path):
    def stiffness(logs: Recording | list[Recording]) -> list[Number]:
        found = identify(files / "arm.urdf", logs, drives=files / "sprung.yaml", hold_out=0.0)
        return [number for number in found.numbers if number.name == "stiffness"]

    parts = [{name: x[rows] for name, x in wound().items()} for rows in (slice(HALF), slice(HALF, None))]
    logs = [Recording(TIME[:HALF], JOINTS, **part) for part in parts]
    for number in stiffness(logs):
        assert number.low < 7e3 < number.high
        assert number.high - number.low < 0.01 * 7e3
    assert len(stiffness(logs)) == 2


@pytest.mark.parametrize("jitter", [0.0, 1e-4])
def test_files_are_joined_and_notes_name_theirs(files: Path, tmp_path: Path, jitter: float):
    rng, logs = np.random.default_rng(3), list[Path]()
    for name, rows in (("first.csv", slice(HALF)), ("second.csv", slice(HALF, None))):
        time = TIME[rows] + jitter * rng.uniform(-1.0, 1.0, HALF)
        kept = ~((time > 8.0) & (time < 8.5))
        columns = {channel: x[rows][kept] for channel, x in channels().items()}
        logs.append(write_log(tmp_path / name, {**columns, "t": time[kept]}))
    status, words = run(files, logs[0], tmp_path / "out", str(logs[1]))
    assert status == 0
    assert re.search(r"note: second.csv: .*1 gap above .* the longest, 0.5\d* s", words)
    assert not re.search(r"first.csv: (?!time: stamps scatter)", words)
    assert "13 of 13 numbers" in words


def test_a_log_that_is_named_twice_is_refused(files: Path, tmp_path: Path):
    """Its samples would count twice, and intervals would come out too narrow."""
    log, once = write_log(tmp_path / "run.csv", channels()), recording()
    status, words = run(files, log, tmp_path / "out", str(tmp_path / "." / "run.csv"))
    assert status and "run.csv' is named twice; name each log once" in words
    with pytest.raises(InputError, match="a recording is named twice"):
        identify(TRUTH, [once, once])
    with pytest.raises(InputError, match="path"):
        identify(TRUTH, 3)  # type: ignore[arg-type]


WRONG = {
    "no log": (lambda: joined([]), "joined: there is no recording"),
    "another period": (
        lambda: joined([recording(), recording(time=2.0 * TIME)]),
        r"joined: recording 2 has a period of 0.004 s, the first one of 0.002 s; resample .*resampled\(0.002\)",
    ),
    "other joints": (lambda: joined([recording(), recording(joints=("shoulder", "wrist"))]), "'elbow'"),
    "no common channel": (
        lambda: joined([recording(torque=None), recording(q=None)]),
        "joined: no channel is in every recording; they hold q; torque",
    ),
    "no recording": (lambda: joined([recording(), TIME]), "joined: recording"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_recordings_that_do_not_go_together_are_refused(name: str):
    call, words = WRONG[name]
    with pytest.raises(InputError, match=words):
        call()


def test_a_channel_that_one_lacks_is_left_out_with_a_note():
    both = joined([recording(theta=recording()["q"]), recording()])
    assert set(both.channels) == {"q", "torque"}
    assert both.notes == ("theta is not used: 1 of 2 logs lack it",)
