"""A stepping program in machine code: all its stages and loops as one function."""

import ctypes
from collections.abc import Mapping

import numpy as np

from cutpoint.kernels.graph import Graph
from cutpoint.kernels.jit import Compiled
from cutpoint.kernels.llvm import SCALAR, straight_line
from cutpoint.kernels.llvm_code import Code
from cutpoint.kernels.lowering import lower
from cutpoint.kernels.nodes import Node
from cutpoint.kernels.program_plan import Plan
from cutpoint.kernels.stepping import Loop

_FUNCTION = "program"


class LlvmProgram:
    """A plan's machine code: i64 program(i64 *counts, double **regions)."""

    def __init__(self, plan: Plan) -> None:
        self._names, self._counts = [*plan.sizes], plan.counts
        self._code = Compiled(program_ir(plan), _FUNCTION)
        self._call = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)(self._code.address)

    def run(self, counts: Mapping[str, int], arrays: Mapping[str, np.ndarray]) -> int:
        """The iterations of the outermost loop; arrays must have been checked."""
        numbers = (ctypes.c_int64 * len(self._counts))(*[counts[name] for name in self._counts])
        pointers = (ctypes.c_void_p * len(self._names))(*[arrays[name].ctypes.data for name in self._names])
        return self._call(numbers, pointers)


def program_ir(plan: Plan) -> str:
    """The module's text."""
    code = Code()
    counts = {name: code.load("%counts", k, "i64") for k, name in enumerate(plan.counts)}
    regions = {name: code.load("%regions", k, "ptr") for k, name in enumerate(plan.sizes)}
    lowered = {stage: lower(graph) for stage, graph in plan.graphs.items()}

    def loop(this: Loop, regions: dict[str, str]) -> str:
        count = counts[this.count] if isinstance(this.count, str) else this.count
        with code.loop(count, regions.get(this.until or "")) as running:
            rows = {name: code.let(f"mul i64 {running.iteration}, {plan.sizes[name]}") for name in this.streams}
            inside = regions | {name: code.at(regions[name], row) for name, row in rows.items()}
            for item in this.body:
                if isinstance(item, Loop):
                    loop(item, inside)
                else:
                    _stage(code, lowered[item], inside)
        return running.done

    done = loop(plan.body, regions)
    head = f"{SCALAR.declarations}define i64 @{_FUNCTION}(ptr %counts, ptr %regions) {{\nentry:"
    return "\n".join([head, *code.lines, f"ret i64 {done}", "}", ""])


def _stage(code: Code, graph: Graph, regions: Mapping[str, str]) -> None:
    """One stage: reads, computes, then writes what has changed."""
    sources = [(port.name, k) for port in graph.inputs for k in range(port.size)]
    targets = [(port.name, k) for port in graph.outputs for k in range(port.size)]
    values = straight_line(code, graph, lambda slot: code.load(regions[sources[slot][0]], sources[slot][1]))
    for x, value, place in zip(graph.results, values, targets, strict=True):
        unchanged = isinstance(x, Node) and x.op == "input" and sources[x.args[0]] == place
        if not unchanged:
            code.store(value, regions[place[0]], place[1])
