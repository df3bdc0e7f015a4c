"""Log files that nobody vouches for."""

import io
import pickle
import zipfile
import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
from machine_logs import positions, times

from cutpoint.errors import InputError
from cutpoint.identification import read_table
from cutpoint.identification.logs import read_mat, read_npz
from cutpoint.identification.logs import table as tables

ENDINGS = (".csv", ".npz", ".mat", ".parquet", ".db3", ".mcap")


class Bomb:
    """What unpickling it would do is seen."""

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return exec, ("raise SystemExit('unpickled')",)


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("content", [b"", b"\x00" * 200, b"PK\x03\x04 no archive", b"\xff\xfe\x89MCAP0\r\n"])
def test_what_is_no_log_is_refused(tmp_path: Path, ending: str, content: bytes):
    path = tmp_path / f"log{ending}"
    path.write_bytes(content)
    with pytest.raises(InputError):
        read_table(path)


@pytest.mark.parametrize("ending", [".npz", ".mat"])
def test_a_log_cut_off_anywhere_is_refused_or_read(tmp_path: Path, ending: str):
    whole = tmp_path / f"whole{ending}"
    content = {"t": times(50), "q": positions(times(50))}
    np.savez(whole, **content) if ending == ".npz" else scipy.io.savemat(whole, content)
    found = whole.read_bytes()
    for length in range(0, len(found), 41):
        path = tmp_path / f"part{ending}"
        path.write_bytes(found[:length])
        try:
            table = read_table(path)
        except InputError:
            continue
        assert set(table.channels) < set(content)


def test_python_objects_are_not_unpickled(tmp_path: Path):
    packed = io.BytesIO()
    np.lib.format.write_array(packed, np.array([Bomb()], dtype=object), allow_pickle=True)
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("q.npy", packed.getvalue())
        archive.writestr("raw.npy", pickle.dumps(Bomb()))
    with pytest.raises(InputError):
        read_table(tmp_path / "log.npz")
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("q.npy", packed.getvalue())
    with pytest.raises(InputError, match=r"log holds no channel of numbers; 'q' holds Python objects"):
        read_npz.read_npz(tmp_path / "log.npz")


def test_an_array_that_promises_more_than_it_holds_is_refused(tmp_path: Path):
    header = io.BytesIO()
    about = {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
    np.lib.format.write_array_header_1_0(header, about)
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("q.npy", header.getvalue())
    with pytest.raises(InputError, match=r"q.npy of type float64 and shape \(1000000000000,\) is larger than its"):
        read_table(tmp_path / "log.npz")


def test_a_file_that_unpacks_to_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    np.savez_compressed(tmp_path / "log.npz", q=np.zeros(10**5))
    scipy.io.savemat(tmp_path / "log.mat", {"q": np.zeros(10**5)}, do_compression=True)
    with h5py.File(tmp_path / "log73.mat", "w", userblock_size=512) as file:
        file.create_dataset("q", (10**5,), "f8", chunks=(100,))
    with (tmp_path / "log73.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file")
    for module in (tables, read_mat):
        monkeypatch.setattr(module, "LARGEST", 10**5)
    for name in ("log.npz", "log.mat", "log73.mat"):
        with pytest.raises(InputError, match=r"too large|more than 100,000 bytes"):
            read_table(tmp_path / name)


def test_a_matlab_file_whose_element_never_ends_is_refused(tmp_path: Path):
    start = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    element = zlib.compress(b"\x0e\x00\x00\x00" + b"\xff" * 1000)
    tag = (15).to_bytes(4, "little") + (2**32 - 1).to_bytes(4, "little")
    (tmp_path / "log.mat").write_bytes(start + tag + element)
    with pytest.raises(InputError, match=r"file is not a MATLAB file that can be read"):
        read_table(tmp_path / "log.mat")


def test_a_log_reads_no_other_file(tmp_path: Path):
    with h5py.File(tmp_path / "secret.h5", "w") as file:
        file["q"] = np.ones(50)
    np.ones(50).tofile(tmp_path / "secret.bin")
    layout = h5py.VirtualLayout((50,), "f8")
    layout[:] = h5py.VirtualSource(str(tmp_path / "secret.h5"), "q", (50,))
    with h5py.File(tmp_path / "log.mat", "w", userblock_size=512) as file:
        file["t"] = np.arange(50.0)
        file["linked"] = h5py.ExternalLink(str(tmp_path / "secret.h5"), "q")
        file["soft"] = h5py.SoftLink("/t")
        file.create_virtual_dataset("virtual", layout)
        file.create_dataset("raw", (50,), "f8", external=[(str(tmp_path / "secret.bin"), 0, 400)])
    with (tmp_path / "log.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file")
    assert list(read_table(tmp_path / "log.mat").channels) == ["t"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "1,2,3\n4,5,6\n",
            r"first line '1, 2, 3' must name the columns, as in 't, q1, q2, tau1, tau2' \(.*log.csv:1\)",
        ),
        ("# a remark\n\nt,q\n0,1\n1\n2,3\n", r"1 cells must be 2, as in the line of names \(.*log.csv:5\)"),
        ("t,q\n0,1\n1,2,3\n", r"3 cells must be 2, as in the line of names \(.*log.csv:3\)"),
        ("t,q,q\n0,1,2\n", r"column 'q' is named twice: each must have a name of its own \(.*log.csv:1\)"),
        (
            "t,q\ns,furlong\n0,1\n1,2\n",
            r"below the names holds 's, furlong': .* 'furlong' is neither; .*\(.*log.csv:2\)",
        ),
        ("t,q\n" + "1" * 200_000 + ",2\n", r"file is not UTF-8 text in columns: field larger"),
    ],
)
def test_a_wrong_text_is_refused_at_its_line(tmp_path: Path, text: str, message: str):
    (tmp_path / "log.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        read_table(tmp_path / "log.csv")


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "latin-1"])
def test_a_text_in_another_encoding_is_refused_with_what_to_save_it_as(tmp_path: Path, encoding: str):
    (tmp_path / "log.csv").write_bytes("t,q1 [°]\n0,1\n1,2\n".encode(encoding))
    with pytest.raises(InputError, match=r"file is not UTF-8 text.* save it as UTF-8"):
        read_table(tmp_path / "log.csv")
