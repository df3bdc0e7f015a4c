"""One log in every format that is read: what comes back is what was written."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
import scipy.io
from machine_logs import JOINTS, positions, recording, times

from cutpoint import Log
from cutpoint.errors import CutpointError, InputError
from cutpoint.identification import read_recording, read_table

T = times(200)
Q, TAU = positions(T), positions(T, 2)


def write_csv(path: Path, delimiter: str = ",", decimal: str = ".") -> None:
    names = ["t [s]", "q1 [rad]", "q2 [rad]", "tau1", "tau2"]
    rows = [[repr(x).replace(".", decimal) for x in row] for row in np.column_stack([T, Q, TAU]).tolist()]
    path.write_text("\n".join(delimiter.join(row) for row in [names, *rows]) + "\n")


def write_npz(path: Path) -> None:
    np.savez(path, t=T, q=Q, tau=TAU.T, label=np.array("a text"))


def write_mat(path: Path) -> None:
    scipy.io.savemat(path, {"t": T, "arm": {"q": Q.T, "tau": TAU, "name": "a text"}}, do_compression=True)


def write_mat_73(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        file["t"] = T[None, :]
        file["arm/q"], file["arm/tau"] = Q.T, TAU.T
        file["#refs#/a"] = np.zeros((3, 4))
        file["elsewhere"] = h5py.ExternalLink("/etc/hostname", "/")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(512))


def write_parquet(path: Path) -> None:
    lists = pyarrow.FixedSizeListArray.from_arrays(pyarrow.array(Q.ravel()), 2)
    nanoseconds = pyarrow.array((1e9 * T).round().astype("int64") + 1_700_000_000 * 10**9, pyarrow.timestamp("ns"))
    words = pyarrow.array(["a text"] * T.size)
    columns = {"time": nanoseconds, "q": lists, "tau1": TAU[:, 0], "tau2": TAU[:, 1], "word": words}
    pyarrow.parquet.write_table(pyarrow.table(columns), path)


WRITERS: dict[str, Callable[[Path], None]] = {
    "log.csv": write_csv,
    "log.npz": write_npz,
    "log.mat": write_mat,
    "log73.mat": write_mat_73,
    "log.parquet": write_parquet,
}


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_gives_the_recording_that_was_written(tmp_path: Path, name: str):
    WRITERS[name](tmp_path / name)
    found = read_recording(tmp_path / name)
    assert np.allclose(found.time, T, rtol=0.0, atol=1e-9)
    assert np.array_equal(found["q"], Q)
    assert np.array_equal(found["torque"], TAU)
    assert found.joints == ("joint_0", "joint_1")


@pytest.mark.parametrize(("delimiter", "decimal"), [(";", ","), (";", "."), ("\t", "."), ("  ", "."), (", ", ".")])
def test_whatever_divides_its_cells_a_text_is_read(tmp_path: Path, delimiter: str, decimal: str):
    if delimiter == "  ":
        (tmp_path / "log.csv").write_text("# made by hand\n\nt  q1  q2\n0  1  2\n1  3  4\n")
        assert np.array_equal(read_table(tmp_path / "log.csv").channels["q2"].values, [2.0, 4.0])
        return
    write_csv(tmp_path / "log.csv", delimiter, decimal)
    assert np.array_equal(read_recording(tmp_path / "log.csv")["q"], Q)


def test_empty_cells_are_unknown_and_columns_of_words_are_left_out(tmp_path: Path):
    (tmp_path / "log.csv").write_text("t,mode,q1,q2\n0,idle,1,\n1,run,nan,4\n2,idle,5,6\n3,7,7,8\n")
    table = read_table(tmp_path / "log.csv")
    assert list(table.channels) == ["t", "q1", "q2"]
    assert np.array_equal(table.channels["q2"].values, [np.nan, 4.0, 6.0, 8.0], equal_nan=True)


@pytest.mark.parametrize("ending", [".npz", ".csv", ".NPZ"])
def test_our_own_logs_are_read_with_their_joints_and_what_their_sensors_said(tmp_path: Path, ending: str):
    channels = {"q": Q, "measured_q": Q + 1e-3, "v": positions(T, 1), "motor_torque": TAU, "power": T}
    units = {"q": "rad", "measured_q": "rad", "v": "rad/s", "motor_torque": "N m", "power": "W"}
    Log(T, channels, units, JOINTS).save(tmp_path / f"run{ending}")
    found = read_recording(tmp_path / f"run{ending}")
    assert found.joints == JOINTS
    assert np.array_equal(found["q"], Q + 1e-3)
    assert np.array_equal(found["torque"], TAU)


def test_a_recording_survives_a_csv_with_names_of_joints(tmp_path: Path):
    made = recording(50)
    names = [f"{channel}.{joint}" for channel in ("q", "velocity", "effort") for joint in JOINTS]
    table = np.column_stack([made.time, made["q"], made["v"], made["torque"]])
    np.savetxt(tmp_path / "log.csv", table, "%.17g", ",", header=",".join(["Time", *names]), comments="")
    found = read_recording(tmp_path / "log.csv")
    assert found.joints == JOINTS
    assert np.array_equal(found["v"], made["v"])
    assert np.array_equal(found["torque"], made["torque"])


def test_titles_in_a_parquet_file_state_units_as_those_of_a_csv_file_do(tmp_path: Path):
    columns = {"t [ms]": 1e3 * T, "q1 [deg]": np.degrees(Q[:, 0]), "q2 (mrad)": 1e3 * Q[:, 1]}
    pyarrow.parquet.write_table(pyarrow.table(columns), tmp_path / "log.parquet")
    table = np.column_stack([*columns.values()])
    np.savetxt(tmp_path / "log.csv", table, "%.17g", ",", header=",".join(columns), comments="")
    found, expected = (read_recording(tmp_path / f"log.{ending}") for ending in ("parquet", "csv"))
    assert np.array_equal(found.time, expected.time) and np.array_equal(found["q"], expected["q"])
    assert np.allclose(expected["q"], Q[:, :2], rtol=1e-12)
    pyarrow.parquet.write_table(pyarrow.table({"t": T, "q [rad]": T, "q [deg]": T}), tmp_path / "twice.parquet")
    with pytest.raises(InputError, match=r"column 'q' occurs twice"):
        read_table(tmp_path / "twice.parquet")


def test_an_unknown_ending_is_refused_and_the_known_are_listed(tmp_path: Path):
    (tmp_path / "log.xls").write_text("")
    with pytest.raises(InputError, match=r"ending '.xls' of 'log.xls' must be one of .csv, .db3, .mat, .mcap, .npz"):
        read_table(tmp_path / "log.xls")


def test_a_format_without_its_library_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    write_parquet(tmp_path / "log.parquet")
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(CutpointError, match=r"a Parquet file needs pyarrow: pip install 'cutpoint\[logs\]'"):
        read_table(tmp_path / "log.parquet")


def test_a_clock_that_was_set_back_is_said_of_its_file(tmp_path: Path):
    file = tmp_path / "set_back.npz"
    np.savez(file, t=np.concatenate([T[:150], T[:50]]), q=Q)
    with pytest.raises(InputError, match=r"time goes back by .* at sample 150: a clock was set back") as caught:
        read_recording(file)
    assert caught.value.place == str(file)
