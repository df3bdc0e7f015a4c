"""C99 of a graph: straight-line code, which rounds exactly as our machine code does.

Every operation is one statement, so a compiler cannot contract or reassociate without flags that violate the C
standard; those are refused, and contraction is switched off, at the head of the file.
"""

import math
from collections.abc import Sequence
from string import Template
from textwrap import indent
from typing import Any, NamedTuple

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import CONDITIONS, Node
from cutpoint.kernels.graphs.ports import Port, slot_names, with_numbers
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.lowering.lower import lower

_FORMS = {
    "add": "{} + {}", "sub": "{} - {}", "mul": "{} * {}", "div": "{} / {}", "neg": "{}", "sqrt": "sqrt{f}({})",
    "fma": "fma{f}({}, {}, {})", "fms": "fma{f}({}, {}, {})", "fnma": "fma{f}({}, {}, {})",
    "lt": "{} < {}", "le": "{} <= {}", "and": "{} & {}", "or": "{} | {}", "not": "!{}",
}  # fmt: skip
"""Operations that C has; all others are calls of the functions below."""

_TURNED = {"neg": 0, "fms": 2, "fnma": 0}
"""Which operand changes its sign."""

_FUSED = ("fma", "fms", "fnma")

_BITS = """\
static inline $word cutpoint_bits($real x) {
  $word bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

static inline $real cutpoint_real($word bits) {
  $real x;
  memcpy(&x, &bits, sizeof x);
  return x;
}
"""

_HELPERS = {
    "select": """\
static inline $real cutpoint_select(int a, $real c, $real d) {
#if defined(__clang__)
  __asm__("" : "+r"(a)); /* or clang takes c < d ? c : d for a minimum, which orders -0 before 0 */
#endif
  return a ? c : d;
}
""",
    "flip": """\
static inline $real cutpoint_flip($real a, int bit, $real c) {
  return cutpoint_real(cutpoint_bits(c) ^ (cutpoint_bits(a) >> bit & 1) << $top);
}
""",
    # by masks, since branches would be unpredictable
    "pick": """\
static inline $real cutpoint_pick($real a, int bit, $real c, $real d) {
  const $word mask = 0 - (cutpoint_bits(a) >> bit & 1);
  return cutpoint_real((cutpoint_bits(c) & mask) | (cutpoint_bits(d) & ~mask));
}
""",
    "pow2": """\
static inline $real cutpoint_pow2($real a) {
  return cutpoint_real((cutpoint_bits(a + $magic) + $bias) << $fraction);
}
""",
    "exponent": """\
static inline $real cutpoint_exponent($real a) {
  return ($real)((int)(cutpoint_bits(a) >> $fraction) - $bias);
}
""",
    "significand": """\
static inline $real cutpoint_significand($real a) {
  return cutpoint_real((cutpoint_bits(a) & ${mask}U) | ($word)$bias << $fraction);
}
""",
}
"""The primitives that C has no exact operator for; PRIMITIVES says what they mean."""

_MINUS = """\
static inline $real cutpoint_minus($real x) { /* a sign that gcc does not draw into a fused operation */
  return cutpoint_real(cutpoint_bits(x) ^ ($word)1 << $top);
}
"""


def words(precision: Precision) -> dict[str, Any]:
    """What stands in templates for numbers of this precision, and for their bits."""
    magic, mask = number(precision.magic, precision), hex((1 << precision.fraction) - 1)
    return {
        "real": precision.c, "word": f"uint{precision.bits}_t", "top": precision.bits - 1, "mask": mask,
        "fraction": precision.fraction, "bias": precision.bias, "magic": magic,
    }  # fmt: skip


def number(x: float, precision: Precision) -> str:
    """A float as a C99 constant: hexadecimal, so no digit is lost; in parentheses where it has a sign."""
    x = precision.rounded(x)
    if math.isfinite(x):
        text = f"{abs(x).hex()}{precision.suffix}"
    elif math.isinf(x):  # headers hold them too, and there C++ may be told to warn of casts
        text = f"HUGE_VAL{precision.suffix.upper()}"
    else:  # a float; there is no other macro
        text = "NAN" if precision.suffix else f"({precision.c})NAN"
    return f"(-{text})" if math.copysign(1, x) < 0 and not math.isnan(x) else text


def parameters(inputs: Sequence[Port], outputs: Sequence[Port], precision: Precision) -> str:
    """The function's parameters: a number by value, arrays by their address, rows one after another."""
    real = precision.c
    given = [f"const {real} {p.name}[{p.size}]" if p.shape else f"{real} {p.name}" for p in inputs]
    return ", ".join([*given, *(f"{real} {p.name}[{p.size}]" for p in outputs)])


class Source(NamedTuple):
    """A function in C: what it takes and gives, the functions that it calls, its statements.

    stack: bytes that its loops work in; 0 of one without loops.
    """

    inputs: Sequence[Port]
    outputs: Sequence[Port]
    precision: Precision
    helpers: Sequence[str]
    body: str
    stack: int = 0


def source_of(graph: Graph) -> Source:
    """Of a graph, as straight-line code.  All inputs are read before an output is written: they may share memory."""
    inputs, outputs = map(with_numbers, (graph.inputs, graph.outputs))
    primitive = lower(graph)
    lines = [f"(void){p.name};" for p in inputs if p.name not in primitive.inputs_read]
    read = [x for p in inputs for x in (slot_names([p]) if p.shape else [p.name])]
    lines += statements(primitive, read, slot_names(outputs))
    text = "".join(f"  {line}\n" for line in lines)
    called = helpers([primitive], graph.precision)
    return Source(graph.inputs, graph.outputs, graph.precision, called, text)


def joined(parts: Sequence[Source], inputs: Sequence[Port], outputs: Sequence[Port]) -> Source:
    """One function after another: each reads, by name, arguments and what those before it have found.

    Inputs that are read after an output is written are kept until then: that output may be their memory.
    """
    precision, known = parts[0].precision, [p.name for p in (*inputs, *outputs)]
    own = {p.name: p for part in parts for p in part.outputs if p.name not in known}.values()
    read = {p.name for part in parts for p in part.inputs}
    lines = [f"  {precision.c} {p.name}[{p.size}];\n" for p in own]
    lines += [f"  (void){p.name}; /* written alone */\n" for p in own if p.name not in read]
    given, results = {p.name: p for p in inputs}, {p.name for p in outputs}
    kept, written = dict[str, Port](), False
    blocks = list[str]()
    for part in parts:
        again = [given[p.name] for p in part.inputs if written and p.name in given and p.shape]
        kept |= {p.name: p for p in again}
        names = "".join(f"    const {precision.c} *const {p.name} = kept_{p.name};\n" for p in again)
        blocks.append("  {\n" + names + indent(part.body, "  ") + "  }\n")
        written = written or any(p.name in results for p in part.outputs)
    for p in kept.values():
        lines.append(f"  {precision.c} kept_{p.name}[{p.size}];\n")
        lines.append(f"  for (int k = 0; k < {p.size}; k++) kept_{p.name}[k] = {p.name}[k];\n")
    lines += blocks
    called = dict.fromkeys(text for part in parts for text in part.helpers)
    stack = sum(part.stack for part in parts) + sum(precision.item * p.size for p in (*own, *kept.values()))
    return Source(inputs, outputs, precision, [*called], "".join(lines), stack)


def helpers(graphs: Sequence[Graph], precision: Precision) -> list[str]:
    """The functions that the code of lowered graphs calls."""
    used = [text for op, text in _HELPERS.items() if any(op in graph.operations for graph in graphs)]
    turned = (x for graph in graphs for x in graph.nodes if x.op in _TURNED)
    used += [_MINUS] if any(_is_fused(x.args[_turned(x)]) for x in turned) else []
    texts = [_BITS, *used] if any("cutpoint_bits" in text for text in used) else used
    return [Template(text).substitute(words(precision)) for text in texts]


def statements(graph: Graph, read: Sequence[str], write: Sequence[str]) -> list[str]:
    """Those of a lowered graph.  read, write: what its input slots and results are called."""
    names: dict[int, str] = {}
    lines, precision = list[str](), graph.precision

    def name(x: Any) -> str:
        return names[x.serial] if isinstance(x, Node) else number(x, precision) if isinstance(x, float) else str(x)

    for count, x in enumerate(graph.nodes):
        names[x.serial] = f"_{count}"
        value = read[x.args[0]] if x.op == "input" else _expression(x, [name(y) for y in x.args], precision)
        lines.append(f"const {'int' if x.op in CONDITIONS else precision.c} _{count} = {value};")
    return lines + [f"{slot} = {name(x)};" for slot, x in zip(write, graph.results, strict=True)]


def _expression(x: Node, operands: list[str], precision: Precision) -> str:
    if x.op in _TURNED:
        k = _turned(x)
        operands[k] = f"cutpoint_minus({operands[k]})" if _is_fused(x.args[k]) else f"-{operands[k]}"
    if x.op in _FORMS:
        return _FORMS[x.op].format(*operands, f=precision.suffix)
    return f"cutpoint_{x.op}({', '.join(operands)})"


def _turned(x: Node) -> int:
    """The operand that changes its sign; of two factors one that is not fused, where there is one.

    Of -fma(a, b, c) gcc makes one operation, fma(-a, b, -c), whose exact zeros have the other sign.
    """
    first = _TURNED[x.op]
    return 1 if x.op == "fnma" and _is_fused(x.args[0]) and not _is_fused(x.args[1]) else first


def _is_fused(x: Any) -> bool:
    return isinstance(x, Node) and x.op in _FUSED
