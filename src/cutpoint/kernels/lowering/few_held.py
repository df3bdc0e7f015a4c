"""Schedules of a graph's operations with low register pressure.

A GPU hides latency behind other threads, and the more registers each takes, the fewer can run.  No order is best for
all graphs, and a compiler reorders at will: of these candidates the one is taken that asks for least beyond the
registers, then for least in total.  On ten functions of arms that predicted the order for which CUDA's compiler would
spill least, or use fewest registers, better than the maximum of live numbers does.
Sethi and Ullman (1970), "The generation of optimal code for arithmetic expressions".
"""

import heapq
from collections.abc import Callable, Iterable, Sequence
from itertools import accumulate, count

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node

_MOST_NODES = 2**15
"""In longer graphs the choice among all that could come next takes seconds: those are ordered by need alone."""

Order = list[Node]
Uses = Callable[[Order], Iterable[tuple[int, Node]]]
"""The places in an order after which something outside the graph, such as memory, reads a node."""


def fewest_held(graph: Graph, reads: Uses, registers: int) -> Order:
    """The graph's operations, operands before users, in the candidate order with the fewest live numbers."""

    def asks(order: Order) -> tuple[int, int]:
        found = numbers_held(order, reads(order))
        return sum(max(0, n - registers) for n in found), sum(found)

    return min(_candidates(graph), key=asks)


def numbers_held(order: Order, reads: Iterable[tuple[int, Node]]) -> list[int]:
    """Number of live numbers at each operation; a live range is from its definition to its last use."""
    last = {y.serial: k for k, x in enumerate(order) for y in _operands(x)}
    for k, x in reads:
        last[x.serial] = max(k, last.get(x.serial, k))
    growth = [0] * (len(order) + 1)
    for k, x in enumerate(order):
        growth[k] += 1
        growth[last.get(x.serial, k) + 1] -= 1
    return [*accumulate(growth[:-1])]


def _candidates(graph: Graph) -> list[Order]:
    nodes, results = graph.nodes, [x for x in graph.results if isinstance(x, Node)]
    need = _needs(nodes)
    found = [_by_need(results, need), _by_need(sorted(results, key=lambda x: need[x.serial]), need)]
    if len(nodes) <= _MOST_NODES:
        found += [_forwards(found[0]), _backwards(nodes)]
    return found


def _needs(nodes: Sequence[Node]) -> dict[int, int]:
    """Registers for each node if computed alone: the most demanding operand first, its result held meanwhile."""
    need: dict[int, int] = {}
    for x in nodes:
        operands = sorted((need[y.serial] for y in _operands(x)), reverse=True)
        need[x.serial] = max((n + held for held, n in enumerate(operands)), default=1)
    return need


def _by_need(results: Iterable[Node], need: dict[int, int]) -> Order:
    """Depth first, result by result, the most demanding operand first."""
    order: dict[int, Node] = {}
    waiting = [(x, False) for x in reversed([*results])]
    while waiting:
        x, has_operands = waiting.pop()
        if has_operands:
            order.setdefault(x.serial, x)
        elif x.serial not in order:
            operands = sorted(_operands(x), key=lambda y: need[y.serial])
            waiting += [(x, True), *((y, False) for y in operands if y.serial not in order)]
    return [*order.values()]


def _forwards(nodes: Sequence[Node]) -> Order:
    """Always the ready operation that ends the most live ranges; of several, the latest to become ready."""
    users = _users(nodes)
    unread = {key: len(x) for key, x in users.items()}
    missing = {x.serial: len(_operands(x)) for x in nodes}
    begun = set[int]()

    def growth(x: Node) -> int:
        return (unread[x.serial] > 0) - sum(unread[y.serial] == 1 for y in _operands(x))

    def begin(x: Node) -> tuple[list[Node], list[Node]]:
        begun.add(x.serial)
        alone = list[Node]()
        for y in _operands(x):
            unread[y.serial] -= 1
            if unread[y.serial] == 1:  # its last user now ends its live range
                alone += [user for user in users[y.serial] if user.serial not in begun]
        for user in users[x.serial]:
            missing[user.serial] -= 1
        return [user for user in users[x.serial] if not missing[user.serial]], alone

    return _greedily([x for x in nodes if not missing[x.serial]], growth, begin)


def _backwards(nodes: Sequence[Node]) -> Order:
    """The same from the last operation to the first: always the one that makes the fewest more numbers live."""
    users = _users(nodes)
    unread = {key: len(x) for key, x in users.items()}
    held = set[int]()

    def growth(x: Node) -> int:
        return sum(y.serial not in held for y in _operands(x)) - (x.serial in held)

    def begin(x: Node) -> tuple[list[Node], list[Node]]:
        held.discard(x.serial)
        cheaper = [user for y in _operands(x) if y.serial not in held for user in users[y.serial]]
        held.update(y.serial for y in _operands(x))
        for y in _operands(x):
            unread[y.serial] -= 1
        return [y for y in _operands(x) if not unread[y.serial]], cheaper

    return _greedily([x for x in reversed(nodes) if not unread[x.serial]], growth, begin)[::-1]


def _greedily(
    ready: Sequence[Node],
    growth: Callable[[Node], int],
    begin: Callable[[Node], tuple[list[Node], list[Node]]],
) -> Order:
    """Always the ready operation with the least growth, the latest first.

    begin: returns the operations that become ready, and others whose growth may have shrunk.
    """
    order: Order = []
    turn = {x.serial: -k for k, x in enumerate(reversed(ready))}  # of the waiting operations
    waiting = [(growth(x), turn[x.serial], x.serial, x) for x in ready]
    heapq.heapify(waiting)
    turns = count(len(turn))
    while waiting:
        grows, _, key, x = heapq.heappop(waiting)
        if key not in turn or grows != growth(x):  # already scheduled, or waiting with less growth
            continue
        del turn[key]
        order.append(x)
        new, changed = begin(x)
        turn.update((y.serial, -next(turns)) for y in new)
        for y in (*new, *changed):
            if y.serial in turn:
                heapq.heappush(waiting, (growth(y), turn[y.serial], y.serial, y))
    return order


def _users(nodes: Sequence[Node]) -> dict[int, list[Node]]:
    users: dict[int, list[Node]] = {x.serial: [] for x in nodes}
    for x in nodes:
        for y in _operands(x):
            users[y.serial].append(x)
    return users


def _operands(x: Node) -> list[Node]:
    """Its operands without repetition."""
    return [*{y.serial: y for y in x.args if isinstance(y, Node)}.values()]
