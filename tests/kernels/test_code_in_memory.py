"""Machine code is freed with its owner, and only then."""

import gc
import resource
import weakref
from pathlib import Path

import numpy as np

from cutpoint import Robot, robots
from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.machine.jit import Compiled

DOUBLED = "define double @doubled(double %x) {\n %y = fadd double %x, %x\n ret double %y\n}\n"


def in_memory() -> int:
    """Bytes of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def test_code_whose_owner_is_gone_leaves_nothing_behind() -> None:
    for _ in range(300):
        Compiled(DOUBLED, "doubled")
    before = in_memory()
    for _ in range(1000):
        Compiled(DOUBLED, "doubled")
    assert in_memory() - before < 1000 * 2**11


def test_kernels_outlive_those_compiled_beside_them() -> None:
    def scaled(factor: float) -> Kernel:
        return compile(lambda x: x * factor, x=(), name="scaled", backend="llvm")

    kept = {}
    for k, kernel in enumerate(map(scaled, np.arange(2.0, 82.0))):
        kernel(1.0)
        if k % 20 == 0:
            kept[2.0 + k] = kernel
    del kernel
    gc.collect()
    assert all(kernel(3.0) == 3 * factor for factor, kernel in kept.items())


def test_a_robots_kernels_go_with_it_at_once() -> None:
    paper = robots.xia2019()
    ours, q = Robot(paper.mechanism, paper.drives), np.zeros(paper.nv)
    ours.inverse_dynamics(q, q, q)
    ours.jacobian(q, paper.frames[-1])
    kernels = [weakref.ref(ours.kernel(name)) for name in ("inverse_dynamics", "jacobian")]
    gc.disable()
    try:
        del ours
        assert [kernel() for kernel in kernels] == [None, None]
    finally:
        gc.enable()
