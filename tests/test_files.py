"""Files that users bring and files that we leave."""

import errno
import os
import stat
from pathlib import Path

import pytest

from cutpoint.errors import InputError
from cutpoint.files import check_readable, check_target_file, check_target_folder, replacing


def test_a_file_is_replaced_at_once_or_not_at_all(tmp_path: Path):
    path = tmp_path / "result"
    path.write_bytes(b"before")
    with pytest.raises(KeyboardInterrupt), replacing(path) as file:
        file.write(b"half")
        raise KeyboardInterrupt
    assert path.read_bytes() == b"before"
    with replacing(path) as file:
        file.write(b"after")
        assert path.read_bytes() == b"before"
    assert path.read_bytes() == b"after"
    assert os.listdir(tmp_path) == ["result"]


def test_a_file_keeps_its_permissions_and_a_link_its_file(tmp_path: Path):
    path, link = tmp_path / "result", tmp_path / "link"
    path.write_bytes(b"before")
    path.chmod(0o640)
    link.symlink_to(path)
    with replacing(link) as file:
        file.write(b"after")
    assert path.read_bytes() == b"after" and link.is_symlink()
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_new_file_follows_the_users_mask(tmp_path: Path):
    mask = os.umask(0o027)
    try:
        with replacing(tmp_path / "result") as file:
            file.write(b"new")
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "result").stat().st_mode) == 0o640


def test_what_a_full_disk_refuses_is_named(tmp_path: Path):
    path = tmp_path / "result"
    with pytest.raises(OSError, match=rf"No space left on device: '{path}'"), replacing(path):
        raise OSError(errno.ENOSPC, "No space left on device")


@pytest.mark.parametrize("size", [0, 7])
def test_a_file_of_the_largest_size_is_read(tmp_path: Path, size: int):
    path = tmp_path / "given"
    path.write_bytes(bytes(size))
    check_readable(path, 7)


def test_what_is_no_file_or_too_large_is_refused(tmp_path: Path):
    (tmp_path / "large").write_bytes(bytes(8))
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match=r"file of 8 bytes is too large: at most 7 are read \(.*large\)"):
        check_readable(tmp_path / "large", 7)
    with pytest.raises(InputError, match=r"at most 7 are read; split it \(.*large\)"):
        check_readable(tmp_path / "large", 7, "split it")
    for name in ("pipe", "."):
        with pytest.raises(InputError, match=r"is not a regular file; give the path of a file"):
            check_readable(tmp_path / name, 7)
    with pytest.raises(InputError, match=r"'.*none' does not exist; give the path of a file"):
        check_readable(tmp_path / "none", 7)


def test_asking_for_a_place_leaves_nothing_there(tmp_path: Path):
    check_target_file(tmp_path / "result.npz")
    check_target_folder(tmp_path)
    check_target_folder(tmp_path / "new" / "newer")
    assert os.listdir(tmp_path) == []


def test_a_place_where_no_file_can_be_is_told_by_its_own_name(tmp_path: Path):
    (tmp_path / "file").write_bytes(b"")
    long = "x" * 300
    with pytest.raises(InputError, match=r"--output '\S+/file' is not a folder"):
        check_target_folder(tmp_path / "file" / "new", "--output")
    for check, path in ((check_target_file, tmp_path / long), (check_target_folder, tmp_path / long)):
        with pytest.raises(InputError, match=rf"--output '\S+/{long}' cannot be written \(File name too long\)"):
            check(path, "--output")
    gone = tmp_path / "none" / "result"
    with pytest.raises(InputError, match=r"file '\S+/none/result' cannot be written"), replacing(gone):
        raise AssertionError("there is no file to write to")


def test_a_null_byte_and_a_link_to_itself_are_told(tmp_path: Path):
    null, link = tmp_path / "a\0b", tmp_path / "link"
    link.symlink_to(link)
    for check, path in ((check_target_file, null), (check_target_folder, null), (check_target_folder, null / "new")):
        with pytest.raises(InputError, match=r"--output '.*a\\x00b\S*' cannot be written \([^)]*embedded null"):
            check(path, "--output")
    with pytest.raises(InputError, match=r"--output '\S+/link' cannot be written \(Too many levels"):
        check_target_folder(link, "--output")
    with pytest.raises(InputError, match=r"file '\S+/link/x' cannot be written \("), replacing(link / "x"):
        raise AssertionError("there is no file to write to")
