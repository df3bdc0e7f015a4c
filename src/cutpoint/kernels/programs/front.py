"""A program as a built-in function of Python: arrays in, a run on the program's own memory, arrays out.

A call keeps the GIL, so that calls from several threads do not race in that memory.
"""

from collections.abc import Callable, Mapping, Sequence
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from cutpoint.kernels.arrays.fastcall import Front, fastcall
from cutpoint.kernels.arrays.plain_arguments import is_possible
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.machine.element import FUNCTION
from cutpoint.kernels.machine.jit import Compiled
from cutpoint.kernels.machine.llvm_code import Code
from cutpoint.kernels.programs.compiled import BoundProgram
from cutpoint.kernels.programs.outputs import Output, whole

NUMBER = np.dtype(np.float64).itemsize


def front_of(
    run: Callable[[], int], name: str, inputs: Mapping[str, np.ndarray], outputs: Mapping[str, Output], front: Front
) -> Any:
    """The function; `front.general` itself where Python or NumPy has no shortcut.

    run: a program's, bound by LLVM.  inputs: parts of its arrays, filled from a call's arguments.
    """
    if not is_possible():
        return front.general
    given, made = ([Port(key, x.shape) for key, x in some.items()] for some in (inputs, outputs))
    element = ProgramElement(run, [*map(whole, inputs.values())], [*outputs.values()])
    return fastcall(element, name, given, made, front)


class ProgramElement:
    """Copies in, a run that LLVM bound, copies out, as a function of pointers."""

    def __init__(self, run: Callable[[], int], inputs: Sequence[Output], outputs: Sequence[Output]) -> None:
        assert isinstance(run, BoundProgram), "NumPy's programs have no machine code"
        self.call: Callable[..., Any] = run
        arguments = [*inputs, *outputs]
        self._owned = [part.own for x in arguments for part in x.parts]  # some of this the run itself does not own
        symbols = {f"own{k}": own.ctypes.data for k, own in enumerate(self._owned)}
        self._code = Compiled(_ir(arguments, len(inputs)), FUNCTION, symbols=symbols | run.symbols)

    @property
    def element(self) -> int:
        return self._code.address


def _ir(arguments: Sequence[Output], inputs: int) -> str:
    """The module's text up to the element; so many of the arguments are inputs."""
    lines = [f"@own{k} = external global i8" for k in range(sum(len(x.parts) for x in arguments))]
    lines += ["@counts = external global i8", "@regions = external global i8", "declare i64 @program(ptr, ptr)"]
    lines += ["declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)"]
    head = f"define void @{FUNCTION}({', '.join(f'ptr %given{k}' for k in range(len(arguments)))}) {{\nentry:"
    code, numbers = Code(), count()
    for k, x in enumerate(arguments):
        if k == inputs:
            code.let("call i64 @program(ptr @counts, ptr @regions)")
        room = np.empty(x.shape)
        for part in x.parts:
            there = part.place(room)
            place = code.at(f"%given{k}", there.ctypes.data - room.ctypes.data, "i8")
            given, own = _Place(place, there.strides), _Place(f"@own{next(numbers)}", part.own.strides)
            to, source = (own, given) if k < inputs else (given, own)
            _copy(code, to, source, part.own.shape)
    return "\n".join([*lines, head, *code.lines, "ret void", "}", ""])


class _Place(NamedTuple):
    """Start of an array, and its strides in bytes."""

    pointer: str
    strides: Sequence[int]

    def entry(self, code: Code, k: str) -> "_Place":
        """The k-th entry along the first axis."""
        offset = code.let(f"mul i64 {k}, {self.strides[0]}")
        return _Place(code.at(self.pointer, offset, "i8"), self.strides[1:])


def _copy(code: Code, to: _Place, source: _Place, shape: Sequence[int]) -> None:
    if not shape:
        code.store(code.load(source.pointer, 0), to.pointer, 0)
    elif len(shape) == 1 and to.strides[0] == source.strides[0] == NUMBER:
        arguments = f"ptr {to.pointer}, ptr {source.pointer}, i64 {NUMBER * shape[0]}, i1 false"
        code.lines.append(f"call void @llvm.memcpy.p0.p0.i64({arguments})")
    else:
        with code.loop(shape[0]) as loop:
            _copy(code, to.entry(code, loop.iteration), source.entry(code, loop.iteration), shape[1:])
