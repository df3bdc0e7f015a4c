"""A loop in machine code around a function's address, so that no Python call stands between two calls.

By LLVM, which cutpoint brings: a machine without a C compiler measures the same.
"""

import ctypes
from collections.abc import Callable, Sequence

import numpy as np

from cutpoint.kernels.machine.jit import Compiled
from cutpoint.kernels.machine.llvm_code import Code


def called(address: int, arrays: Sequence[np.ndarray], count: int, owner: object) -> Callable[[], None]:
    """Calls the function at an address, void f(double *, ...), count times: a row of every array after another.

    arrays: C-contiguous, (count, ...); all calls get the same of one with no axis of rows, (n,).  owner: of the code.
    """
    code = Code()
    with code.loop("%count") as loop:
        starts = [code.let(f"mul i64 {loop.iteration}, {_stride(x)}") for x in arrays]
        rows = [code.at(f"%array{k}", start) for k, start in enumerate(starts)]
        code.lines.append(f"call void %f({', '.join(f'ptr {row}' for row in rows)})")
    function = Machine("calls", ["i64 %count", "ptr %f", *(f"ptr %array{k}" for k in range(len(arrays)))], code.lines)
    kept = (owner, *arrays)
    return lambda: function(count, address, *(x.ctypes.data for x in kept[1:]))


def _stride(x: np.ndarray) -> int:
    return x[0].size if x.ndim > 1 else 0


class Machine:
    """A function without result, from the lines of its body; called with whole numbers and addresses."""

    def __init__(self, name: str, parameters: Sequence[str], lines: Sequence[str], declared: str = "") -> None:
        body = "\n".join(["entry:", *lines, "ret void"])
        text = f"{declared}\ndefine void @{name}({', '.join(parameters)}) {{\n{body}\n}}\n"
        self._code = Compiled(text, name)  # the code lives as long as this
        kinds = [ctypes.c_int64 if x.startswith("i64") else ctypes.c_void_p for x in parameters]
        self._call = ctypes.CFUNCTYPE(None, *kinds)(self._code.address)

    def __call__(self, *arguments: int) -> None:
        self._call(*arguments)
