"""Speedup of packs on batches of rows: ns per element, packs against single elements, in alternation.

python benchmarks/batches.py      (needs the package example-robot-data)

Batches are sized so that inputs and outputs fill at most 1 MB.
"""

import platform
import statistics
import time
from collections.abc import Callable
from importlib.metadata import files
from typing import Any
from unittest.mock import patch

import llvmlite
import numpy as np
from llvmlite import binding

import cutpoint
from cutpoint.kernels.arrays.backends import array_function
from cutpoint.kernels.machine.jit import vector_width

ROUNDS = 41
BYTES = 1_000_000
FUNCTIONS = {
    "inverse_dynamics": 3, "forward_dynamics": 3, "mass_matrix": 1, "elastic_inverse_dynamics": 5,
}  # fmt: skip
"""Public functions of a robot, and their numbers of input vectors."""


def robots() -> dict[str, cutpoint.Robot]:
    """Arms with the same drive in every joint that has none of its own."""
    paper = cutpoint.robots.xia2019()
    drive = next(iter(paper.drives.values()))
    found = {"xia2019": paper}
    for name, file in {"UR10": "ur10_robot.urdf", "Panda": "panda.urdf"}.items():
        (entry,) = [x for x in files("example-robot-data") or () if x.name == file]
        robot = cutpoint.load(str(entry.locate()), mimic="coupled")
        found[name] = robot.with_drives({joint: drive for joint in robot.joints})
    return found


def seconds(call: Callable[[], Any]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def measure(robot: cutpoint.Robot, function: str, vectors: int) -> tuple[list[float], list[float]]:
    """Seconds an element in every round: single elements, packs."""
    rng = np.random.default_rng(0)
    getattr(robot, function)(*rng.uniform(-2, 2, (vectors, robot.nv)))
    graph = robot.kernel(function).graph
    numbers = vectors * robot.nv + sum(port.size for port in graph.outputs)
    count = BYTES // (8 * numbers)
    arguments = [*rng.uniform(-2, 2, (vectors, count, robot.nv))]
    if len(graph.inputs) > vectors:
        arguments.append(robot.drive_parameters)
    with patch("cutpoint.kernels.arrays.packs._MOST_NODES", 0):
        single = array_function(graph, function, "llvm")
    packs = array_function(graph, function, "llvm")
    results = single.call(*arguments)
    out = results if isinstance(results, tuple) else (results,)
    np.testing.assert_array_equal(packs.call(*arguments), results)
    rounds = [
        [seconds(lambda f=f: f.call(*arguments, out=out)) / count for f in (single, packs)] for _ in range(ROUNDS)
    ]
    return tuple(map(list, zip(*rounds, strict=True)))


def main() -> None:
    width = vector_width()
    print(f"cutpoint {cutpoint.__version__}, {binding.get_host_cpu_name()}, packs of {width} float64;", end=" ")
    print(f"llvmlite {llvmlite.__version__}, NumPy {np.__version__}, Python {platform.python_version()}")
    print(f"{'ns an element: median (least)':36}{'single':>16}{'packs':>16}{'gain':>7}")
    for name, robot in robots().items():
        for function, vectors in FUNCTIONS.items():
            single, packs = ([1e9 * x for x in times] for times in measure(robot, function, vectors))
            cells = [f"{statistics.median(x):8.1f} ({min(x):5.1f})" for x in (single, packs)]
            gain = statistics.median(single) / statistics.median(packs)
            print(f"{name + ' ' + function:36}{cells[0]:>16}{cells[1]:>16}{gain:6.1f}x")


if __name__ == "__main__":
    main()
