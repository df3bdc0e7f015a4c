"""cutpoint beside its peers: `make bench`.  Writes benchmarks/results.json and docs/benchmarks.md."""

import json
import os
import platform
import subprocess
import sys
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from codegen import FLAGS
from contenders import ITEMS, ROBOTS, TASKS, Entry, entries
from document import document
from steps import steps

import cutpoint
from cutpoint.studies.cost.study import processor
from cutpoint.studies.cost.timing import in_turns

HERE = Path(__file__).parent
AGREEMENT = 1e-10
"""Largest difference of results, as a share of the largest."""


def main() -> None:
    core = _pin_to_one_core()
    results = {"machine": _machine(core), "tasks": []}
    with TemporaryDirectory() as folder:
        for robot in ROBOTS:
            for task in TASKS:
                print(f"{robot}: {task}", file=sys.stderr)
                results["tasks"].append(_measured(robot, task, entries(robot, task, Path(folder))))
    print("integration steps", file=sys.stderr)
    results["steps"] = steps()
    (HERE / "results.json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    text = document(results)
    (HERE.parent / "docs" / "benchmarks.md").write_text(text, encoding="utf-8")
    print(text)


def _measured(robot: str, task: str, entries: dict[str, Entry]) -> dict:
    expected = entries["Pinocchio"].results
    largest = np.abs(expected).max()
    differences = {name: float(np.abs(x.results - expected).max() / largest) for name, x in entries.items()}
    wrong = {name: x for name, x in differences.items() if not x < AGREEMENT}
    if wrong:
        sys.exit(f"{robot}, {task}: {wrong} of the largest result off Pinocchio's, more than {AGREEMENT}; not timed")
    single = in_turns({name: x.single for name, x in entries.items() if x.single})
    batched = in_turns({name: x.batched for name, x in entries.items() if x.batched}, ITEMS)
    times = {"single": single, "batched": batched}
    found = {kind: {name: asdict(t) for name, t in of.items()} for kind, of in times.items()}
    return {"robot": robot, "task": task, "differences": differences, **found}


def _pin_to_one_core() -> int | None:
    """The core this process and its children then stay on, where the system lets them be pinned."""
    if not hasattr(os, "sched_setaffinity"):
        return None
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return core


def _machine(core: int | None) -> dict:
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=HERE, capture_output=True, text=True)
    gcc = subprocess.run(["gcc", "--version"], capture_output=True, text=True).stdout.partition("\n")[0]
    others = {name: version(name) for name in ("numpy", "llvmlite", "pin", "casadi", "example-robot-data")}
    versions = {"Python": platform.python_version(), "cutpoint": cutpoint.__version__, **others}
    system = f"{platform.system()} {platform.machine()}"
    compiler = {"gcc": gcc, "flags": FLAGS}
    return {"processor": processor(), "core": core, "system": system, **compiler, "commit": commit.stdout.strip(),
            "versions": versions, "items": ITEMS}  # fmt: skip


if __name__ == "__main__":
    main()
