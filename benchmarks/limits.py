"""Limits of one core: multiply-adds per second, and bytes stored and copied per second.

python benchmarks/limits.py      prints them
"""

import time
from collections.abc import Callable

import numpy as np
from machine_loops import Machine

from cutpoint.kernels.machine.jit import vector_width
from cutpoint.kernels.machine.llvm_code import Code

CHAINS = 12
"""Independent multiply-adds under way: more than two units of latency 4 take, and few enough for the registers."""

IN_CACHE, IN_MEMORY = 1_000_000, 256_000_000
"""Bytes of a batch as the tables have it, and of one that no cache holds."""

ROUNDS = 15


def limits() -> dict[str, float]:
    """flops: float64 operations a second, a multiply-add for two.  The others: bytes a second.

    store: of plain stores into as much memory as a batch of the tables takes.  copy: by NumPy, from and to memory,
    bytes read and bytes written both counted.
    """
    source, target = np.ones(IN_MEMORY // 8), np.zeros(IN_MEMORY // 8)
    count, near, rounds = IN_CACHE // 8, np.zeros(IN_CACHE // 8 + 8), 100_000
    peak, store = _multiply_adds(), _stores()
    start = near.ctypes.data + -near.ctypes.data % 64
    return {
        "flops": 2 * CHAINS * vector_width() * rounds / _seconds(lambda: peak(rounds, near.ctypes.data)),
        "store": 8 * count / _seconds(lambda: store(count // vector_width(), start)),
        "copy": 2 * source.nbytes / _seconds(lambda: np.copyto(target, source)),
    }


def _multiply_adds() -> Machine:
    """(rounds, memory): chains of c = c / 2 + 1 / 2, which memory has in the end."""
    kind, code = f"<{vector_width()} x double>", Code()
    half = f"{kind} <{', '.join(['double 0.5'] * vector_width())}>"
    fma = f"@llvm.fma.v{vector_width()}f64"
    code.lines += ["br label %head", "head:", "%i = phi i64 [ 0, %entry ], [ %j, %head ]"]
    code.lines += [f"%c{k} = phi {half.replace(' <', ' [ <', 1)}, %entry ], [ %n{k}, %head ]" for k in range(CHAINS)]
    code.lines += [f"%n{k} = call {kind} {fma}({kind} %c{k}, {half}, {half})" for k in range(CHAINS)]
    code.lines += ["%j = add i64 %i, 1", "%more = icmp slt i64 %j, %rounds"]
    code.lines += ["br i1 %more, label %head, label %done", "done:"]
    for k in range(CHAINS):
        code.store(f"%n{k}", "%memory", k, kind, 8)
    return Machine("peak", ["i64 %rounds", "ptr %memory"], code.lines, f"declare {kind} {fma}({kind}, {kind}, {kind})")


def _stores() -> Machine:
    """(vectors, memory): as many vectors of ones."""
    kind, code = f"<{vector_width()} x double>", Code()
    with code.loop("%vectors") as loop:
        code.store(f"<{', '.join(['double 1.0'] * vector_width())}>", "%memory", loop.iteration, kind)
    return Machine("stores", ["i64 %vectors", "ptr %memory"], code.lines)


def _seconds(call: Callable[[], object]) -> float:
    """The least of several: what the machine can, not what else it does."""
    found = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        call()
        found.append(time.perf_counter() - start)
    return min(found)


if __name__ == "__main__":
    print(", ".join(f"{name} {value / 1e9:.1f} G/s" for name, value in limits().items()))
