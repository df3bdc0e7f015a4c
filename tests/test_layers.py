"""Dependencies point one way: every part of the package knows only those before it, wherever it imports them."""

import ast
from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import cutpoint

PACKAGE = Path(cutpoint.__file__).parent

LAYERS = """
    arrays version errors callers
    files scalars door resolvent
    kernels model reporting
    mechanics
    definitions drive_slopes formats trajectories
    rolled
    functions
    robot
    joint_units robot_arguments
    control derivatives loading robots
    simulation
    analysis identification
    export studies
    face
    commands
    cli
"""
"""Parts of one line do not know each other.  face: the names that users import from `cutpoint` itself."""

OFFERED = {("robot.py", "analysis"), ("simulation/log/log.py", "analysis")}
"""Methods that are offered where users look for them: `Robot.linearize` and `modes`, and `Log.certificate`."""

LAYER = {part: layer for layer, line in enumerate(LAYERS.strip().splitlines()) for part in line.split()}


def test_every_part_has_its_layer() -> None:
    parts = {path.stem for path in PACKAGE.glob("*.py")} | {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    assert parts - {"__init__", "__main__"} == LAYER.keys() - {"face"}


def test_every_part_knows_only_those_of_the_layers_before_it() -> None:
    found: set[tuple[str, str]] = set()
    for path in PACKAGE.rglob("*.py"):
        file = path.relative_to(PACKAGE)
        own = file.parts[0].removesuffix(".py")
        if own not in ("__init__", "__main__"):
            others = {*imported(ast.parse(path.read_text("utf-8")))} - {own}
            found |= {(file.as_posix(), x) for x in others if LAYER[x] >= LAYER[own]}
    assert found == OFFERED


def imported(node: ast.AST) -> Iterator[str]:
    """Parts that a file imports when it runs, also from inside functions; not what only a type checker reads."""
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return
    if isinstance(node, ast.ImportFrom) and node.module == "cutpoint":
        yield from (x.name if x.name in LAYER else "face" for x in node.names)
    elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cutpoint."):
        yield (node.module or "").split(".")[1]
    elif isinstance(node, ast.Import):
        modules = [x.name.split(".") for x in node.names]
        yield from ([*own, "face"][1] for own in modules if own[0] == "cutpoint")
    for child in ast.iter_child_nodes(node):
        yield from imported(child)


def test_benchmarks_and_examples_import_what_there_is() -> None:
    """They run with peers that tests do not install, so their imports of cutpoint are followed here."""
    root, missing = Path(__file__).parents[1], list[str]()
    for path in (*root.glob("benchmarks/*.py"), *root.glob("examples/*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "cutpoint":
                missing += [f"{path.name}: {x.name}" for x in node.names if not is_there(node.module or "", x.name)]
    assert not missing


def is_there(module: str, name: str) -> bool:
    found = import_module(module)
    return hasattr(found, name) or (hasattr(found, "__path__") and find_spec(f"{module}.{name}") is not None)
