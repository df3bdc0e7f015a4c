"""Tables as machines and spreadsheets write them: headers, units, gaps and ends that are not as they should be."""

from pathlib import Path

import numpy as np
import pytest
from machine_logs import positions, times

from cutpoint import Robot
from cutpoint.errors import CutpointError, InputError
from cutpoint.identification import Recording, read_recording, read_table
from cutpoint.model.stated_units import name_and_unit
from random_trees import random_tree

T = times(200)
Q, TAU = positions(T), positions(T, 2)
NUMBERS = np.column_stack([T, Q, TAU])
HEADER = "t,q1,q2,tau1,tau2"


def lines(delimiter: str = ",") -> list[str]:
    return [delimiter.join(map(repr, row)) for row in NUMBERS.tolist()]


def read(folder: Path, *text: str) -> Recording:
    (folder / "log.csv").write_text("\n".join(text))
    return read_recording(folder / "log.csv")


def assert_read(found: Recording, missing: int = 0) -> None:
    """All that was written, but for the first samples."""
    assert np.allclose(found.time, T[: found.time.size], rtol=0.0, atol=1e-12)
    assert np.array_equal(found["q"][missing:], Q[missing : found.time.size])
    assert np.array_equal(found["torque"][missing:], TAU[missing : found.time.size])


@pytest.mark.parametrize(
    "above",
    [
        ["sep=,", HEADER],
        ['"sep=,"', "# exported by hand", HEADER],
        [f"# {HEADER}"],
        ["# a remark", f"# {HEADER}"],
        ["# t q1 q2 tau1 tau2", ""],
        [HEADER, "s,rad,rad,Nm,Nm"],
        [HEADER, "[s],-,,[N·m],(N.m)"],
        ["t (s),q1 [rad],q2 (radians),tau1[Nm],tau2 [N m]"],
        ["// exported by hand", HEADER],
        ["t,/joint_states/position/0,/joint_states/position/1,/joint_states/effort/0,/joint_states/effort/1"],
    ],
)
def test_whatever_stands_above_its_numbers_a_table_is_read(tmp_path: Path, above: list[str]):
    found = read(tmp_path, *above, *lines())
    assert_read(found)
    assert found.notes == ()


def test_a_line_that_was_taken_for_the_names_is_shown_where_others_do_not_fit(tmp_path: Path):
    told = r"line has 5 cells: it must have 3, .*; line 1 was taken as the names: 'Arm, of, tests'; .* \(.*log.csv:2\)"
    with pytest.raises(InputError, match=told):
        read(tmp_path, "Arm of tests", *lines(" "))
    with pytest.raises(InputError, match=r"'exported' is neither; .*; line 1 was taken as the names: 'Arm, of, tests'"):
        read(tmp_path, "Arm of tests", "exported by hand", HEADER, *lines())


def test_columns_that_are_numbered_from_zero_and_from_one_are_not_paired(tmp_path: Path):
    with pytest.raises(InputError, match=r"columns 'tau1', 'tau2': none of them matches 'q0'; use matching names"):
        read(tmp_path, "t,q0,q1,tau1,tau2", *lines())


def test_newton_millimetres_and_milliseconds_in_a_name_are_known(tmp_path: Path):
    found = read(tmp_path, "timestamp_ms,q1,q2,tau1 [Nmm],tau2 [N mm]", *lines())
    assert np.allclose(found.time, 1e-3 * T, rtol=0.0, atol=1e-15)
    assert np.allclose(found["torque"], 1e-3 * TAU, rtol=1e-15, atol=0.0)


def test_a_clocks_nanoseconds_are_known_by_their_size(tmp_path: Path):
    stamps = [1_700_000_000_000_000_000 + round(1e9 * t) for t in T.tolist()]
    rest = (line.partition(",")[2] for line in lines())
    found = read(tmp_path, HEADER, *(f"{stamp},{others}" for stamp, others in zip(stamps, rest, strict=True)))
    # doubles near 1.7e18 are multiples of 256, near 1.7e9 of 2.4e-7: half of both, for each end of a span
    assert np.allclose(found.time, T, rtol=0.0, atol=5e-7)
    assert found.notes == ("time: t is taken as ns since 1970; if it is not, state time.unit in a mapping",)


def test_excels_first_line_says_what_divides_cells(tmp_path: Path):
    assert_read(read(tmp_path, "sep=|", HEADER.replace(",", "|"), *lines("|")))


def test_what_numpy_writes_is_read(tmp_path: Path):
    for delimiter, header in ((" ", HEADER), (" ", HEADER.replace(",", " ")), (",", HEADER)):
        np.savetxt(tmp_path / "log.txt", NUMBERS, "%.17g", delimiter, header=header)
        assert_read(read_recording(tmp_path / "log.txt"))


def test_a_remark_above_numbers_is_no_header(tmp_path: Path):
    with pytest.raises(InputError, match=r"first line '0.0, .*' must name the columns, .*:2\)"):
        read(tmp_path, "# made by hand", *lines())


def test_a_line_of_units_counts_for_its_columns(tmp_path: Path):
    found = read(tmp_path, HEADER, "ms,°,rad,mNm,kN m", *lines())
    assert found.time[-1] == pytest.approx(1e-3 * T[-1])
    assert np.allclose(found["q"], Q * [np.pi / 180.0, 1.0], rtol=1e-15, atol=0.0)
    assert np.allclose(found["torque"], TAU * [1e-3, 1e3], rtol=1e-15, atol=0.0)


@pytest.mark.parametrize(
    ("title", "found"),
    [
        ("q1 [°]", ("q1", "deg")),
        ("q1(deg)", ("q1", "deg")),
        ("Time(ms)", ("Time", "ms")),
        ("v [°/sec]", ("v", "deg/s")),
        ("v [1/min]", ("v", "rpm")),
        ("q [grad]", ("q", "grad")),
        ("q[3]", ("q[3]", "")),
        ("q (3)", ("q (3)", "")),
        ("q (elbow)", ("q (elbow)", "")),
        ("q [-]", ("q", "")),
        ("q", ("q", "")),
        ("", ("", "")),
    ],
)
def test_titles_say_names_and_units(title: str, found: tuple[str, str]):
    assert name_and_unit(title) == found


@pytest.mark.parametrize("word", ["--", "start", "1.2.3"])
def test_words_among_numbers_are_missing_samples_with_a_note(tmp_path: Path, word: str):
    first = f"0.0,{word},{word},{TAU[0, 0]!r},{TAU[0, 1]!r}"
    found = read(tmp_path, HEADER, first, *lines()[1:])
    assert_read(found, missing=1)
    assert np.isnan(found["q"][0]).all()
    assert found.notes[0] == f"column 'q1': text in 1 of 200 cells, such as '{word}', counts as missing"


def test_a_column_of_words_is_named_where_it_is_missed(tmp_path: Path):
    words = [f"home,{line}" for line in lines()]
    with pytest.raises(
        InputError, match=r"no channel has a name that means position; .*'x5'; 'q1' holds text, such as 'home'"
    ):
        read(tmp_path, "q1,t,x2,x3,x4,x5", *words)
    with pytest.raises(CutpointError, match=r"q: the log's channel 'q1' holds text, such as 'home': it must hold num"):
        read_recording(tmp_path / "log.csv", {"version": 1, "q": "q1"})


@pytest.mark.parametrize(
    "form", ["2024-02-29 23:59:59.{:03d}", "2024-02-29T23:59:59,{:03d}Z", "1999-12-31 23:59:59.{:03d}000+0530"]
)
def test_date_times_are_seconds(tmp_path: Path, form: str):
    rows = [";".join([form.format(k), *line.split(";")[1:]]) for k, line in enumerate(lines(";"))]
    assert_read(read(tmp_path, HEADER.replace(",", ";"), *rows))


def test_date_times_in_two_zones_are_of_one_clock(tmp_path: Path):
    zones = ("2024-03-31T01:59:59.{:03d}+01:00", "2024-03-31T02:59:59.{:03d}+02:00")
    rows = [",".join([zones[k // 100].format(k), *line.split(",")[1:]]) for k, line in enumerate(lines())]
    assert_read(read(tmp_path, HEADER, *rows))


def test_times_of_day_are_refused_with_what_to_write(tmp_path: Path):
    rows = [",".join([f"23:59:59.{k:03d}", *line.split(",")[1:]]) for k, line in enumerate(lines())]
    with pytest.raises(
        CutpointError, match=r"channel 't' holds text, such as '23:59:59.000': .* or date-times such as"
    ):
        read(tmp_path, HEADER, *rows)


def test_a_last_line_that_was_cut_off_is_left_out(tmp_path: Path):
    found = read(tmp_path, HEADER, *lines()[:150], "0.15,0.1,0.")
    assert_read(found)
    assert found.time.size == 150
    assert found.notes == ("line 152, the last, was cut off after 3 of 5 cells and is left out",)


def test_objects_in_an_archive_are_named(tmp_path: Path):
    np.savez(tmp_path / "log.npz", t=T, q=Q, tau=TAU.astype(object))
    found = read_recording(tmp_path / "log.npz")
    assert found.notes == ("'tau' holds Python objects: they are never read; save an array of numbers",)
    with pytest.raises(CutpointError, match=r"torque: the log's channel 'tau' holds Python objects"):
        read_recording(tmp_path / "log.npz", {"version": 1, "q": "q", "torque": "tau"})


def test_a_column_is_found_by_its_title_too(tmp_path: Path):
    (tmp_path / "log.csv").write_text("\n".join(["t,q1 [deg],q2 (rad),x,y", *lines()]))
    table = read_table(tmp_path / "log.csv")
    assert table.find("q1 [deg]") is table.find("q1") is not None
    assert table.find("q2 (rad)") is table.find("q2") is not None
    assert table.find("q3 [deg]") is None


def test_an_array_called_header_does_not_make_a_log_ours(tmp_path: Path):
    np.savez(tmp_path / "log.npz", header=np.array("written by my own logger"), time=T, q=Q, tau=TAU)
    assert_read(read_recording(tmp_path / "log.npz"))


def test_names_in_a_comment_stand_above_samples_that_hold_words(tmp_path: Path):
    rows = [f"{line},base" for line in lines()]
    assert_read(read(tmp_path, f"%{HEADER},frame", *rows))
    assert_read(read(tmp_path, "# a remark, in two parts", f"{HEADER},frame", *rows))


def test_columns_of_joint_names_say_whose_the_numbered_columns_are(tmp_path: Path):
    robot = Robot(random_tree(0, 2))
    header = "%time,field.header.frame_id,field.name0,field.name1,field.position0,field.position1,"
    header += "field.effort0,field.effort1"
    rows = [f"{t!r},,joint1,joint0,{b!r},{a!r},{d!r},{c!r}" for t, a, b, c, d in NUMBERS.tolist()]
    (tmp_path / "log.csv").write_text("\n".join([header, *rows]))
    assert read_recording(tmp_path / "log.csv").joints == ("joint1", "joint0")
    found = read_recording(tmp_path / "log.csv", robot=robot)
    assert found.joints == ("joint0", "joint1")
    assert_read(found)


def test_names_that_change_within_a_log_name_no_joint(tmp_path: Path):
    rows = [f"{line},{'joint1' if k else 'joint0'}" for k, line in enumerate(lines())]
    assert read(tmp_path, f"{HEADER},name1", *rows).joints == ("joint_0", "joint_1")
