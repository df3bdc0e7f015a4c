"""From a log to files: what `identify` finds, and what it leaves on disk."""

import json
import re
from dataclasses import replace
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from arm_logs import LAW, TIME, TRUTH, channels, motions, run, wound, write_arm, write_log
from two_joints import urdf_text

import cutpoint
from cutpoint import Backlash, Coulomb, Drive, LinearSpring, Robot, Rotor
from cutpoint.errors import InputError
from cutpoint.formats import parse_urdf
from cutpoint.identification import Recording, identify_drives
from cutpoint.identification.output import Identification, estimates, identify, saving
from cutpoint.identification.output.drive_pictures import amplitudes
from cutpoint.identification.output.steps import Steps
from cutpoint.identification.output.terminal import table_of


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_arm(tmp_path_factory.mktemp("arm"))


@pytest.fixture(scope="module")
def found(files: Path) -> Identification:
    """Everything at once, springs too."""
    log = write_log(files / "wound.csv", wound())
    return identify(files / "arm.urdf", log, drives=files / "sprung.yaml")


def test_the_model_explains_what_it_was_not_fitted_to(found: Identification):
    for j in range(2):
        assert found.errors.rms("after", held_out=True)[j] < 0.05 * found.errors.rms("before", held_out=True)[j]
    assert found.errors.held_out.mean() == pytest.approx(0.3, abs=1e-3)


def test_plain_least_squares_stand_beside_what_was_identified(found: Identification, tmp_path: Path):
    _, _, numbers, page = (path.read_text() for path in found.save(tmp_path))
    sheet, plain = json.loads(numbers), found.errors.rms("plain", held_out=True)
    assert sheet["torque_RMS"]["plain_held_out"] == plain.tolist()
    for j, ratio in enumerate(found.errors.to_plain()):
        assert ratio.value == pytest.approx(found.errors.rms("after", held_out=True)[j] / plain[j], rel=0.05)
        assert sheet["held_out_over_plain"][j] == ratio._asdict()
        assert f"{ratio.low:.2f} to {ratio.high:.2f}: " in page


@pytest.mark.parametrize("log", [channels, wound])
def test_files_that_are_right_explain_torques_as_they_are(log: Any):
    rotor = Drive(100.0, Rotor(4e-5), LinearSpring(7e3), motor_friction=LAW)
    drive = rotor if log is wound else Drive(link_friction=LAW)
    robot = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, drive))
    found = identify(robot, Recording(TIME, TRUTH.joints, **log()), friction="stated")
    # noise of 0.01 N m, of which a tenth of the band is left, and friction's steps through the filter
    assert (found.errors.rms("before") < 0.02).all() and (found.errors.rms("after") < 0.02).all()


def test_a_links_parameter_is_not_its_namesake_joints(tmp_path: Path):
    text = urdf_text().replace('"lower"', '"elbow"')
    robot = Robot(parse_urdf(text), {joint: Drive(link_friction=LAW) for joint in TRUTH.joints})
    found = identify(robot, Recording(TIME, TRUTH.joints, **channels()), friction="stated")
    of_link = [number for number in found.numbers if number.name.endswith(".elbow") and number.name[0] in "hI"]
    assert any(number.name.startswith("h_") for number in of_link)
    assert not any(number.joint or number.path for number in of_link if not number.name.startswith("I_m"))


@pytest.mark.parametrize("log", [channels, wound])
def test_rotors_are_not_sought_in_what_gears_hand_out(log: Any):
    drive = (
        Drive(100.0, Rotor(4e-5), LinearSpring(7e3), motor_friction=LAW) if log is wound else Drive(link_friction=LAW)
    )
    robot = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, drive))
    found = identify(robot, Recording(TIME, TRUTH.joints, **log()), friction="stated", rotors=False)
    assert not any("I_m" in parameter.name for parameter in found.rigid.parameters)


@pytest.mark.parametrize("flicker", [0.0, 1e-5])
def test_a_joint_that_stands_still_keeps_the_friction_that_its_file_states(flicker: float):
    drive = Drive(100.0, Rotor(0.0), link_friction=Coulomb(2.0, 1.0, 0.05))
    before = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, drive))
    q, v, a = (x * [1.0, 0.0] for x in motions())
    torque = TRUTH.inverse_dynamics(q, v, a) + [1.0, 0.0] * LAW.torque(v)
    rng = np.random.default_rng(2)
    noisy = q + [1e-6, flicker] * rng.normal(size=q.shape), torque + 0.01 * rng.normal(size=q.shape)
    found = identify(before, Recording(TIME, TRUTH.joints, q=noisy[0], torque=noisy[1]), friction="stated")
    assert "elbow stood still: what moves only with these, and their friction, is not told" in found.notes
    numbers = {(number.joint, number.name): number for number in found.numbers}
    for name, stated, true in (("coulomb", 2.0, 4.0), ("viscous", 1.0, 3.0)):
        still, moving = numbers["elbow", f"{name}.elbow"], numbers["shoulder", f"{name}.shoulder"]
        assert not still.told and still.used == pytest.approx(stated, rel=1e-3)
        assert moving.told and moving.used == pytest.approx(true, rel=0.05)


def test_waves_have_their_amplitude_however_long_the_motor_rests():
    angle = np.concatenate([np.zeros(4000), np.linspace(0.0, 80.0 * np.pi, 6000), np.full(9000, 80.0 * np.pi)])
    values = 3.0 * np.sin(2.0 * angle + 0.7) + 0.5 * np.sin(5.0 * angle) + 10.0
    values[100:200] = np.nan
    assert np.allclose(amplitudes(angle, values, [1.0, 2.0, 5.0]), [0.0, 3.0, 0.5], atol=0.02)


def test_springs_and_rotors_are_those_of_the_truth(found: Identification):
    for drive in found.robot.drives.values():
        assert isinstance(drive.compliance, LinearSpring) and drive.rotor
        assert drive.compliance.stiffness == pytest.approx(7e3, rel=0.02)
        assert drive.rotor.inertia == pytest.approx(4e-5, rel=0.03)


def test_a_drive_that_is_stated_to_be_rigid_has_no_spring_to_be_told(files: Path, tmp_path: Path):
    before = cutpoint.load(files / "arm.urdf", files / "sprung.yaml")
    before = before.with_drives({"elbow": replace(before.drives["elbow"], compliance=None)})
    found = identify(before, Recording(TIME, TRUTH.joints, **wound()), friction="stated")
    assert found.drives and [*found.drives.joints] == ["shoulder"]
    assert found.robot.drives["elbow"].compliance is None
    assert not any("elbow" in words and "cannot be told" in words for words in found.untold)
    assert {number.joint for number in found.numbers if number.name in ("stiffness", "damping")} == {"shoulder"}
    assert "Figure 4" in found.save(tmp_path)[-1].read_text()


def test_what_is_not_told_of_a_spring_stays_as_its_file_states_it(files: Path, tmp_path: Path):
    stated = (files / "sprung.yaml").read_text()
    more = "  backlash: 1.0e-4\n  hysteresis: {loss: 2.0e-4, reach: 3.0e-4}\n"
    (tmp_path / "more.yaml").write_text(stated.replace("  friction:", f"{more}  friction:"))
    log = Recording(TIME, TRUTH.joints, **wound())
    found = identify(files / "arm.urdf", log, drives=tmp_path / "more.yaml", friction="stated")
    assert all("hysteresis" in each.unidentifiable for each in found.drives.joints.values())  # type: ignore[union-attr]
    entries = yaml.safe_load(found.save(tmp_path / "out")[1].read_text())["drives"]
    for joint, entry in entries.items():
        assert entry["compliance"]["linear"]["stiffness"] == pytest.approx(7e3, rel=0.02)
        assert entry["hysteresis"]["loss"] == pytest.approx(2e-4, rel=1e-9)
        assert entry["hysteresis"]["reach"] == pytest.approx(3e-4, rel=1e-9)
        assert entry["backlash"] == 1e-4
        assert any(words.startswith(f"{joint}: backlash cannot be told: 0.0001 rad is kept") for words in found.untold)
        assert not any(words.startswith(f"{joint}: backlash") for words in found.notes)


def test_that_motors_lead_their_links_is_said_where_no_drive_bends(files: Path):
    given, rigid = wound(), {"drives": files / "rigid.yaml", "friction": "stated", "rotors": False}
    quiet = Recording(TIME, TRUTH.joints, **given | {"theta": given["q"] + 1e-5 * np.sin(TIME)[:, None]})
    words = r"what theta leads q by changes \(shoulder 0\.0\d+ rad, elbow 0\.0\d+ rad\), .*: springs=True"
    for log, springs, is_said in (
        (Recording(TIME, TRUTH.joints, **given), None, True),
        (Recording(TIME, TRUTH.joints, **given), False, False),
        (quiet, None, False),
    ):
        found = identify(files / "arm.urdf", log, springs=springs, **rigid)
        assert any(re.match(words, note) for note in found.notes) == is_said


def test_a_spring_behind_a_play_that_its_file_states_is_found_beside_it(files: Path):
    gap, log = 4e-4, wound()
    q, v, a = motions()
    load, true = TRUTH.inverse_dynamics(q, v, a), Backlash(LinearSpring(7e3), gap)
    log["theta"] = log["theta"] + true.deflection(load) - true.spring.deflection(load)
    before = cutpoint.load(files / "arm.urdf", files / "sprung.yaml")
    drives = {joint: replace(each, compliance=Backlash(each.compliance, gap)) for joint, each in before.drives.items()}
    found = identify(before.with_drives(drives), Recording(TIME, TRUTH.joints, **log), friction="stated")
    for drive in found.robot.drives.values():
        assert isinstance(drive.compliance, Backlash) and drive.compliance.gap == gap
        for torque in (3.0, 12.0):
            assert drive.compliance.deflection(torque) == pytest.approx(true.deflection(torque), rel=0.03)


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
    with pytest.raises(InputError, match=r"already holds robot.urdf; name another, or give --force"):
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


def test_ctrl_c_while_springs_are_sought_keeps_the_links(files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def pressed(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(estimates, "identify_drives", pressed)
    log = write_log(tmp_path / "wound.csv", wound())
    found = identify(files / "arm.urdf", log, drives=files / "sprung.yaml", friction="stated")
    assert found.drives is None and found.rigid["coulomb.elbow"].told
    assert "springs were not identified: Ctrl-C was pressed during the search" in found.notes


def test_ctrl_c_keeps_the_springs_found_so_far():
    first, second = TRUTH.joints

    def pressed(joint: str) -> None:
        if joint == second:
            raise KeyboardInterrupt

    drive = Drive(100.0, Rotor(4e-5), LinearSpring(5e3), motor_friction=LAW)
    robot = Robot(TRUTH.mechanism, dict.fromkeys(TRUTH.joints, drive))
    found = identify_drives(robot, Recording(TIME, TRUTH.joints, **wound()), say=pressed)
    assert found.joints[first].drive.compliance.stiffness == pytest.approx(7e3, rel=0.01)
    assert found.robot.drives == {first: found.joints[first].drive, second: drive}
    kept = f"{second}: its spring was not identified and stays as it was: Ctrl-C was pressed during the search"
    assert kept in found.notes


def test_progress_counts_every_step_on_stderr_and_leaves_nothing(files: Path, monkeypatch: pytest.MonkeyPatch):
    seen, update = list[tuple[float, float | None]](), Steps.update

    def watched(bar: Steps, task_id: Any, **changed: Any) -> None:
        update(bar, task_id, **changed)
        seen.append((bar.tasks[0].completed, bar.tasks[0].total))

    monkeypatch.setattr(Steps, "update", watched)
    log = Recording(TIME, TRUTH.joints, **channels())
    identify(files / "arm.urdf", log, drives=files / "rigid.yaml", friction="stated", progress=True)
    assert seen == [(0, 3), (1, 3), (2, 3)]


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


def test_a_xacro_file_is_left_expanded(tmp_path: Path):
    opened = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" '
    text = urdf_text().replace("<robot ", opened).replace('name="two"', 'name="$(arg name)"')
    (tmp_path / "arm.xacro").write_text(text)
    recording = Recording(TIME, TRUTH.joints, **channels())
    found = identify(tmp_path / "arm.xacro", recording, friction="stated", xacro={"name": "left"})
    saved = found.save(tmp_path / "out")
    again = cutpoint.load(saved[0]).inertial_parameters
    assert np.abs(again - found.robot.inertial_parameters).max() <= 1e-12 * np.abs(again).max()
    assert 'name="left"' in saved[0].read_text()
    assert "robot.urdf is the expanded xacro file" in saved[-1].read_text()


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


def test_the_command_prints_errors_and_saves(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", channels())
    status, text = run(files, log, tmp_path / "out")
    assert status == 0, text
    for word in (
        "held out",
        "shoulder",
        "elbow",
        "numbers identified from this log",
        "not identified: no torque of any motion",
    ):
        assert word in text
    assert len(list((tmp_path / "out").iterdir())) == 4
    status, text = run(files, log, tmp_path / "out")
    assert status == 1 and "already holds" in text


def test_encoders_on_two_clocks_are_named_first_and_brought_to_one(files: Path, tmp_path: Path):
    late = wound()
    late["q"] = np.column_stack([np.interp(TIME - 3e-3, TIME, x) for x in late["q"].T])
    log, clocks = write_log(tmp_path / "log.csv", late), "warning: the encoders' clocks differ at "
    drives = ("--drives", str(files / "sprung.yaml"))
    _, apart = run(files, log, tmp_path / "apart", *drives)
    _, aligned = run(files, log, tmp_path / "aligned", *drives, "--align")
    assert clocks in apart and "--align" in apart and clocks not in aligned
    entries = [yaml.safe_load((tmp_path / name / "robot.drives.yaml").read_text()) for name in ("apart", "aligned")]
    stiffness = [e["drives"]["elbow"]["compliance"]["linear"]["stiffness"] for e in entries]
    assert stiffness == [9e3, pytest.approx(7e3, rel=0.02)]


def test_nothing_held_out_judges_nothing(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", channels())
    found = identify(files / "arm.urdf", log, drives=files / "rigid.yaml", hold_out=0.0, friction="stated")
    assert np.isnan(found.errors.rms("after", held_out=True)).all()
    assert np.isnan(found.errors.to_plain()).all() and not np.any(found.errors.resting())
    found.save(tmp_path / "out")
    assert (tmp_path / "out" / "report.html").stat().st_size > 10_000


def test_what_a_locked_joint_means_for_the_file_is_said_at_the_terminal(files: Path, tmp_path: Path):
    log = write_log(tmp_path / "log.csv", {name: x[:, :1] for name, x in channels().items()}, ("shoulder",))
    status, text = run(files, log, tmp_path / "out", "--lock", "elbow=0.3")
    assert status == 0 and "note: robot.urdf: load it with elbow locked as now" in text, text


def test_a_joint_that_slides_has_the_units_of_one(tmp_path: Path):
    text = urdf_text().replace('name="shoulder" type="revolute"', 'name="shoulder" type="prismatic"')
    (tmp_path / "arm.urdf").write_text(text)
    robot, (q, v, a) = cutpoint.load(tmp_path / "arm.urdf"), motions()
    torque = robot.inverse_dynamics(q, v, a) + LAW.torque(v) + 0.01 * np.random.default_rng(0).normal(size=q.shape)
    found = identify(robot, Recording(TIME, robot.joints, q=q, torque=torque), friction="stated")
    units = {number.name: number.unit for number in found.numbers}
    assert [units[f"viscous.{joint}"] for joint in robot.joints] == ["N s/m", "N m s/rad"]
    assert [units[f"coulomb.{joint}"] for joint in robot.joints] == ["N", "N m"]
    *_, numbers, page = (path.read_text() for path in found.save(tmp_path / "out"))
    assert json.loads(numbers)["torque_units"] == ["N", "N m"]
    assert "RMS of torque errors, N or N m at the joint" in page
    assert "errors, N or N m at the joint" in str(table_of(found).title)
    led = Recording(TIME, robot.joints, q=q, theta=q + 1e-3 * np.sin(TIME)[:, None], torque=torque)
    noted = identify(robot, led, friction="stated", rotors=False).notes
    assert any("what theta leads q by changes (shoulder 0.002 m, elbow 0.002 rad)" in words for words in noted)
    chosen = identify(robot, Recording(TIME, robot.joints, q=q, torque=torque)).rigid.friction
    assert [re.search("torques, (.*)\\)", str(each))[1] for each in chosen] == ["N", "N m"]  # type: ignore[index]
