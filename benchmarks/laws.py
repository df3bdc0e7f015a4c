"""Time of a step of each control law on the paper's arm: called once, and in lanes.

python benchmarks/laws.py      prints them
"""

import sys
from dataclasses import asdict, replace

import numpy as np
import ours

import cutpoint
from cutpoint.control import (
    PD,
    PID,
    VDC,
    AdaptiveVDC,
    ComputedTorque,
    DisturbanceObserver,
    ElasticComputedTorque,
    Feedforward,
    FullStateFeedback,
    Guard,
    Robust,
    SlotineLi,
    tune,
)
from cutpoint.simulation.control_kernel import law_kernel, law_memory
from cutpoint.simulation.loop.parameters import law_parameters
from cutpoint.studies.cost.timing import in_turns

COUNT, BANDWIDTH, PERIOD = 256, 4.0, 1e-3
"""Rows in turn, Hz, s."""


def laws() -> list[dict]:
    """Nanoseconds a step, machine code called in a loop, and an element of blocks."""
    print("control laws", file=sys.stderr)
    robot = cutpoint.robots.xia2019()
    made = _laws(robot)
    linear = _with_linear_drives(robot)
    made |= {"VDC, derivatives of the model; linear springs, no friction": (linear, tune(linear, BANDWIDTH, VDC))}
    entries = {name: _entries(*law) for name, law in made.items()}
    single = in_turns({name: x["single"].call for name, x in entries.items()}, COUNT)
    lanes = in_turns({name: x["lanes"].call for name, x in entries.items()}, COUNT)
    return [
        {"law": name, "operations": sum(law_kernel(*made[name]).operations.values()),
         "single": asdict(single[name]), "lanes": asdict(lanes[name])}
        for name in made
    ]  # fmt: skip


def _with_linear_drives(robot: cutpoint.Robot) -> cutpoint.Robot:
    linear = {"compliance": cutpoint.LinearSpring(1e4), "link_friction": None}
    return robot.with_drives({name: replace(drive, **linear) for name, drive in robot.drives.items()})


def _laws(robot: cutpoint.Robot) -> dict[str, tuple[cutpoint.Robot, object]]:
    pd = tune(robot, BANDWIDTH, PD) + Feedforward(robot)
    made = {
        "PD": tune(robot, BANDWIDTH, PD), "PID": tune(robot, BANDWIDTH, PID), "PD + Feedforward": pd,
        "PD + Feedforward in a Guard": Guard(robot, pd),
        "DisturbanceObserver around PD + Feedforward": DisturbanceObserver(robot, pd, np.ones(6)),
        "ComputedTorque": tune(robot, BANDWIDTH, ComputedTorque), "Robust": tune(robot, BANDWIDTH, Robust),
        "SlotineLi": tune(robot, BANDWIDTH, SlotineLi),
        "FullStateFeedback": tune(robot, BANDWIDTH, FullStateFeedback),
        "ElasticComputedTorque": ElasticComputedTorque(robot, 50.0),
        "VDC, derivatives of the model": tune(robot, BANDWIDTH, VDC),
        "VDC, derivatives of a filter": tune(robot, BANDWIDTH, VDC, derivatives="filter"),
        "AdaptiveVDC, projection": tune(robot, BANDWIDTH, AdaptiveVDC),
        "AdaptiveVDC, natural": tune(robot, BANDWIDTH, AdaptiveVDC, update="natural"),
    }  # fmt: skip
    return {name: (robot, law) for name, law in made.items()}


def _entries(robot: cutpoint.Robot, law: object) -> dict[str, ours.Entry]:
    kernel, rng = law_kernel(robot, law), np.random.default_rng(0)
    given = {"time": np.zeros(COUNT), "memory": law_memory(law), "parameters": law_parameters(law, PERIOD)}
    inputs = [
        np.ascontiguousarray(np.broadcast_to(given[p.name], (COUNT, *p.shape))) if p.name in given
        else 1e-2 * rng.normal(size=(COUNT, *p.shape))
        for p in kernel.graph.inputs
    ]  # fmt: skip
    return {"single": ours.single(kernel, inputs), "lanes": ours.lanes(kernel, inputs)}


if __name__ == "__main__":
    for row in laws():
        print(f"{row['law']:45} {row['single']['least']:7.0f} {row['lanes']['least']:7.1f} ns")
