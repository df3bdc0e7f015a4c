"""Humanoids and a long chain against Pinocchio: single calls and batches of their dynamics, from Python.

Beyond some size cutpoint's functions run as loops over bodies; which do differs from robot to robot.
"""

import sys
import warnings
from collections.abc import Callable, Sequence

import numpy as np
import pinocchio as pin
import pinocchio_cpp
import pinocchio_python
from cases import TASKS, Case, robot_file
from chains import LONG, ROWS, chain, model_of, states
from tasks import agreed_with, in_columns

import cutpoint
from cutpoint import derivatives
from cutpoint.formats import MimicWarning
from cutpoint.studies.cost.timing import in_turns

ROBOTS = {"G1": "g1_29dof_rev_1_0.urdf", "Talos": "talos_full_v2.urdf"}
"""Files of the package example-robot-data, of revolute joints; the pelvis stands still."""

MATRICES = ("mass matrix", "derivatives", "forward derivatives")
VECTORS = ("inverse dynamics", "forward dynamics")
"""Those of a long chain have a section of their own."""


def large_robots() -> list[dict]:
    found = []
    for case in (*map(_humanoid, ROBOTS), _chain()):
        for task in MATRICES if case.name not in ROBOTS else (*VECTORS, *MATRICES):
            print(f"{case.name}: {task}", file=sys.stderr)
            found.append({"robot": case.name, "joints": case.model.nv, "task": task, **_measured(case, task)})
    return found


def _humanoid(name: str) -> Case:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MimicWarning)  # to Pinocchio mimic joints are coordinates of their own too
        robot = cutpoint.load(robot_file(ROBOTS[name]))
    model = pin.buildModelFromUrdf(robot_file(ROBOTS[name]))
    model.armature = np.zeros(model.nv)
    return Case(name, robot, model)


def _chain() -> Case:
    mechanism = chain(LONG)
    return Case(f"chain of {LONG}", cutpoint.Robot(mechanism), model_of(mechanism))


def _measured(case: Case, task: str) -> dict:
    order = [case.robot.joints.index(name) for name in case.model.names[1:]]  # of Pinocchio's joints among ours
    theirs = states(case.model.nv)[: len(TASKS[task])]
    own = [_in_our_order(x, order) for x in theirs]
    compute, algorithm = _ours(case.robot)[task], pinocchio_python.function(case, task)
    each, each_of_theirs = [*zip(*own, strict=True)], [*zip(*theirs, strict=True)]
    calls: dict[str, Callable[[], object]] = {
        "single": lambda: _each(compute, each),
        "rows": lambda: compute(*own),
        "Pinocchio, Python": lambda: _each(algorithm, each_of_theirs),
    }
    cpp = pinocchio_cpp.entries(case, task, theirs)
    results = {name: entry.results for name, entry in cpp.items()}
    results |= {"rows": _as_theirs(compute(*own), order)}
    results |= {"single": np.array([_as_theirs(compute(*state), order) for state in each])}
    differences = agreed_with(f"{case.name}, {task}", results, pinocchio_python.results(case, task, theirs))
    times = in_turns(calls | {name: entry.call for name, entry in cpp.items()}, ROWS)
    return {"differences": differences, "times": in_columns(times, cpp)}


def _each(function: Callable, states: Sequence[tuple]) -> None:
    """No result is kept: matrices of a call go where those of the one before went."""
    for state in states:
        function(*state)


def _ours(robot: cutpoint.Robot) -> dict[str, Callable]:
    return {
        "inverse dynamics": robot.inverse_dynamics, "forward dynamics": robot.forward_dynamics,
        "mass matrix": robot.mass_matrix, "derivatives": lambda *x: derivatives.inverse_dynamics(robot, *x),
        "forward derivatives": lambda *x: derivatives.forward_dynamics(robot, *x),
    }  # fmt: skip


def _in_our_order(x: np.ndarray, order: list[int]) -> np.ndarray:
    found = np.empty_like(x)
    found[..., order] = x
    return found


def _as_theirs(found: np.ndarray | tuple, order: list[int]) -> np.ndarray:
    """Results with joints in Pinocchio's order; of derivatives (..., 3, n, n)."""
    if isinstance(found, tuple):
        return np.stack([_as_theirs(x, order) for x in found], axis=-3)
    x = found[..., order]
    return x[..., order, :] if x.shape[-2:] == (len(order),) * 2 else x
