"""CUDA C of a graph: one thread computes one configuration, in straight-line code that rounds as our machine code does.

Every rounded operation is a CUDA intrinsic such as __dadd_rn or __fadd_rn, which compilers neither contract nor
reassociate.
"""

import math
import re
from collections.abc import Sequence
from string import Template
from typing import Any

from cutpoint.errors import InputError
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import CONDITIONS, Node
from cutpoint.kernels.graphs.ports import Port, slot_names, with_numbers
from cutpoint.kernels.graphs.precision import FLOAT32, FLOAT64, Precision
from cutpoint.kernels.lowering.few_held import Order, fewest_held
from cutpoint.kernels.lowering.lower import lower
from cutpoint.kernels.targets import c99, c_names
from cutpoint.kernels.targets.cuda_results import LEAVE, THREADS, Step, leaving, windows_of

_FORMS = {
    "add": "__{d}add_rn({}, {})", "sub": "__{d}sub_rn({}, {})", "mul": "__{d}mul_rn({}, {})",
    "div": "__{d}div_rn({}, {})", "neg": "-{}", "sqrt": "__{d}sqrt_rn({})",
    "fma": "__fma{f}_rn({}, {}, {})", "fms": "__fma{f}_rn({}, {}, -{})", "fnma": "__fma{f}_rn(-{}, {}, {})",
    "lt": "{} < {}", "le": "{} <= {}", "and": "{} & {}", "or": "{} | {}", "not": "!{}",
}  # fmt: skip
"""Operations that CUDA has; all others are calls of the functions below."""

_WORDS = {
    FLOAT64: {"whole": "long long", "as_bits": "__double_as_longlong", "as_real": "__longlong_as_double", "d": "d"},
    FLOAT32: {"whole": "int", "as_bits": "__float_as_int", "as_real": "__int_as_float", "d": "f"},
}
"""What CUDA calls a number's bits, how to come by them and back, and the letter in the names of its roundings."""

_HELPERS = {
    "select": """\
static __device__ $real cutpoint_select(int a, $real c, $real d) {
  asm("" : "+r"(a)); /* or compilers take c < d ? c : d for a minimum, which tells zeros apart by their signs */
  return a ? c : d;
}
""",
    "flip": """\
static __device__ $real cutpoint_flip($real a, int bit, $real c) {
  const unsigned $whole sign = (unsigned $whole)$as_bits(a) >> bit & 1;
  return $as_real($as_bits(c) ^ ($whole)(sign << $top));
}
""",
    "pick": """\
static __device__ $real cutpoint_pick($real a, int bit, $real c, $real d) {
  return $as_bits(a) >> bit & 1 ? c : d;
}
""",
    "pow2": """\
static __device__ $real cutpoint_pow2($real a) {
  const $whole bits = $as_bits(__${d}add_rn(a, $magic)) + $bias;
  return $as_real(($whole)((unsigned $whole)bits << $fraction));
}
""",
    "exponent": """\
static __device__ $real cutpoint_exponent($real a) {
  return ($real)((int)((unsigned $whole)$as_bits(a) >> $fraction) - $bias);
}
""",
    "significand": """\
static __device__ $real cutpoint_significand($real a) {
  return $as_real(($as_bits(a) & $mask) | ($whole)$bias << $fraction);
}
""",
}
"""What takes more than a word; PRIMITIVES says what it means."""

_REGISTERS = 840
"""Bytes of a thread's registers that are left for numbers, about."""

_OWN = ("blockIdx", "blockDim", "threadIdx", "gridDim", "warpSize", "CUDARTAPI", "cutpoint")
"""What CUDA has names for."""

_FUNCTIONS = re.compile(
    "(rcbrt|rhypot|r?norm([34]d)?|normcdf(inv)?|erfc?inv|erfcx|sincospi|cyl_bessel_i[01]|fdivide)f?|(u|ll|ull)?(min|max)"
    "|clock64|dim3|(u?(char|short|int|long|longlong)|float|double)[1-4]"
)
"""What CUDA has besides C's library."""


def check_names(name: str, graph: Graph) -> None:
    """Raises InputError for a name that CUDA C cannot take or that two arguments share."""
    inputs, outputs = full(graph)
    c_names.check_names(name, inputs, outputs)
    own = {*_OWN, "count", *(_step(p).name for p in inputs)}
    for port in (*inputs, *outputs):
        if port.name in own:
            told = f"{port.name!r} is a name that CUDA or the kernel itself already uses"
            raise InputError(f"{name}: {told}: rename it", name=port.name)
    if name in _OWN or _FUNCTIONS.fullmatch(name):
        raise InputError(f"{name}: CUDA already uses this name: rename it", name=name)


def full(graph: Graph) -> tuple[list[Port], list[Port]]:
    """Inputs and outputs of nonzero size: only these are the function's arguments."""
    inputs, outputs = map(with_numbers, (graph.inputs, graph.outputs))
    return inputs, outputs


def declaration(name: str, graph: Graph, attributes: str = "") -> str:
    """The kernel's signature."""
    (inputs, outputs), real = full(graph), graph.precision.c
    read = [f"const {real} *__restrict__ {p.name}, long long {_step(p).name}" for p in inputs]
    arguments = ["long long count", *read, *(f"{real} *__restrict__ {p.name}" for p in outputs)]
    lines = ",\n    ".join(arguments)
    return f'extern "C" __global__ void {attributes}{name}(\n    {lines})'


def code(name: str, graph: Graph) -> str:
    """The complete code, without includes.

    Raises InputError for names that CUDA C cannot take.
    """
    check_names(name, graph)
    lowered, (_, outputs) = lower(graph), full(graph)
    texts = {op: text for op, text in _HELPERS.items() if op in lowered.operations}
    texts |= {"leave": LEAVE} if windows_of(outputs, graph.precision) else {}
    words = c99.words(graph.precision) | _WORDS[graph.precision]
    helpers = "\n".join(_once(f"{op}_{graph.precision.bits}", text) for op, text in texts.items())
    head = declaration(name, graph, f"__launch_bounds__({THREADS}) ")
    return f"{Template(helpers).substitute(words)}\n{head} {{\n{_body(lowered)}}}\n".lstrip()


def _once(what: str, text: str) -> str:
    """A helper that several kernels of one source file share, with an include guard."""
    return f"#ifndef CUTPOINT_{what}\n#define CUTPOINT_{what}\n{text}#endif\n"


def _body(graph: Graph) -> str:
    """The statements, in an order of low register pressure."""
    names: dict[int, str] = {}
    (inputs, outputs), precision = full(graph), graph.precision
    slots = slot_names(inputs)

    def name(x: Any) -> str:
        return names[x.serial] if isinstance(x, Node) else _number(x, precision) if isinstance(x, float) else str(x)

    def steps(order: Order) -> list[Step]:
        return leaving(outputs, graph.results, order, precision)

    def reads(order: Order) -> list[tuple[int, Node]]:
        return [(step.after - 1, step.value) for step in steps(order) if isinstance(step.value, Node)]

    order = fewest_held(graph, reads, _REGISTERS // precision.item)
    lines = _place(inputs, outputs, precision)
    left = steps(order)[::-1]
    for count, x in enumerate([None, *order]):
        if x is not None:
            names[x.serial] = f"_{count}"
            value = slots[x.args[0]] if x.op == "input" else _expression(x.op, [name(y) for y in x.args], precision)
            lines.append(f"const {'bool' if x.op in CONDITIONS else precision.c} _{count} = {value};")
        while left and left[-1].after == count:
            step = left.pop()
            lines.append(step.text.format(name(step.value)))
    return "".join(f"  {line}\n" for line in lines)


def _place(inputs: Sequence[Port], outputs: Sequence[Port], precision: Precision) -> list[str]:
    """This thread's configuration, and pointers to its numbers; with windows, to the warp's rows.

    Threads of the last warp without a configuration then recompute its first, to the same bits: windows need all
    threads of the warp.
    """
    lines = ["const long long cutpoint_thread = (long long)blockIdx.x * blockDim.x + threadIdx.x;"]
    windows = windows_of(outputs, precision)
    together = {window.port.name for window in windows}
    if windows:
        shared = max(window.distance for window in windows)
        lines = [
            f"__shared__ {precision.c} cutpoint_block[{THREADS * shared}];", *lines,
            "const unsigned cutpoint_lane = threadIdx.x % 32;",
            "const long long cutpoint_first = cutpoint_thread - cutpoint_lane;",
            "if (cutpoint_first >= count) return;",
            "const unsigned cutpoint_rows = count - cutpoint_first < 32 ? (unsigned)(count - cutpoint_first) : 32;",
            "const long long cutpoint_row = cutpoint_thread < count ? cutpoint_thread : cutpoint_first;",
            f"{precision.c} *const cutpoint_stage = cutpoint_block + threadIdx.x / 32 * {32 * shared};",
        ]  # fmt: skip
    else:
        lines += ["if (cutpoint_thread >= count) return;", "const long long cutpoint_row = cutpoint_thread;"]
    return [
        *lines, *(f"{p.name} += cutpoint_row * {_step(p).name};" for p in inputs),
        *(f"{p.name} += {'cutpoint_first' if p.name in together else 'cutpoint_row'} * {p.size};" for p in outputs),
    ]  # fmt: skip


def _expression(op: str, operands: list[str], precision: Precision) -> str:
    if op in _FORMS:
        return _FORMS[op].format(*operands, d=_WORDS[precision]["d"], f=precision.suffix)
    return f"cutpoint_{op}({', '.join(operands)})"


def _number(x: float, precision: Precision) -> str:
    """A float as a constant; CUDA can write infinity and NaN only by their bits."""
    if math.isfinite(x):
        return c99.number(x, precision)
    bits = precision.dtype.type(abs(x)).view(f"i{precision.item}")
    text = f"{_WORDS[precision]['as_real']}({hex(bits)})"
    return f"(-{text})" if x < 0 else text


def _step(port: Port) -> Port:
    """The argument that holds an input's stride between configurations, in numbers: 0 if all share it."""
    return Port(f"{port.name}_step", ())
