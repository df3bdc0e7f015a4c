"""Recorded channels of a run."""

import io
import itertools
import json
import os
import re
import sys
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from matplotlib.colors import to_rgb
from matplotlib.image import imread
from matplotlib.text import Text

from cutpoint.control import PD, Guard
from cutpoint.errors import CutpointError, InputError
from cutpoint.simulation import simulate
from cutpoint.simulation.log import files as log_files
from cutpoint.simulation.log.log import Log
from cutpoint.trajectories import cycloid
from robot_library import robot

JOINTS = ("shoulder", "el,bow [x]", "$li_ft^$")
UNITS = {"q": ("rad", "rad", "m"), "q_d": ("rad", "rad", "m"), "torque": "N m", "power": "W", "speed": "rad/s"}
WIDE = ("q", "q_d", "torque", "speed")


def example(count: int = 50, **changes: Any) -> Log:
    time = np.linspace(0.0, 2.0, count)
    channels = {name: np.sin(time[:, None] * np.arange(1, 4) + index) for index, name in enumerate(WIDE)}
    given_here = {"time": time, "channels": channels | {"power": time**2}, "units": UNITS, "joints": JOINTS}
    return Log(**{**given_here, "meta": {"seed": 1}, **changes})


def same(a: Log, b: Log) -> bool:
    return (
        np.array_equal(a.time, b.time)
        and list(a.channels) == list(b.channels)
        and all(np.array_equal(a[name], b[name], equal_nan=True) for name in a.channels)
        and (a.units, a.joints, a.meta) == (b.units, b.joints, b.meta)
    )


def test_a_channel_is_found_by_its_name():
    log = example()
    assert np.array_equal(log["power"], log.time**2)
    assert "power" in log
    assert "colour" not in log


def test_an_unknown_channel_is_refused_and_the_known_are_listed():
    with pytest.raises(InputError, match=r"no channel is named 'p'; there are: 'q', 'q_d', 'torque', 'speed', 'power'"):
        example()["p"]
    with pytest.raises(InputError, match=r"no channel is named 'p'"):
        example().plot("p")


@pytest.mark.parametrize("name", [["q"], 3, None])
def test_a_channel_is_asked_for_by_its_name(name: Any):
    for ask in (example().__getitem__, example().plot, example().columns):
        with pytest.raises(InputError, match=r"log: channel must be a name, such as 'q', got"):
            ask(name)


def test_rms_and_max_are_per_joint():
    log = example()
    assert np.allclose(log.rms("q"), np.linalg.norm(log["q"], axis=0) / np.sqrt(50), rtol=1e-14)
    assert log.max("power") == 4.0
    down = example(channels={"q": np.column_stack([-np.arange(50.0), np.zeros(50), np.arange(50.0)])})
    assert down.max("q").tolist() == [49.0, 0.0, 49.0]
    assert log.rms("power").shape == ()


def test_between_keeps_both_ends():
    log = example(5).between(0.5, 1.5)
    assert log.time.tolist() == [0.5, 1.0, 1.5]
    assert np.array_equal(log["q"], example(5)["q"][1:4])
    assert same(log.between(-9.0, 9.0), log)
    with pytest.raises(InputError, match=r"no samples from 3.0 s to 4.0 s: the log runs from 0.5 s to 1.5 s"):
        log.between(3.0, 4.0)


def test_nobody_changes_what_was_recorded():
    values = np.zeros((50, 3))
    log = example(channels={"q": values})
    values[0, 0] = 1.0
    assert not log["q"].any()
    with pytest.raises(ValueError, match="read-only"):
        log["q"][0, 0] = 1.0


def test_a_trajectory_of_ones_own_keeps_its_array():
    class Held:
        size, duration, table = 6, 0.01, np.zeros((5, 11, 6))

        def derivatives(self, t: Any, highest: int = 4) -> Any:
            return self.table

    move: Any = Held()
    log = simulate(robot("xia2019"), None, move)
    move.table[0] = 1.0
    assert not log["reference_q"].any()


def test_it_says_what_it_holds():
    assert repr(example()).startswith("Log(50 samples from 0 s to 2 s: q [rad or m]")


def test_it_says_that_its_law_has_found_a_fault():
    arm = robot("xia2019")
    law = Guard(arm, PD(kp=[1000.0] * 6, kd=[30.0] * 6, side="motor"), speed_limit=0.5)
    told = repr(simulate(arm, law, cycloid(np.full(6, 1.0), 0.5), channels=("fault",)))
    assert re.match(r"Log\(501 samples from 0 s to 0.5 s, with fault 4 \(speed\) from 0\.\d+ s on: ", told)
    log = example()
    own = replace(
        log, channels={**log.channels, "fault": np.linspace(0.0, 40.0, 50) // 20}, units={**log.units, "fault": ""}
    )
    assert "with fault 1 (measurement) from" in repr(own)
    unknown = replace(own, channels={**own.channels, "fault": np.full(50, 99.0)})
    assert "with fault 99 from 0 s on" in repr(unknown)


@pytest.mark.parametrize("ending", ["npz", "csv"])
@given(data=st.data())
def test_a_file_gives_back_every_number_exactly(ending: str, data: st.DataObject):
    names = st.text(st.characters(exclude_categories=["Cs"]), min_size=1)
    joints = data.draw(st.lists(names, unique=True, max_size=3))
    time = np.cumsum(data.draw(hnp.arrays(float, st.integers(1, 6), elements=st.floats(1e-6, 1e3))))
    wide = data.draw(hnp.arrays(float, (time.size, len(joints))))
    alone = data.draw(hnp.arrays(float, time.size))
    meta = {"note": data.draw(st.text()), "gains": [1.0, None], "deep": {"a": True}}
    units = {
        "wide": tuple("rad" for _ in joints),
        "alone": data.draw(st.text(st.characters(exclude_categories=["Cs"]))),
    }
    log = Log(time, {"wide": wide, "alone": alone}, units, tuple(joints), meta)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"run.{ending}"
        log.save(path)
        assert same(Log.load(path), log)


def test_an_npz_is_plain_for_numpy(tmp_path: Path):
    example().save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as arrays:
        assert np.array_equal(arrays["q"], example()["q"])
        assert np.array_equal(arrays["time"], example().time)


def test_a_csv_names_joints_and_units_in_its_second_line(tmp_path: Path):
    example().save(tmp_path / "run.csv")
    header, titles, first, *_ = (tmp_path / "run.csv").read_text().splitlines()
    assert json.loads(header.removeprefix("# "))["meta"] == {"seed": 1}
    assert titles.startswith('"time [s]","q.shoulder [rad]","q.el,bow [x] [rad]","q.$li_ft^$ [m]","q_d.shoulder [rad]"')
    assert first.startswith("0.0,0.0,0.0,0.0,0.8414709848078965,")


@pytest.mark.parametrize("ending", ["npz", "csv"])
def test_a_save_that_fails_leaves_what_was_there(tmp_path: Path, ending: str, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / f"run.{ending}"
    example().save(path)
    monkeypatch.setattr(log_files, "LARGEST_FILE", 10)
    with pytest.raises(InputError, match=r"log of [\d,]+ bytes is more than a file may hold, 10: save parts of it"):
        example(99).save(path)
    monkeypatch.undo()
    assert os.listdir(tmp_path) == [path.name]
    assert same(Log.load(path), example())


def test_a_save_has_the_rights_of_any_new_file(tmp_path: Path):
    (tmp_path / "other").touch()
    example().save(tmp_path / "run.npz")
    assert (tmp_path / "run.npz").stat().st_mode == (tmp_path / "other").stat().st_mode


def test_a_meta_too_long_for_a_file_is_refused(tmp_path: Path):
    with pytest.raises(InputError, match=r"meta of 1,000,\d+ characters is too long for a file"):
        example(meta={"note": "x" * 1_000_000}).save(tmp_path / "run.csv")


@pytest.mark.parametrize("name", ["run.txt", "run"])
def test_another_ending_is_refused(tmp_path: Path, name: str):
    with pytest.raises(InputError, match=rf"ending '.*' of '{name}' must be one of .npz, .csv"):
        example().save(tmp_path / name)
    with pytest.raises(InputError, match=rf"ending '.*' of '{name}' must be one of .npz, .csv"):
        Log.load(tmp_path / name)


def test_a_table_has_a_column_per_joint_and_channel():
    table = example().to_dataframe()
    assert table.index.name == "time"
    assert list(table.columns[:3]) == ["q.shoulder", "q.el,bow [x]", "q.$li_ft^$"]
    assert np.array_equal(table["q.$li_ft^$"], example()["q"][:, 2])
    assert np.array_equal(table["power"], example()["power"])
    assert table.attrs["units"]["q.$li_ft^$"] == "m"
    assert table.attrs["meta"] == {"seed": 1}


def test_a_table_without_pandas_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(CutpointError, match=r"to_dataframe needs pandas: pip install 'cutpoint\[pandas\]'"):
        example().to_dataframe()


def test_a_plot_has_an_axis_for_each_channel_and_degrees_for_angles():
    figure = example().plot()
    titles = [axis.get_title(loc="left") for axis in figure.axes]
    assert titles == ["q [deg]", "q [mm]", "q_d [deg]", "q_d [mm]", "torque [N m]", "speed [deg/s]", "power [W]"]
    shown = figure.axes[0].lines[1].get_ydata()
    assert np.allclose(np.asarray(shown), np.rad2deg(example()["q"][:, 1]), rtol=1e-12)
    assert np.array_equal(np.asarray(figure.axes[1].lines[0].get_ydata()), 1e3 * example()["q"][:, 2])


def test_rounding_fills_no_axis():
    still = Log([0.0, 1.0], {"q": [[1e-30], [3e-30]]}, {"q": "rad"}, ("joint",))
    low, high = still.plot().axes[0].get_ylim()
    assert low < 0.0 < high and high - low > 1e-10


def test_a_plot_of_named_channels_has_an_axis_for_each_joint_and_unit():
    figure = example().plot("q", "torque", "q_d", "power")
    titles = [axis.get_title(loc="left") for axis in figure.axes]
    assert titles[:3] == ["shoulder [deg]", "el,bow [x] [deg]", "$li_ft^$ [mm]"]
    assert titles[3:] == ["shoulder [N m]", "el,bow [x] [N m]", "$li_ft^$ [N m]", "power [W]"]
    assert [len(axis.lines) for axis in figure.axes] == [2, 2, 2, 1, 1, 1, 1]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["q", "torque", "q_d", "power"]


def test_errors_have_axes_apart_from_positions_which_would_flatten_them():
    q = np.linspace(0.0, 1.0, 5)[:, None]
    log = Log(
        np.arange(5.0),
        {"q": q, "q_d": q, "position_error": 1e-4 * q},
        dict.fromkeys(("q", "q_d", "position_error"), "rad"),
        ("joint",),
    )
    positions, errors = log.plot("q", "position_error", "q_d").axes
    assert (len(positions.lines), len(errors.lines)) == (2, 1)
    assert errors.get_ylim()[1] < np.degrees(2e-4)


def test_a_plot_has_the_named_channels_of_other_logs_over_their_own_times():
    log = example()
    longer = Log([0.0, 9.0], {"q": np.ones((2, 3))}, {"q": log.units["q"]}, log.joints)
    figure = log.plot("q", beside={"longer": longer})
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["this log", "longer"] and len(figure.axes) == 3
    named = log.plot("q", label="shorter", beside={"longer": longer})
    assert [text.get_text() for text in named.legends[0].get_texts()] == ["shorter", "longer"]
    own, other = figure.axes[0].lines
    assert own.get_xdata()[-1] == log.time[-1] and other.get_xdata()[-1] == 9.0
    assert own.get_color() != other.get_color()
    together = log.plot("q", "q_d", beside={"other": log}).legends[0].get_texts()
    assert [text.get_text() for text in together] == ["q", "q_d", "other: q", "other: q_d"]


def test_axes_of_one_channel_each_are_named_after_it_and_a_log_has_one_colour():
    alone, beside = example().plot("q", "torque"), example().plot("q", "torque", beside={"other": example()})
    titles = [axis.get_title(loc="left") for axis in beside.axes]
    assert [titles[0], titles[3]] == ["shoulder: q [deg]", "shoulder: torque [N m]"] and not alone.legends
    assert len({tuple(line.get_color() for line in axis.lines) for axis in beside.axes}) == 1


@pytest.mark.parametrize(
    ("names", "beside", "message"),
    [
        ((), {"other": example()}, "name the channels of logs side by side"),
        (("q",), {"": example()}, "a name in beside is empty"),
        (("q",), example(), "beside must be logs by name, such as"),
        (("q",), {"other": 3}, r"beside\['other'\] must be a log, got 3"),
        (("q",), {1: example()}, "each name in beside must be a text for the legend, got 1"),
        (("q_d",), {"other": Log([0.0], {}, {}, ("joint",))}, "no channel is named 'q_d'"),
    ],
)
def test_what_cannot_be_drawn_beside_a_log_is_refused(names: tuple[str, ...], beside: Any, message: str):
    with pytest.raises(InputError, match=message):
        example().plot(*names, beside=beside)


def test_channels_of_one_kind_stand_in_rows_of_their_own():
    joints = ("a", "b", "c", "d")
    q, torque = np.zeros((2, 4)), np.ones((2, 4))
    log = Log(np.arange(2.0), {"q": q, "torque": torque}, {"q": ("rad", "rad", "m", "rad"), "torque": "N m"}, joints)
    cells = [
        (spec.rowspan.start, spec.colspan.start)
        for axis in log.plot("q", "torque").axes
        if (spec := axis.get_subplotspec())
    ]
    assert cells == [(row, column) for row in range(4) for column in range(2)]
    far = Log(np.arange(2.0), {"q": 2.0 + q, "q_error": 1e-4 + q}, {"q": "m", "q_error": "m"}, joints)
    assert [axis.get_title(loc="left") for axis in far.plot().axes] == ["q [m]", "q_error [mm]"]


def test_the_legend_lies_within_the_picture_and_reads_row_by_row_whatever_the_joints_are_called():
    for count, length in ((1, 90), (9, 36), (30, 10)):
        joints = tuple(f"_{k}".ljust(length, "m") for k in range(count))
        log = Log(np.arange(2.0), {"q": np.zeros((2, count))}, {"q": "rad"}, joints)
        figure = log.plot()
        figure.canvas.draw()
        (legend,), whole = figure.legends, figure.bbox
        places = {text.get_text(): text.get_window_extent() for text in legend.get_texts()}
        assert sorted(places, key=lambda name: (-round(places[name].y0), places[name].x0)) == [*joints]
        box = legend.get_window_extent()
        assert whole.x0 <= box.x0 and box.x1 <= whole.x1 and whole.y0 <= box.y0 and box.y1 <= whole.y1
        # rows of names take nothing from the axes
        assert figure.axes[0].bbox.height > 1.2 * figure.dpi


def test_titles_of_long_names_do_not_reach_into_the_next_axis():
    joints = tuple(f"right_shoulder_pitch_and_roll_joint_{k}" for k in range(3))
    figure = Log(np.arange(2.0), {"position_error": np.zeros((2, 3))}, {"position_error": "rad"}, joints).plot(
        "position_error"
    )
    figure.canvas.draw()
    titles = [
        text.get_window_extent()
        for axis in figure.axes
        for text in axis.findobj(lambda each: isinstance(each, Text) and "position_error" in each.get_text())
    ]
    assert len(titles) == 3
    assert all(left.x1 < right.x0 for left, right in itertools.pairwise(titles)) and titles[-1].x1 < figure.bbox.x1


def test_all_axes_show_all_of_the_time_also_where_a_channel_ends_early():
    q, torque = np.zeros((5, 1)), np.where(np.arange(5) < 2, 1.0, np.nan)[:, None]
    log = Log(1.7e9 + np.arange(5.0), {"q": q, "torque": torque}, {"q": "rad", "torque": "N m"}, ("joint",))
    figure = log.plot()
    figure.canvas.draw()
    for axis in figure.axes:
        assert axis.get_xlim() == (log.time[0], log.time[-1])
        # times of a clock are long: what they have in common stands apart
        assert all(len(label.get_text()) < 4 for label in axis.get_xticklabels())


def test_a_single_sample_is_seen():
    image = io.BytesIO()
    Log([0.0], {"q": [[0.5]]}, {"q": "rad"}, ("joint",)).plot("q").savefig(image, format="png")
    blue = imread(io.BytesIO(image.getvalue()))[..., :3] @ [-1.0, 0.0, 1.0] > 0.4
    assert blue.any()


def test_the_legend_draws_each_channel_as_its_curve_is_drawn():
    figure = example().plot("q", "torque", "q_d")
    shown = [(line.get_color(), line.get_linestyle()) for line in figure.legends[0].get_lines()]
    (q, q_d), torque = figure.axes[0].lines, figure.axes[3].lines[0]
    assert shown == [(line.get_color(), line.get_linestyle()) for line in (q, torque, q_d)]
    assert [style for _, style in shown] == ["-", "-", "--"]


def test_rows_of_the_legend_are_about_the_same_length():
    joints, three = tuple(f"shoulder_lift_joint_{k}" for k in range(6)), ("q", "v", "a")
    log = Log(np.arange(2.0), dict.fromkeys(three, np.zeros((2, 6))), dict.fromkeys(three, "rad"), joints)
    (legend,) = log.plot().legends
    heights = [round(text.get_window_extent().y0) for text in legend.get_texts()]
    assert sorted(map(heights.count, {*heights})) == [3, 3]


def test_the_label_of_a_log_is_a_text_of_its_own():
    with pytest.raises(InputError, match="plot: label 'PD' is also the name of a log beside; give each its own"):
        example().plot("q", label="PD", beside={"PD": example()})
    with pytest.raises(InputError, match="plot: label must be a text for the legend, got 3"):
        example().plot("q", label=3)  # pyright: ignore[reportArgumentType]


def test_of_lines_that_cover_each_other_all_are_seen():
    log = example()
    figure = log.plot("q", beside=dict.fromkeys(("first", "second", "third"), log))
    assert [line.get_linestyle() for line in figure.axes[0].lines] == ["-", "--", "-.", ":"]
    image = io.BytesIO()
    figure.savefig(image, format="png")
    seen = imread(io.BytesIO(image.getvalue()))[..., :3].reshape(-1, 3)
    for line in figure.axes[0].lines:
        assert (np.abs(seen - to_rgb(line.get_color())).max(axis=1) < 0.02).sum() > 300


@pytest.mark.parametrize("names", [(), ("q", "power"), ("power",)])
def test_a_plot_can_be_saved_whatever_the_joints_are_called(tmp_path: Path, names: tuple[str, ...]):
    example().plot(*names).savefig(tmp_path / "run.png")
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_many_joints_have_lines_that_differ():
    joints = tuple(f"joint{k}" for k in range(40))
    log = Log(np.arange(2.0), {"q": np.zeros((2, 40))}, {"q": "rad"}, joints)
    (axis,) = log.plot().axes
    assert len({(line.get_color(), line.get_linestyle()) for line in axis.lines}) == 40
    # curves of joints that move alike cover each other: dashes on them would show the wrong colour between
    assert len({line.get_color() for line in axis.lines}) == 20


def test_what_no_sensor_told_has_no_axis():
    channels = {"q": example()["q"].copy(), "torque": np.full((50, 3), np.nan), "speed": example()["speed"]}
    channels["q"][:, 1] = np.nan
    log = example(channels=channels)
    titles = [axis.get_title(loc="left") for axis in log.plot().axes]
    assert titles == ["q [deg]", "q [mm]", "speed [deg/s]"]
    named = [axis.get_title(loc="left") for axis in log.plot("q", "torque").axes]
    assert named == ["shoulder: q [deg]", "$li_ft^$: q [mm]"]
    with pytest.raises(InputError, match="no channels to plot, or only NaN in them"):
        log.plot("torque")


def test_a_log_without_channels_has_nothing_to_plot():
    with pytest.raises(InputError, match="the log has no channels to plot"):
        example(channels={}).plot()


COUNT = np.zeros(50)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"time": []}, r"time of shape \(0,\) must be \(N,\), N at least 1, finite and increasing"),
        ({"time": COUNT}, r"time of shape \(50,\) must be"),
        ({"time": [[0.0]]}, r"time of shape \(1, 1\) must be"),
        ({"time": np.arange(50.0) * np.nan}, r"time of shape \(50,\) must be"),
        ({"channels": {"q": np.zeros((50, 2))}}, r"channel 'q' has shape \(50, 2\): it must be \(50,\) or \(50, 3\)"),
        ({"channels": {"q": np.zeros((49, 3))}}, r"channel 'q' has shape \(49, 3\)"),
        ({"channels": {"a b": COUNT}}, r"channel 'a b' must be named like a variable"),
        ({"channels": {"../q": COUNT}}, r"channel '../q' must be named like a variable"),
        ({"channels": {"time": COUNT}}, r"channel 'time' must be named like a variable, and not one of"),
        ({"channels": {"u": COUNT}}, r"channel 'u' has no unit: units must name every channel; '' means none"),
        (
            {"units": UNITS | {"q": ("rad",)}},
            r"channel 'q' has units \('rad',\): it must have one, or one for each of 3",
        ),
        ({"units": UNITS | {"q": (1, 2, 3)}}, r"channel 'q' has units \(1, 2, 3\)"),
        ({"joints": ("a", "a", "b")}, r"joints \('a', 'a', 'b'\) must be distinct names"),
        ({"joints": ("a", "", "b")}, r"joints \('a', '', 'b'\) must be distinct names"),
        ({"joints": (1, 2, 3)}, r"joints must be names, .*, got \(1, 2, 3\)"),
        ({"meta": {"robot": object()}}, r"meta must be JSON: numbers"),
    ],
)
def test_what_cannot_be_a_log_is_refused(changes: dict[str, Any], message: str):
    with pytest.raises(InputError, match=message):
        example(**changes)


def header(**changes: Any) -> str:
    return json.dumps({"cutpoint_log": 1, "joints": ["a"], "units": {"q": "rad"}, "meta": {}, **changes})


GOOD = {"header": np.array(header()), "time": np.arange(3.0), "q": np.zeros((3, 1))}


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"header": None}, "There is no item named 'header.npy'"),
        ({"q": None}, "There is no item named 'q.npy'"),
        ({"q": np.zeros((2, 1))}, r"channel 'q' has shape \(2, 1\)"),
        ({"q": np.array([["a"]] * 3)}, "q is of type <U1, not float64"),
        ({"q": np.zeros((3, 1), dtype=complex)}, "q is of type complex128"),
        ({"header": np.zeros(3)}, "header is of type float64"),
        ({"header": np.array("{")}, "Expecting property name"),
        ({"header": np.array("[1]")}, "its version is None, not 1"),
        ({"header": np.array("{}")}, "cutpoint_log"),
        ({"header": np.array("[" * 100_000)}, "recursion"),
        ({"header": np.array(header(cutpoint_log=2))}, "its version is 2, not 1"),
        ({"header": np.array(header(units=["q"]))}, "units must be the unit of every channel"),
        ({"q": np.zeros((3, 1), dtype=int)}, "q is of type int64, not float64"),
        ({"header": np.array(header(joints=7))}, "its joints are 7, not a list of names"),
        ({"header": np.array(header(joints="a"))}, "its joints are 'a', not a list of names"),
        ({"header": np.array(header(joints=[7]))}, "joints must be names"),
        ({"header": np.array(header(meta=7))}, "not iterable"),
        ({"header": np.array([header()] * 2)}, "can only convert an array of size 1"),
    ],
)
def test_an_npz_that_is_no_log_is_refused(tmp_path: Path, arrays: dict[str, Any], message: str):
    path = tmp_path / "run.npz"
    np.savez(path, **{name: values for name, values in (GOOD | arrays).items() if values is not None})
    with pytest.raises(InputError, match=rf"file is not a log written by Log.save: .*{message}.*\(.*run.npz\)"):
        Log.load(path)


def test_an_npz_is_never_unpickled(tmp_path: Path):
    path = tmp_path / "run.npz"
    np.savez(path, **(GOOD | {"q": np.array([print, {}, []], dtype=object)}))  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match=r"q is of type object"):
        Log.load(path)


def crafted(path: Path, shape: str, version: bytes = b"\x01\x00") -> Path:
    """An archive whose channel announces another shape than it has."""
    np.savez(path, **{name: values for name, values in GOOD.items() if name != "q"})
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}".ljust(117) + "\n"
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("q.npy", b"\x93NUMPY" + version + len(text).to_bytes(2, "little") + text.encode() + bytes(24))
    return path


@pytest.mark.parametrize("shape", ["(4, 10)", f"({10**7}, 1)", f"({10**15}, 1)", f"({10**15}, {10**15})"])
def test_an_npz_that_announces_more_than_it_holds_is_refused(tmp_path: Path, shape: str):
    with pytest.raises(InputError, match=r"q is of type float64 and shape .*, more than its 152 bytes hold"):
        Log.load(crafted(tmp_path / "run.npz", shape))


@pytest.mark.parametrize("shape", ["(2, 1)", "(-3, 1)", "(3,", "(0, 10)", "print()", "(10**15, 1)"])
def test_an_npz_that_announces_a_wrong_shape_is_refused(tmp_path: Path, shape: str):
    with pytest.raises(InputError, match=r"file is not a log written by Log.save"):
        Log.load(crafted(tmp_path / "run.npz", shape))


def test_an_npz_of_another_format_version_is_refused(tmp_path: Path):
    with pytest.raises(InputError, match=r"q is not in version 1.0 of the format"):
        Log.load(crafted(tmp_path / "run.npz", "(3, 1)", version=b"\x09\x00"))


def test_an_npz_that_unpacks_to_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "run.npz"
    np.savez_compressed(path, **(GOOD | {"q": np.zeros((100_000, 1))}))  # pyright: ignore[reportArgumentType]
    monkeypatch.setattr(log_files, "LARGEST_FILE", 100_000)
    with pytest.raises(InputError, match=r"its arrays are larger than 100,000 bytes"):
        Log.load(path)


def test_a_csv_whose_short_cells_are_too_many_numbers_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path, joints = tmp_path / "run.csv", [f"j{k}" for k in range(20)]
    titles = ",".join(["time [s]", *(f"q.{joint} [rad]" for joint in joints)])
    rows = "".join(f"{k}{',0' * 20}\n" for k in range(100))
    path.write_text(f"# {header(joints=joints)}\n{titles}\n{rows}")
    monkeypatch.setattr(log_files, "LARGEST_FILE", path.stat().st_size)
    with pytest.raises(InputError, match=r"its channels are larger than [\d,]+ bytes"):
        Log.load(path)


@pytest.mark.parametrize("ending", ["npz", "csv"])
@given(place=st.floats(0.0, 1.0, exclude_max=True), byte=st.integers(0, 255))
def test_a_file_with_a_wrong_byte_gives_a_log_or_one_clear_error(ending: str, place: float, byte: int):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"run.{ending}"
        example(3).save(path)
        content = bytearray(path.read_bytes())
        content[int(place * len(content))] = byte
        path.write_bytes(content)
        try:
            assert isinstance(Log.load(path), Log)
        except InputError as error:
            assert "file is not a log written by Log.save" in str(error)


@pytest.mark.parametrize("keep", [0.0, 0.3, 0.9])
def test_an_npz_cut_short_is_refused(tmp_path: Path, keep: float):
    path = tmp_path / "run.npz"
    example().save(path)
    content = path.read_bytes()
    path.write_bytes(content[: int(keep * len(content))])
    with pytest.raises(InputError, match=r"file is not a log written by Log.save: .*\(.*run.npz\)"):
        Log.load(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "its first line must be '# {\"cutpoint_log\": 1, ...}'; read other logs with read_table"),
        ("time,q\n0,1\n", "its first line must be"),
        (f"# {header()[:9]}", "line 1 has no end: the file was cut off"),
        (f"# {header()}\n", "its columns are not those its first line announces"),
        (f"# {header()}\ntime [s]\n0\n", "its columns are not those its first line announces"),
        (f"# {header()}\ntime [s],q.a [rad]\n", r"time of shape \(0,\)"),
        (
            f"# {header()}\ntime [s],q.a [rad]\n0,1,2,3\n",
            "line 3 has 4 cells, but must have 2 like the line of titles; copy",
        ),
        (
            f"# {header()}\ntime [s],q.a [rad]\n0,1\n1\n",
            "line 4 has 1 cell, but must have 2 like the line of titles; copy",
        ),
        (f"# {header()}\ntime [s],q.a [rad]\n0,1\n1,0.2", "line 4 has no end: the file was cut off; copy"),
        (f"# {header()}\ntime [s],q.a [rad]\n0,b\n", "line 3: could not convert string to float: 'b'"),
        (f"# {header()}\ntime [s],q.a [rad]\n0,1_0\n", "line 3: '1_0' is not a number"),
        (f"# {header()}\ntime [s],q.a [rad]\n1,0\n0,0\n", r"time of shape \(2,\) must be"),
        (f"# {header()}\ntime [s],q.b [rad]\n0,1\n", "its columns are not those its first line announces"),
        (f"# {header()}\ntime [s],q.a [deg]\n0,1\n", "its columns are not those its first line announces"),
        (f"# {header(joints=['a', 'b'])}\ntime [s],q.a [rad]\n0,1\n", "its columns are not those its first line"),
    ],
)
def test_a_csv_that_is_no_log_is_refused(tmp_path: Path, text: str, message: str):
    path = tmp_path / "run.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=rf"file is not a log written by Log.save: .*{message}.*\(.*run.csv\)"):
        Log.load(path)


@pytest.mark.parametrize("ending", ["NPZ", "Csv"])
def test_endings_may_be_in_capitals(tmp_path: Path, ending: str):
    path = tmp_path / f"run.{ending}"
    example().save(path)
    assert same(Log.load(path), example())


@pytest.mark.parametrize("ending", ["npz", "csv"])
def test_a_log_without_joints_comes_back(tmp_path: Path, ending: str):
    bare = Log(np.arange(3.0), {"q": np.zeros((3, 0)), "power": np.arange(3.0)}, {"q": "rad", "power": "W"}, ())
    bare.save(tmp_path / f"run.{ending}")
    assert same(Log.load(tmp_path / f"run.{ending}"), bare)


@pytest.mark.parametrize(("ending", "largest"), [("npz", 100), ("csv", 100), ("csv", 80_000)])
def test_a_log_too_large_for_a_file_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ending: str, largest: int
):
    """Before it is written; one whose text alone is too long, soon."""
    long = Log(np.arange(9000.0) / 3, {"power": np.arange(9000.0) / 7}, {"power": "W"}, ())
    monkeypatch.setattr(log_files, "LARGEST_FILE", largest)
    with pytest.raises(InputError, match=r"is more than a file may hold, .*: save parts of it, log.between"):
        long.save(tmp_path / f"run.{ending}")
    assert not [*tmp_path.iterdir()]
