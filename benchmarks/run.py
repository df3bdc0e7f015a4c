"""cutpoint beside its peers: `make bench`.  Writes docs/benchmarks.md, and what was measured, for each processor.

python benchmarks/run.py --into /tmp --calls 1e6      a trial: both files there, and fewer calls for latency
"""

import argparse
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import compilers
import kdl_peer
import ours
import pinocchio_cpp
from chains import chains
from closed_loop import closed_loop
from document import document
from elastic import elastic_inverse_dynamics
from from_memory import from_memory
from function_sections import KDL
from jax_rows import jax_rows
from latency import CALLS, latency
from laws import laws
from limits import limits
from llvmlite import binding
from parameters import parameters_as_inputs
from python_calls import python_calls
from simulations import loops
from starts import starts
from steps import steps
from tasks import tasks

import cutpoint
from cutpoint.studies.cost.study import processor
from large_robots import large_robots

HERE = Path(__file__).parent
RESULTS = HERE / "results"
PACKAGES = ("numpy", "llvmlite", "pin", "mujoco", "casadi", "jax", "example-robot-data")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--into", type=Path, help="a folder for both files")
    parser.add_argument("--calls", type=float, default=CALLS, help="of the exported function, for latency")
    given = parser.parse_args()
    if given.into:  # now, not after minutes of measuring
        given.into.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    for name in pinocchio_cpp.COMPILERS:  # with all cores, before anything is timed
        pinocchio_cpp.built(name)
    core = _pin_to_one_core()
    results = {"machine": _machine(core), **_measured(int(given.calls))}
    _write(results, given.into)
    print(f"{time.perf_counter() - start:.0f} s", file=sys.stderr)


def _measured(calls: int) -> dict:
    return {
        "limits": limits(), "tasks": tasks(), "elastic": elastic_inverse_dynamics(),
        "parameters": parameters_as_inputs(), "from memory": from_memory(), "in JAX": jax_rows(), "chains": chains(),
        "large robots": large_robots(),
        "from Python": python_calls(), "closed loop": closed_loop(), "own arm": loops(), "steps": steps(),
        "laws": laws(), "starts": starts(),
        "latency": latency(calls=calls),
    }  # fmt: skip


def _write(results: dict, into: Path | None) -> None:
    own = "-".join(re.findall("[a-z0-9]+", results["machine"]["processor"].lower())) + ".json"
    others = [json.loads(x.read_text("utf-8")) for x in sorted(RESULTS.glob("*.json")) if x.name != own]
    text = document(results, others)
    (into or RESULTS).joinpath(own).write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    (into or HERE.parent / "docs").joinpath("benchmarks.md").write_text(text, encoding="utf-8")
    print(text)


def _pin_to_one_core() -> int | None:
    """The core this process and its children then stay on, where the system lets them be pinned."""
    if not hasattr(os, "sched_setaffinity"):
        return None
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return core


def _machine(core: int | None) -> dict:
    versions = {"Python": platform.python_version(), "cutpoint": cutpoint.__version__}
    kdl = {KDL: found} if (found := kdl_peer.version()) else {}
    flags = {"flags": compilers.FLAGS, "own_flags": ours.C_FLAGS, "cpp_flags": pinocchio_cpp.STANDARD}
    return {
        "processor": f"{processor()} ({binding.get_host_cpu_name()})", "core": core,
        "system": f"{platform.system()} {platform.machine()}",
        "commit": _commit(), "versions": versions | {name: version(name) for name in PACKAGES} | kdl,
        "compilers": [x for x in map(compilers.version, ("gcc", "clang")) if x], **flags,
    }  # fmt: skip


def _commit() -> str:
    command = ["git", "describe", "--always", "--dirty"]
    if not shutil.which(command[0]):
        return "unknown"
    return subprocess.run(command, cwd=HERE, capture_output=True, text=True).stdout.strip()


if __name__ == "__main__":
    main()
