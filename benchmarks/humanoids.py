"""Humanoids beside Pinocchio: single calls and batches of their dynamics, from Python.

Beyond some size cutpoint's functions run as loops over bodies; which do differs from robot to robot.
"""

import sys
import warnings
from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pinocchio_cpp
from cases import TASKS, robot_file
from tasks import agreed_with, in_columns

import cutpoint
from cutpoint import derivatives
from cutpoint.formats import MimicWarning
from cutpoint.studies.cost.timing import in_turns

ROBOTS = {"G1": "g1_29dof_rev_1_0.urdf", "Talos": "talos_full_v2.urdf"}
"""Files of the package example-robot-data, of revolute joints; the pelvis stands still."""

MEASURED = ("inverse dynamics", "forward dynamics", "mass matrix", "derivatives")
ROWS = 64


def humanoids() -> list[dict]:
    found = []
    for name, file in ROBOTS.items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MimicWarning)  # to Pinocchio mimic joints are coordinates of their own too
            robot = cutpoint.load(robot_file(file))
        model = pin.buildModelFromUrdf(robot_file(file))
        model.armature = np.zeros(model.nv)
        for task in MEASURED:
            print(f"{name}: {task}", file=sys.stderr)
            found.append({"robot": name, "joints": model.nv, "task": task, **_measured(robot, model, task)})
    return found


def _measured(robot: cutpoint.Robot, model: pin.Model, task: str) -> dict:
    n, rng = model.nv, np.random.default_rng(0)
    order = [robot.joints.index(name) for name in model.names[1:]]  # of Pinocchio's joints among ours
    theirs = [rng.uniform(-1, 1, (ROWS, n)) for _ in TASKS[task]]
    if task == "forward dynamics":
        theirs[2] *= 10.0
    own = [_in_our_order(x, order) for x in theirs]
    compute, algorithm = _functions(robot, model)[task]
    each, each_of_theirs = [*zip(*own, strict=True)], [*zip(*theirs, strict=True)]
    calls: dict[str, Callable[[], object]] = {
        "single": lambda: [compute(*state) for state in each],
        "rows": lambda: compute(*own),
        "Pinocchio, Python": lambda: [algorithm(*state) for state in each_of_theirs],
    }
    shape = {"mass matrix": (n, n), "derivatives": (3, n, n)}.get(task, (n,))
    results, cpp = {"rows": _as_theirs(calls["rows"](), order)}, {}
    results["single"] = np.array([_as_theirs(x, order) for x in calls["single"]()])  # type: ignore[union-attr]
    for name in pinocchio_cpp.COMPILERS:
        library = pinocchio_cpp.built(name)
        for variant in pinocchio_cpp.FUNCTIONS[task] if library else ():
            contender, out = pinocchio_cpp.Robot(library, model), np.empty((ROWS, *shape))
            contender.run(variant, theirs, out)
            results[f"{name}, {variant}"] = out
            cpp[f"{name}, {variant}"] = lambda r=contender, f=variant: r.run(f, theirs, None)
    expected = np.array([_full(algorithm(*state)) for state in each_of_theirs])
    differences = agreed_with(f"{robot.name}, {task}", results, expected)
    return {"differences": differences, "times": in_columns(in_turns(calls | cpp, ROWS), dict.fromkeys(cpp))}


def _functions(robot: cutpoint.Robot, model: pin.Model) -> dict[str, tuple[Callable, Callable]]:
    """Ours, and Pinocchio's from Python."""
    data = model.createData()
    return {
        "inverse dynamics": (robot.inverse_dynamics, lambda *x: pin.rnea(model, data, *x)),
        "forward dynamics": (robot.forward_dynamics, lambda *x: pin.aba(model, data, *x)),
        "mass matrix": (robot.mass_matrix, lambda q: pin.crba(model, data, q)),
        "derivatives": (
            lambda *x: derivatives.inverse_dynamics(robot, *x),
            lambda *x: pin.computeRNEADerivatives(model, data, *x),
        ),
    }


def _in_our_order(x: np.ndarray, order: list[int]) -> np.ndarray:
    found = np.empty_like(x)
    found[..., order] = x
    return found


def _as_theirs(found: object, order: list[int]) -> np.ndarray:
    """Results with joints in Pinocchio's order; of derivatives (..., 3, n, n)."""
    if not isinstance(found, tuple):
        x = np.asarray(found)
        return x[..., order, :][..., order] if x.shape[-2:] == (len(order),) * 2 else x[..., order]
    return np.stack([x[..., order, :][..., order] for x in found], axis=-3)


def _full(found: object) -> np.ndarray:
    """Pinocchio's result, mirrored where it fills one half."""
    if not isinstance(found, tuple):
        x = np.array(found)
        return np.triu(x) + np.triu(x, 1).T if x.ndim == 2 else x
    d_q, d_v, d_a = map(np.array, found)
    return np.stack([d_q, d_v, np.triu(d_a) + np.triu(d_a, 1).T])
