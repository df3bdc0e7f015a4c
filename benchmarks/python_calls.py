"""One call from Python, over random states, a new one each call."""

import itertools
import sys
from collections.abc import Callable
from dataclasses import asdict

import mujoco
import mujoco_peer
import numpy as np
import ours
import pinocchio_python
from cases import ROBOTS, TASKS, Case, case

from cutpoint import derivatives
from cutpoint.studies.cost.timing import in_turns

STATES = 256


def python_calls() -> list[dict]:
    found = []
    for name in ROBOTS:
        robot = case(name)
        for task in TASKS:
            print(f"{name}: one call from Python, {task}", file=sys.stderr)
            times = in_turns(_calls(robot, task))
            found.append({"robot": name, "task": task, "times": {key: asdict(x) for key, x in times.items()}})
    return found


def _calls(robot: Case, task: str) -> dict[str, Callable[[], object]]:
    """kernel: without the checks of the robot's own function.  general: as arrays of any other shape take it."""
    inputs = [x[:STATES] for x in robot.inputs(task)]
    kernel = ours.kernel_of(robot, task, inputs)
    functions = {
        "cutpoint": _public(robot, task), "kernel": kernel.call, "general": kernel.general,
        "Pinocchio": pinocchio_python.function(robot, task), **_mujoco(robot, task),
    }  # fmt: skip
    return {name: _each(function, inputs) for name, function in functions.items()}


def _public(robot: Case, task: str) -> Callable[..., object]:
    if task == "Jacobian":
        jacobian, frame = robot.robot.jacobian, robot.flange
        return lambda q: jacobian(q, frame, "local_world_aligned")
    if task == "derivatives":
        return lambda q, v, a: derivatives.inverse_dynamics(robot.robot, q, v, a)
    if task == "forward derivatives":
        return lambda q, v, tau: derivatives.forward_dynamics(robot.robot, q, v, tau)
    return getattr(robot.robot, task.replace(" ", "_"))


def _mujoco(robot: Case, task: str) -> dict[str, Callable[..., object]]:
    """mj_inverse and mj_forward, which offer no part of what they do."""
    called = {"inverse dynamics": (mujoco.mj_inverse, "qacc"), "forward dynamics": (mujoco.mj_forward, "qfrc_applied")}
    if task not in called:
        return {}
    (function, third), model = called[task], mujoco_peer.model_of(robot.model)
    data = mujoco.MjData(model)
    given = data.qpos, data.qvel, getattr(data, third)

    def call(*state: np.ndarray) -> None:
        for own, x in zip(given, state, strict=True):
            own[:] = x
        function(model, data)

    return {"MuJoCo": call}


def _each(function: Callable[..., object], inputs: list[np.ndarray]) -> Callable[[], object]:
    """One call after another."""
    states = itertools.cycle([tuple(x.copy() for x in state) for state in zip(*inputs, strict=True)])
    return lambda: function(*next(states))
