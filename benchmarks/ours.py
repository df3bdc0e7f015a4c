"""cutpoint's side: a kernel called once a row, on rows, and on blocks."""

import ctypes
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import compilers
import numpy as np
from cases import Call, Case, Entry
from machine_loops import called

from cutpoint import derivatives
from cutpoint.kernels import Kernel

C_FLAGS = ("-ffp-contract=off", "-fno-math-errno")
"""As an exported package compiles itself: rounding is part of the code."""


def kernel_of(case: Case, task: str, inputs: list[np.ndarray]) -> Kernel:
    """The kernel behind the robot's function, which is called once so that there is one."""
    robot, rows = case.robot, [x[:2] for x in inputs]
    if task == "Jacobian":
        robot.jacobian(*rows, case.flange, "local_world_aligned")
        return robot.kernel("jacobian")
    if task == "derivatives":
        derivatives.inverse_dynamics(robot, *rows)
        return robot.kernel("inverse_dynamics_derivatives")
    if task == "forward derivatives":
        derivatives.forward_dynamics(robot, *rows)
        return robot.kernel("forward_dynamics_derivatives")
    name = task.replace(" ", "_")
    getattr(robot, name)(*rows)
    return robot.kernel(name)


def entries(kernel: Kernel, inputs: list[np.ndarray]) -> dict[str, Entry]:
    """inputs: (count, n), the same for all rows (n,).

    single: machine code called once a row.  C99: the same, exported and compiled by gcc.  rows: the kernel on all rows.
    lanes: the kernel on blocks, which the caller keeps as they are.
    """
    found = {"single": single(kernel, inputs), "rows": rows(kernel, inputs), "lanes": lanes(kernel, inputs)}
    if compilers.version("gcc"):
        found["C99"] = _c99(kernel, inputs)
    return found


def single(kernel: Kernel, inputs: list[np.ndarray]) -> Entry:
    out = _outputs(kernel, len(inputs[0]))
    address = kernel._function.element  # no public way leads to it: a call through Python is what is left out here
    with_numbers = [x for x in (*inputs, *out) if x.size]
    return _entry(called(address, with_numbers, len(inputs[0]), kernel), out)


def _c99(kernel: Kernel, inputs: list[np.ndarray]) -> Entry:
    with TemporaryDirectory() as folder:
        kernel.to_c(folder)
        text = Path(folder, f"{kernel.name}.c").read_text()
        header = Path(folder, f"{kernel.name}.h").read_text()
    library = compilers.library(text.replace(f'#include "{kernel.name}.h"', header), flags=C_FLAGS, linked=("-lm",))
    address, out = _address(library, kernel.name), _outputs(kernel, len(inputs[0]))
    return _entry(called(address, [*inputs, *out], len(inputs[0]), library), out)


def rows(kernel: Kernel, inputs: list[np.ndarray]) -> Entry:
    out = _outputs(kernel, len(inputs[0]))
    return _entry(partial(kernel, *inputs, out=tuple(out) if len(out) > 1 else out[0]), out)


def lanes(kernel: Kernel, inputs: list[np.ndarray]) -> Entry:
    blocks, count = kernel.blocks, len(inputs[0])
    given = [
        blocks.of(x) if x.ndim > len(port.shape) else np.repeat(x[:, None], blocks.width, axis=1)
        for x, port in zip(inputs, kernel.graph.inputs, strict=True)
    ]
    out = [blocks.of(x) for x in _outputs(kernel, count)]
    call = partial(blocks, *given, out=tuple(out) if len(out) > 1 else out[0])
    call()
    return Entry(call, _joined([blocks.rows(x, count) for x in out]))


def _outputs(kernel: Kernel, count: int) -> list[np.ndarray]:
    return [np.zeros((count, *p.shape)) for p in kernel.graph.outputs]


def _entry(call: Call, out: list[np.ndarray]) -> Entry:
    call()
    return Entry(call, _joined(out))


def _joined(out: list[np.ndarray]) -> np.ndarray:
    """All outputs of a row together."""
    alike = len({x.shape for x in out}) == 1
    return np.stack(out, axis=1) if alike and len(out) > 1 else out[0].copy()


def _address(library: ctypes.CDLL, name: str) -> int:
    return ctypes.cast(getattr(library, name), ctypes.c_void_p).value
