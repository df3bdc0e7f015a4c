"""LLVM IR of a graph: straight-line code in single static assignment, no fast-math, no contraction."""

import struct
from collections.abc import Callable
from typing import Any

from cutpoint.kernels.graph import Graph
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

DECLARATIONS = "declare double @llvm.sqrt.f64(double)\ndeclare double @llvm.fma.f64(double, double, double)\n"


class Code:
    """Lines of a function under way."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._count = 0

    def let(self, expression: str) -> str:
        """A new name for the value of an expression."""
        self._count += 1
        self.lines.append(f"%v{self._count} = {expression}")
        return f"%v{self._count}"


def constant(x: float) -> str:
    """A float by its bits: no decimal digits in between."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', x))[0]:016x}"


def straight_line(code: Code, graph: Graph, load: Callable[[int], str]) -> list[str]:
    """Writes the graph's operations and returns the names of its results.  load(slot) names an input's value."""
    names: dict[int, str] = {}

    def name(x: Any) -> str:
        return names[x.serial] if isinstance(x, Node) else constant(x)

    for x in graph.nodes:
        if x.op == "input":
            names[x.serial] = load(x.args[0])
        elif x.op == "bit":
            names[x.serial] = _bit(code, name(x.args[0]), x.args[1])
        elif x.op == "fnma":
            a = code.let(f"fneg double {name(x.args[0])}")
            names[x.serial] = code.let(_FORMS["fma"].format(a, name(x.args[1]), name(x.args[2])))
        elif x.op == "fms":
            a = code.let(f"fneg double {name(x.args[2])}")
            names[x.serial] = code.let(_FORMS["fma"].format(name(x.args[0]), name(x.args[1]), a))
        else:
            names[x.serial] = code.let(_FORMS[x.op].format(*map(name, x.args)))
    return [name(x) for x in graph.results]

def _bit(code, x, k):
    bits = code.let(f"bitcast double {x} to i64")
    return code.let(f"icmp ne i64 {code.let(f'and i64 {bits}, {1<<k}')}, 0")
