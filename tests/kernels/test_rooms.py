"""Which rooms of the kernels know which: an emitter can be read, and added, without the rest."""

import ast
from collections.abc import Iterator
from pathlib import Path

import cutpoint.kernels

KERNELS = Path(cutpoint.kernels.__file__).parent
ROOMS = ("graphs", "lowering", "machine", "arrays", "programs", "targets")
"""Each is built on those before it."""

EVERYWHERE = ("cutpoint.version.", "cutpoint.callers.", "cutpoint.errors.", "cutpoint.files.", "cutpoint.scalars")
"""What kernels take of the rest of the package: its version, the user's line, errors, files and scalars."""


def test_kernels_know_nothing_of_robots() -> None:
    for path in KERNELS.rglob("*.py"):
        strange = [name for name in imported(path) if not name.startswith(("cutpoint.kernels.", *EVERYWHERE))]
        assert not strange, f"{path}: {strange}"


def test_every_room_is_built_on_those_before_it() -> None:
    assert {path.parent.name for path in KERNELS.glob("*/*.py")} == {*ROOMS}
    for path in KERNELS.glob("*/*.py"):
        known = ROOMS[: ROOMS.index(path.parent.name) + 1]
        within = [name for name in imported(path) if name.startswith("cutpoint.kernels")]
        strange = [name for name in within if name.split(".")[2] not in known]
        assert not strange, f"{path}: {strange}"


def test_targets_of_graphs_know_nothing_of_programs() -> None:
    targets = [path for path in KERNELS.glob("targets/*.py") if path.name != "c99_program.py"]
    assert not [name for path in targets for name in imported(path) if ".programs." in name]


def imported(path: Path) -> Iterator[str]:
    """All that a file takes of the package, as `cutpoint.room.name`, wherever in the file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "cutpoint":
            yield from (f"{node.module}.{x.name}" for x in node.names)
        elif isinstance(node, ast.Import):
            yield from (x.name for x in node.names if x.name.partition(".")[0] == "cutpoint")
