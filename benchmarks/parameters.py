"""Inverse dynamics with the bodies' inertial parameters as inputs, against that with them as constants."""

import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import ours
import pinocchio_python
from cases import ROBOTS, Case, case
from tasks import agreed

import cutpoint
from cutpoint.mechanics.bodies.rigid_body import inertia_of
from cutpoint.mechanics.inverse_dynamics import inverse_dynamics
from cutpoint.mechanics.system import System
from cutpoint.studies.cost.timing import in_turns

TASK = "inverse dynamics"


def parameters_as_inputs() -> list[dict]:
    found = []
    for name in ROBOTS:
        print(f"{name}: parameters as inputs", file=sys.stderr)
        found.append(measured(case(name)))
    return found


def measured(given: Case) -> dict:
    inputs = given.inputs(TASK)
    folded, system = ours.kernel_of(given, TASK, inputs), given.robot.machine.system
    p, n = parameters_of(system), given.robot.nv

    def torques(q: Any, v: Any, a: Any, p: Any) -> Any:
        return inverse_dynamics(with_parameters(system, p), q, v, a)

    open_ = cutpoint.compile(torques, name="with_parameters", q=n, v=n, a=n, p=len(p))
    expected = pinocchio_python.results(given, TASK, inputs)
    contenders = {"folded": ours.entries(folded, inputs), "inputs": ours.entries(open_, [*inputs, p])}
    entries = {f"{kind}, {name}": x for kind, group in contenders.items() for name, x in group.items()}
    differences = agreed(f"{given.name}, parameters as inputs", entries, expected)
    times = in_turns({name: x.call for name, x in entries.items()}, len(inputs[0]))
    return {"robot": given.name, "rows": len(inputs[0]), "differences": differences,
            "times": {name: asdict(x) for name, x in times.items()}}  # fmt: skip


def parameters_of(system: System) -> np.ndarray:
    """(10 n,): of each segment, in its own frame."""
    rows: list[float] = []
    for segment in system.segments:
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = segment.inertia.rotational
        rows += [segment.inertia.mass, *segment.inertia.first_moment, xx, xy, xz, yy, yz, zz]
    return np.array(rows, dtype=np.float64)


def with_parameters(system: System, p: Sequence[Any]) -> System:
    bodies = [replace(x, inertia=inertia_of([*p[10 * i : 10 * i + 10]])) for i, x in enumerate(system.segments)]
    return replace(system, segments=tuple(bodies))
