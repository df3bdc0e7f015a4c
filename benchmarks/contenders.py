"""cutpoint, Pinocchio and CasADi on the same robot and the same random states."""

import itertools
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.metadata import files
from pathlib import Path

import casadi as ca
import codegen
import numpy as np
import pinocchio as pin
import symbolic

import cutpoint

ITEMS = 4096
ROBOTS = {"UR10": ("ur10_robot.urdf", ()), "Panda": ("panda.urdf", ("panda_finger_joint1", "panda_finger_joint2"))}
"""Files of the package example-robot-data, and joints held at zero."""

TASKS = {"inverse dynamics": ("q", "v", "a"), "forward dynamics": ("q", "v", "tau"), "mass matrix": ("q",)}
Call = Callable[[], object]


@dataclass(frozen=True, eq=False)
class Entry:
    """One contender's side of a task: a call of one state from Python, a call that does all ITEMS, their results."""

    single: Call | None
    batched: Call | None
    results: np.ndarray


def entries(robot_name: str, task: str, folder: Path) -> dict[str, Entry]:
    """The contenders of a task on a robot; folder: for CasADi's code."""
    name, locked = ROBOTS[robot_name]
    path = next(str(entry.locate()) for entry in files("example-robot-data") or () if entry.name == name)
    robot = cutpoint.load(path, lock=dict.fromkeys(locked, 0.0))
    model = pin.buildModelFromUrdf(path)
    model = pin.buildReducedModel(model, [model.getJointId(j) for j in locked], pin.neutral(model))
    rng = np.random.default_rng(0)
    inputs = [rng.uniform(-2, 2, (ITEMS, robot.nv)) for _ in TASKS[task]]
    found = {"Pinocchio": _pinocchio(model, task, inputs), **_ours(robot, task, inputs)}
    if shutil.which("gcc"):
        found["CasADi"] = _casadi(robot, task, inputs, folder)
    return found


def _ours(robot: cutpoint.Robot, task: str, inputs: list[np.ndarray]) -> dict[str, Entry]:
    name = task.replace(" ", "_")
    method = getattr(robot, name)
    results = method(*inputs)
    kernel = robot.kernel(name)
    return {
        "cutpoint": Entry(_each(method, inputs), None, results),
        "kernel": Entry(_each(kernel.call, inputs), partial(kernel, *inputs), kernel(*inputs)),
    }


def _pinocchio(model: pin.Model, task: str, inputs: list[np.ndarray]) -> Entry:
    function = {"inverse dynamics": pin.rnea, "forward dynamics": pin.aba, "mass matrix": pin.crba}[task]
    batch = {"inverse dynamics": pin.rneaInParallel, "forward dynamics": pin.abaInParallel}.get(task)
    call = partial(function, model, model.createData())
    results = np.array([call(*state).copy() for state in zip(*inputs, strict=True)])
    columns = [np.asfortranarray(x.T) for x in (*inputs, np.zeros_like(inputs[0]))]
    return Entry(_each(call, inputs), batch and partial(batch, 1, pin.ModelPool(model, 1), *columns), results)


def _casadi(robot: cutpoint.Robot, task: str, inputs: list[np.ndarray], folder: Path) -> Entry:
    symbols = [ca.SX.sym(name, robot.nv) for name in TASKS[task]]
    result = getattr(symbolic, task.replace(" ", "_"))(robot.mechanism, *symbols)
    function = ca.Function("f", symbols, [ca.cse(result)])
    call = codegen.compiled(function, folder, f"{robot.name}_{task}".replace(" ", "_"))
    out = np.empty((ITEMS, *(s for s in result.shape if s > 1)))
    return Entry(None, partial(call, *inputs, out=out), call(*inputs, out=out))


def _each(function: Callable[..., object], inputs: list[np.ndarray]) -> Call:
    """One call after another over 256 states, a new one each time."""
    states = itertools.cycle([tuple(x.copy() for x in state) for state in zip(*(x[:256] for x in inputs), strict=True)])
    return lambda: function(*next(states))
