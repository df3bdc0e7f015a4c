"""Which channels of a log are which quantity, in what units, and on which side."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine_logs import positions, times
from two_joints import two_joints, urdf_text

from cutpoint import Robot
from cutpoint.errors import CutpointError, InputError, ModelError
from cutpoint.formats import parse_urdf
from cutpoint.identification import Channel, Recording, Table, parse_mapping, read_recording, recording_of
from cutpoint.model import Drive
from robot_library import assert_close

T = times(100)
Q, V, TAU = (positions(T, order) for order in range(3))


def table(**channels: Any) -> Table:
    found = {name: each if isinstance(each, Channel) else Channel(each) for name, each in channels.items()}
    return Table("log.csv", {"t": Channel(T)} | found)


def mapped(text: str, log: Table) -> Recording:
    return recording_of(log, parse_mapping("version: 1\n" + text, "map.yaml"))


@pytest.mark.parametrize(
    ("fields", "factor"),
    [
        ("unit: rad", 1.0),
        ("unit: deg", math.pi / 180.0),
        ("unit: rev", 2.0 * math.pi),
        ("unit: mm", 1e-3),
        ("{unit: counts, counts_per_turn: 4096}", 2.0 * math.pi / 4096),
        ("{unit: deg, side: motor}", math.pi / 180.0 / -100.0),
        ("{unit: counts, counts_per_turn: 4096, side: motor, sign: -1}", 2.0 * math.pi / 4096 / 100.0),
        ("{gain: 0.25}", 0.25),
        ("{unit: 1, gain: 0.25}", 0.25),
    ],
)
def test_positions_come_out_in_radians_at_the_joint(fields: str, factor: float):
    inner = fields.strip("{}")
    found = mapped(f"ratio: -100\nq: {{channels: x, {inner}}}", table(x=Q))
    assert np.allclose(found["q"], factor * Q, rtol=1e-15, atol=0.0)


@pytest.mark.parametrize(
    ("quantity", "fields", "factor"),
    [
        ("v", "unit: rpm", math.pi / 30.0),
        ("theta_dot", "unit: counts/s, counts_per_turn: 1000, side: motor", 2.0 * math.pi / 1000 / 50.0),
        ("torque", "unit: mN m, side: motor", 1e-3 * 50.0),
        ("torque", "unit: A, gain: 0.11, side: motor", 0.11 * 50.0),
        ("torque", "unit: V, gain: [35, 70]", np.array([35.0, 70.0])),
        ("current", "unit: mA, side: motor", 1e-3),
        ("current", "unit: '%', gain: 0.2, sign: [1, -1]", np.array([0.2, -0.2])),
    ],
)
def test_other_quantities_come_out_in_si_at_the_joint(quantity: str, fields: str, factor: Any):
    found = mapped(f"ratio: 50\n{quantity}: {{channels: x, {fields}}}", table(x=V))
    assert np.allclose(found[quantity], factor * V, rtol=1e-15, atol=0.0)


def test_an_encoder_may_have_its_zero_elsewhere():
    found = mapped("q: {channels: x, unit: deg, offset: [0.1, -0.2]}", table(x=Q))
    assert np.allclose(found["q"], np.radians(Q) + np.array([0.1, -0.2]), rtol=1e-15, atol=1e-15)


def test_a_unit_that_the_log_states_holds_unless_the_mapping_states_another():
    log = table(x=Channel(Q, unit="deg"))
    assert np.allclose(mapped("q: x", log)["q"], np.radians(Q), rtol=1e-15)
    assert np.array_equal(mapped("q: {channels: x, unit: rad}", log)["q"], Q)


def test_every_column_has_the_unit_that_the_log_states_for_it():
    angles = {"a": Channel(Q[:, 0], unit="deg"), "b": Channel(Q[:, 1], unit="rad")}
    torques = {"c": Channel(V[:, 0], unit="N m"), "d": Channel(V[:, 1], unit="mN m")}
    found = mapped("q: [a, b]\ntorque: [c, d]", table(**angles, **torques))
    assert np.allclose(found["q"], Q * [math.pi / 180.0, 1.0], rtol=1e-15, atol=0.0)
    assert np.allclose(found["torque"], V * [1.0, 1e-3], rtol=1e-15, atol=0.0)
    assert np.array_equal(mapped("q: {channels: [a, b], unit: rad}", table(**angles))["q"], Q)
    with pytest.raises(ModelError, match=r"q: one column states the unit 'deg', another states none; state 'q.unit'"):
        mapped("q: [a, x]", table(a=angles["a"], x=Q[:, 1]))


def test_units_follow_their_columns_where_labels_pick_them():
    own = {"x.a": Channel(Q[:, :1], ("a",), "deg"), "x.b": Channel(Q[:, 1:], ("b",), "rad")}
    found = mapped("joints: [b, a]\nq: [x.a, x.b]", table(**own))
    assert np.allclose(found["q"], Q[:, ::-1] * [1.0, math.pi / 180.0], rtol=1e-15, atol=0.0)


def test_columns_are_picked_by_label_by_number_or_one_by_one():
    labelled = table(x=Channel(np.column_stack([Q, V]), ("a", "b", "c", "d")))
    assert np.array_equal(mapped("joints: [c, a]\nq: x", labelled)["q"], np.column_stack([V[:, 0], Q[:, 0]]))
    assert np.array_equal(mapped("q: [x.d, 'x[1]']", labelled)["q"], np.column_stack([V[:, 1], Q[:, 1]]))
    assert mapped("q: x", labelled).joints == ("a", "b", "c", "d")
    assert np.array_equal(mapped("q: [left, right]", table(left=Q[:, 0], right=Q[:, 1]))["q"], Q)


@pytest.mark.parametrize(
    ("time", "step"),
    [("{channel: t, unit: ms}", 1e-6), ("{channel: t}", 1e-3), ("t", 1e-3), ("{period: 0.004}", 4e-3)],
)
def test_time_is_a_channel_in_its_unit_or_a_period(time: str, step: float):
    assert mapped(f"time: {time}\nq: x", table(x=Q)).time == pytest.approx(step * np.arange(100), abs=1e-15)


@pytest.mark.parametrize(("stated", "step"), [("", 1e-6), ("unit: s", 1e-3), ("unit: us", 1e-9)])
def test_a_time_is_in_the_mappings_unit_else_in_that_of_the_log(stated: str, step: float):
    log = table(stamp=Channel(T, unit="ms"), x=Q)
    found = mapped(f"time: {{channel: stamp, {stated}}}\nq: x", log)
    assert found.time == pytest.approx(step * np.arange(100), abs=1e-15)


def test_what_was_recorded_before_the_start_and_after_the_end_is_left_out():
    whole, cut = mapped("q: x", table(x=Q)), mapped("q: x\ntime: {start: 0.025, end: 0.05}", table(x=Q))
    kept = (whole.time >= 0.025) & (whole.time <= 0.05)
    assert 2 <= kept.sum() < len(kept)
    np.testing.assert_array_equal(cut.time, whole.time[kept])
    np.testing.assert_array_equal(cut["q"], whole["q"][kept])
    assert cut.notes == (*whole.notes, f"used from 0.025 s to 0.05 s of {whole.time[-1]:.4g} s")


def test_quantities_that_a_mapping_does_not_name_are_found_by_name():
    obvious = table(q1=Q[:, 0], q2=Q[:, 1])
    named, found = mapped("q: [q1, q2]\njoints: [a, b]", obvious), mapped("joints: [a, b]", obvious)
    assert found.joints == named.joints == ("a", "b")
    np.testing.assert_array_equal(found["q"], named["q"])
    assert mapped("time: {start: 0.025}", obvious).time[0] >= 0.025


def test_a_unit_that_is_no_time_is_refused():
    with pytest.raises(ModelError, match=r"time: channel 'w' is in 'min', not a known unit of time; state time.unit"):
        mapped("time: {channel: w}\nq: x", table(w=Channel(T, unit="min"), x=Q))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("q: y", r"mapping: q: the log has no channel 'y'; there are: 't', 'x', 'w' \(map.yaml:2\)"),
        ("q: x[2]", r"mapping: q: the log has no channel 'x\[2\]'; there are"),
        ("q: x\ntime: {channel: z}", r"mapping: time: the log has no channel 'z'; there are: .* \(map.yaml:3\)"),
        ("{}", r"is not allowed|YAML cannot be read"),
        ("joints: [a]", r"no channel has a name that means position; give a mapping.  There are: 't', 'x', 'w'"),
        ("q: x\ntime: {start: 2.0, end: 1.0}", r"time.end 1 s must be later than time.start, 2 s \(map.yaml:3\)"),
        ("q: x\ntime: {start: 9.0}", r"fewer than two samples from 9.0 s to .*: the recording runs from 0 s to"),
        ("p: x", r"mapping: unknown key 'p'; known keys: 'version', 'joints', 'ratio', 'time', 'q'"),
        (
            "q: {channels: x, units: deg}",
            r"unknown key 'units' in q; known keys: 'channels', 'unit',.*; did you mean 'unit'\?",
        ),
        ("q: {unit: deg}", r"'channels' is missing in q: .* \(map.yaml:2\)"),
        ("q: {channels: []}", r"q.channels \[\] must have at least 1 entries \(map.yaml:2\)"),
        ("q: {channels: x, unit: grad}", r"q.unit 'grad' is not known; use 'rad', 'mrad', 'deg'"),
        ("q: {channels: x, unit: [deg, rad, deg]}", r"q.unit has 3 units: it must have 1 or 2 \(map.yaml:2\)"),
        ("q: {channels: x, unit: [deg, grad]}", r"q.unit 'grad' is not known; use 'rad', 'mrad', 'deg'"),
        ("q: {channels: x, unit: []}", r"q.unit \[\] must have at least 1 entries"),
        ("q: {channels: x, unit: counts}", r"q.unit 'counts' needs 'counts_per_turn'"),
        ("v: {channels: x, unit: counts}", r"v.unit 'counts' is not known"),
        ("torque: {channels: x, unit: A}", r"torque.unit 'A' needs 'gain': the SI value of one A"),
        ("q: {channels: x, sign: 2}", r"q.sign \[2.0\] must be 1 or -1; a scale factor goes into gain"),
        ("q: {channels: x, sign: [1, 1, -1]}", r"q.sign has 3 numbers: it must have 1 or 2"),
        ("q: {channels: x, gain: 0}", r"q.gain must not be zero"),
        ("q: {channels: x, side: motor}", r"q.side 'motor' needs 'ratio': motor turns per joint turn"),
        ("q: {channels: x, side: rotor}", r"q.side 'rotor' must be 'link' or 'motor' \(map.yaml:2\)"),
        ("ratio: 0\nq: x", r"ratio must not be zero"),
        ("joints: [a]\nq: {channels: 'x[0]', sign: [1, -1]}", r"q.sign has 2 numbers: it must have 1 \(map.yaml:3\)"),
        (
            "q: {channels: x, counts_per_turn: 4096}",
            r"q.counts_per_turn is for the unit 'counts', but q is in 'rad'; state 'q.unit', or .* \(map.yaml:2\)",
        ),
        (
            "v: {channels: x, unit: [deg/s, rpm], counts_per_turn: 4096}",
            r"v.counts_per_turn is for the unit 'counts/s', but v is in 'deg/s', 'rpm'; state 'v.unit', or leave",
        ),
        (
            "torque: {channels: x, counts_per_turn: 4096}",
            r"torque.counts_per_turn is for encoders, but torque is in 'N m'",
        ),
        ("ratio: [1, 2, 3]\nq: x", r"ratio has 3 numbers: it must have 1 or 2"),
        ("joints: [a, a]\nq: x", r"joints \['a', 'a'\] must be distinct names"),
        ("joints: [a]\nq: x", r"q has 2 columns: it must have one for each of a \(map.yaml:3\)"),
        ("time: {channel: t, period: 1}\nq: x", r"mapping: time has both 'channel' and 'period'; state only one"),
        ("time: {period: -1}\nq: x", r"time.period -1.0 s must be positive"),
        ("q: x\ntime: 3", r"time 3.0 must be a channel's name or a mapping with keys from 'channel', 'unit', .*:3\)"),
        ("q: 3", r"q 3.0 must be a channel's name, a list of names or a mapping with keys from 'channels', 'unit'"),
        ("q: [x, x]", r"q: 'x' and 'x' are the same column of the log; each joint needs its own \(map.yaml:2\)"),
        ("q: ['x[1]', 'x[1]']", r"q: 'x\[1\]' and 'x\[1\]' are the same column of the log"),
        ("q: ['x[1]', x]", r"q: 'x\[1\]' and 'x' are the same column of the log"),
        ("q: [x, w]", r"q: channel 'w' was not sampled at the same times as the others"),
    ],
)
def test_a_wrong_mapping_is_refused_at_its_line(text: str, message: str):
    with pytest.raises(CutpointError, match=message):
        mapped(text, table(x=Q, w=Q[:50]))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (
            "q: {channels: x, unit: mm}",
            r"q.unit 'mm' is for .* slide, but 'shoulder' turns: .* 'rad', .*'rev' \(map.ya",
        ),
        ("q: x\nv: {channels: x, unit: m/s}", r"v.unit 'm/s' .*: it must be one of .*'rpm' \(map.yaml:3\)"),
        ("q: x\ntorque: {channels: x, unit: kN}", r"torque.unit 'kN' .*: it must be one of 'N m', .*'kN m' \("),
        ("q: y", r"q.unit 'mm' is for joints that slide, but 'shoulder' turns"),
    ],
)
def test_lengths_and_forces_of_joints_that_turn_are_refused(fields: str, message: str):
    mapping = parse_mapping("version: 1\n" + fields, "map.yaml")
    with pytest.raises(ModelError, match=message):
        recording_of(table(x=Q, y=Channel(Q, unit="mm")), mapping, two_joints())


def test_angles_of_joints_that_slide_are_refused_but_not_those_of_their_motors():
    text = urdf_text().replace('name="elbow" type="revolute"', 'name="elbow" type="prismatic"')
    arm = Robot(parse_urdf(text), {name: Drive(100.0) for name in ("shoulder", "elbow")})
    rule = r"q.unit 'deg' is for joints that turn, but 'elbow' slides: it must be one of 'm', 'mm'; unit may be a list"
    with pytest.raises(ModelError, match=rule):
        recording_of(table(x=Q), parse_mapping("version: 1\nq: {channels: x, unit: deg}", "map.yaml"), arm)
    each = parse_mapping("version: 1\nq: {channels: x, unit: [deg, mm]}", "map.yaml")
    assert_close(recording_of(table(x=Q), each, arm)["q"], Q * [np.pi / 180.0, 1e-3], 1e-15)
    with pytest.raises(ModelError, match=r"torque.unit 'kN m' is for joints that turn, .* it must be one of 'N', 'kN'"):
        forces = "version: 1\nq: {channels: x, unit: [deg, mm]}\ntorque: {channels: x, unit: kN m}"
        recording_of(table(x=Q), parse_mapping(forces, "map.yaml"), arm)
    motors = parse_mapping("version: 1\nratio: 100\nq: {channels: x, unit: deg, side: motor}", "map.yaml")
    assert_close(recording_of(table(x=Q), motors, arm)["q"], np.deg2rad(Q) / 100.0, 1e-15)


def test_a_gain_makes_an_angle_of_a_length():
    mapping = parse_mapping("version: 1\nq: {channels: x, unit: m, gain: 0.5}")
    assert np.array_equal(recording_of(table(x=Q), mapping, two_joints())["q"], 0.5 * Q)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"q": {"channels": ["x"], "unit": "grad"}}, r"mapping: q.unit 'grad' is not known; .* or state 'gain'$"),
        ({"q": {"channels": ("x", "x")}}, r"mapping: q: 'x' and 'x' are the same column of the log; .* its own$"),
        ({"q": "x", "ratio": [1, 0]}, r"mapping: ratio must not be zero$"),
        ({"q": "x", "sign": 1}, r"mapping: unknown key 'sign'; known keys: .*'$"),
        ({"q": {"channels": np.ones(2)}}, r"mapping: it may hold only text, numbers, lists and dicts: .*able$"),
        ({3: "x"}, r"mapping: unknown key '3'; known keys: .*'$"),
    ],
)
def test_a_wrong_dict_is_refused_by_its_keys_and_no_line(fields: dict[Any, Any], message: str):
    with pytest.raises(ModelError, match=message):
        recording_of(table(x=Q), parse_mapping({"version": 1, **fields}))


def test_a_column_of_more_joints_than_the_robot_has_is_named(tmp_path: Path):
    columns = {f"q{k}": Q[:, 0] + k for k in (1, 2, 3)} | {f"tau{k}": TAU[:, 0] + k for k in (1, 2)}
    np.savez(tmp_path / "log.npz", t=T, **columns)  # pyright: ignore[reportArgumentType]
    robot = two_joints()
    rule = r"q has 3 columns, but the robot has 2 driven joints, 'shoulder', 'elbow': nothing says"
    with pytest.raises(
        ModelError, match=rf"{rule} whose 'q3' are; name the joints' columns in a mapping, 'q: .*log.npz\)$"
    ):
        read_recording(tmp_path / "log.npz", robot=robot)
    mapping = {"version": 1, "q": ["q1", "q2"], "torque": ["tau1", "tau2"]}
    assert np.array_equal(read_recording(tmp_path / "log.npz", mapping, robot)["q"], Q[:, :1] + [1, 2])
    np.savez(tmp_path / "log.npz", t=T, q=np.column_stack([Q, TAU[:, 0]]))
    with pytest.raises(ModelError, match=rf"{rule} which belong to them; name the joints' columns in a mapping, 'q: "):
        read_recording(tmp_path / "log.npz", robot=robot)


def test_a_version_of_the_future_is_refused():
    with pytest.raises(ModelError, match=r"version 2 is not known; this cutpoint reads 1 \(map.yaml:1\)"):
        parse_mapping("version: 2\nq: x", "map.yaml")


def test_a_missing_channel_among_many_is_answered_with_those_that_come_near():
    many = table(**{f"filler_{k}": Q for k in range(30)}, actual_position=Q)
    with pytest.raises(ModelError, match=r"no channel 'actual_positoin'; did you mean 'actual_position'\?"):
        mapped("q: actual_positoin", many)


@pytest.mark.parametrize(
    "names",
    [
        ("q", "qd", "tau"),
        ("position", "velocity", "effort"),
        ("/joint_states.position", "/joint_states.velocity", "/joint_states.effort"),
        ("rec.Actual_Q", "rec.actual_qd", "rec.motor_torque"),
    ],
)
def test_obvious_names_need_no_mapping(names: tuple[str, str, str], tmp_path: Path):
    np.savez(tmp_path / "log.npz", timestamp=T, **dict(zip(names, (Q, V, TAU), strict=True)))
    found = read_recording(tmp_path / "log.npz")
    assert np.array_equal(found["q"], Q)
    assert np.array_equal(found["v"], V)
    assert np.array_equal(found["torque"], TAU)


@pytest.mark.parametrize("pattern", ["actual_q_{}", "q{}", "q[{}]", "q ({})", "Q-{}", "Joint {} Position"])
def test_numbered_columns_are_one_quantity(pattern: str):
    from cutpoint.identification.logs.mapping import obvious_mapping

    log = table(**{pattern.format(k): Q[:, k] for k in range(2)})
    assert np.array_equal(recording_of(log, obvious_mapping(log))["q"], Q)


@pytest.mark.parametrize(
    "names",
    [
        ("q_left_elbow", "left_elbow_q", "tau_left_elbow"),
        ("left_elbow_pos", "left_elbow_Pos", "left_elbow_effort"),
        ("/joint_states/position/left_elbow", "left_elbow/position", "left_elbow.torque"),
    ],
)
def test_columns_are_found_by_the_names_of_the_robots_joints_in_any_order(names: tuple[str, str, str]):
    from cutpoint.identification.logs.mapping import obvious_mapping

    position, other, effort = names
    columns = {other.replace("elbow", "elbow_2"): Q[:, 1], position: Q[:, 0]}
    log = table(**columns, **{effort.replace("elbow", "elbow_2"): TAU[:, 1], effort: TAU[:, 0]})
    found = recording_of(log, obvious_mapping(log, ("left_elbow", "left_elbow_2")))
    assert found.joints == ("left_elbow", "left_elbow_2")
    assert np.array_equal(found["q"], Q) and np.array_equal(found["torque"], TAU)


@pytest.mark.parametrize("ends", [(".a", ".b"), ("1", "2"), ("_01", "_10")])
def test_columns_of_one_quantity_follow_those_of_the_position_whatever_their_order(ends: tuple[str, str]):
    from cutpoint.identification.logs.mapping import obvious_mapping

    a, b = ends
    log = table(**{f"q{a}": Q[:, 0], f"q{b}": Q[:, 1], f"tau{b}": TAU[:, 1], f"tau{a}": TAU[:, 0]})
    found = recording_of(log, obvious_mapping(log))
    assert np.array_equal(found["q"], Q) and np.array_equal(found["torque"], TAU)


def test_columns_that_are_named_otherwise_than_the_positions_are_refused():
    from cutpoint.identification.logs.mapping import obvious_mapping

    log = table(**{"q.a": Q[:, 0], "q.b": Q[:, 1], "tau1": TAU[:, 0], "tau2": TAU[:, 1]})
    with pytest.raises(InputError, match=r"columns 'tau1', 'tau2': none of them matches 'q.a'; use matching names"):
        obvious_mapping(log)


@pytest.mark.parametrize(
    ("name", "remedy"),
    [("tau", r"every joint needs one: lock one .*--mimic coupled"), ("theta", "add a column without numbers")],
)
def test_what_to_do_for_a_joint_that_lacks_a_column_depends_on_the_quantity(name: str, remedy: str):
    from cutpoint.identification.logs.mapping import obvious_mapping

    log = table(**{"q.a": Q[:, 0], "q.b": Q[:, 1], f"{name}.b": TAU[:, 1]})
    with pytest.raises(InputError, match=rf"'{name}.b': none of them matches 'q.a'; .*{remedy}"):
        obvious_mapping(log)


def test_labels_that_name_some_joints_must_name_all():
    log = table(q=Channel(Q, labels=("a", "b")), tau=Channel(TAU, labels=("b", "c")))
    with pytest.raises(CutpointError, match=r"torque has 2 columns, labelled 'b', 'c': .* one for each of a, b"):
        mapped("joints: [a, b]\nq: q\ntorque: tau", log)


def test_a_numbered_column_is_no_time():
    log = Table("log.csv", {"T1": Channel(25.0 + T), "q1": Channel(Q[:, 0]), "t": Channel(T)})
    from cutpoint.identification.logs.mapping import obvious_mapping

    assert np.array_equal(recording_of(log, obvious_mapping(log)).time, T)


def obvious(*names: str, joints: tuple[str, ...] = ()) -> Recording:
    """Of columns of these names; column k is k times the first joint's motion."""
    from cutpoint.identification.logs.mapping import obvious_mapping

    log = table(**{name: (k + 1.0) * Q[:, 0] for k, name in enumerate(names)})
    return recording_of(log, obvious_mapping(log, joints))


@pytest.mark.parametrize(
    ("names", "taken"),
    [
        (("desired/q0", "desired/q1", "actual/q0", "actual/q1"), (3.0, 4.0)),
        (("q0", "q1", "ref/q0", "ref/q1"), (1.0, 2.0)),
        (("Setpoint.q0", "measured.q0"), (2.0,)),
        (("cmd/q0", "q0"), (2.0,)),
        (("desired/q0", "desired/q1", "actual/q0"), (3.0,)),
        (("desired/q0", "actual/position0"), (2.0,)),
        (("cmd/q0", "cmd/q1"), (1.0, 2.0)),
    ],
)
def test_what_was_measured_is_taken_and_not_what_was_asked_for(names: tuple[str, ...], taken: tuple[float, ...]):
    assert np.array_equal(obvious(*names)["q"], np.outer(Q[:, 0], taken))


def test_a_commanded_torque_is_taken_if_it_is_alone():
    assert np.array_equal(obvious("q0", "command/tau0")["torque"][:, 0], 2.0 * Q[:, 0])
    assert np.array_equal(obvious("q0", "command/tau0", "tau0")["torque"][:, 0], 3.0 * Q[:, 0])


@pytest.mark.parametrize(
    "names",
    [
        ("left/q0", "right/q0", "right/tau0", "left/tau0"),
        ("q0", "actual/q0"),
        ("desired/q0", "target/q0"),
        ("q0", "left/tau0", "right/tau0"),
    ],
)
def test_columns_that_are_named_alike_are_refused_by_name(names: tuple[str, ...]):
    with pytest.raises(InputError, match=r"'.*0' and '.*0' have equivalent names: .*; state it in a mapping"):
        obvious(*names)


def test_of_matrices_that_are_named_alike_the_one_that_names_the_robots_joints_is_taken():
    from cutpoint.identification.logs.mapping import obvious_mapping

    log = table(**{"arm.position": Channel(Q, ("a", "b")), "hand.position": Channel(V, ("c", "d"))})
    assert np.array_equal(recording_of(log, obvious_mapping(log, ("c", "d")))["q"], V)
    with pytest.raises(InputError, match=r"'arm.position' and 'hand.position' have equivalent names"):
        obvious_mapping(log)


def test_names_that_say_nothing_are_an_error_that_lists_them(tmp_path: Path):
    np.savez(tmp_path / "log.npz", t=T, x=Q, y=V)
    with pytest.raises(
        InputError, match=r"no channel has a name that means position; give a mapping.  There are: 't', 'x'"
    ):
        read_recording(tmp_path / "log.npz")
    np.savez(tmp_path / "log.npz", q=Q)
    with pytest.raises(ModelError, match=r"no channel has a name that means time; state 'time: {channel: ...}'"):
        read_recording(tmp_path / "log.npz")


def test_a_channel_as_long_as_no_other_is_refused(tmp_path: Path):
    np.savez(tmp_path / "log.npz", t=T, q=Q[:60])
    with pytest.raises(InputError, match=r"q has 60 samples: it must have as many as time, 100"):
        read_recording(tmp_path / "log.npz")
