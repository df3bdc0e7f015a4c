"""Kernels on a GPU: first equality of bits with machine code, then times against a copy of as many bytes.

python benchmarks/gpu.py      (needs the extra cuda, a GPU, and the package example-robot-data)
"""

import statistics
from collections.abc import Callable
from importlib.metadata import files
from typing import Any

import cupy
import numpy as np

import cutpoint
from cutpoint import derivatives
from cutpoint.kernels import Kernel

ROUNDS = 9
BYTES = 2**28
"""Of a batch: more than any cache holds."""

ROBOTS = {"UR10": ("ur10_robot.urdf", ()), "Panda": ("panda.urdf", ("panda_finger_joint1", "panda_finger_joint2"))}
"""Files of the package example-robot-data, and joints held at zero."""

FUNCTIONS = {
    "inverse_dynamics": 3,
    "forward_dynamics": 3,
    "mass_matrix": 1,
    "regressor": 3,
    "elastic_inverse_dynamics": 5,
}
"""Functions of a robot, and their numbers of input vectors."""


def robots() -> dict[str, cutpoint.Robot]:
    """The same drive in every joint: it counts where joints bend."""
    drive = next(iter(cutpoint.robots.xia2019().drives.values()))
    found = {}
    for name, (file, locked) in ROBOTS.items():
        (entry,) = [x for x in files("example-robot-data") or () if x.name == file]
        found[name] = cutpoint.load(str(entry.locate()), lock=dict.fromkeys(locked, 0.0))
    return found | {f"{name} with drives": x.with_drives(dict.fromkeys(x.joints, drive)) for name, x in found.items()}


def kernels(robot: cutpoint.Robot, is_elastic: bool) -> dict[str, Kernel]:
    found = {}
    for function, vectors in FUNCTIONS.items():
        if function.startswith("elastic") == is_elastic:
            getattr(robot, function)(*np.zeros((vectors, robot.nv)))
            found[function.replace("_", " ")] = robot.kernel(function)
    if not is_elastic:
        derivatives.inverse_dynamics(robot, *np.zeros((3, robot.nv)))
        found["derivatives"] = robot.kernel("inverse_dynamics_derivatives")
    return found


def differing(kernel: Kernel, robot: cutpoint.Robot) -> int:
    """Number of results that are not bitwise those of machine code."""
    rows, wrong = inputs(kernel, robot, 4099), 0
    for ours, theirs in zip(_parts(kernel.on_gpu()(*rows)), _parts(kernel(*map(cupy.asnumpy, rows))), strict=True):
        bits = f"u{theirs.itemsize}"
        wrong += int((cupy.asnumpy(ours).view(bits) != theirs.view(bits)).sum())
    return wrong


def inputs(kernel: Kernel, robot: cutpoint.Robot, count: int) -> list[Any]:
    """Random rows; the drives' numbers are the same for all."""
    dtype, rng = kernel.graph.precision.dtype, cupy.random.default_rng(0)
    return [
        cupy.asarray(robot.drive_parameters, dtype)
        if p.name == "parameters"
        else (4 * rng.random((count, *p.shape)) - 2).astype(dtype)
        for p in kernel.graph.inputs
    ]


def seconds(call: Callable[[], Any]) -> float:
    """Median over the rounds, by the GPU's own clock."""
    call()
    found = []
    for _ in range(ROUNDS):
        begin, end = cupy.cuda.Event(), cupy.cuda.Event()
        begin.record()
        call()
        end.record()
        end.synchronize()
        found.append(cupy.cuda.get_elapsed_time(begin, end) / 1e3)
    return statistics.median(found)


def _parts(result: Any) -> list[Any]:
    return [*result] if isinstance(result, tuple) else [result]


def main() -> None:
    array = cupy.ones(BYTES // 8)
    copied = cupy.empty_like(array)
    rate = 2 * BYTES / seconds(lambda: cupy.copyto(copied, array))
    told = cupy.cuda.runtime.getDeviceProperties(0)["name"].decode()
    print(f"cutpoint {cutpoint.__version__}, CuPy {cupy.__version__}, {told}: a copy moves {rate / 1e12:.2f} TB/s")
    print(f"{'':56}{'bits differ':>12}{'ns each':>9}{'of the copy':>13}")
    for name, robot in robots().items():
        for function, double in kernels(robot, "drives" in name).items():
            for kernel in double, double.float32:
                precision = kernel.graph.precision
                ports = [p for p in (*kernel.graph.inputs, *kernel.graph.outputs) if p.name != "parameters"]
                each = precision.item * sum(p.size for p in ports)
                count, function_on_gpu = BYTES // each, kernel.on_gpu()
                rows = inputs(kernel, robot, count)
                time = seconds(lambda call=function_on_gpu, rows=rows: call(*rows)) / count
                share = each / rate / time
                line = f"{name}, {function}, {precision.dtype.name}"
                print(f"{line:56}{differing(kernel, robot):12}{1e9 * time:9.4f}{share:12.0%}", flush=True)


if __name__ == "__main__":
    main()
