"""CUDA C of a graph: one thread computes one configuration, in straight-line code that rounds as our machine code does.

Every rounding is one of CUDA's intrinsics, __dadd_rn and its like, which compilers neither contract nor reassociate.
"""

import math
from collections.abc import Sequence
from typing import Any

from cutpoint.kernels import c99
from cutpoint.kernels.elementary import MAGIC
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.lowering import lower
from cutpoint.kernels.nodes import CONDITIONS, Node
from cutpoint.kernels.ports import Port

_FORMS = {
    "add": "__dadd_rn({}, {})", "sub": "__dsub_rn({}, {})", "mul": "__dmul_rn({}, {})", "div": "__ddiv_rn({}, {})",
    "neg": "-{}", "sqrt": "__dsqrt_rn({})",
    "fma": "__fma_rn({}, {}, {})", "fms": "__fma_rn({}, {}, -{})", "fnma": "__fma_rn(-{}, {}, {})",
    "lt": "{} < {}", "le": "{} <= {}", "and": "{} & {}", "or": "{} | {}", "not": "!{}", "select": "{} ? {} : {}",
}  # fmt: skip
"""Operations that CUDA has; all others are calls of the functions below."""

_HELPERS = {
    "flip": """\
static __device__ double cutpoint_flip(double a, int bit, double c) {
  const unsigned long long sign = (unsigned long long)__double_as_longlong(a) >> bit & 1;
  return __longlong_as_double(__double_as_longlong(c) ^ (long long)(sign << 63));
}
""",
    "pick": """\
static __device__ double cutpoint_pick(double a, int bit, double c, double d) {
  return __double_as_longlong(a) >> bit & 1 ? c : d;
}
""",
    "pow2": f"""\
static __device__ double cutpoint_pow2(double a) {{
  const long long bits = __double_as_longlong(__dadd_rn(a, {MAGIC.hex()})) + 1023;
  return __longlong_as_double((long long)((unsigned long long)bits << 52));
}}
""",
    "exponent": """\
static __device__ double cutpoint_exponent(double a) {
  return (double)((int)((unsigned long long)__double_as_longlong(a) >> 52) - 1023);
}
""",
    "significand": """\
static __device__ double cutpoint_significand(double a) {
  return __longlong_as_double((__double_as_longlong(a) & 0xfffffffffffffLL) | 1023LL << 52);
}
""",
}
"""The primitives that look at bits; PRIMITIVES says what they mean."""

_OWN = [Port(name, ()) for name in ("count", "blockIdx", "blockDim", "threadIdx", "gridDim", "warpSize")]
"""What CUDA and the code have names for."""


def check_names(name: str, graph: Graph) -> None:
    """Raises InputError for a name that CUDA C cannot take, or that two arguments share."""
    inputs, outputs = full(graph)
    c99.check_names(name, [*_OWN, *inputs, *map(_step, inputs)], outputs)


def full(graph: Graph) -> tuple[list[Port], list[Port]]:
    """Inputs and outputs that hold numbers: only these are the function's arguments."""
    inputs, outputs = ([p for p in ports if p.size] for ports in (graph.inputs, graph.outputs))
    return inputs, outputs


def declaration(name: str, graph: Graph) -> str:
    """The kernel's head."""
    inputs, outputs = full(graph)
    read = [f"const double *__restrict__ {p.name}, long long {_step(p).name}" for p in inputs]
    arguments = ["long long count", *read, *(f"double *__restrict__ {p.name}" for p in outputs)]
    lines = ",\n    ".join(arguments)
    return f'extern "C" __global__ void {name}(\n    {lines})'


def code(name: str, graph: Graph) -> str:
    """All of the code: nothing is included.

    Raises InputError for names that CUDA C cannot take.
    """
    check_names(name, graph)
    lowered = lower(graph)
    helpers = "\n".join(text for op, text in _HELPERS.items() if op in lowered.operations)
    return f"{helpers}\n{declaration(name, graph)} {{\n{_body(lowered)}}}\n".lstrip()


def _body(graph: Graph) -> str:
    """The statements.  A result leaves as soon as it is there, so that few registers are held."""
    names: dict[int, str] = {}
    inputs, outputs = full(graph)
    read, write = _slots(inputs), _slots(outputs)

    def name(x: Any) -> str:
        return names[x.serial] if isinstance(x, Node) else _number(x) if isinstance(x, float) else str(x)

    lines = [*_place(inputs, outputs)]
    leaving: dict[int, list[str]] = {}
    for slot, x in zip(write, graph.results, strict=True):
        if isinstance(x, Node):
            leaving.setdefault(x.serial, []).append(slot)
        else:
            lines.append(f"{slot} = {name(x)};")
    for count, x in enumerate(graph.nodes):
        names[x.serial] = f"_{count}"
        value = read[x.args[0]] if x.op == "input" else _expression(x.op, [name(y) for y in x.args])
        lines.append(f"const {'bool' if x.op in CONDITIONS else 'double'} _{count} = {value};")
        lines += [f"{slot} = _{count};" for slot in leaving.get(x.serial, ())]
    return "".join(f"  {line}\n" for line in lines)


def _place(inputs: Sequence[Port], outputs: Sequence[Port]) -> list[str]:
    """Which configuration this thread has, and where its numbers lie."""
    return [
        "const long long cutpoint_thread = (long long)blockIdx.x * blockDim.x + threadIdx.x;",
        "if (cutpoint_thread >= count) return;",
        *(f"{p.name} += cutpoint_thread * {_step(p).name};" for p in inputs),
        *(f"{p.name} += cutpoint_thread * {p.size};" for p in outputs),
    ]


def _expression(op: str, operands: list[str]) -> str:
    return _FORMS[op].format(*operands) if op in _FORMS else f"cutpoint_{op}({', '.join(operands)})"


def _number(x: float) -> str:
    """A float as a constant; CUDA knows infinity and not-a-number by their bits only."""
    if math.isfinite(x):
        return c99.number(x)
    bits = "0x7ff8" if math.isnan(x) else "0x7ff0"
    text = f"__longlong_as_double({bits}{'0' * 12}LL)"
    return f"(-{text})" if x < 0 else text


def _step(port: Port) -> Port:
    """The argument that says how many numbers lie between two configurations of an input: 0 if all share it."""
    return Port(f"{port.name}_step", ())


def _slots(ports: Sequence[Port]) -> list[str]:
    return [f"{p.name}[{k}]" for p in ports for k in range(p.size)]
