"""The graph of a stage, from its function."""

from collections.abc import Container, Sequence
from typing import Any

import numpy as np

from cutpoint.errors import TraceError
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.specialise import checked, name_of
from cutpoint.kernels.graphs.tracing import tracing
from cutpoint.kernels.programs.stepping import Region, Stage


def stage_graph(stage: Stage, regions: dict[str, Region], single: Container[str] = ()) -> Graph:
    """The graph of one lane of a stage: a vector in for each region read, a vector out for each region written.

    single: regions of which it sees one lane.
    """
    lanes = {name: r.lanes if r.lanes == stage.lanes or name in single else 1 for name, r in regions.items()}
    seen = {name: r.size // lanes[name] for name, r in regions.items()}
    inputs, outputs = ([Port(name, (seen[name],)) for name in names] for names in (stage.reads, stage.writes))
    with tracing() as trace:
        slots = iter([trace.node("input", k) for k in range(sum(p.size for p in inputs))])
        result = stage.function(*[[next(slots) for _ in range(p.size)] for p in inputs])
        lists = [result] if len(outputs) == 1 else result
        _check_lists(stage, outputs, lists)
        pairs = zip(outputs, lists, strict=True)
        numbers = [checked(stage.function, port.name, x, trace) for port, one in pairs for x in one]
    return Graph(tuple(inputs), tuple(outputs), tuple(numbers))


def _check_lists(stage: Stage, outputs: Sequence[Port], lists: Any) -> None:
    stage_name = name_of(stage.function)
    if not isinstance(lists, (list, tuple)) or len(lists) != len(outputs):
        raise TraceError(f"stage {stage_name} must return {len(outputs)} lists, for {', '.join(stage.writes)}")
    for port, one in zip(outputs, lists, strict=True):
        found = len(one) if isinstance(one, (list, tuple, np.ndarray)) else f"a {type(one).__name__}"
        if found != port.size:
            raise TraceError(f"stage {stage_name} returns {found} for region {port.name!r} of {port.size} slots")
