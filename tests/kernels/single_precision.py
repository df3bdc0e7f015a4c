"""Functions for the tests of single precision: robots' functions, and one for every kind of output."""

from typing import Any

import numpy as np
from emitters import Rows

import robot_library
from cutpoint.kernels import Kernel
from cutpoint.kernels.machine.batch_loop import WORTH_MAKING_PACKS
from cutpoint.scalars import atan, exp, log, sin, tanh, where

RNG = np.random.default_rng(9)
LONG = 2 * WORTH_MAKING_PACKS + 3
SHAPES = ((7,), (), (3, 4))
TINY = 2.0**-149
SCALES = [0.0, TINY, 1e-20, 1e-8, *[1.0] * 70, 10.0, 1e3, 1e6, 1e30, np.inf, np.nan]
"""Of a robot's inputs, a row each: enough rows for packs."""
TAME = (0, 2, 3, *range(4, 8), 74)
"""Rows whose results have a running error bound worth the name."""

ROBOTS = [
    ("ur10", "inverse_dynamics"), ("xia2019", "elastic_inverse_dynamics"), ("mixed", "forward_dynamics"),
]  # fmt: skip


def robot_kernel(robot: str, function: str) -> Kernel:
    machine = robot_library.MAKERS[robot]()
    vectors = 4 if function == "elastic_inverse_dynamics" else 2
    getattr(machine, function)(machine.neutral(), *np.zeros((vectors, machine.nv)))
    return machine.kernel(function)


def robot_rows(robot: str, kernel: Kernel) -> Rows:
    """Inputs of every scale, positions around the neutral ones, the drives' numbers around the robot's own."""
    machine, rng, scales, rows = robot_library.MAKERS[robot](), np.random.default_rng(7), np.array(SCALES), []
    for p in kernel.graph.inputs:
        random = rng.normal(size=(len(scales), *p.shape))
        centre = machine.neutral() if p.name == "q" else 0.0
        is_drives = p.name == "parameters"
        found = machine.drive_parameters * (1 + random / 100) if is_drives else centre + scales[:, None] * random
        with np.errstate(all="ignore"):
            rows.append(found.astype(np.float32))
    return rows


def every_kind(q: Any, v: Any, M: Any) -> Any:
    """Outputs that are computed, constant, and inputs as they came."""
    column = [where(sin(x) < v, exp(x) / (1 + x * x), -tanh(x * v)) for x in q]
    return [[*column, 0.1, M[i][3], -0.0, log(M[i][0] * M[i][0] + v * v) + atan(q[i])] for i in range(3)]


def batch(size: int) -> Rows:
    return [RNG.normal(size=(size, *shape)).astype(np.float32) for shape in SHAPES]
