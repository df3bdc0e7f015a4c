"""From a log to files: what `identify` finds, what it says of logs that are not good, and what it leaves on disk."""

import json
import re
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine_logs import positions
from two_joints import two_joints, urdf_text
from typer.testing import CliRunner

import cutpoint
from cutpoint import Coulomb, LinearSpring, Robot
from cutpoint.cli import app
from cutpoint.errors import InputError
from cutpoint.formats import parse_urdf
from cutpoint.identification import Recording
from cutpoint.identification.bodies import with_parameters
from cutpoint.identification.output import Identification, identify, saving

Array = np.ndarray

TIME = 2e-3 * np.arange(5000)

LAW = Coulomb(4.0, 3.0, 0.05)

STATED = """version: 1
defaults:
  ratio: 100
  rotor: {inertia: 3.0e-5}
  compliance: {linear: {stiffness: 9000}}
  friction: {motor: {coulomb: 2.0, viscous: 1.0, smoothing: 0.05}}
drives: {shoulder: {}, elbow: {}}
"""

RIGID = """version: 1
defaults:
  ratio: 100
  motor: {torque_constant: 0.1}
  friction: {link: {coulomb: 2.0, viscous: 1.0, smoothing: 0.05}}
drives: {shoulder: {}, elbow: {}}
"""


def heavier(robot: Robot) -> Robot:
    return Robot(with_parameters(robot.mechanism, 1.3 * robot.inertial_parameters), robot.drives)


TRUTH = heavier(two_joints())
"""Of the links."""


def motions(time: Array = TIME) -> tuple[Array, Array, Array]:
    q, v, a = (positions(time, order) for order in range(3))
    return q, v, a


def channels(time: Array = TIME) -> dict[str, Array]:
    """Of a rigid arm with friction and without rotors."""
    q, v, a = motions(time)
    noise = np.random.default_rng(0).normal(size=(2, *q.shape))
    torque = TRUTH.inverse_dynamics(q, v, a) + LAW.torque(v) + 0.01 * noise[1]
    return {"q": q + 1e-6 * noise[0], "torque": torque}


def write_log(path: Path, columns: dict[str, Array], joints: tuple[str, ...] = ("shoulder", "elbow")) -> Path:
    """A CSV file whose columns are named obviously."""
    names = ["t", *(f"{name}.{joint}" for name in columns if name != "t" for joint in joints)]
    time = columns.get("t", TIME)
    rows = np.column_stack([time, *(x for name, x in columns.items() if name != "t")])
    text = "\n".join([",".join(names), *(",".join(f"{x:.9g}" for x in row) for row in rows.tolist())])
    path.write_text(text + "\n")
    return path


def wound() -> dict[str, Array]:
    """Encoders on both sides of drives that bend, and the motors' torques."""
    q, v, a = motions()
    load = TRUTH.inverse_dynamics(q, v, a)
    theta = q + load / 7e3
    speed, acceleration = (np.gradient(x, TIME[1], axis=0) for x in (theta, np.gradient(theta, TIME[1], axis=0)))
    rng = np.random.default_rng(1)
    torque = 0.4 * acceleration + load + LAW.torque(speed) + 0.01 * rng.normal(size=q.shape)
    step = 2.0 * np.pi / 2**20
    return {"q": step * np.round(q / step), "theta": 0.01 * step * np.round(theta / (0.01 * step)), "torque": torque}


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("arm")
    (folder / "arm.urdf").write_text(urdf_text())
    (folder / "rigid.yaml").write_text(RIGID)
    (folder / "sprung.yaml").write_text(STATED)
    return folder


@pytest.fixture(scope="module")
def found(files: Path) -> Identification:
    """Everything at once, springs too."""
    log = write_log(files / "wound.csv", wound())
    return identify(files / "arm.urdf", log, drives=files / "sprung.yaml")


def test_the_model_explains_what_it_was_not_fitted_to(found: Identification):
    for j in range(2):
        assert found.errors.rms("after", held_out=True)[j] < 0.05 * found.errors.rms("before", held_out=True)[j]
    assert found.errors.held_out.mean() == pytest.approx(0.3, abs=1e-3)


def test_springs_and_rotors_are_those_of_the_truth(found: Identification):
    for drive in found.robot.drives.values():
        assert isinstance(drive.compliance, LinearSpring) and drive.rotor
        assert drive.compliance.stiffness == pytest.approx(7e3, rel=0.02)
        assert drive.rotor.inertia == pytest.approx(4e-5, rel=0.03)


def test_numbers_lie_in_their_intervals_and_have_units(found: Identification):
    for number in found.numbers:
        assert number.unit and number.low <= number.value <= number.high
        assert number.told or number.why
    assert {"I_yy.lower", "coulomb.elbow", "stiffness", "rotor inertia"} <= {number.name for number in found.numbers}


def test_files_give_back_the_identified_robot(found: Identification, tmp_path: Path):
    saved = found.save(tmp_path / "new")
    assert [path.name for path in saved] == ["robot.urdf", "robot.drives.yaml", "parameters.json", "report.html"]
    again = cutpoint.load(saved[0], saved[1])
    wanted = found.robot.inertial_parameters
    assert np.abs(again.inertial_parameters - wanted).max() <= 1e-12 * np.abs(wanted).max()
    motion = np.random.default_rng(0).normal(size=(5, 2))
    mine, its = (robot.elastic_inverse_dynamics(*motion).motor_torque for robot in (found.robot, again))
    assert np.allclose(mine, its, rtol=1e-9)


def test_the_drive_file_and_the_numbers_say_the_same_intervals(found: Identification, tmp_path: Path):
    _, drives, numbers, _ = found.save(tmp_path)
    told = {(each["name"], each["joint"]): each for each in json.loads(numbers.read_text())["numbers"]}
    stiffness = told["stiffness", "elbow"]
    assert f"{stiffness['low']:.4g} to {stiffness['high']:.4g}" in drives.read_text()
    assert told["coulomb.elbow", "elbow"]["prior"] == 2.0


def test_results_are_overwritten_on_request_only(found: Identification, tmp_path: Path):
    (tmp_path / "robot.urdf").write_text("mine")
    with pytest.raises(InputError, match=r"already holds robot.urdf; name another, or force it"):
        found.save(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["robot.urdf"]
    found.save(tmp_path, force=True)
    assert "mine" not in (tmp_path / "robot.urdf").read_text()


def test_a_run_that_dies_leaves_no_file(found: Identification, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def die(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(saving, "report", die)
    with pytest.raises(KeyboardInterrupt):
        found.save(tmp_path / "new")
    assert not (tmp_path / "new").exists()


class Tags(HTMLParser):
    """Counts tags, keeps what they refer to."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.sources: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.sources += [value or "" for name, value in attrs if name in ("src", "href")]


def test_the_report_needs_nothing_else_and_shows_drives(found: Identification, tmp_path: Path):
    page = Tags()
    page.feed(found.save(tmp_path)[-1].read_text())
    assert page.tags.count("img") == 4
    assert all(source.startswith(("data:image/png;base64,", "#")) for source in page.sources)


def test_names_are_escaped_and_a_robot_in_memory_is_told_as_json(tmp_path: Path):
    names = ("<script>alert(1)</script>", "$x_1$ & y")
    text = urdf_text().replace('name="two"', 'name="&lt;b&gt;"')
    for plain, name in zip(("shoulder", "elbow"), names, strict=True):
        text = text.replace(f'"{plain}"', f'"{escape(name)}"')
    robot = Robot(parse_urdf(text))
    found = identify(robot, Recording(TIME, names, **channels()), friction="stated")
    saved = {path.name: path.read_text() for path in found.save(tmp_path)}
    page = Tags()
    page.feed(saved["report.html"])
    assert "script" not in page.tags and "img" in page.tags
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in saved["report.html"]
    assert "robot.urdf" not in saved and '"lower"' in saved["robot.inertias.json"]
    assert "a robot in memory, which is not rewritten" in saved["report.html"]


PENDULUM = """<mujoco model="pendulum"><worldbody><body name="arm">
  <joint name="swing" axis="0 1 0"/><inertial pos="0.2 0 0" mass="2" diaginertia="0.02 0.02 0.02"/>
</body></worldbody></mujoco>"""


def test_an_mjcf_file_is_not_rewritten(tmp_path: Path):
    (tmp_path / "arm.xml").write_text(PENDULUM)
    q, _, a = (x[:, :1] for x in motions())
    torque = 0.13 * a - 2.6 * 9.81 * 0.2 * np.cos(q)  # 1.3 times the file's, as are its bodies
    log = Recording(TIME, ("swing",), q=q, torque=torque + 1e-3 * np.sin(40.0 * TIME[:, None]))
    found = identify(tmp_path / "arm.xml", log, friction="stated")
    names = [path.name for path in found.save(tmp_path / "out")]
    assert names == ["robot.inertias.json", "robot.drives.yaml", "parameters.json", "report.html"]
    arm = json.loads((tmp_path / "out" / "robot.inertias.json").read_text())["arm"]
    assert arm["mass"] * arm["com"][0] == pytest.approx(0.52, rel=1e-2)


def run(files: Path, log: Path, output: Path, *options: str) -> tuple[int, str]:
    """Exit status, and all words that were printed, on single blanks."""
    given = [str(files / "arm.urdf"), str(log), "--drives", str(files / "rigid.yaml"), "--output", str(output)]
    result = CliRunner().invoke(app, ["identify", *given, *options])
    return result.exit_code, " ".join(f"{result.output} {result.exception or ''}".split())


def elbow(name: str, change: Any) -> dict[str, Array]:
    """The good log, of which one channel of the elbow is another."""
    found = channels()
    found[name][:, 1] = change(found[name][:, 1])
    return found


def test_the_command_prints_errors_and_saves(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", channels())
    status, text = run(files, log, tmp_path / "out")
    assert status == 0, text
    for word in ("held out", "shoulder", "elbow", "numbers told by this log", "not told: no torque of any motion"):
        assert word in text
    assert len(list((tmp_path / "out").iterdir())) == 4
    status, text = run(files, log, tmp_path / "out")
    assert status == 1 and "already holds" in text


def gaps(x: Array) -> Array:
    return np.where((TIME > 3.0) & (TIME < 3.2), np.nan, x)


@pytest.mark.parametrize(
    ("changed", "note"),
    [
        (lambda: elbow("q", lambda x: np.full_like(x, 0.3)), "q of elbow never changes: was it measured?"),
        (
            lambda: elbow("torque", lambda x: np.clip(x, -9.0, 9.0)),
            "torque of elbow stays at its extreme: was it cut off?",
        ),
        (lambda: elbow("q", gaps), "q of elbow misses some samples"),
        (lambda: channels() | {"v": np.degrees(motions()[1])}, "times the rate of q: degrees for radians?"),
    ],
)
def test_what_looks_wrong_is_in_the_report(files: Path, tmp_path: Path, changed: Any, note: str):
    status, text = run(files, write_log(tmp_path / "log.csv", changed()), tmp_path / "out")
    assert status == 0, text
    assert note in text
    assert note in " ".join((tmp_path / "out" / "report.html").read_text().split())


def test_a_joint_that_stood_still_is_not_told(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", elbow("q", lambda x: np.full_like(x, 0.3)))
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml")
    assert not any(n.told for n in found.numbers if n.name in ("viscous.elbow", "I_m.elbow"))
    assert any("viscous.elbow" in sentence for sentence in found.untold)


def shuffled() -> dict[str, Array]:
    order = np.random.default_rng(2).permutation(TIME.size)
    return {name: x[order] for name, x in ({"t": TIME} | channels()).items()}


@pytest.mark.parametrize(
    ("columns", "joint", "message"),
    [
        (channels, "wrist", r"no driven joint 'wrist'"),
        (lambda: channels() | {"q": np.degrees(channels()["q"])}, "elbow", r"exceeds its limits .* degrees"),
        (lambda: {"q": channels()["q"]}, "elbow", r"holds no torque or current"),
        (lambda: channels() | {"q": np.zeros_like(TIME[:, None] * [1, 1])}, "elbow", r"no column moves"),
        (lambda: channels() | {"t": np.zeros_like(TIME)}, "elbow", r"q/torque: "),
    ],
)
def test_what_is_surely_wrong_is_refused(files: Path, tmp_path: Path, columns: Any, joint: str, message: str):
    status, text = run(files, write_log(tmp_path / "log.csv", columns(), ("shoulder", joint)), tmp_path / "out")
    assert status == 1 and re.search(message, text), text
    assert not (tmp_path / "out").exists()


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


def test_springs_need_both_encoders(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", channels())
    status, text = run(files, log, tmp_path / "out", "--springs")
    assert status == 1 and "springs need positions of both sides" in text


@pytest.mark.parametrize("share", ["-0.1", "0.95", "nan"])
def test_a_hold_out_that_is_no_share_is_refused(files: Path, tmp_path: Path, share: str):
    log = write_log(tmp_path / "log.csv", channels())
    status, text = run(files, log, tmp_path / "out", "--hold-out", share)
    assert status == 1 and "must be a share of the log" in text


def test_nothing_held_out_judges_nothing(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", channels())
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", hold_out=0.0, friction="stated")
    assert np.isnan(found.errors.rms("after", held_out=True)).all()
    found.save(tmp_path / "out")
    assert (tmp_path / "out" / "report.html").stat().st_size > 10_000
