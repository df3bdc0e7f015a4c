"""LLVM IR of a graph: straight-line code in single static assignment, no fast-math, no contraction."""

import struct
from collections.abc import Callable
from typing import Any

from cutpoint.kernels.elementary import MAGIC
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.llvm_code import Code
from cutpoint.kernels.nodes import Node

_FORMS = {
    "add": "fadd double {}, {}",
    "sub": "fsub double {}, {}",
    "mul": "fmul double {}, {}",
    "div": "fdiv double {}, {}",
    "neg": "fneg double {}",
    "sqrt": "call double @llvm.sqrt.f64(double {})",
    "fma": "call double @llvm.fma.f64(double {}, double {}, double {})",
    "lt": "fcmp olt double {}, {}",
    "le": "fcmp ole double {}, {}",
    "and": "and i1 {}, {}",
    "or": "or i1 {}, {}",
    "not": "xor i1 {}, true",
    "select": "select i1 {}, double {}, double {}",
}
"""Operations that are one instruction."""

DECLARATIONS = "declare double @llvm.sqrt.f64(double)\ndeclare double @llvm.fma.f64(double, double, double)\n"
"""What a module with straight-line code must declare."""


def constant(x: float) -> str:
    """A float by its bits: no decimal digits in between."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', x))[0]:016x}"


def straight_line(
    code: Code, graph: Graph, load: Callable[[int], str], ready: Callable[[int, str], None] = lambda *_: None
) -> list[str]:
    """Writes a lowered graph's operations and returns the names of its results.

    load(slot) names an input's value; ready(slot, name) hears of a result as soon as it is there.
    """
    names: dict[int, str] = {}
    slots: dict[int, list[int]] = {}
    for slot, x in enumerate(graph.results):
        if isinstance(x, Node):
            slots.setdefault(x.serial, []).append(slot)

    def name(x: Any) -> str:
        return names[x.serial] if isinstance(x, Node) else constant(x) if isinstance(x, float) else x

    for x in graph.nodes:
        if x.op == "input":
            names[x.serial] = load(x.args[0])
        elif x.op in _FORMS:
            names[x.serial] = code.let(_FORMS[x.op].format(*map(name, x.args)))
        else:
            names[x.serial] = _SEQUENCES[x.op](code, *map(name, x.args))
        for slot in slots.get(x.serial, ()):
            ready(slot, names[x.serial])
    return [name(x) for x in graph.results]


def _fms(code: Code, a: str, b: str, c: str) -> str:
    return code.let(_FORMS["fma"].format(a, b, code.let(f"fneg double {c}")))


def _fnma(code: Code, a: str, b: str, c: str) -> str:
    return code.let(_FORMS["fma"].format(code.let(f"fneg double {a}"), b, c))


def _flip(code: Code, a: str, bit: int, c: str) -> str:
    sign = code.let(f"and i64 {_to_top(code, a, bit)}, {1 << 63}")
    return _real(code, code.let(f"xor i64 {_bits(code, c)}, {sign}"))


def _pick(code: Code, a: str, bit: int, c: str, d: str) -> str:
    # by masks: a select on an integer condition becomes a jump on processors without AVX-512
    mask = code.let(f"ashr i64 {_to_top(code, a, bit)}, 63")
    yes = code.let(f"and i64 {_bits(code, c)}, {mask}")
    no = code.let(f"and i64 {_bits(code, d)}, {code.let(f'xor i64 {mask}, -1')}")
    return _real(code, code.let(f"or i64 {yes}, {no}"))


def _pow2(code: Code, n: str) -> str:
    bits = _bits(code, code.let(_FORMS["add"].format(n, constant(MAGIC))))
    return _real(code, code.let(f"shl i64 {code.let(f'add i64 {bits}, 1023')}, 52"))


def _exponent(code: Code, a: str) -> str:
    biased = code.let(f"lshr i64 {_bits(code, a)}, 52")
    return code.let(f"sitofp i64 {code.let(f'sub i64 {biased}, 1023')} to double")


def _significand(code: Code, a: str) -> str:
    digits = code.let(f"and i64 {_bits(code, a)}, {(1 << 52) - 1}")
    return _real(code, code.let(f"or i64 {digits}, {1023 << 52}"))


def _to_top(code: Code, a: str, bit: int) -> str:
    return code.let(f"shl i64 {_bits(code, a)}, {63 - bit}")


def _bits(code: Code, a: str) -> str:
    return code.let(f"bitcast double {a} to i64")


def _real(code: Code, bits: str) -> str:
    return code.let(f"bitcast i64 {bits} to double")


_SEQUENCES: dict[str, Callable[..., str]] = {
    "fms": _fms, "fnma": _fnma, "flip": _flip, "pick": _pick, "pow2": _pow2, "exponent": _exponent,
    "significand": _significand,
}  # fmt: skip
"""Operations that take several instructions."""
