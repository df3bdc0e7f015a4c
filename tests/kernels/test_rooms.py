"""Which rooms of the kernels know which: an emitter can be read, and added, without the rest."""

import ast
from collections.abc import Iterator
from pathlib import Path

import cutpoint.kernels

KERNELS = Path(cutpoint.kernels.__file__).parent
ROOMS = ("graphs", "lowering", "machine", "arrays", "programs", "targets")
"""Each is built on those before it."""

EVERYWHERE = ("cutpoint", "cutpoint.errors", "cutpoint.files", "cutpoint.scalars")
"""What kernels take of the rest of the package: its version, errors, files and scalars."""


def test_kernels_know_nothing_of_robots() -> None:
    for path in KERNELS.rglob("*.py"):
        strange = [name for name in imported(path) if not name.startswith("cutpoint.kernels.")]
        assert set(strange) <= {*EVERYWHERE}, f"{path}: {strange}"


def test_every_room_is_built_on_those_before_it() -> None:
    assert {path.parent.name for path in KERNELS.glob("*/*.py")} == {*ROOMS}
    for path in KERNELS.glob("*/*.py"):
        known = ROOMS[: ROOMS.index(path.parent.name) + 1]
        strange = [x for x in imported(path) if x.startswith("cutpoint.kernels") and x.split(".")[2] not in known]
        assert not strange, f"{path}: {strange}"


def test_programs_and_targets_do_not_know_each_other() -> None:
    assert not [x for path in KERNELS.glob("targets/*.py") for x in imported(path) if ".programs" in x]


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "cutpoint":
            yield node.module or ""
        elif isinstance(node, ast.Import):
            yield from (x.name for x in node.names if x.name.partition(".")[0] == "cutpoint")
