"""Kernels inside JAX, jitted and batched by vmap, against the same kernels on rows of NumPy arrays."""

import sys
from dataclasses import asdict

import jax
import numpy as np
import ours
from cases import ROBOTS, TASKS, Case, Entry, case
from tasks import agreed

from cutpoint.kernels import Kernel
from cutpoint.studies.cost.timing import in_turns


def jax_rows() -> list[dict]:
    jax.config.update("jax_enable_x64", True)
    found = []
    for name in ROBOTS:
        robot = case(name)
        for task in TASKS:
            print(f"{name}: {task} in JAX", file=sys.stderr)
            found.append(measured(robot, task))
    return found


def measured(robot: Case, task: str) -> dict:
    inputs = robot.inputs(task)
    kernel = ours.kernel_of(robot, task, inputs)
    entries = {"rows": ours.rows(kernel, inputs), "JAX": in_jax(kernel, inputs)}
    differences = agreed(f"{robot.name}, {task} in JAX", entries, entries["rows"].results)
    times = in_turns({name: x.call for name, x in entries.items()}, len(inputs[0]))
    return {"robot": robot.name, "task": task, "rows": len(inputs[0]), "differences": differences,
            "times": {name: asdict(x) for name, x in times.items()}}  # fmt: skip


def in_jax(kernel: Kernel, inputs: list[np.ndarray]) -> Entry:
    """From arrays of JAX's to others, which are waited for."""
    compute, given = jax.jit(jax.vmap(kernel.to_jax())), [jax.numpy.asarray(x) for x in inputs]
    found = [np.asarray(x) for x in jax.tree.leaves(compute(*given))]
    results = np.stack(found, axis=1) if len(found) > 1 else found[0]
    return Entry(lambda: jax.block_until_ready(compute(*given)), results)
