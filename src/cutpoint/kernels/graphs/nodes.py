"""The graph's nodes: every operation on a trace's inputs, common subexpressions shared (hash consing)."""

import itertools
from typing import Any

from cutpoint.errors import InputError, TraceError

PRIMITIVES = {
    "input": "the number in slot a of the inputs, laid one after another",
    "add": "a + b",
    "sub": "a - b",
    "mul": "a * b",
    "div": "a / b",
    "neg": "-a",
    "sqrt": "square root of a",
    "fma": "a * b + c, rounded once",
    "fms": "a * b - c, rounded once",
    "fnma": "c - a * b, rounded once",
    "lt": "condition a < b; false where either is not a number",
    "le": "condition a <= b; false where either is not a number",
    "and": "condition a and b",
    "or": "condition a or b",
    "not": "condition not a",
    "select": "b where condition a holds, else c; both are evaluated",
    "flip": "c with its sign turned where bit b (a Python int, 0 the lowest) of the bits of a is set, else c",
    "pick": "c where bit b of the bits of a is set, else d",
    "pow2": "2**a for a whole a for which it is a normal number; unspecified elsewhere",
    "exponent": "the whole n with 2**n <= a < 2**(n + 1), for a normal a > 0; unspecified elsewhere",
    "significand": "a / 2**n with that n, in [1, 2); unspecified where n is",
}
"""All that an emitter must know, as op: meaning, with args (a, b, c, d): nodes and floats, a slot and bits ints."""

ELEMENTARY = ("sin", "cos", "tan", "exp", "log", "tanh", "atan")
"""Functions that a graph may hold until it is lowered to primitives."""

CONDITIONS = frozenset({"lt", "le", "and", "or", "not"})
COMMUTATIVE = frozenset({"add", "mul", "and", "or"})

MOST_TRACED = 2_000_000
"""Of one trace, those included that no result needs: they take some ten seconds and a gigabyte."""

_serials = itertools.count()


class Node:
    """One operation.  `op` is a name in PRIMITIVES or ELEMENTARY; `args` are nodes and floats, a slot and bits ints.

    `serial` orders all nodes by creation: operands come before their users.
    """

    __slots__ = ("args", "op", "serial", "trace")

    op: str
    args: tuple[Any, ...]
    serial: int
    trace: "Trace"

    def __repr__(self) -> str:
        return f"<{self.op} #{self.serial}>"


def key_of(x: Any) -> Any:
    """An operand's key, equal for equal operands: no serial is a string, and repr tells -0.0 from 0.0."""
    return x.serial if isinstance(x, Node) else repr(x)


class Trace:
    """The value table of one trace: equal operations on equal operands are one node."""

    __slots__ = ("_kinds", "_table")

    def __init__(self, real: type[Node], condition: type[Node]) -> None:
        self._kinds = (real, condition)
        self._table: dict[tuple[Any, ...], Node] = {}

    def node(self, op: str, *args: Any) -> Any:
        """The node of this operation, new or existing.

        Raises:
            TraceError: an operand belongs to another trace, or this trace has ended.
            InputError: there are too many nodes.
        """
        key = (op, *map(key_of, args))
        found = self._table.get(key)
        return self._add(key, op, args) if found is None else found

    def _add(self, key: tuple[Any, ...], op: str, args: tuple[Any, ...]) -> Node:
        if any(isinstance(x, Node) and x.trace is not self for x in args):
            raise TraceError("an operation combines numbers of two traces; make both inputs of one function")
        if len(self._table) >= MOST_TRACED:
            told = f"more than {MOST_TRACED} operations in one function are too many to trace"
            raise InputError(f"{told}; split it, or use a smaller model")
        node = Node.__new__(self._kinds[op in CONDITIONS])
        node.op, node.args, node.trace, node.serial = op, args, self, next(_serials)
        self._table[key] = node
        return node

    def end(self) -> None:
        """Ends the trace: any further operation on a leaked number is an error."""
        self._table = _Ended()


class _Ended(dict[tuple[Any, ...], Node]):
    """The table of a trace that has ended."""

    def get(self, key: Any, default: Any = None) -> Any:
        raise TraceError("a traced number was kept and used after its function was traced; return it instead")
