"""LLVM IR of a function that XLA calls: it runs a graph's batch loop on XLA's buffers, without copying.

XLA's foreign function interface passes a call frame: a C struct, declared in xla/ffi/api/c_api.h, which ships with
jaxlib.  Its fields are read at their offsets in version 0 of the interface; minor versions only append fields.
XLA's threads flush subnormal numbers to zero.  While our code runs, floats behave as in Python.
"""

from collections.abc import Sequence

import numpy as np

from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.machine.llvm_code import Code

FUNCTION = "xla_call"
LOOP, PACKS, FLOATS = "batch_loop_of_xla_call", "packs_of_xla_call", "floats_of_xla_call"
"""What the function needs: the loop, its data pointer, and the C library's fenv_t with which it runs."""

FENV_BYTES = 256
"""Room for a fenv_t of any platform."""

_EXTENSION, _ARGUMENTS, _RESULTS = 8, 72, 112
"""Of a call frame, in bytes: what else is asked, and the tables of buffers."""
_EXTENSION_KIND, _METADATA = 8, 24
_METADATA_IS_ASKED = 1
_ANSWERS = {24: 0, 28: 1, 32: 0}
"""To a question for metadata, by their place in bytes: major and minor version of the interface, and no promises."""
_DATA, _LENGTHS = 24, 40
"""Of a buffer, in bytes: its numbers, and the lengths of its axes."""

_HEADER = f"""declare void @{LOOP}(ptr, ptr, ptr, ptr)
declare i32 @fegetenv(ptr)
declare i32 @fesetenv(ptr)
@{PACKS} = external global ptr
@{FLOATS} = external global ptr
define ptr @{FUNCTION}(ptr %frame) {{
entry:"""


def xla_call(inputs: Sequence[Port], outputs: Sequence[Port], precision: Precision) -> str:
    """The module's text: XLA_FFI_Error *xla_call(XLA_FFI_CallFrame *).

    Every buffer has a leading axis before the port's own: of length 1 for an input that the whole batch shares, else
    the batch's length.  No port has size 0, and there is an output.
    """
    code, ports = Code(), (*inputs, *outputs)
    asked, run = code.name("asked"), code.name("run")
    extension = code.field("%frame", _EXTENSION)
    # a frame without an extension has a null pointer, which itself reads as no kind
    somewhere = code.let(f"select i1 {code.let(f'icmp eq ptr {extension}, null')}, ptr %frame, ptr {extension}")
    is_metadata = code.let(f"icmp eq i32 {code.field(somewhere, _EXTENSION_KIND, 'i32')}, {_METADATA_IS_ASKED}")
    code.branch(is_metadata, asked, run)
    code.open(asked)
    _answer(code, extension)
    code.open(run)
    arguments, lengths = (code.let(f"alloca {kind}, i64 {len(ports)}") for kind in ("ptr", "i64"))
    for number, buffer in enumerate(_buffers(code, inputs, outputs)):
        code.store(code.field(buffer, _DATA), arguments, number, "ptr")
        code.store(code.field(code.field(buffer, _LENGTHS), 0, "i64"), lengths, number, "i64")
    steps = _steps(code, ports, lengths, precision)
    count = code.at(lengths, len(inputs), "i64")
    theirs = code.let(f"alloca i8, i64 {FENV_BYTES}, align 16")
    code.let(f"call i32 @fegetenv(ptr {theirs})")
    code.let(f"call i32 @fesetenv(ptr @{FLOATS})")
    code.lines.append(f"call void @{LOOP}(ptr {arguments}, ptr {count}, ptr {steps}, ptr @{PACKS})")
    code.let(f"call i32 @fesetenv(ptr {theirs})")
    return "\n".join([_HEADER, *code.lines, "ret ptr null", "}", ""])


def _answer(code: Code, extension: str) -> None:
    """Reports the interface version that this is written for."""
    metadata = code.field(extension, _METADATA)
    for place, value in _ANSWERS.items():
        code.lines.append(f"store i32 {value}, ptr {code.at(metadata, place, 'i8')}")
    code.lines.append("ret ptr null")


def _buffers(code: Code, inputs: Sequence[Port], outputs: Sequence[Port]) -> list[str]:
    sides = ((code.field("%frame", _ARGUMENTS), inputs), (code.field("%frame", _RESULTS), outputs))
    return [code.load(table, k, "ptr") for table, ports in sides for k in range(len(ports))]


def _steps(code: Code, ports: Sequence[Port], lengths: str, precision: Precision) -> str:
    """Every argument's stride along the batch, in bytes, 0 if it is shared; then the strides along its own axes."""
    own = [stride for p in ports for stride in np.empty(p.shape, precision.dtype).strides]
    steps = code.let(f"alloca i64, i64 {len(ports) + len(own)}")
    for number, port in enumerate(ports):
        is_shared = code.let(f"icmp eq i64 {code.load(lengths, number, 'i64')}, 1")
        code.store(code.let(f"select i1 {is_shared}, i64 0, i64 {precision.item * port.size}"), steps, number, "i64")
    for k, stride in enumerate(own, start=len(ports)):
        code.store(str(stride), steps, k, "i64")
    return steps
