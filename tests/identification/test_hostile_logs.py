"""Log files that nobody vouches for."""

import io
import pickle
import warnings
import zipfile
import zlib
from pathlib import Path

import h5py
import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
import scipy.io
from machine_logs import positions, times

from cutpoint.errors import InputError
from cutpoint.identification import read_recording, read_table
from cutpoint.identification.logs import mat_nesting, read_mat, read_npz
from cutpoint.identification.logs import table as tables

REFUSED = {
    ".csv": "file holds no line that names the columns|file is not UTF-8 text|file holds 0 samples",
    ".npz": "file is not a readable archive of NumPy arrays",
    ".mat": "file is not a readable MATLAB file",
    ".parquet": "file is not a readable Parquet file",
    ".db3": "file is not a readable ROS 2 bag",
    ".mcap": "file is not a readable ROS 2 bag",
}
"""What is said of a file that only its ending makes a log."""


class Bomb:
    """What unpickling it would do is seen."""

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return exec, ("raise SystemExit('unpickled')",)


@pytest.mark.parametrize("ending", REFUSED)
@pytest.mark.parametrize("content", [b"", b"\x00" * 200, b"PK\x03\x04 no archive", b"\xff\xfe\x89MCAP0\r\n"])
def test_what_is_no_log_is_refused(tmp_path: Path, ending: str, content: bytes):
    path = tmp_path / f"log{ending}"
    path.write_bytes(content)
    with pytest.raises(InputError, match=REFUSED[ending]):
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
    with pytest.raises(InputError, match="file is not a readable archive of NumPy arrays: the magic string"):
        read_table(tmp_path / "log.npz")
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("q.npy", packed.getvalue())
    with pytest.raises(InputError, match=r"log holds no channel of numbers; 'q' holds Python objects"):
        read_npz.read_npz(tmp_path / "log.npz")


def test_a_type_in_a_parquet_file_is_not_unpickled(tmp_path: Path):
    kind = {"ARROW:extension:name": "arrow.py_extension_type", "ARROW:extension:metadata": pickle.dumps(Bomb(), 0)}
    fields = pyarrow.field("t", pyarrow.float64()), pyarrow.field("q", pyarrow.float64(), metadata=kind)
    columns = pyarrow.table([[0.0, 1.0], [0.0, 1.0]], schema=pyarrow.schema(fields))
    pyarrow.parquet.write_table(columns, tmp_path / "log.parquet")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the oldest pyarrow that refuses
        assert "t" in read_table(tmp_path / "log.parquet").channels


def test_an_array_that_promises_more_than_it_holds_is_refused(tmp_path: Path):
    header = io.BytesIO()
    about = {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
    np.lib.format.write_array_header_1_0(header, about)
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        archive.writestr("q.npy", header.getvalue())
    with pytest.raises(InputError, match=r"q.npy of type float64 and shape \(1000000000000,\) is larger than its"):
        read_table(tmp_path / "log.npz")


def test_two_arrays_of_one_name_are_refused(tmp_path: Path):
    """Each entry would be read as the last one, however large that is."""
    with zipfile.ZipFile(tmp_path / "log.npz", "w") as archive:
        for _ in range(2):
            packed = io.BytesIO()
            np.lib.format.write_array(packed, times(50))
            with warnings.catch_warnings(action="ignore"):
                archive.writestr("q.npy", packed.getvalue())
    with pytest.raises(InputError, match=r"readable archive of NumPy arrays: it holds two arrays of the same name"):
        read_table(tmp_path / "log.npz")


def test_a_path_that_the_system_refuses_is_told(tmp_path: Path):
    for path in (tmp_path / f"{'a' * 300}.csv", tmp_path / f"{'a' * 300}.npz"):
        with pytest.raises(InputError, match=r"cannot be read \(File name too long\); give another path"):
            read_table(path)


def test_columns_of_empty_lists_are_no_channels(tmp_path: Path):
    lists = pyarrow.array([[], [], []], pyarrow.list_(pyarrow.float64()))
    pyarrow.parquet.write_table(pyarrow.table({"t": [0.0, 1.0, 2.0], "q": lists}), tmp_path / "log.parquet")
    assert list(read_table(tmp_path / "log.parquet").channels) == ["t"]


def test_an_underscore_makes_a_cell_a_word(tmp_path: Path):
    (tmp_path / "log.csv").write_text("t,q\n0,1_0\n1,2\n2,3\n")
    table = read_table(tmp_path / "log.csv")
    assert np.isnan(table.channels["q"].values[0]) and "such as '1_0', counts as missing" in table.notes[0]


def damaged_npz(path: Path, damage: str) -> None:
    """An archive with a header as ours, in which single bytes were changed."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, values in (("header", np.array('{"cutpoint_log": 1}')), ("time", times(50))):
            packed = io.BytesIO()
            np.lib.format.write_array(packed, values)
            archive.writestr(f"{name}.npy", packed.getvalue())
    content = bytearray(path.read_bytes())
    local, central, end = (content.find(sign) for sign in (b"PK\x03\x04", b"PK\x01\x02", b"PK\x05\x06"))
    changes = {
        "checksum": {content.find(b"NUMPY") + 40: 0},
        "encrypted": {local + 6: 1, central + 8: 1},
        "packing": {local + 8: 97, central + 10: 97},
        "LZMA": {local + 8: 14, central + 10: 14},
        "member": {local: 0},
        "directory": {central: 0},
        "offset": {end + 18: 0xFF},
    }
    for place, byte in changes[damage].items():
        content[place] = byte
    path.write_bytes(content)


@pytest.mark.parametrize("damage", ["checksum", "encrypted", "packing", "LZMA", "member", "directory", "offset"])
def test_a_damaged_or_encrypted_archive_is_refused(tmp_path: Path, damage: str):
    damaged_npz(tmp_path / "log.npz", damage)
    with pytest.raises(InputError, match=r"file is not a readable archive of NumPy arrays: .*; copy it again"):
        read_table(tmp_path / "log.npz")


def element(kind: int, content: bytes) -> bytes:
    """Of a MATLAB file."""
    return kind.to_bytes(4, "little") + len(content).to_bytes(4, "little") + content + bytes(-len(content) % 8)


def nested_mat(path: Path, depth: int, size: int | None) -> None:
    """A number in cells in cells, each of which says to be of that size, or of its own; plain, and packed."""
    flags, shape, name = element(6, bytes([1, *bytes(7)])), element(5, b"\1\0\0\0\1\0\0\0"), element(1, b"q")
    head = flags + shape + element(1, b"")
    inner = element(14, element(6, bytes([6, *bytes(7)])) + shape + element(1, b"") + element(9, bytes(8)))
    for _ in range(depth):
        content = head + inner
        inner = (14).to_bytes(4, "little") + (size or len(content)).to_bytes(4, "little") + content
    whole = element(14, flags + shape + name + inner)
    start = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    path.write_bytes(start + whole)
    path.with_suffix(".packed.mat").write_bytes(start + element(15, zlib.compress(whole)))


@pytest.mark.parametrize("size", [None, 1])
def test_a_matlab_file_of_cells_in_cells_is_refused_before_they_are_read(tmp_path: Path, size: int | None):
    nested_mat(tmp_path / "log.mat", 50, size=None)
    with pytest.raises(InputError, match=r"log holds no channel of numbers"):
        read_table(tmp_path / "log.mat")
    nested_mat(tmp_path / "log.mat", 1000, size)
    for name in ("log.mat", "log.packed.mat"):
        with pytest.raises(InputError, match=r"its arrays nest deeper than 100, .*; save only the matrices of numbers"):
            read_table(tmp_path / name)


@pytest.mark.parametrize(
    ("shape", "rest", "message"),
    [
        (bytes([255]) * 160_000, b"", r"one of its arrays has more than 32 dimensions"),
        (b"\xff\xff\xff\x7f" * 2, element(9, b"") * 2000, r"or have more than 1,000 elements; save only the matrices"),
    ],
)
def test_a_matlab_file_that_would_take_long_to_count_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, shape: bytes, rest: bytes, message: str
):
    monkeypatch.setattr(mat_nesting, "MOST_ARRAYS", 1000)
    cells = element(14, element(6, bytes([1, *bytes(7)])) + element(5, shape) + element(1, b"q") + rest)
    (tmp_path / "log.mat").write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + cells)
    with pytest.raises(InputError, match=message):
        read_table(tmp_path / "log.mat")


def test_what_a_matlab_file_holds_beside_matrices_hinders_nothing(tmp_path: Path):
    cells = np.empty((2, 2), dtype=object)
    cells[:] = [["a text", np.ones(3)], [{"a": {"b": "another"}}, 1j]]
    cells[0, 0] = cells.copy()
    parts = np.array([(1.0, "a"), (2.0, "b")], dtype=[("x", object), ("y", object)])
    scipy.io.savemat(tmp_path / "log.mat", {"c": cells, "p": parts, "s": scipy.sparse.eye(3), "q": positions(times(9))})
    assert np.array_equal(read_table(tmp_path / "log.mat").channels["q"].values, positions(times(9)))


def test_structures_in_an_array_of_a_matlab_file_are_named_as_what_a_channel_may_be_in(tmp_path: Path):
    signals = [{"values": positions(times(9)), "label": name} for name in ("q", "tau")]
    scipy.io.savemat(tmp_path / "log.mat", {"out": {"time": times(9), "signals": signals}})
    with pytest.raises(InputError, match=r"'out.time'; 'out.signals' holds cells or several structures"):
        read_recording(tmp_path / "log.mat")


def repeated(value: object, count: int) -> pyarrow.DictionaryArray:
    return pyarrow.DictionaryArray.from_arrays(np.zeros(count, dtype=np.int32), pyarrow.array([value]))


def test_a_parquet_file_of_one_number_many_times_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    pyarrow.parquet.write_table(pyarrow.table({"q": repeated(1.5, 100_000)}), tmp_path / "log.parquet")
    monkeypatch.setattr(tables, "LARGEST_FILE", 700_000)
    with pytest.raises(InputError, match=r"table of 800,000 bytes is too large: at most 700,000 are read"):
        read_table(tmp_path / "log.parquet")


def test_texts_in_a_parquet_file_are_not_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    words, asked = repeated("a word", 50), list[list[str]]()
    columns = {"q": np.zeros(50), "word": words, "s": pyarrow.StructArray.from_arrays([words], ["word"])}
    pyarrow.parquet.write_table(pyarrow.table(columns), tmp_path / "log.parquet", store_schema=False)
    read = pyarrow.parquet.ParquetFile.read
    monkeypatch.setattr(
        pyarrow.parquet.ParquetFile, "read", lambda file, columns: asked.append(columns) or read(file, columns)
    )
    table = read_table(tmp_path / "log.parquet")
    assert asked == [["q"]]
    assert table.left_out == {"word": "string, not numbers", "s.word": "string, not numbers"}


def test_a_file_that_unpacks_to_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    np.savez_compressed(tmp_path / "log.npz", q=np.zeros(10**5))
    scipy.io.savemat(tmp_path / "log.mat", {"q": np.zeros(10**5)}, do_compression=True)
    with h5py.File(tmp_path / "log73.mat", "w", userblock_size=512) as file:
        file.create_dataset("q", (10**5,), "f8", chunks=(100,))
    with (tmp_path / "log73.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file")
    for module in (tables, read_mat):
        monkeypatch.setattr(module, "LARGEST_FILE", 10**5)
    for name in ("log.npz", "log.mat", "log73.mat"):
        with pytest.raises(InputError, match=r"too large|more than 100,000 bytes"):
            read_table(tmp_path / name)


def test_a_matlab_file_whose_element_never_ends_is_refused(tmp_path: Path):
    start = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    element = zlib.compress(b"\x0e\x00\x00\x00" + b"\xff" * 1000)
    tag = (15).to_bytes(4, "little") + (2**32 - 1).to_bytes(4, "little")
    (tmp_path / "log.mat").write_bytes(start + tag + element)
    with pytest.raises(InputError, match=r"file is not a readable MATLAB file"):
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
        ("", r"file holds no line that names the columns: it is empty, or all comments \(.*log.csv\)"),
        ("# a remark\n\n", r"file holds no line that names the columns: it is empty, or all comments"),
        (
            "1,2,3\n4,5,6\n",
            r"first line '1, 2, 3' must name the columns, as in 't, q1, q2, tau1, tau2' \(.*log.csv:1\)",
        ),
        ("sep=\r\nt,q\r\n0,1\r\n", r"the line below the names holds 't,q': .* \(.*log.csv:2\)"),
        ("t,q\n\x1bc,m\n0,1\n", r"the line below the names holds '\\x1bc, m': .* '\\x1bc' is neither"),
        ("# a remark\n\nt,q\n0,1\n1\n2,3\n", r"line has 1 cell: it must have 2, as the line of names \(.*log.csv:5\)"),
        ("t,q\n0,1\n1,2,3\n", r"line has 3 cells: it must have 2, as the line of names \(.*log.csv:3\)"),
        ("t,q\n0,0,1,5\n0,1,1,6\n", r"line has 4 cells: .*; if commas are decimal points here, .*semicolons"),
        ("t,q,q\n0,1,2\n", r"column 'q' occurs twice: each name must be unique \(.*log.csv:1\)"),
        (
            "t,q\ns,furlong\n0,1\n1,2\n",
            r"below the names holds 's, furlong': .* 'furlong' is neither; .*\(.*log.csv:2\)",
        ),
        (
            ",".join(f"column{k:05}" for k in range(9000)) + "\n",
            r"line 1 is longer than 100,000 characters: shorten it",
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


def test_a_long_title_is_a_name_that_says_nothing(tmp_path: Path):
    titles = ["q" + " " * 50_000 + "x", "q" + "1" * 20_000, "x" + "[rad]" * 3000]
    (tmp_path / "log.csv").write_text("\n".join([",".join(["t", *titles]), "0,1,2,3", "1,2,3,4"]))
    table = read_table(tmp_path / "log.csv")
    assert list(table.channels) == ["t", *titles]
    assert table.find("y" + "[rad]" * 3000) is None
    with pytest.raises(InputError, match=r"no channel has a name that means position; give a mapping"):
        read_recording(tmp_path / "log.csv")


def test_a_label_that_only_looks_like_a_number_is_a_name(tmp_path: Path):
    rows = [f"{k / 100},{k},{2 * k}" for k in range(9)]
    (tmp_path / "log.csv").write_text("\n".join(["t,q.²,q.³", *rows]))
    assert read_recording(tmp_path / "log.csv").joints == ("²", "³")
