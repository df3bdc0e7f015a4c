"""A program as a built-in function of Python: vectors in, the program's run on memory of its own, vectors out.

A call keeps the GIL, so that calls from several threads do not meet in that memory.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cutpoint.kernels.element import FUNCTION
from cutpoint.kernels.fastcall import Front, fastcall, is_possible
from cutpoint.kernels.jit import Compiled
from cutpoint.kernels.ports import Port
from cutpoint.kernels.program_llvm import BoundProgram

Vectors = Mapping[str, np.ndarray]


def front_of(run: Callable[[], int], name: str, inputs: Vectors, outputs: Vectors, front: Front) -> Any:
    """The function; `front.general` itself where Python or NumPy knows no shortcut.

    run: a program's, bound by LLVM.  inputs, outputs: stretches of its arrays, which calls are given and give.
    """
    if not is_possible():
        return front.general
    assert isinstance(run, BoundProgram), "NumPy's programs have no machine code"
    given, made = ([Port(key, x.shape) for key, x in vectors.items()] for vectors in (inputs, outputs))
    return fastcall(_Element(run, inputs, outputs), name, given, made, front)


class _Element:
    """Copies in, the run, copies out, as a function of pointers."""

    def __init__(self, run: BoundProgram, inputs: Vectors, outputs: Vectors) -> None:
        self.call: Callable[..., Any] = run
        symbols = {f"own{k}": x.ctypes.data for k, x in enumerate((*inputs.values(), *outputs.values()))}
        self._code = Compiled(_ir(inputs, outputs), FUNCTION, symbols=symbols | run.symbols)

    @property
    def element(self) -> int:
        return self._code.address


def _ir(inputs: Vectors, outputs: Vectors) -> str:
    sizes = [x.nbytes for x in (*inputs.values(), *outputs.values())]
    places = [("@own", "%given")] * len(inputs) + [("%given", "@own")] * len(outputs)
    lines = [f"@own{k} = external global i8" for k in range(len(sizes))]
    lines += ["@counts = external global i8", "@regions = external global i8", "declare i64 @program(ptr, ptr)"]
    lines += ["declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)"]
    lines += [f"define void @{FUNCTION}({', '.join(f'ptr %given{k}' for k in range(len(sizes)))}) {{\nentry:"]
    copies = [
        f"call void @llvm.memcpy.p0.p0.i64(ptr {to}{k}, ptr {source}{k}, i64 {size}, i1 false)"
        for k, (size, (to, source)) in enumerate(zip(sizes, places, strict=True))
    ]
    run = "call i64 @program(ptr @counts, ptr @regions)"
    return "\n".join([*lines, *copies[: len(inputs)], run, *copies[len(inputs) :], "ret void", "}", ""])
