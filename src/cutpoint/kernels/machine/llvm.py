"""LLVM IR of a graph: straight-line code in static single assignment form, no fast-math, no contraction."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from cutpoint.kernels.graphs.graph import Graph, reach
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.graphs.precision import FLOAT64, Precision
from cutpoint.kernels.machine.llvm_code import Code, literal

_FORMS = {
    "add": "fadd {real} {}, {}",
    "sub": "fsub {real} {}, {}",
    "mul": "fmul {real} {}, {}",
    "div": "fdiv {real} {}, {}",
    "neg": "fneg {real} {}",
    "sqrt": "call {real} @llvm.sqrt.{suffix}({real} {})",
    "copysign": "call {real} @llvm.copysign.{suffix}({real} {}, {real} {})",
    "fma": "call {real} @llvm.fma.{suffix}({real} {}, {real} {}, {real} {})",
    "lt": "fcmp olt {real} {}, {}",
    "le": "fcmp ole {real} {}, {}",
    "and": "and {truth} {}, {}",
    "or": "or {truth} {}, {}",
    "not": "xor {truth} {}, {true}",
    "select": "select {truth} {}, {real} {}, {real} {}",
}
"""Operations that are one instruction."""


class Lanes:
    """The types of a vector of so many lanes; a single lane is a scalar.

    Attributes:
        one: the type of a single number; item: its size, bytes.
        real: the vector's type; whole: that of its bits; truth: that of comparisons.
    """

    def __init__(self, width: int, precision: Precision = FLOAT64) -> None:
        self.width, self.precision = width, precision
        self.one, self.item = precision.real, precision.item
        self._bits = f"i{precision.bits}"
        self.real, self.whole, self.truth = map(self._type, (self.one, self._bits, "i1"))
        self.true = self._each("i1", "true")
        self.suffix = f"f{precision.bits}" if width == 1 else f"v{width}f{precision.bits}"
        self.declarations = "".join(
            f"declare {self.real} @llvm.{name}.{self.suffix}({', '.join([self.real] * arguments)})\n"
            for name, arguments in (("sqrt", 1), ("copysign", 2), ("fma", 3))
        )

    def constant(self, x: float) -> str:
        """A float constant in every lane."""
        return self._each(self.one, literal(x))

    def integer(self, k: int) -> str:
        """An integer constant in every lane."""
        return self._each(self._bits, str(k))

    def spread(self, code: Code, number: str) -> str:
        """A number broadcast to every lane."""
        first = code.let(f"insertelement {self.real} poison, {self.one} {number}, i64 0")
        everywhere = f"<{self.width} x i32> zeroinitializer"
        return code.let(f"shufflevector {self.real} {first}, {self.real} poison, {everywhere}")

    def joined(self, code: Code, numbers: list[str]) -> str:
        """Numbers packed into a vector, padded with zeros."""
        found = "zeroinitializer"
        for lane, number in enumerate(numbers):
            found = code.let(f"insertelement {self.real} {found}, {self.one} {number}, i64 {lane}")
        return found

    def turned(self, code: Code, vector: str, lanes: Sequence[int]) -> str:
        """A permutation of a vector: the chosen lanes, the rest unspecified."""
        places = [f"i32 {k}" for k in lanes] + ["i32 poison"] * (self.width - len(lanes))
        kind = f"<{self.width} x i32> <{', '.join(places)}>"
        return code.let(f"shufflevector {self.real} {vector}, {self.real} poison, {kind}")

    def beside(self, code: Code, a: str, b: str, lanes: Sequence[int | None]) -> str:
        """A shuffle of two vectors, the second's lanes numbered after the first's; None: unspecified."""
        places = ", ".join(f"i32 {'poison' if k is None else k}" for k in lanes)
        return code.let(f"shufflevector {self.real} {a}, {self.real} {b}, <{len(lanes)} x i32> <{places}>")

    def signed(self, code: Code, vector: str, signs: Sequence[int]) -> str:
        """A vector's lanes unchanged (1), negated (-1), or zero (0); the lanes after them unchanged."""
        top, bits = 1 << self.precision.bits - 1, _bits(code, self, vector)
        every = [*signs] + [1] * (self.width - len(signs))
        kept, turned = [-abs(sign) for sign in every], [top * (sign < 0) for sign in every]
        for operation, masks in (("and", kept), ("xor", turned)):
            numbers = ", ".join(f"{self._bits} {mask}" for mask in masks)
            bits = code.let(f"{operation} {self.whole} {bits}, <{numbers}>")
        return _real(code, self, bits)

    def one_of(self, code: Code, vector: str, lane: int) -> str:
        return code.let(f"extractelement {self.real} {vector}, i64 {lane}")

    def apply(self, code: Code, op: str, *arguments: str) -> str:
        """Emits one instruction and returns its value's name."""
        return code.let(_FORMS[op].format(*arguments, **self.__dict__))

    def _type(self, one: str) -> str:
        return one if self.width == 1 else f"<{self.width} x {one}>"

    def _each(self, kind: str, value: str) -> str:
        return value if self.width == 1 else f"<{', '.join([f'{kind} {value}'] * self.width)}>"


def straight_line(
    code: Code,
    graph: Graph,
    lanes: Lanes,
    load: Callable[[int], str],
    ready: Callable[[int, str], None] = lambda *_: None,
) -> list[str]:
    """Writes a lowered graph's operations and returns the names of its results; see `StraightLine`."""
    return StraightLine(code, graph, lanes, load, ready).written(range(len(graph.results)))


class StraightLine:
    """A lowered graph's operations, emitted on demand."""

    def __init__(
        self,
        code: Code,
        graph: Graph,
        lanes: Lanes,
        load: Callable[[int], str],
        ready: Callable[[int, str], None],
    ) -> None:
        """load(slot) names an input's value; ready(slot, name) is called as soon as a result is computed."""
        self._code, self._graph, self._load, self._ready, self._lanes = code, graph, load, ready, lanes
        self._names: dict[int, str] = {}
        self._slots: dict[int, list[int]] = {}
        for slot, x in enumerate(graph.results):
            if isinstance(x, Node):
                self._slots.setdefault(x.serial, []).append(slot)

    def written(self, slots: Iterable[int]) -> list[str]:
        """The names of results, emitted with all their dependencies."""
        wanted = [self._graph.results[slot] for slot in slots]
        needed = {x.serial for x in reach(wanted)} - self._names.keys()
        for x in self._graph.nodes:
            if x.serial in needed:
                self._write(x)
        return [self._name(x) for x in wanted]

    def _write(self, x: Node) -> None:
        if x.op == "input":
            name = self._load(x.args[0])
        else:
            name = applied(self._code, self._lanes, x.op, *map(self._name, x.args))
        self._names[x.serial] = name
        for slot in self._slots.get(x.serial, ()):
            self._ready(slot, name)

    def _name(self, x: Any) -> str:
        return self._names[x.serial] if isinstance(x, Node) else self._lanes.constant(x) if isinstance(x, float) else x


def applied(code: Code, lanes: Lanes, op: str, *arguments: Any) -> str:
    """Emits an operation and returns its value's name."""
    return lanes.apply(code, op, *arguments) if op in _FORMS else _SEQUENCES[op](code, lanes, *arguments)


def _fms(code: Code, lanes: Lanes, a: str, b: str, c: str) -> str:
    return lanes.apply(code, "fma", a, b, lanes.apply(code, "neg", c))


def _fnma(code: Code, lanes: Lanes, a: str, b: str, c: str) -> str:
    return lanes.apply(code, "fma", lanes.apply(code, "neg", a), b, c)


def _flip(code: Code, lanes: Lanes, a: str, bit: int, c: str) -> str:
    top = lanes.precision.bits - 1
    if bit == top:  # the sign, which need not go through an integer register
        sign = _bits(code, lanes, lanes.apply(code, "copysign", lanes.constant(0.0), a))
    else:
        sign = _whole(code, lanes, "and", _to_top(code, lanes, a, bit), 1 << top)
    return _real(code, lanes, _whole(code, lanes, "xor", _bits(code, lanes, c), sign))


def _pick(code: Code, lanes: Lanes, a: str, bit: int, c: str, d: str) -> str:
    if lanes.width > 1:
        bits = _whole(code, lanes, "and", _bits(code, lanes, a), 1 << bit)
        chosen = code.let(f"icmp ne {lanes.whole} {bits}, {lanes.integer(0)}")
        return lanes.apply(code, "select", chosen, c, d)
    # by masks: a select on an integer condition becomes a branch on processors without AVX-512
    mask = _whole(code, lanes, "ashr", _to_top(code, lanes, a, bit), lanes.precision.bits - 1)
    yes = _whole(code, lanes, "and", _bits(code, lanes, c), mask)
    no = _whole(code, lanes, "and", _bits(code, lanes, d), _whole(code, lanes, "xor", mask, -1))
    return _real(code, lanes, _whole(code, lanes, "or", yes, no))


def _pow2(code: Code, lanes: Lanes, n: str) -> str:
    precision = lanes.precision
    bits = _bits(code, lanes, lanes.apply(code, "add", n, lanes.constant(precision.magic)))
    biased = _whole(code, lanes, "add", bits, precision.bias)
    return _real(code, lanes, _whole(code, lanes, "shl", biased, precision.fraction))


def _exponent(code: Code, lanes: Lanes, a: str) -> str:
    biased = _whole(code, lanes, "lshr", _bits(code, lanes, a), lanes.precision.fraction)
    exponent = _whole(code, lanes, "sub", biased, lanes.precision.bias)
    return code.let(f"sitofp {lanes.whole} {exponent} to {lanes.real}")


def _significand(code: Code, lanes: Lanes, a: str) -> str:
    fraction = lanes.precision.fraction
    digits = _whole(code, lanes, "and", _bits(code, lanes, a), (1 << fraction) - 1)
    return _real(code, lanes, _whole(code, lanes, "or", digits, lanes.precision.bias << fraction))


def _to_top(code: Code, lanes: Lanes, a: str, bit: int) -> str:
    return _whole(code, lanes, "shl", _bits(code, lanes, a), lanes.precision.bits - 1 - bit)


def _whole(code: Code, lanes: Lanes, operation: str, a: str, b: str | int) -> str:
    return code.let(f"{operation} {lanes.whole} {a}, {lanes.integer(b) if isinstance(b, int) else b}")


def _bits(code: Code, lanes: Lanes, a: str) -> str:
    return code.let(f"bitcast {lanes.real} {a} to {lanes.whole}")


def _real(code: Code, lanes: Lanes, bits: str) -> str:
    return code.let(f"bitcast {lanes.whole} {bits} to {lanes.real}")


_SEQUENCES: dict[str, Callable[..., str]] = {
    "fms": _fms, "fnma": _fnma, "flip": _flip, "pick": _pick, "pow2": _pow2, "exponent": _exponent,
    "significand": _significand,
}  # fmt: skip
"""Operations that take several instructions."""
