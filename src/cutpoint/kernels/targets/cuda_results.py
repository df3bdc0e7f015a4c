"""How results leave a CUDA kernel.

Each thread has a row of its own, so a write of a warp's 32 threads goes to 32 places; where rows are long, memory then
takes ten times as long as for the same bytes side by side.  Such rows leave by windows: the threads lay a part of their
rows into shared memory, and write that together, neighbours next to neighbours.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from cutpoint.kernels.graphs.algebra import Operand
from cutpoint.kernels.graphs.nodes import Node
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision

THREADS = 128
"""Of a block."""

_WARP = 32
_DIRECT = 64
"""Bytes of a configuration's results that its thread may as well write itself."""

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
"""A window of so many rows, from shared memory; an odd distance there keeps its banks apart."""


@dataclass(frozen=True)
class Step:
    """A statement after so many operations; its value, if it has one, goes where the braces are."""

    after: int
    text: str
    value: Operand | None = None


def by_windows(outputs: Sequence[Port], precision: Precision) -> bool:
    """Whether results leave by windows."""
    return precision.item * sum(p.size for p in outputs) > _DIRECT


def shared_numbers(outputs: Sequence[Port]) -> int:
    """What a block needs of shared memory for its widest window."""
    return THREADS * _apart(min(_WINDOW, max(p.size for p in outputs)))


def leaving(outputs: Sequence[Port], results: Sequence[Operand], order: Sequence[Node], windows: bool) -> list[Step]:
    """The statements by which results leave, in turn.

    Directly, a result leaves as soon as it is there.  One window is filled at a time, as soon as results are there; the
    one that is complete first comes first.
    """
    place = {x.serial: k for k, x in enumerate(order, 1)}
    places = [place[x.serial] if isinstance(x, Node) else 0 for x in results]
    slots = [(p, k) for p in outputs for k in range(p.size)]
    if not windows:
        steps = [Step(at, f"{p.name}[{k}] = {{}};", x) for (p, k), x, at in zip(slots, results, places, strict=True)]
        return sorted(steps, key=lambda step: step.after)
    steps, opened = [], 0
    for start, stop in sorted(_windows(outputs), key=lambda window: max(places[slice(*window)])):
        (port, first), width = slots[start], stop - start
        inside = sorted(range(start, stop), key=places.__getitem__)
        row = f"cutpoint_stage[{_apart(width)} * cutpoint_lane + {{}}] = {{{{}}}};"
        steps += [Step(max(opened, places[k]), row.format(k - start), results[k]) for k in inside]
        opened = steps[-1].after
        there = f"{port.name} + {first}" if first else port.name
        steps.append(Step(opened, f"cutpoint_leave(cutpoint_stage, {there}, {port.size}, {width}, cutpoint_rows);"))
    return steps


def _windows(outputs: Sequence[Port]) -> list[tuple[int, int]]:
    """First and last slot of each, the last not included."""
    found, start = [], 0
    for port in outputs:
        stop = start + port.size
        found += [(first, min(first + _WINDOW, stop)) for first in range(start, stop, _WINDOW)]
        start = stop
    return found


def _apart(width: int) -> int:
    """Between the rows of a window in shared memory: an odd number, so that its banks are hit alike."""
    return width | 1
