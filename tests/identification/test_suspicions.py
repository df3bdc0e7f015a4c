"""Suspicious data in a log are reported by name; certain errors are refused."""

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from machine_logs import JOINTS, positions, times
from two_joints import urdf_text

import cutpoint
from cutpoint import Drive, Robot
from cutpoint.errors import InputError
from cutpoint.formats import parse_urdf
from cutpoint.identification import Channel, Recording, Table, parse_mapping, recording_of
from cutpoint.identification.logs.suspicions import refuse_other_units, suspicions
from robot_library import load

T = times(3000)
SPANS = positions(T)
GOOD = {
    "q": SPANS,
    "theta": SPANS + 1e-3,
    "v": positions(T, 1),
    "theta_dot": positions(T, 1),
    "torque": positions(T, 2),
}


def read(**changed: Any) -> Recording:
    channels = GOOD | {"current": GOOD["torque"]} | changed
    log = Table("log", {"t": Channel(T)} | {name: Channel(values, JOINTS) for name, values in channels.items()})
    return recording_of(log, parse_mapping({"version": 1, **{name: name for name in channels}}))


def elbow(name: str, values: Any) -> np.ndarray:
    """A channel of which the elbow's column is another."""
    changed = np.array(GOOD[name])
    changed[:, 1] = values
    return changed


def test_nothing_is_said_of_a_good_log():
    assert read().notes == ()


def test_no_channel_of_a_joint_that_only_its_spring_moves_is_taken_for_another_unit():
    of_link, of_motor = 4e-4 * np.cos(T), 1e-3 * np.sin(T)
    still = {"q": of_link, "theta": of_motor, "v": -of_motor, "theta_dot": of_link}
    assert read(**{name: elbow(name, values) for name, values in still.items()}).notes == ()


@pytest.mark.parametrize("name", GOOD)
def test_a_single_false_sample_is_no_other_unit(name: str):
    false = elbow(name, np.where(np.arange(T.size) == 1700, 1e3, GOOD[name][:, 1]))
    assert not [note for note in read(**{name: false}).notes if "another unit" in note]


@pytest.mark.parametrize("every", [1, 10])
@pytest.mark.parametrize("by", [0.02, -0.5])
@pytest.mark.parametrize("name", ["q", "theta"])
def test_positions_that_jump_and_stay_are_named_with_time_and_size(name: str, by: float, every: int):
    after = by * (np.arange(T.size) >= 1700)
    log = read(**{name: elbow(name, GOOD[name][:, 1] + after)}).with_channels(lambda x: x[::every], time=T[::every])
    told = f"{name} of elbow by {by:.2g} rad (m) at {T[1700]:.4g} s: use the log before or after that"
    assert any(told in note for note in suspicions(log)), suspicions(log)


def test_motors_that_count_from_another_zero_after_a_gap_are_named():
    theta = GOOD["theta"] + (np.arange(T.size) >= 1500)[:, None] * [0.0, 0.1]
    kept = np.abs(T - T[1500]) > 0.1
    log = read(theta=theta).with_channels(lambda x: x[kept], time=T[kept])
    assert [note for note in suspicions(log) if "theta less q of elbow by 0.1 rad (m) at 1.6" in note]


@pytest.mark.parametrize("name", ["q", "theta", "torque", "current"])
def test_columns_of_two_joints_that_are_equal_are_named(name: str):
    values = read()[name]
    notes = read(**{name: np.column_stack([values[:, 0], values[:, 0]])}).notes
    assert any(f"columns are equal, as if one was logged twice: {name} of shoulder and elbow: map" in x for x in notes)


@pytest.mark.parametrize("name", ["q", "torque", "current"])
def test_values_that_stand_still_while_the_joint_moves_are_named_with_the_time(name: str):
    x = elbow("q" if name == "q" else "torque", GOOD["q" if name == "q" else "torque"][:, 1])
    x[1000:1900, 1] = x[1000, 1]
    told = f"values stand still while the joint moves, .*: {name} of elbow from {T[1000]:.4g} to {T[1899]:.4g} s: leave"
    assert any(re.match(told, note) for note in read(**{name: x}).notes), read(**{name: x}).notes


@pytest.mark.parametrize("step", [0.01, 1.0, 10.0])
def test_torques_of_coarse_steps_do_not_count_as_standing_still(step: float):
    torque = np.round(GOOD["torque"] / step) * step
    assert not [note for note in read(torque=torque).notes if "stand still" in note]


def test_neither_a_joint_at_rest_nor_its_torque_counts_as_standing_still():
    resting = np.minimum(T, T[1000]) + np.maximum(T - T[1900], 0.0)
    values = {name: positions(resting, order) for name, order in (("q", 0), ("theta", 0), ("torque", 2))}
    assert not [note for note in suspicions(Recording(T, JOINTS, **values)) if "stand still" in note]


@pytest.mark.parametrize("kind", ["coarse", "held", "corners", "spikes", "jitter", "gap"])
def test_no_jump_is_seen_in_coarse_held_or_fast_positions_nor_across_gaps(kind: str):
    rng, time = np.random.default_rng(1), T
    changed = {name: np.array(GOOD[name]) for name in ("q", "theta")}
    for name, x in changed.items():
        if kind == "coarse":
            changed[name] = np.round(x / 0.01) * 0.01
        elif kind == "held":
            changed[name] = x[np.arange(T.size) // 10 * 10]
        elif kind == "corners":  # a speed that changes from one sample to the next
            changed[name] = np.abs((T / 3.0) % 2.0 - 1.0)[:, None] * [1.0, 2.0]
        elif kind == "spikes":
            x[[500, 1500, 1501]] += 0.3
    if kind == "jitter":
        time = np.sort(T + rng.uniform(-0.4, 0.4, T.size) * T[1])
    keep = np.abs(T - T[1500]) > 0.2 if kind == "gap" else T >= 0.0
    log = Recording(time[keep], JOINTS, **{name: x[keep] for name, x in changed.items()})
    assert not [note for note in suspicions(log) if "jump" in note]


@pytest.mark.parametrize(
    ("changed", "note"),
    [
        ({"q": elbow("q", 0.0)}, "q of elbow never changes: was it measured?"),
        ({"torque": elbow("torque", np.nan)}, "torque of elbow holds no number"),
        ({"v": elbow("v", np.where(T < 1.0, np.nan, GOOD["v"][:, 1]))}, "v of elbow lacks some samples"),
        ({"torque": elbow("torque", np.inf)}, "torque of elbow holds no number"),
        (
            {"torque": np.clip(GOOD["torque"], -5.0, 5.0)},
            "torque of shoulder, elbow stays at its extreme: was it clipped?  If so, leave these parts out",
        ),
        ({"v": np.degrees(GOOD["v"])}, "v of 'elbow' is 57.3 times the rate of q: degrees for radians?"),
        ({"v": -GOOD["v"]}, "v of 'elbow' is -1 times the rate of q: a wrong sign?"),
        ({"theta_dot": GOOD["v"] * 30.0 / math.pi}, "theta_dot of 'elbow' is 9.549 times the rate of theta: rpm for"),
        ({"v": GOOD["v"] / (2.0 * math.pi)}, "v of 'elbow' is 0.1592 times the rate of q: turns for radians?"),
        (
            {"theta": 100.0 * SPANS, "theta_dot": 100.0 * GOOD["v"]},
            "theta of 'elbow' is 100 times q: another unit",
        ),
        ({"theta": SPANS + 0.5}, "theta of 'elbow' leads q by about 0.5 rad (m) throughout: do their zeros agree?"),
        (
            {"q": 50.0 * SPANS, "v": 50.0 * GOOD["v"]},
            "q of shoulder, elbow spans more than 4 turns: degrees for radians, or mm for m?",
        ),
    ],
)
def test_what_looks_wrong_is_noted_by_name(changed: dict[str, np.ndarray], note: str):
    notes = read(**changed).notes
    assert any(each.startswith(note) for each in notes), notes


def test_a_peak_is_not_taken_for_a_limit():
    rounded = np.round(GOOD["torque"], 1)
    assert not [note for note in read(torque=rounded, current=GOOD["torque"]).notes if "clipped" in note]


def robot_log(robot: cutpoint.Robot, factor: float) -> Recording:
    names = tuple(robot.drives)
    q = factor * 0.5 * np.column_stack([SPANS[:, k % 2] for k in range(len(names))])
    log = Table("log", {"t": Channel(T), "x": Channel(q), "y": Channel(q)})
    return recording_of(log, parse_mapping("version: 1\nq: x\ntheta: {channels: y, side: motor}"), robot)


def test_a_robot_gives_names_and_ratios():
    robot = cutpoint.robots.xia2019()
    found = robot_log(robot, 1.0)
    assert found.joints == tuple(robot.drives)
    ratios = [drive.ratio for drive in robot.drives.values()]
    assert np.allclose(found["theta"], found["q"] / ratios, rtol=1e-15, atol=0.0)


def test_positions_far_beyond_the_limits_of_a_robot_are_refused():
    robot = load("ur10_robot.urdf")
    with pytest.raises(InputError, match=r"q of joint '.*' runs from .* beyond its limits; .* degrees: .* unit: deg}'"):
        robot_log(robot, 180.0 / math.pi)


@pytest.mark.parametrize(
    ("unit", "said"),
    [
        ("deg", r"limits; it is the rotor's, before .* side: motor}'; or the unit that is stated"),
        ("", r"limits; this looks like degrees: .* unit: deg}'; or it is the rotor's, .* side: motor}' \(log\)$"),
    ],
)
def test_a_unit_is_suggested_only_where_the_log_states_none(unit: str, said: str):
    arm = Robot(parse_urdf(urdf_text()), dict.fromkeys(("shoulder", "elbow"), Drive(100.0)))
    log = Table("log", {"t": Channel(T), "theta": Channel(100.0 * np.degrees(SPANS), unit=unit)})
    with pytest.raises(InputError, match=said):
        recording_of(log, parse_mapping("version: 1\njoints: [shoulder, elbow]\ntheta: theta"), arm)


@pytest.mark.parametrize("unit", ["", "unit: deg, "])
def test_an_offset_is_suspected_where_one_is_stated(unit: str):
    arm = Robot(parse_urdf(urdf_text()))
    mapping = parse_mapping(f"version: 1\njoints: [shoulder, elbow]\nq: {{channels: q, {unit}offset: [0, 90]}}")
    said = (
        r"q of joint 'elbow' runs from .* rad, far beyond its limits; .*; or the offset that is stated for it, in rad"
    )
    with pytest.raises(InputError, match=said):
        recording_of(Table("log", {"t": Channel(T), "q": Channel(0.1 * SPANS)}), mapping, arm)


def test_a_joint_that_the_robot_lacks_is_refused():
    log = Table("log", {"t": Channel(T), "q": Channel(SPANS)})
    mapping = parse_mapping("version: 1\njoints: [elbow, wrist]\nq: q", "map.yaml")
    robot = cutpoint.robots.xia2019()
    with pytest.raises(cutpoint.ModelError, match=r"the robot has no driven joint 'elbow'; there are: .*map.yaml:2"):
        recording_of(log, mapping, robot)
    with pytest.raises(cutpoint.ModelError, match=r"2 columns, but the robot has 6 driven .*; state .* as 'joints' "):
        recording_of(log, parse_mapping("version: 1\nq: q"), robot)


def test_motion_across_a_gap_is_no_disagreement():
    kept = np.r_[0:800, 1500:3000]
    notes = suspicions(Recording(T[kept], JOINTS, **{name: x[kept] for name, x in GOOD.items()}))
    assert not [note for note in notes if "times the rate" in note]


def test_motors_that_all_move_as_many_times_as_far_as_links_are_refused():
    arm = Robot(parse_urdf(urdf_text()))
    log = Recording(T, ("shoulder", "elbow"), q=GOOD["q"] / 60.0, theta=np.degrees(GOOD["q"]) / 60.0)
    with pytest.raises(InputError, match=r"theta of all joints is 57.3 times q: degrees for radians\?  If so, state"):
        refuse_other_units(log, arm)
    refuse_other_units(replace(log, theta=np.column_stack([log["theta"][:, 0], log["q"][:, 1]])), arm)


def test_millimetres_of_a_joint_that_slides_are_refused_with_the_units_of_all():
    arm = Robot(parse_urdf(urdf_text().replace('name="elbow" type="revolute"', 'name="elbow" type="prismatic"')))
    q = np.column_stack([GOOD["q"][:, 0], 500.0 + 300.0 * np.sin(T)])
    with pytest.raises(
        InputError, match=r"q of joint 'elbow' runs from .* to 800 m, .* like mm: .* unit: \[rad, mm\]}"
    ):
        refuse_other_units(Recording(T, ("shoulder", "elbow"), q=q), arm)


@pytest.mark.parametrize("false", [50.0, -1e300])
def test_single_false_positions_are_not_taken_for_another_unit(false: float):
    arm, q = Robot(parse_urdf(urdf_text())), np.array(SPANS)
    q[[700, 1900], 1] = false
    log = Recording(T, ("shoulder", "elbow"), q=q)
    refuse_other_units(log, arm)
    assert suspicions(log) == []


def test_false_positions_in_a_row_are_refused_as_false_with_their_time():
    arm, q = Robot(parse_urdf(urdf_text())), np.array(SPANS)
    q[700:720, 1] = 65535.0
    said = rf"to 6.554e\+04 rad, .* in only 20 samples, from {T[700]:.4g} s on: leave the cells"
    with pytest.raises(InputError, match=said):
        refuse_other_units(Recording(T, ("shoulder", "elbow"), q=q), arm)
