"""How a CUDA kernel stores its results.

Each thread has its own row, so a store by a warp's 32 threads is scattered over 32 places; with long rows that takes
ten times as long as coalesced stores of the same bytes.  Such rows are stored through windows: the threads stage part
of their rows in shared memory, and write it together, coalesced.
"""

from collections.abc import Sequence
from typing import NamedTuple

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision

THREADS = 128
"""Of a block."""

_DIRECT = 64
"""Bytes of a configuration's results that its thread may as well write itself."""

_SHORT = 3
"""Numbers of an output that lie near enough to their neighbours' in any case."""

_WINDOW = 32
"""Numbers of a row that leave together."""

LEAVE = """\
static __device__ __forceinline__ void cutpoint_leave(
    const $real *stage, $real *rows, int size, unsigned width, unsigned count) {
  __syncwarp();
  for (unsigned i = threadIdx.x % 32; i < count * width; i += 32)
    rows[i / width * size + i % width] = stage[i / width * (width | 1) + i % width];
  __syncwarp();
}
"""
"""A window of so many rows, from shared memory."""


class Window(NamedTuple):
    """Part of an output's rows.  start: its first number in the row.  slot: the same among all results."""

    port: Port
    start: int
    slot: int

    @property
    def width(self) -> int:
        return min(_WINDOW, self.port.size - self.start)

    @property
    def distance(self) -> int:
        """Row pitch in shared memory: odd, to avoid bank conflicts."""
        return self.width | 1


class Step(NamedTuple):
    """A statement after so many operations; its value, if any, replaces the braces."""

    after: int
    text: str
    value: Operand | None = None


def windows_of(outputs: Sequence[Port], precision: Precision) -> list[Window]:
    """The windows for results; those in none are written directly by their threads."""
    if precision.item * sum(p.size for p in outputs) <= _DIRECT:
        return []
    slots = zip(outputs, _slots(outputs), strict=True)
    return [Window(p, k, slot + k) for p, slot in slots if p.size > _SHORT for k in range(0, p.size, _WINDOW)]


def leaving(
    outputs: Sequence[Port], results: Sequence[Operand], order: Sequence[Node], precision: Precision
) -> list[Step]:
    """The statements that store results, in order.

    Direct stores come as soon as a result is computed.  One window is filled at a time, as soon as its results are
    computed; the one that is complete first comes first.
    """
    place = {x.serial: k for k, x in enumerate(order, 1)}
    places = [place[x.serial] if isinstance(x, Node) else 0 for x in results]
    windows, steps, opened = windows_of(outputs, precision), list[Step](), 0
    together = {window.port.name for window in windows}
    for p, slot in zip(outputs, _slots(outputs), strict=True):
        if p.name not in together:
            steps += [Step(places[slot + k], f"{p.name}[{k}] = {{}};", results[slot + k]) for k in range(p.size)]
    for window in sorted(windows, key=lambda x: max(places[x.slot : x.slot + x.width])):
        port, start, slot = window
        for k in sorted(range(window.width), key=lambda k: places[slot + k]):
            text = f"cutpoint_stage[{window.distance} * cutpoint_lane + {k}] = {{}};"
            steps.append(Step(max(opened, places[slot + k]), text, results[slot + k]))
        opened = steps[-1].after
        rows = f"{port.name} + {start}" if start else port.name
        text = f"cutpoint_leave(cutpoint_stage, {rows}, {port.size}, {window.width}, cutpoint_rows);"
        steps.append(Step(opened, text))
    return sorted(steps, key=lambda step: step.after)


def _slots(outputs: Sequence[Port]) -> list[int]:
    """The index of each output's first number among all results."""
    return [sum(p.size for p in outputs[:k]) for k in range(len(outputs))]
