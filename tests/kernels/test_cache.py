"""Machine code on disk: a second start finds it, and nothing but it."""

import errno
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from llvmlite import binding

from cutpoint.kernels import Kernel, Loop, Program, Region, Stage, compile, compile_program
from cutpoint.kernels.machine import cache as caches
from cutpoint.kernels.machine import jit
from cutpoint.kernels.machine.batch_loop import WORTH_MAKING_PACKS
from cutpoint.kernels.machine.cache import VARIABLE, Cache, key_of, not_kept, user_folder
from cutpoint.kernels.machine.jit import object_code
from cutpoint.kernels.programs import compiled as programs
from cutpoint.scalars import sin, tanh

HEADER = 80  # bytes before the code
RNG = np.random.default_rng(11)
X = RNG.normal(size=(2 * WORTH_MAKING_PACKS, 3))

PROGRAM = """
import numpy as np
from llvmlite import binding
from cutpoint.kernels import compile
from cutpoint.scalars import sin, tanh
{patch}
kernel = compile(lambda q: [sin(q[0]) * q[1], tanh(q[2]) / q[0]], name="law", q=3, backend="llvm")
x = np.random.default_rng(3).normal(size=(200, 3))
print(kernel(x[0]).tobytes().hex(), kernel(x).tobytes().hex())
"""
REFUSES_TO_COMPILE = """
def refuse(*_): raise AssertionError("compiled")
binding.TargetMachine.emit_object = refuse
"""
ANOTHER_PROCESSOR = "features = binding.FeatureMap({}); binding.get_host_cpu_features = lambda: features"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache's folder; it is made with the first entry."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache" / "kernels"


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The sizes of all object files that LLVM makes from now on."""
    sizes: list[int] = []
    emit = binding.TargetMachine.emit_object

    def counted(machine: Any, module: Any) -> bytes:
        code = emit(machine, module)
        sizes.append(len(code))
        return code

    monkeypatch.setattr(binding.TargetMachine, "emit_object", counted)
    return sizes


def law() -> Kernel:
    return compile(lambda q: [sin(q[0]) * q[1], tanh(q[2]) / q[0]], name="law", q=3, backend="llvm")


def bits(kernel: Kernel) -> bytes:
    """Of a single call and of a batch, which between them run all code that a kernel has."""
    return kernel(X[0]).tobytes() + kernel(X).tobytes()


def entries(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def start(patch: str = "") -> "subprocess.Popen[str]":
    source = PROGRAM.format(patch=patch)
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-c", source], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def answer(process: "subprocess.Popen[str]") -> str:
    printed, complaints = process.communicate(timeout=120)
    assert process.returncode == 0, complaints
    return printed


def test_a_second_process_compiles_nothing_and_gives_the_same_bits(folder: Path) -> None:
    first = answer(start())
    kept = entries(folder)
    assert len(kept) == 4  # single elements, packs, and the shortcuts for single calls and for whole batches
    assert answer(start(REFUSES_TO_COMPILE)) == first
    assert entries(folder) == kept


def program(**changed: Any) -> Program:
    """Of two stages in a loop; changed: what of the first stage, or of the loop, is otherwise."""
    told: dict[str, Any] = {"lanes": 1, "factor": 2.0, "count": "steps", "streams": (), "backward": False} | changed
    grow = Stage(lambda x: [told["factor"] * x_k for x_k in x], ("x",), ("x",), told["lanes"])
    add = Stage(lambda x, y: [x_k + y_k for x_k, y_k in zip(x, y, strict=True)], ("x", "y"), ("y",), told["lanes"])
    body = Loop(told["count"], [grow, add], told["streams"], backward=told["backward"])
    return compile_program(body, [Region("x", 4, told["lanes"]), Region("y", 4, told["lanes"])], "llvm")


def test_a_program_on_disk_is_found_before_its_text_is_written(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def run(made: Program) -> bytes:
        x, y = np.arange(4.0), np.zeros(4)
        made.run({"steps": 3}, x=x, y=y)
        return x.tobytes() + y.tobytes()

    first = run(program())

    def refuse(plan: Any) -> str:
        raise AssertionError("written")

    monkeypatch.setattr(programs, "program_ir", refuse)
    assert run(program()) == first


@pytest.mark.parametrize(
    "changed",
    [{"lanes": 2}, {"factor": 3.0}, {"factor": -2.0}, {"count": 3}, {"streams": ("x",)}, {"count": "others"},
     {"streams": ("x",), "backward": True}],
)  # fmt: skip
def test_another_program_is_another_entry(folder: Path, changed: dict[str, Any]) -> None:
    program()
    program(**changed)
    assert len(entries(folder)) == 2


def test_code_for_another_processor_is_not_used(folder: Path) -> None:
    first = answer(start())
    names = set(entries(folder))
    assert answer(start(ANOTHER_PROCESSOR)) == first
    assert names < set(entries(folder)) and len(entries(folder)) == 2 * len(names)


def test_processes_that_start_together_share_the_folder_in_peace(folder: Path) -> None:
    together = [start() for _ in range(4)]
    assert len({answer(process) for process in together}) == 1
    assert len(entries(folder)) == 4 and all(name.endswith(".code") for name in entries(folder))
    answer(start(REFUSES_TO_COMPILE))


def test_a_process_killed_while_it_writes_harms_nobody(folder: Path) -> None:
    killed = start("import os; os.replace = lambda *_: os._exit(9)")
    assert killed.communicate(timeout=120) == ("", "") and killed.returncode == 9
    assert [name.endswith(".code") for name in entries(folder)] == [False]
    first = answer(start())
    assert answer(start(REFUSES_TO_COMPILE)) == first


@pytest.mark.usefixtures("folder")
def test_a_kernel_from_disk_gives_the_bits_of_a_compiled_one(
    compiled: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    first = bits(law())
    assert len(compiled) == 4
    assert bits(law()) == first
    assert len(compiled) == 4
    monkeypatch.setenv(VARIABLE, "")
    assert bits(law()) == first
    assert len(compiled) == 8


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "emptied": lambda x: b"",
    "cut to a byte": lambda x: x[:1],
    "cut in the header": lambda x: x[: HEADER - 1],
    "cut behind the header": lambda x: x[:HEADER],
    "cut in half": lambda x: x[: len(x) // 2],
    "cut by a byte": lambda x: x[:-1],
    "longer by a byte": lambda x: x + b"\0",
    "of zeros": lambda x: bytes(len(x)),
    "without its header": lambda x: x[HEADER:],
    **{f"flipped at {k}": lambda x, k=k: x[:k] + bytes([x[k] ^ 1]) + x[k + 1 :] for k in (0, 8, 40, 72, HEADER, -1)},
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_entry_is_not_used_and_is_written_anew(
    folder: Path, compiled: list[int], damage: Callable[[bytes], bytes]
) -> None:
    first = bits(law())
    sound, before = entries(folder), len(compiled)
    for name, content in sound.items():
        (folder / name).write_bytes(damage(content))
    assert bits(law()) == first
    assert len(compiled) == 2 * before
    assert entries(folder) == sound


def test_an_entry_under_the_key_of_another_is_not_used(folder: Path, compiled: list[int]) -> None:
    first = bits(law())
    sound, before = entries(folder), len(compiled)
    for name, foreign in zip(sound, [*sound.values()][1:] + [*sound.values()][:1], strict=True):
        (folder / name).write_bytes(foreign)
    assert bits(law()) == first
    assert len(compiled) == 2 * before
    assert entries(folder) == sound


def test_folder_and_entries_are_closed_to_others(folder: Path) -> None:
    mask = os.umask(0)
    law()
    os.umask(mask)
    modes = {path: path.stat().st_mode & 0o077 for path in (folder, *folder.iterdir())}
    assert len(modes) > 1 and not any(modes.values())


@pytest.mark.parametrize("mode", [0o701, 0o710, 0o750, 0o755, 0o770, 0o777])
def test_a_folder_that_is_open_to_others_is_neither_read_nor_written(
    folder: Path, compiled: list[int], mode: int
) -> None:
    first = bits(law())
    folder.chmod(mode)
    for path in folder.iterdir():
        path.write_bytes(b"")
    assert bits(law()) == first
    assert len(compiled) == 8 and set(entries(folder).values()) == {b""}


@pytest.mark.parametrize("mode", [0o620, 0o602, 0o666])
def test_an_entry_that_others_may_write_is_replaced(folder: Path, compiled: list[int], mode: int) -> None:
    first = bits(law())
    for path in folder.iterdir():
        path.chmod(mode)
    assert bits(law()) == first
    assert len(compiled) == 8 and all(path.stat().st_mode & 0o777 == 0o600 for path in folder.iterdir())


def test_a_folder_or_an_entry_of_another_user_is_not_used(
    folder: Path, compiled: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    first, own = bits(law()), os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: own + 1)
    assert bits(law()) == first
    assert len(compiled) == 8


def test_links_are_not_followed(folder: Path, compiled: list[int], tmp_path: Path) -> None:
    first = bits(law())
    for path in [*folder.iterdir()]:
        path.rename(tmp_path / path.name)
        path.symlink_to(tmp_path / path.name)
    assert bits(law()) == first
    assert len(compiled) == 8 and not any(path.is_symlink() for path in folder.iterdir())
    folder.rename(tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    assert bits(law()) == first
    assert len(compiled) == 12


@pytest.mark.parametrize("kind", ["pipe", "folder"])
def test_what_is_no_file_is_passed_over(folder: Path, kind: str) -> None:
    first = answer(start())
    for path in [*folder.iterdir()]:
        path.unlink()
        (os.mkfifo if kind == "pipe" else os.mkdir)(path)
    assert answer(start()) == first
    assert all(path.is_file() for path in folder.iterdir()) == (kind == "pipe")


def test_a_cache_that_can_only_be_read_is_used(
    folder: Path, compiled: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    first, before = bits(law()), len(compiled)
    for name in ("utime", "replace", "unlink"):
        monkeypatch.setattr(os, name, refused)
    monkeypatch.setattr(tempfile, "mkstemp", refused)
    assert bits(law()) == first and len(compiled) == before


def test_where_nothing_can_be_kept_kernels_work_all_the_same(
    tmp_path: Path, compiled: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("in the way")
    results = set()
    for place in (tmp_path / "file", tmp_path / "file" / "below", Path("/dev/null")):
        monkeypatch.setenv(VARIABLE, str(place))
        results |= {bits(law()), bits(law())}
    assert len(results) == 1 and len(compiled) == 24


def test_an_empty_variable_keeps_nothing_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("HOME", "XDG_CACHE_HOME", "LOCALAPPDATA", "TMPDIR"):
        monkeypatch.setenv(variable, str(tmp_path))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(VARIABLE, "")
    bits(law())
    assert user_folder() is None and not [*tmp_path.iterdir()]


def test_compilation_can_be_timed_whatever_is_kept(folder: Path, compiled: list[int]) -> None:
    law()
    kept, before = entries(folder), len(compiled)
    with not_kept():
        law()
    assert len(compiled) == 2 * before and entries(folder) == kept
    law()
    assert len(compiled) == 2 * before


def test_an_unset_variable_is_unset_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE)
    with not_kept():
        assert user_folder() is None
    assert VARIABLE not in os.environ


@pytest.mark.parametrize(
    ("platform", "variables", "expected"),
    [
        ("linux", {}, "home/.cache/cutpoint/kernels"),
        ("linux", {"XDG_CACHE_HOME": "{root}/xdg"}, "xdg/cutpoint/kernels"),
        ("linux", {"XDG_CACHE_HOME": "not/absolute"}, "home/.cache/cutpoint/kernels"),
        ("linux", {"XDG_CACHE_HOME": ""}, "home/.cache/cutpoint/kernels"),
        ("darwin", {}, "home/Library/Caches/cutpoint/kernels"),
        ("win32", {"LOCALAPPDATA": "{root}/local"}, "local/cutpoint/kernels"),
        ("win32", {"LOCALAPPDATA": ""}, "home/AppData/Local/cutpoint/kernels"),
        ("linux", {VARIABLE: "{root}/mine"}, "mine/kernels"),
        ("win32", {VARIABLE: "{root}/mine"}, "mine/kernels"),
    ],
)
def test_each_platform_keeps_code_where_it_keeps_caches(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, platform: str, variables: dict[str, str], expected: str
) -> None:
    for variable in (VARIABLE, "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(variable, raising=False)
    for variable, value in variables.items():
        monkeypatch.setenv(variable, value.format(root=tmp_path))
    monkeypatch.setattr(Path, "home", lambda: tmp_path / "home")
    monkeypatch.setattr(caches.sys, "platform", platform)
    assert user_folder() == tmp_path / expected


def test_without_a_home_nothing_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("no home")

    for variable in (VARIABLE, "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(Path, "home", homeless)
    assert user_folder() is None


def test_what_was_used_least_recently_goes(tmp_path: Path) -> None:
    keys = [key_of(str(k)) for k in range(5)]
    full = Cache(tmp_path / "kernels")
    for age, key in enumerate(keys):
        full.write(key, bytes(1000))
        path = tmp_path / "kernels" / f"{key.hex()}.code"
        stamp = time.time() - 100 + age
        os.utime(path, (stamp, stamp))
    assert full.read(keys[0])  # which was the oldest
    bounded = Cache(tmp_path / "kernels", largest=3 * (1000 + HEADER))
    bounded.write(key_of("new"), bytes(1000))
    found = [bounded.read(key) is not None for key in (*keys, key_of("new"))]
    assert found == [True, False, False, False, True, True]


def test_what_killed_processes_left_goes_when_it_is_old(tmp_path: Path) -> None:
    Cache(tmp_path / "kernels").write(key_of("old"), b"code")
    left, fresh = tmp_path / "kernels" / "tmpleft", tmp_path / "kernels" / "tmpfresh"
    for path in (left, fresh):
        path.write_bytes(b"half")
    os.utime(left, (0, 0))
    Cache(tmp_path / "kernels").write(key_of("new"), b"code")
    assert not left.exists() and fresh.exists()


@pytest.mark.parametrize("code", [b"\0", bytes(range(256)) * 64])
def test_code_comes_back_as_it_was(tmp_path: Path, code: bytes) -> None:
    cache = Cache(tmp_path / "kernels")
    assert cache.read(key_of("x")) is None
    cache.write(key_of("x"), code)
    assert Cache(tmp_path / "kernels").read(key_of("x")) == code


DOUBLED = "define double @double(double %x) {\n%y = fadd double %x, %x\nret double %y\n}"


def test_what_is_compiled_with_another_effort_is_another_entry(folder: Path) -> None:
    found = [object_code(DOUBLED, effort) for effort in (0, 2, 0)]
    assert found[0] == found[2] and len(entries(folder)) == 2


def test_parts_of_a_key_are_told_apart() -> None:
    keys = {key_of(*parts) for parts in (("ab", "c"), ("a", "bc"), ("abc",), ("abc", ""), ("c", "ab"))}
    assert len(keys) == 5


def test_code_of_changed_modules_is_not_kept_under_their_new_stamps(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []

    def write() -> str:
        written.append(DOUBLED)
        return DOUBLED

    unwritten = jit.Unwritten(("a test", "doubled"), write)
    monkeypatch.setattr(jit, "LOADED_AT", 0)
    assert object_code(unwritten, 2) == object_code(DOUBLED, 2)
    monkeypatch.setattr(jit, "LOADED_AT", time.time_ns())
    object_code(unwritten, 2)
    assert len(written) == 2  # what was kept before is not found by its stamps
    object_code(unwritten, 2)
    assert len(written) == 2
