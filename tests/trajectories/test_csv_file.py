"""Motions from CSV files."""

from pathlib import Path

import numpy as np
import pytest

from cutpoint import Log
from cutpoint.errors import InputError
from cutpoint.trajectories import csv_file, cycloid, from_csv, from_samples

TIMES = np.linspace(0.0, 2.0, 101)
POSITIONS = cycloid([1.0, -0.5, 0.3], 2.0, [0.0, 1.0, 0.1])(TIMES).q


def written(folder: Path, header: str, data: np.ndarray = POSITIONS, encoding: str = "utf-8") -> Path:
    rows = np.column_stack([TIMES, data]).tolist()
    text = "\n".join([header, *(", ".join(map(repr, row)) for row in rows)]) + "\n"
    path = folder / "motion.csv"
    path.write_text(text, encoding=encoding)
    return path


@pytest.mark.parametrize("channels", [("q", "reference_q", "effort"), ("effort", "q")])
def test_a_log_gives_its_references_motion_or_else_that_of_its_links(tmp_path: Path, channels: tuple[str, ...]):
    values = {"q": POSITIONS + 0.01, "reference_q": POSITIONS, "effort": 100.0 + POSITIONS}
    units = {"q": ("rad", "rad", "m"), "reference_q": ("rad", "rad", "m"), "effort": ("N m", "N m", "N")}
    path = tmp_path / "run.csv"
    of_log = {name: values[name] for name in channels}
    Log(TIMES, of_log, {name: units[name] for name in channels}, ("upper, arm", "elbow", "lift")).save(path)
    found = from_csv(path, ["lift", "upper, arm"], sliding=("lift",))
    expected = values["reference_q" if "reference_q" in channels else "q"][:, [2, 0]]
    assert found.joints == ("lift", "upper, arm")
    assert np.array_equal(found(TIMES).q, from_samples(TIMES, expected)(TIMES).q)


def test_a_log_without_a_motion_is_refused_and_so_is_a_line_that_is_cut_off(tmp_path: Path):
    path = tmp_path / "run.csv"
    Log(TIMES, {"effort": POSITIONS}, {"effort": "N m"}, ("a", "b", "c")).save(path)
    with pytest.raises(InputError, match=r"this is a cutpoint log without a motion: it has neither reference_q nor q;"):
        from_csv(path)
    Log(TIMES, {"q": POSITIONS}, {"q": "rad"}, ("a", "b", "c")).save(path)
    path.write_text(path.read_text("utf-8") + "3.0,1.0,2.0\n", "utf-8")
    with pytest.raises(InputError, match=r"line has 3 cells: it must have 4, as the line of names \(.*run.csv:104\)"):
        from_csv(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
@pytest.mark.parametrize("header", ["t,shoulder,elbow,lift", "Time [s], shoulder [rad], elbow [rad] , lift [m]"])
def test_a_file_gives_the_motion_of_its_samples(tmp_path: Path, header: str, encoding: str):
    found = from_csv(written(tmp_path, header, encoding=encoding))
    assert found.joints == ("shoulder", "elbow", "lift")
    assert np.array_equal(found(TIMES).q, from_samples(TIMES, POSITIONS)(TIMES).q)


def test_degrees_are_converted_where_the_header_says_so(tmp_path: Path):
    path = written(tmp_path, "t,a [deg],b [rad],c", POSITIONS * [180.0 / np.pi, 10.0, 1.0])
    assert np.allclose(
        from_csv(path)(TIMES).q, from_samples(TIMES, POSITIONS * [1, 10, 1])(TIMES).q, rtol=0, atol=1e-12
    )


@pytest.mark.parametrize(("mark", "point"), [(";", ","), (";", "."), ("\t", ","), ("\t", "."), (",", ".")])
def test_a_motion_may_be_separated_and_pointed_as_spreadsheets_do(tmp_path: Path, mark: str, point: str):
    path = written(tmp_path, "t [s],a,b,c")
    head, *lines = path.read_text("utf-8").split("\n")
    text = "\n".join(line.replace(".", point) for line in [x.replace(", ", mark) for x in lines])
    path.write_text(f"{head.replace(',', mark)}\n{text}", "utf-8")
    assert np.array_equal(from_csv(path)(TIMES).q, from_samples(TIMES, POSITIONS)(TIMES).q)


@pytest.mark.parametrize(("unit", "second"), [("s", 1.0), ("ms", 1e3), ("us", 1e6)])
def test_times_are_in_the_unit_that_the_first_line_names(tmp_path: Path, unit: str, second: float):
    rows = "\n".join(",".join(map(repr, row)) for row in np.column_stack([second * TIMES, POSITIONS]).tolist())
    path = tmp_path / "motion.csv"
    path.write_text(f"t [{unit}],a,b,c\n{rows}\n", "utf-8")
    same = from_samples(TIMES, POSITIONS)
    assert from_csv(path).duration == pytest.approx(same.duration, rel=1e-15)
    np.testing.assert_allclose(from_csv(path)(TIMES).q, same(TIMES).q, rtol=0, atol=1e-12)


@pytest.mark.parametrize("header", ["Time (ms),a [°],b (degrees),c (mm)", "t [msec],a(deg),b [Degree],c [mm]"])
def test_units_may_be_spelled_as_in_other_programs(tmp_path: Path, header: str):
    rows = np.column_stack([1e3 * TIMES, POSITIONS * [180.0 / np.pi, 180.0 / np.pi, 1e3]])
    path = tmp_path / "motion.csv"
    path.write_text(f"{header}\n" + "\n".join(",".join(map(repr, row)) for row in rows.tolist()) + "\n", "utf-8")
    np.testing.assert_allclose(from_csv(path)(TIMES).q, from_samples(TIMES, POSITIONS)(TIMES).q, rtol=0, atol=1e-12)


def test_millimetres_are_converted_too(tmp_path: Path):
    path = written(tmp_path, "t,a,b,c [mm]", POSITIONS * [1.0, 1.0, 1e3])
    same = from_samples(TIMES, POSITIONS)(TIMES).q
    assert np.allclose(from_csv(path, sliding=["c"])(TIMES).q, same, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        (
            "t,turns [m],lift [m]",
            r"'turns' is in 'm': it turns, so its unit must be one of 'rad', 'mrad', 'deg', 'rev' \(.*csv:1\)",
        ),
        ("t,turns,lift [rad]", r"'lift' is in 'rad': it slides, so its unit must be one of 'm', 'mm' \(.*csv:1\)"),
        (
            "t,turns,lift",
            r"'lift': position 350.0 looks like millimetres; .* 'lift \[mm\]' or 'lift \[m\]' \(.*csv:2\)",
        ),
    ],
)
def test_units_are_held_against_the_joints_where_it_is_told_which_slide(tmp_path: Path, header: str, message: str):
    path = tmp_path / "motion.csv"
    path.write_text(header + "\n0,1,350\n1,1,351\n2,1,352\n3,1,353\n")
    with pytest.raises(InputError, match=message):
        from_csv(path, sliding={"lift"})


def test_columns_are_picked_by_name_in_the_order_asked_for(tmp_path: Path):
    found = from_csv(written(tmp_path, "t,a,b,c"), ["c", "a"], bandwidth=5.0, at_rest=False)
    same = from_samples(TIMES, POSITIONS[:, [2, 0]], bandwidth=5.0, at_rest=False)
    assert found.joints == ("c", "a")
    assert np.array_equal(found(TIMES).q, same(TIMES).q)


def test_empty_lines_do_not_count(tmp_path: Path):
    path = written(tmp_path, "t,a,b,c\n\n")
    assert from_csv(path).duration == 2.0


GOOD = "0,1\n1,2\n2,3\n3,4\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"first line '' must name the columns, as in 't, shoulder, elbow': time first, .*motion.csv:1\)"),
        (GOOD, r"first line '0, 1' must name the columns"),
        ("elbow,t\n" + GOOD, r"first line 'elbow, t' must name the columns"),
        ("x,elb\x1bow\x9b\n", r"first line 'x, elb\\x1bow\\x9b' must name the columns"),
        (
            "t,elb\x1b[31mow\n",
            r"column 'elb\\x1b\[31mow' must be a name, or a name and its unit, as in 'elbow \[deg\]'",
        ),
        ("t [s,elbow\n" + GOOD, r"column 't \[s' must be a name, or a name and its unit, .* \(.*motion.csv:1\)"),
        ("t,elbow [deg\n" + GOOD, r"column 'elbow \[deg' must be a name"),
        ("t,elbow deg]\n" + GOOD, r"column 'elbow deg\]' must be a name"),
        ("t,elbow [deg] x\n" + GOOD, r"column 'elbow \[deg\] x' must be a name"),
        ("t,\x1bc\n0,1\n1,90\n", r"looks like degrees; name the unit in the first line, '\\x1bc \[deg\]' or"),
        ("t\n0\n1\n2\n3\n", r"first line 't' must name the columns"),
        ("t|elbow\n0|1\n", r"first line 't\|elbow' separates columns with '\|': use commas, as in"),
        ("t;elbow\n0;1\n1,5;1,2,3\n", r"position of joint 'elbow' is '1.2.3': it must be a finite .*motion.csv:3\)"),
        ("t [h],elbow\n" + GOOD, r"time is in 'h': it must be in 's', 'ms', 'us', 'ns' \(.*motion.csv:1\)"),
        ("t [ms],elbow\n0,1\n2,1\n1,2\n", r"time 0.001 s must be later than 0.002 s, the one before it \(.*csv:4\)"),
        (
            "t,elbow [grad]\n" + GOOD,
            r"no unit of joint 'elbow' is named 'grad'; there are: 'rad', 'mrad', 'deg', 'rev', 'm', 'mm'",
        ),
        ("t,elbow,elbow\n" + GOOD, r"column 'elbow' must have its own name"),
        ("t,elbow,\n" + GOOD, r"column '' must have its own name"),
        ("t" + ",elbow" * 1000 + "\n", r"first line .* must name the columns"),
        ("t,elbow\n0,1\n1,2,3\n", r"line has 3 cells: it must have 2, as the line of names \(.*motion.csv:3\)"),
        (
            "t,elbow\n0,1\n1,bent\n",
            r"position of joint 'elbow' is 'bent': it must be a finite .*\(.*motion.csv:3\)",
        ),
        ("t,elbow\n0,1\n1,nan\n", r"position of joint 'elbow' is 'nan': it must be a finite number \(.*motion.csv:3\)"),
        ("t,elbow\n0,1\ninf,1\n", r"time is 'inf': it must be a finite number \(.*motion.csv:3\)"),
        ("t,elbow\n1.7e18,1\n", r"time is 1.7e\+18 s: it must be within 1e\+15 s; name .* 't \[ns\]' \(.*csv:2\)"),
        ("t,elbow\n0,1\n\n2,1\n1,2\n", r"time 1.0 s must be later than 2.0 s, the one before it \(.*motion.csv:5\)"),
        (
            "t,elbow\n0,1\n1,90\n",
            r"joint 'elbow': position 90.0 looks like degrees; .*'elbow \[deg\]'.*motion.csv:3",
        ),
        ("t,elbow\n0,1\n1,2\n", r"2 points found: at least 4 are needed \(.*motion.csv\)"),
        ("t,elbow\n", r"0 points found"),
        ("t,elbow\n0," + "1" * 200_000, r"file is not comma-separated UTF-8 text: field larger"),
    ],
)
def test_a_wrong_file_is_refused_at_its_line(tmp_path: Path, text: str, message: str):
    path = tmp_path / "motion.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        from_csv(path)


def test_an_unknown_joint_is_refused_and_the_known_are_listed(tmp_path: Path):
    path = written(tmp_path, "t,a,b,c")
    told = r"no column is named 'wrist', 'elbow'; there are: 'a', 'b', 'c'; name .* or lock .* \(.*motion.csv\)"
    with pytest.raises(InputError, match=told):
        from_csv(path, ["a", "wrist", "elbow"])
    with pytest.raises(InputError, match=r"path must be the path of a file, got None"):
        from_csv(None)  # type: ignore[arg-type]
    for wrong in ("wrist", 3, np.array(3)):
        with pytest.raises(InputError, match=r"joints must be names, such as robot\.joints, got"):
            from_csv(path, joints=wrong)  # type: ignore[arg-type]


def test_a_file_that_is_no_text_is_refused(tmp_path: Path):
    path = tmp_path / "motion.csv"
    path.write_bytes(b"t,a\n\xff\xfe\x00")
    with pytest.raises(InputError, match=r"file is not comma-separated UTF-8 text"):
        from_csv(path)


def test_a_file_too_large_to_read_is_refused(tmp_path: Path):
    path = tmp_path / "motion.csv"
    with path.open("wb") as file:
        file.truncate(csv_file.LARGEST_FILE + 1)
    with pytest.raises(InputError, match=r"file of 200,000,001 bytes is too large: .* \(.*motion.csv\)"):
        from_csv(path)


def test_what_is_no_file_is_refused(tmp_path: Path):
    with pytest.raises(InputError, match=r"motion.csv' does not exist; give the path of a file"):
        from_csv(tmp_path / "motion.csv")
    with pytest.raises(InputError, match=r"is not a regular file; give the path of a file"):
        from_csv(tmp_path)


def test_columns_of_other_joints_may_have_any_unit(tmp_path: Path):
    """Whether a joint slides that nobody asks for, as one of another robot, is not known."""
    path = written(tmp_path, "t,a,b,c [mm]")
    assert from_csv(path, ["a", "b"], sliding=()).joints == ("a", "b")
    with pytest.raises(InputError, match=r"joint 'c' is in 'mm': it turns, so its unit must be one of 'rad', 'mrad',"):
        from_csv(path, ["a", "c"], sliding=())


def test_columns_that_nobody_asks_for_may_hold_anything(tmp_path: Path):
    """As torques, remarks and counts beside the positions, and the cell behind a comma at the end of each line."""
    lines = written(tmp_path, "t,a,b,c").read_text("utf-8").splitlines()
    also = ["tau[1] [N m] x,effort [N m],said,counts,said,", "nan,,bent,90000,-,", *["1,2,straight,90001,-,"] * 100]
    path = tmp_path / "wider.csv"
    path.write_text("\n".join(map(",".join, zip(lines, also, strict=True))) + "\n", "utf-8")
    assert np.array_equal(from_csv(path, ["c", "a"])(TIMES).q, from_samples(TIMES, POSITIONS[:, [2, 0]])(TIMES).q)
    with pytest.raises(InputError, match=r"column 'said' must have its own name \(.*wider.csv:1\)"):
        from_csv(path, ["a", "said"])
    with pytest.raises(InputError, match=r"position of joint 'effort' is '': it must be a finite .*wider.csv:2\)"):
        path.write_text(path.read_text("utf-8").replace("effort [N m]", "effort"), "utf-8")
        from_csv(path, ["effort"])
