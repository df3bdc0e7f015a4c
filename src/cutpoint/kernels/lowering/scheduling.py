"""The order in which a graph's operations are written for a processor.

Compilers roughly keep the order that they are given, and a processor looks only some hundred operations ahead.  List
scheduling fills its stalls: of the ready operations the one on the longest path comes next; once the registers are
full, one that frees some.  Cooper and Torczon (2012), chapter 12.  Against depth-first order it was measured to save 10
to 30 % of the time of an arm's dynamics, in vector lanes and scalar code, by LLVM and by gcc.
"""

from bisect import insort
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.lowering.latencies import cycles

_REGISTERS = 33
"""One more than a processor has: an operand may come from memory.

Measured on Zen 4 with 28 to 33: alike, but for forward dynamics of a UR10 in lanes, which took 12 % longer with 32.
"""

_AT_ONCE = 3
"""Operations that begin in a cycle."""

_LOOKED_AT = 256
"""Operations among which the next is sought, those with the longest way first: arms have no more, so time is linear."""

_MOST_NODES = 2**12
"""Longer code waits for its own instructions, from memory, more than for operands: it stays depth first."""

_OPERATIONS_A_STORE = 3
"""Where there are fewer, stores are waited for: see `waits_for_stores`."""

_FEW_AHEAD = 32
"""Operations in depth-first order, from the first that has not begun, among which the next is then sought.

They let results go at all times, and hold few numbers.  Measured for an arm's regressor in batches of 1 MB: 10 to 20 %
less time in lanes, by depth-first order alone; 1 to 16 % less in calls one by one, by these, and 2 to 18 % where the
results' place is claimed first.
"""


@dataclass(frozen=True, eq=False)
class Scheduled(Graph):
    """A graph whose nodes are in the order in which they are best emitted."""

    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes that the results need: operands before users."""
        nodes = super().nodes
        if len(nodes) > _MOST_NODES:
            return nodes
        ahead = _FEW_AHEAD if waits_for_stores(nodes, self.results) else len(nodes)
        return tuple(nodes[k] for k in _Schedule(nodes).order(ahead))


def scheduled(graph: Graph) -> Scheduled:
    """The same graph in that order, which is computed on demand."""
    return Scheduled(graph.inputs, graph.outputs, graph.results, graph.precision)


def depth_first(graph: Graph) -> Graph:
    """The same graph in the order of its results."""
    return Graph(graph.inputs, graph.outputs, graph.results, graph.precision)


def waits_for_stores(nodes: Sequence[Node], results: Sequence[object]) -> bool:
    """Whether storing a lowered graph's results takes longer than computing them."""
    return len(nodes) < _OPERATIONS_A_STORE * len(results)


class _Schedule:
    """Nodes by their place in depth-first order.

    operands, users: of each, without repetition.  missing: operands not yet issued.  unread: users not yet issued.
    growth: how many more registers are live once it is issued.  there: cycle in which its operands are ready.
    rank: the first has the longest path from its issue to the last result that depends on it.
    """

    def __init__(self, nodes: Sequence[Node]) -> None:
        place = {x.serial: k for k, x in enumerate(nodes)}
        self._operands = [[*{place[y.serial]: 0 for y in x.args if isinstance(y, Node)}] for x in nodes]
        self._users: list[list[int]] = [[] for _ in nodes]
        for k, operands in enumerate(self._operands):
            for operand in operands:
                self._users[operand].append(k)
        self._cycles = [cycles(x.op) for x in nodes]
        self._missing, self._unread = ([*map(len, x)] for x in (self._operands, self._users))
        self._growth = [int(n > 0) for n in self._unread]
        self._begun: set[int] = set()
        for operand in range(len(nodes)):
            self._free(operand)
        self._there, self._rank = [0] * len(nodes), self._ranks()

    def _ranks(self) -> list[int]:
        way = [*self._cycles]
        for k in reversed(range(len(way))):
            way[k] += max((way[user] for user in self._users[k]), default=0)
        ranks = [0] * len(way)
        for rank, k in enumerate(sorted(range(len(way)), key=lambda k: -way[k])):
            ranks[k] = rank
        return ranks

    def order(self, ahead: int) -> list[int]:
        """ahead: size of the window from the first operation, in depth-first order, that is not yet issued."""
        order: list[int] = []
        ready: list[int] = []
        slot = held = first = seen = 0
        there, rank, growth = self._there, self._rank, self._growth
        while len(order) < len(there):
            first = next(k for k in count(first) if k not in self._begun)
            end = min(first + ahead, len(there))
            self._join(ready, range(seen, end))
            seen, cycle, looked_at = end, slot // _AT_ONCE, ready[:_LOOKED_AT]
            if held < _REGISTERS:
                k = min(looked_at, key=lambda k: (there[k] > cycle, rank[k]))
            else:
                k = min(looked_at, key=lambda k: (growth[k], there[k], rank[k]))
            slot = max(slot, there[k] * _AT_ONCE)
            ready.remove(k)
            order.append(k)
            held += growth[k]
            self._join(ready, (user for user in self._begin(k, slot // _AT_ONCE) if user < seen))
            slot += 1
        return order

    def _join(self, ready: list[int], others: Iterable[int]) -> None:
        """Adds those that have all their operands."""
        for k in others:
            if not self._missing[k]:
                insort(ready, k, key=self._rank.__getitem__)

    def _begin(self, k: int, cycle: int) -> list[int]:
        """Issues k; returns the operations that now have all their operands."""
        self._begun.add(k)
        for operand in self._operands[k]:
            self._unread[operand] -= 1
            self._free(operand)
        for user in self._users[k]:
            self._missing[user] -= 1
            self._there[user] = max(self._there[user], cycle + self._cycles[k])
        return [user for user in self._users[k] if not self._missing[user]]

    def _free(self, operand: int) -> None:
        """Notes that its only remaining user will free its register."""
        if self._unread[operand] == 1:
            self._growth[next(user for user in self._users[operand] if user not in self._begun)] -= 1
