"""Excitation: motions that tell much of a robot's parameters, within every limit, from rest to rest."""

import errno
import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread
from numpy.typing import NDArray
from two_joints import two_joints, urdf_text
from typer.testing import CliRunner

import cutpoint
from cutpoint import Robot
from cutpoint.commands import app
from cutpoint.identification import Excitation, base_parameters, excitation
from cutpoint.identification.excitation.bounds import bounds_of
from cutpoint.identification.excitation.limits import limits_of
from cutpoint.identification.excitation.problem import FINER, SAMPLES, Problem
from cutpoint.identification.excitation.table import save, table_of
from cutpoint.model import Drive, Motor
from robot_library import assert_close, derivative, robot

Array = NDArray[np.float64]

LONG = 600.0
"""s: the searches here end after their starts, also on a busy machine."""

BETWEEN = 1.0 - np.cos(np.pi / (FINER * SAMPLES))
"""Of a limit: what a wave may pass it by between the samples at which it was held against it."""


@cache
def planar(criterion: Any = "determinant", harmonics: int = 4) -> Excitation:
    return excitation(two_joints(), 5.0, harmonics, criterion=criterion, seconds=LONG, starts=1)


@cache
def bending() -> Excitation:
    """Of the paper's arm, whose drives bend."""
    limits = {"speed": 2.0, "acceleration": 8.0, "torque": [50.0, 50.0, 30.0, 20.0, 10.0, 10.0]}
    boxes = {"tool": ([-np.inf, -np.inf, 0.1], [np.inf, 0.6, np.inf])}
    return excitation(robot("xia2019"), harmonics=3, **limits, boxes=boxes, seconds=LONG, starts=1)


FOUND = {"rigid": planar, "elastic": bending}


def motion(found: Excitation, count: int = 20_011) -> Array:
    """Position to snap (5, N, n) at times that are no multiples of the search's."""
    return found.trajectory.derivatives(np.linspace(0.0, found.trajectory.duration, count), 4)


def regressor(arm: Robot, q: Array, v: Array, a: Array) -> Array:
    """Of base parameters, rotors, viscous and dry friction, stacked; columns of length one."""
    n = arm.nv
    friction = [np.eye(n) * x[:, None] for x in (v, np.tanh(v / (0.02 * np.abs(v).max(axis=0))))]
    Y = np.concatenate([base_parameters(arm, rotors=True).regressor(q, v, a), *friction], axis=-1)
    Y = Y.reshape(-1, Y.shape[-1])
    return Y / np.linalg.norm(Y, axis=0)


@pytest.mark.parametrize("kind", FOUND)
def test_every_limit_holds_at_every_time(kind: str) -> None:
    found = FOUND[kind]()
    moved, arm = motion(found), found.robot
    torques = arm.elastic_inverse_dynamics(*moved, quasi_rigid=True).motor_torque
    seen = {"position": moved[0], "speed": moved[1], "acceleration": moved[2], "torque": torques}
    for use in found.limits:
        if use.kind == "place":
            frame, axis = use.name.split()
            x = arm.frame_pose(moved[0], frame)[:, "xyz".index(axis), 3]
        else:
            x = seen[use.kind][:, arm.joints.index(use.name)]
        # torques and places are no waves of their own: their crests are narrower than those of the series
        allowed = 100.0 * BETWEEN * max(abs(x.min()), abs(x.max()))
        assert use.low - allowed <= x.min() and x.max() <= use.high + allowed
        # dry friction peaks for a few milliseconds where a joint turns back, between samples too
        assert (use.least, use.largest) == pytest.approx((x.min(), x.max()), abs=0.05 * np.ptp(x))


@pytest.mark.parametrize("kind", FOUND)
def test_limits_are_those_of_robot_and_user(kind: str) -> None:
    kinds = {(use.kind, use.low, use.high) for use in FOUND[kind]().limits}
    if kind == "rigid":
        assert kinds == {("position", -2.0, 2.5), ("speed", -3.0, 3.0), ("torque", -60.0, 60.0)}
    else:
        assert {("speed", -2.0, 2.0), ("acceleration", -8.0, 8.0), ("position", -np.pi, np.pi)} <= kinds
        assert {("torque", -10.0, 10.0), ("place", 0.1, np.inf), ("place", -np.inf, 0.6)} <= kinds


@pytest.mark.parametrize(("kind", "order"), [("rigid", 2), ("elastic", 4)])
def test_a_motion_starts_and_ends_at_rest_so_that_no_motor_jumps(kind: str, order: int) -> None:
    moved = motion(FOUND[kind]())
    for k in range(1, order + 1):
        assert_close(moved[k][[0, -1]], np.zeros((2, moved.shape[-1])), 1e-12, np.abs(moved[k]).max())
    assert_close(moved[0][-1], moved[0][0], 1e-12)


def test_each_derivative_of_a_series_is_that_of_the_one_before() -> None:
    trajectory = planar().trajectory
    for t in (0.3, 1.7, 4.9):
        exact = trajectory.derivatives(t, 7)
        for k in range(7):
            slope = derivative(lambda h, k=k, t=t: trajectory.derivatives(t + h, 7)[k])
            assert_close(slope, exact[k + 1], 1e-9, np.abs(exact[k]).max())


def test_periods_repeat() -> None:
    found = excitation(two_joints(), 5.0, 3, base_frequency=0.4, seconds=LONG, starts=1)
    q = found.trajectory.derivatives(np.array([0.7, 3.2]), 2)
    assert found.periods == 2
    assert_close(q[:, 0], q[:, 1], 1e-12)


def test_the_found_motion_tells_more_than_a_random_one_as_large_as_limits_allow() -> None:
    found = planar()
    assert found.before is not None
    # five parameters of a body each, and rotors and friction: the gain is no matter of a few percent
    assert found.after.log_determinant > found.before.log_determinant + 5.0


def test_each_criterion_is_best_at_what_it_is_for() -> None:
    by_determinant, by_condition = planar("determinant"), planar("condition")
    assert by_determinant.after.log_determinant > by_condition.after.log_determinant
    assert by_condition.after.condition < by_determinant.after.condition


def test_position_limits_that_stand_for_none_leave_a_turn() -> None:
    """As files converted from SDF have them."""
    free = two_joints('<limit lower="-1e16" upper="1e16" velocity="3" effort="60"/>')
    bounds = bounds_of(free, None, None, None, None)
    assert bounds.low.tolist() == [-np.pi] * 2 and bounds.high.tolist() == [np.pi] * 2


def test_it_says_about_what_a_motion_tells_next_to_nothing() -> None:
    found = excitation(two_joints(), harmonics=3, travel=1e-5, seconds=LONG, starts=1)
    assert found.untold and {*found.untold} < {*base_parameters(found.robot, rotors=True).names}
    assert f"next to nothing about '{found.untold[0]}'" in str(table_of(found).caption)
    assert planar().untold == ()


def test_limits_that_stand_for_none_do_not_hide_what_a_motion_tells() -> None:
    """As some files state them for joints that nobody limits: dry and viscous friction must stay apart."""
    free = two_joints('<limit lower="-1" upper="1" velocity="10000" effort="50000"/>')
    found = excitation(free, 10.0, 5, seconds=LONG, starts=1)
    _, v, *_ = motion(found)
    assert found.after.condition < 200
    assert np.abs(v).max() < 5 * 2 * np.pi / 10.0  # a wave of the whole range, at the highest frequency


def test_it_tells_more_than_point_to_point_moves_between_the_same_limits() -> None:
    found, arm = planar(), two_joints()
    there = cutpoint.trajectories.cycloid([1.8, 0.5], 2.5, start=[-1.9, 2.4])
    back = cutpoint.trajectories.cycloid([-1.9, 2.4], 2.5, start=[1.8, 0.5])
    t = np.linspace(0.0, 2.5, 500)
    moves = np.concatenate([there.derivatives(t, 2), back.derivatives(t, 2)], axis=1)
    plain, ours = (np.linalg.cond(regressor(arm, *x[:3])) for x in (moves, motion(found, 1000)))
    assert ours < 0.2 * plain


@pytest.mark.parametrize("criterion", ["determinant", "condition"])
def test_gradients_are_those_of_the_cost(criterion: Any) -> None:
    arm = robot("xia2019")
    bounds = bounds_of(arm, None, 2.0, 8.0, 20.0)
    problem = Problem(arm, bounds, {"tool": ([-np.inf] * 3, [0.4, np.inf, 0.4])}, criterion, 0.1, 3)
    rng = np.random.default_rng(0)
    z, direction = 0.2 * rng.normal(size=(2, *problem.shape))
    for weight, softness in ((0.3, 0.1), (1e-2, 1e-2)):
        _, slope = problem.barred(z, weight, softness)
        measured = derivative(lambda h, w=weight, s=softness: problem.barred(z + h * direction, w, s)[0], 1e-4)
        # eigenvalues 1e-8 of the largest are known to eight digits, of which the difference's step takes half
        assert float((slope * direction).sum()) == pytest.approx(float(measured), rel=1e-3)


def test_what_the_motors_current_can_do_is_a_limit() -> None:
    arm = two_joints()
    weak = Drive(100.0, motor=Motor(torque_constant=0.1, current_limit=1.0))
    assert bounds_of(arm.with_drives({"elbow": weak}), None, None, None, None).torque.tolist() == [60.0, 10.0]


def test_a_resumed_search_goes_on_from_the_file_and_is_never_worse(tmp_path: Path) -> None:
    file = tmp_path / "best.json"
    options: dict[str, Any] = {"seconds": LONG, "starts": 1, "resume": file}
    first = excitation(two_joints(), 5.0, 3, **options)
    stored = json.loads(file.read_text())
    cost = stored["cost"]
    again = excitation(two_joints(), 5.0, 3, **options, seed=5)
    assert again.resumed and not first.resumed
    assert again.before is not None
    assert again.before.log_determinant == pytest.approx(first.after.log_determinant, rel=1e-9)
    assert f"the file's motion: log det {first.after.log_determinant:.1f}" in str(table_of(again).caption)
    brief = excitation(two_joints(), 5.0, 3, **options | {"seconds": 1e-3})
    assert brief.before == brief.after and "; none better was found: search longer" in str(table_of(brief).caption)
    assert json.loads(file.read_text())["cost"] <= cost + 1e-6 * abs(cost)
    assert "none better was found" not in str(table_of(first).caption)
    slower = excitation(two_joints(), 5.0, 3, **options, speed=0.5)
    assert slower.before is not None and slower.after.log_determinant < slower.before.log_determinant
    file.write_text(json.dumps(stored))
    assert again.after.log_determinant >= first.after.log_determinant - 1e-6 * abs(first.after.log_determinant)
    assert json.loads(file.read_text())["cost"] <= cost + 1e-6 * abs(cost)


def test_ctrl_c_returns_the_best_so_far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from cutpoint.identification.excitation import search as excitation_search

    def pressed(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(excitation_search, "_improve", pressed)
    found = excitation(two_joints(), 5.0, 3, seconds=LONG)
    assert found.starts == 0 and found.before == found.after


def test_a_full_disk_leaves_the_old_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(figure: Any, file: Any, **_: Any) -> None:
        if isinstance(file, str | Path):
            Path(file).write_bytes(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    found = planar()
    (tmp_path / "excitation.png").write_bytes(b"before")
    monkeypatch.setattr(Figure, "savefig", full)
    with pytest.raises(OSError, match=r"No space left on device: '.*excitation.png'"):
        save(found, tmp_path)
    assert (tmp_path / "excitation.png").read_bytes() == b"before"


def test_when_time_is_up_the_best_so_far_is_returned() -> None:
    whole = planar()
    short = excitation(two_joints(), 5.0, 4, seconds=0.2)
    assert short.after.log_determinant <= whole.after.log_determinant + 60.0
    assert {use.kind for use in short.limits} == {"position", "speed", "torque"}


def test_a_share_of_the_travel_keeps_clear_of_stops() -> None:
    whole, some = (excitation(two_joints(), 5.0, 4, seconds=0.1, starts=1, travel=share) for share in (1.0, 0.8))
    for own, less in zip(whole.limits, some.limits, strict=True):
        if own.kind == "position":
            middle, half = (own.low + own.high) / 2.0, 0.8 * (own.high - own.low) / 2.0
            assert (less.low, less.high) == pytest.approx((middle - half, middle + half))
            assert less.low - 1e-6 <= less.least and less.largest <= less.high + 1e-6


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("nothing", "not an excitation"),
        ("[1]", "not an excitation"),
        (f'{{"cutpoint_excitation": 1, "joints": ["a"], "base_frequency_Hz": 1{"0" * 400}}}', "not an excitation"),
        ('{"cutpoint_excitation": 1, "joints": ["a"], "base_frequency_Hz": 0.2, "centre": "x"}', "not an excitation"),
        (
            '{"cutpoint_excitation": 1, "joints": ["a"], "base_frequency_Hz": 0.2, "centre": [0], "sine": [[0]],'
            ' "cosine": [[0]]}',
            r"its joints.*another file \(resume=\) or folder \(--output\)",
        ),
        (
            '{"cutpoint_excitation": 1, "joints": ["shoulder", "elbow"], "base_frequency_Hz": 0.4, "centre": [0],'
            ' "sine": [[0]], "cosine": [[0]]}',
            r"0.4, must be 0.2 to resume .*; give the duration \(--duration\) that it had, or --base-frequency 0.4; to",
        ),
    ],
)
def test_a_file_that_tells_of_something_else_is_refused_by_its_name(tmp_path: Path, text: str, why: str) -> None:
    file = tmp_path / "other.json"
    file.write_text(text)
    with pytest.raises(cutpoint.InputError, match=rf"(?s){why}.*other\.json"):
        excitation(two_joints(), 5.0, 3, resume=file)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"boxes": {"lower": ([4.0, 4.0, 4.0], [5.0, 5.0, 5.0])}}, r"frame 'lower [xyz]': place runs"),
        ({"position": (-0.05, 0.05), "torque": [5.0, 60.0]}, r"joint 'shoulder': torque runs.*--base-freq.*--seconds"),
        ({"boxes": {"hand": ([0, 0, 0], [1, 1, 1])}}, r"no frame is named 'hand'"),
        ({"boxes": {"lower": ([0, 0, 0], [1, -1, 1])}}, r"is empty"),
        ({"boxes": {"lower": (0.0, [1, 2])}}, r"three numbers"),
        ({"position": (1.0, 1.0)}, r"joint 'shoulder': position limits 1 and 1"),
        ({"travel": 1.1}, r"excitation: travel 1.1 must be at most 1, all that limits leave"),
        ({"travel": 0.0}, r"excitation: travel 0.0 must be positive"),
        ({"speed": [1.0, -1.0]}, r"joint 'elbow': speed limit -1"),
        ({"torque": np.nan}, r"torque limit is NaN"),
        ({"acceleration": [1.0, 2.0, 3.0]}, r"acceleration limit must be a number, or 2"),
        ({"duration": 0.0}, r"duration 0.0 s"),
        ({"base_frequency": 0.33}, r"3.3 periods of the base frequency, 0.33 Hz"),
        ({"harmonics": 2}, r"harmonics 2"),
        ({"criterion": "trace"}, r"no criterion is named 'trace'"),
        ({"starts": 0}, r"starts 0"),
        ({"duration": "10"}, r"duration must be one number, s, got '10'"),
        ({"base_frequency": [0.1, 0.2]}, r"base frequency must be one number, Hz"),
        ({"harmonics": "3"}, r"harmonics '3' must be a whole number"),
        ({"harmonics": 51}, r"harmonics 51 must lie between 3 and 50"),
        ({"starts": [1]}, r"starts \[1\] must be a whole number"),
        ({"seed": -1}, r"seed -1 must be a whole number, at least 0"),
        ({"seconds": None}, r"seconds must be one number, s"),
        ({"criterion": ["trace"]}, r"no criterion is named"),
        ({"position": (1.0, 1.0)}, r"position limits 1 and 1 leave no range: .*; correct them, or lock"),
        ({"position": 1.0}, r"position must be \(low, high\)"),
        ({"boxes": [1.0]}, r"boxes must be a mapping of frame names to \(low, high\)"),
        ({"resume": 3}, r"resume must be the path of a file, got 3"),
        ({"seconds": -1.0}, r"seconds -1.0"),
        (
            {"travel": 1e-6},
            r"that tells of most parameters was found in .* s; least is told about .*: allow more travel",
        ),
    ],
)
def test_what_cannot_be_done_is_refused_in_words(options: dict[str, Any], message: str) -> None:
    with pytest.raises(cutpoint.InputError, match=message):
        excitation(two_joints(), **{"harmonics": 3, "seconds": LONG, "starts": 1, **options})


def test_a_light_finger_that_slides_is_no_obstacle(tmp_path: Path) -> None:
    """A rotor that nothing states is as heavy as the finger: in kg, since the finger slides."""
    finger = """<link name="finger"><inertial><mass value="0.015"/>
        <inertia ixx="2e-6" ixy="0" ixz="0" iyy="2e-6" iyz="0" izz="4e-7"/></inertial></link>
        <joint name="grip" type="prismatic"><parent link="lower"/><child link="finger"/><origin xyz="0.4 0 0"/>
        <axis xyz="1 0 0"/><limit lower="0" upper="0.04" velocity="0.2" effort="20"/></joint></robot>"""
    (tmp_path / "gripper.urdf").write_text(urdf_text().replace("</robot>", finger))
    found = excitation(cutpoint.load(tmp_path / "gripper.urdf"), harmonics=3, seconds=LONG, starts=1)
    assert found.after.condition < 1e5
    assert any(use.name == "grip" and use.largest - use.least > 0.02 for use in found.limits)


def test_a_box_without_walls_is_no_limit() -> None:
    arm, open_box = two_joints(), {"lower": ([-np.inf] * 3, [np.inf] * 3)}
    bounds = bounds_of(arm, None, None, None, None)
    assert [each.kind for each in limits_of(arm, bounds, open_box)] == [
        each.kind for each in limits_of(arm, bounds, {})
    ]


def test_a_rate_at_which_a_file_would_show_no_motion_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        cutpoint.InputError, match=r"save_csv: rate 0.1 Hz makes 0 steps of 5 s: it must make 10 or more"
    ):
        planar().save_csv(tmp_path / "motion.csv", rate=0.1)
    assert not [*tmp_path.iterdir()]


def test_a_joint_without_a_limit_of_speed_is_refused() -> None:
    with pytest.raises(cutpoint.InputError, match=r"joint 'joint1': neither robot nor drive limits its speed"):
        excitation(robot("xia2019"))


def test_a_floating_base_is_refused() -> None:
    with pytest.raises(cutpoint.InputError, match=r"a floating base has no motor \(.*\): .* make it fixed"):
        excitation(robot("floating"))


def test_the_command_leaves_a_motion_that_can_be_read_a_picture_and_a_table(tmp_path: Path) -> None:
    arm, folder = tmp_path / "two.urdf", tmp_path / "out"
    arm.write_text(urdf_text())
    options = ["--duration", "5", "--harmonics", "3", "--seconds", "1", "--output", str(folder)]
    result = CliRunner().invoke(app, ["excite", str(arm), *options])
    assert result.exit_code == 0, result.output
    assert "shoulder" in result.output and "-114.6 to 143.2 deg" in result.output and "condition" in result.output
    motion_of = cutpoint.trajectories.from_csv(folder / "excitation.csv", ["shoulder", "elbow"])
    assert motion_of.duration == 5.0
    assert imread(folder / "excitation.png").std() > 0.0
    assert len(json.loads((folder / "excitation.json").read_text())["sine"]) == 3


def test_the_command_keeps_the_last_frame_or_the_named_one_in_a_box(tmp_path: Path) -> None:
    # a first motion within the box takes a quick machine about a second
    options = ["excite", "xia2019", "--harmonics", "3", "--speed", "1", "--seconds", "5", "--output", str(tmp_path)]
    box = ["--box", "-9", "-9", "0.1", "9", "0.6", "inf"]
    for frame, given in (("tool", []), ("link6", ["--frame", "link6"])):
        result = CliRunner().invoke(app, [*options, *box, *given])
        assert result.exit_code == 0, result.output
        places = [line for line in result.output.splitlines() if f"{frame} " in line and "place" in line]
        assert len(places) == 3 and "0.1 to inf m" in places[2]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["--box", "0", "0", "1", "1", "1", "0"], r"frame 'tool': box from \[0. 0. 1.\] to \[1. 1. 0.\] is empty"),
        (["--box", "0", "0", "0", "1", "1", "1", "--frame", "hand"], r"no frame is named 'hand'"),
        (["--frame", "tool"], r"--frame 'tool' needs a box to stay in: add --box"),
        (["--box", "0", "0", "0", "1", "1"], r"'--box' requires 6 arguments"),
        (["--box", "0", "0", "0", "1", "1", "high"], r"--box.* (float|number)"),
    ],
)
def test_a_box_that_is_none_is_refused_by_the_command(given: list[str], message: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["excite", "xia2019", "--speed", "1", "--output", str(tmp_path), *given])
    assert result.exit_code != 0
    assert re.search(message, " ".join(f"{result.output} {result.exception}".split()))
