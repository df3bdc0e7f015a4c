"""The functions of a robot, all contenders on the same rows: agreement first, then times."""

import sys
from collections.abc import Mapping
from dataclasses import asdict

import casadi_peer
import compilers
import kdl_peer
import mujoco_peer
import numpy as np
import ours
import pinocchio_cpp
import pinocchio_python
from cases import ROBOTS, TASKS, Case, Entry, case

from cutpoint.kernels import Kernel
from cutpoint.kernels.lowering.lower import lower
from cutpoint.studies.cost.timing import Timing, in_turns

AGREEMENT = 1e-10
"""Largest difference of results, as a share of the largest."""


def tasks() -> list[dict]:
    found = []
    for name in ROBOTS:
        robot = case(name)
        for task in TASKS:
            print(f"{name}: {task}", file=sys.stderr)
            found.append(measured(robot, task))
    return found


def measured(robot: Case, task: str) -> dict:
    inputs = robot.inputs(task)
    kernel = ours.kernel_of(robot, task, inputs)
    cpp = pinocchio_cpp.entries(robot, task, inputs) | pinocchio_cpp.wheel(robot, task, inputs)
    entries = {**ours.entries(kernel, inputs), **cpp}
    entries |= mujoco_peer.entries(robot, task, inputs) | kdl_peer.entries(robot, task, inputs)
    if compilers.version("gcc"):
        entries |= casadi_peer.entries(robot, task, inputs)
    differences = agreed(f"{robot.name}, {task}", entries, pinocchio_python.results(robot, task, inputs))
    count = len(inputs[0])
    times = in_turns({name: x.call for name, x in entries.items()}, count)
    return {
        "robot": robot.name, "task": task, "rows": count, "differences": differences, **numbers(kernel),
        "times": in_columns(times, cpp),
    }  # fmt: skip


def agreed(title: str, entries: Mapping[str, Entry], expected: np.ndarray) -> dict[str, float]:
    """How far everyone's results are off, as a share of the largest; nothing is timed that is too far off."""
    found = {name: x.results[: len(expected)].reshape(expected.shape) for name, x in entries.items()}
    return agreed_with(title, found, expected)


def agreed_with(title: str, found: Mapping[str, np.ndarray], expected: np.ndarray) -> dict[str, float]:
    """The same, of results of the same shape."""
    largest = np.abs(expected).max()
    differences = {name: float(np.abs(x - expected).max() / largest) for name, x in found.items()}
    wrong = {name: x for name, x in differences.items() if not x < AGREEMENT}
    if wrong:
        sys.exit(f"{title}: {wrong} of the largest result off, more than {AGREEMENT}; not timed")
    return differences


def numbers(kernel: Kernel) -> dict[str, int]:
    """Of a row: bytes in and out, and flops, a multiply-add for two, sines and cosines as what they are made of."""
    graph = lower(kernel.graph)
    twice = sum(graph.operations.get(op, 0) for op in ("fma", "fms", "fnma"))
    once = sum(graph.operations.get(op, 0) for op in ("add", "sub", "mul", "div", "sqrt"))
    ports = [p.size for p in graph.outputs]
    return {"bytes": 8 * (sum(p.size for p in graph.inputs) + sum(ports)), "bytes out": 8 * sum(ports),
            "flops": 2 * twice + once}  # fmt: skip


def in_columns(times: Mapping[str, Timing], cpp: Mapping[str, Entry]) -> dict[str, dict]:
    """Of Pinocchio's builds the fastest, with its name, and the least times of all."""
    found = {name: asdict(x) for name, x in times.items() if name not in cpp}
    if cpp:
        best = min(cpp, key=lambda name: times[name].least)
        found["Pinocchio"] = {**asdict(times[best]), "build": best, "builds": {name: times[name].least for name in cpp}}
    return found
