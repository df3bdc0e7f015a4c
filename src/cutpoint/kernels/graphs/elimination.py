"""The chain rule on a graph, by vertex elimination between inputs and results.

Every edge carries the partial derivative of a number with respect to one of its operands.  Eliminating a number joins
its operands to its users; when only inputs and results are left, the edges are the Jacobian.  From the operands on this
is forward mode, from the results back it is reverse mode; an edge that does not exist costs nothing.
Griewank and Walther (2008), chapters 9 and 10.
"""

import heapq
from collections.abc import Callable, Iterable, Iterator, Sequence

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.graph import reach
from cutpoint.kernels.graphs.nodes import CONDITIONS, Node
from cutpoint.kernels.graphs.slopes import Slope, local_slopes


class Web:
    """Numbers by serial, operands before users, and the partial derivatives between them; results are -1, -2, ...

    slopes: by number, then by operand.  users: by number, its users (as keys).  inner: numbers that are neither
    independent nor results.
    """

    def __init__(self, results: Sequence[Operand], independent: Sequence[Node]) -> None:
        self.independent, self.results = [x.serial for x in independent], len(results)
        self.slopes: dict[int, dict[int, Slope]] = {}
        self.users: dict[int, dict[int, None]] = {x.serial: {} for x in independent}
        for x in reach(results):
            entering = [k for k, y in enumerate(x.args) if isinstance(y, Node) and y.serial in self.users]
            if entering and x.op not in CONDITIONS and x.serial not in self.users:
                self._insert(x.serial)
                local = local_slopes(x)
                for k in entering:
                    self._join(x.args[k].serial, x.serial, local[k])
        self.inner = [*self.slopes]
        for k, x in enumerate(results):
            self._insert(-1 - k)
            if isinstance(x, Node) and x.serial in self.users:
                self._join(x.serial, -1 - k, Slope(1.0))

    def eliminate(self, number: int) -> None:
        """Eliminates a number: its operands become operands of its users."""
        entering = self.slopes.pop(number)
        for source in entering:
            del self.users[source][number]
        for user in self.users.pop(number):
            outer = self.slopes[user].pop(number)
            for source, inner in entering.items():
                self._join(source, user, outer * inner)

    def cost(self, number: int) -> int:
        """Upper bound on the products that its elimination takes."""
        return len(self.slopes[number]) * len(self.users[number])

    def _insert(self, number: int) -> None:
        self.slopes[number], self.users[number] = {}, {}

    def _join(self, source: int, user: int, slope: Slope) -> None:
        """Adds a path from a source to its user."""
        known = self.slopes[user].pop(source, None)
        self.users[source].pop(user, None)
        total = slope if known is None else known + slope
        if not total.vanishes:
            self.slopes[user][source], self.users[source][user] = total, None


Order = Callable[[Web], Iterable[int]]
"""Names the inner numbers of a web one by one, each after the one before has been eliminated."""


def forward(web: Web) -> Iterable[int]:
    """Operands first: the derivatives of every number with respect to the inputs."""
    return [*web.inner]


def reverse(web: Web) -> Iterable[int]:
    """Results first: the derivatives of the results with respect to every number."""
    return web.inner[::-1]


def cheapest_first(web: Web) -> Iterator[int]:
    """The number that takes the fewest products first: Markowitz' rule."""
    queue = [(web.cost(x), -x) for x in web.inner]
    heapq.heapify(queue)
    while queue:
        cost, x = heapq.heappop(queue)
        if -x in web.slopes and web.cost(-x) == cost:
            near = [*web.slopes[-x], *web.users[-x]]
            yield -x
            for y in near:
                if y in web.slopes and y >= 0:
                    heapq.heappush(queue, (web.cost(y), -y))


def forward_products(web: Web) -> int:
    """Estimated products that `forward` takes: for each edge, the inputs that reach it."""
    reached = {x: 1 << k for k, x in enumerate(web.independent)}
    total = 0
    for x, entering in web.slopes.items():
        reached[x] = 0
        for y in entering:
            total += reached[y].bit_count()
            reached[x] |= reached[y]
    return total


def reverse_products(web: Web) -> int:
    """Estimated products that `reverse` takes: for each edge, the results that it reaches."""
    feeds: dict[int, int] = {}
    total = 0
    for x in reversed(web.slopes):
        feeds[x] = 1 << -1 - x if x < 0 else 0
        for y in web.users[x]:
            feeds[x] |= feeds[y]
        total += len(web.slopes[x]) * feeds[x].bit_count()
    return total


MANY_PRODUCTS = 30_000
"""From here on, about 0.3 s, only the order that promises the fewest products is carried out."""


def orders_for(web: Web) -> list[Order]:
    """The elimination orders worth trying."""
    products = {forward: forward_products(web), reverse: reverse_products(web)}
    best = min(products, key=lambda order: products[order])
    return [best] if products[best] > MANY_PRODUCTS else [forward, reverse, cheapest_first]


def jacobian(
    results: Sequence[Operand], independent: Sequence[Node], orders: Sequence[Order] | None = None
) -> list[Operand]:
    """d result / d independent number, row by row, in the trace of both, by the order that gives fewest operations.

    orders: those to try, default those worth trying.
    """
    tried = orders or orders_for(Web(results, independent))
    return min((_eliminated(Web(results, independent), order) for order in tried), key=lambda found: len(reach(found)))


def _eliminated(web: Web, order: Order) -> list[Operand]:
    for number in order(web):
        web.eliminate(number)
    rows = [web.slopes[-1 - k] for k in range(web.results)]
    return [row[x].operand if x in row else 0.0 for row in rows for x in web.independent]
