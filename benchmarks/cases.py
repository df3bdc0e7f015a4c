"""Measured robots and tasks, and the interface of every contender: a call on many rows, and its results."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import files

import numpy as np
import pinocchio as pin

import cutpoint

BYTES = 1_000_000
"""Bytes of a batch's inputs and outputs together."""

ROBOTS = {"UR10": ("ur10_robot.urdf", ()), "Panda": ("panda.urdf", ("panda_finger_joint1", "panda_finger_joint2"))}
"""Files of the package example-robot-data, and joints held at zero."""

FLANGES = {"UR10": "tool0", "Panda": "panda_link8"}

TASKS = {
    "inverse dynamics": ("q", "v", "a"), "forward dynamics": ("q", "v", "tau"), "mass matrix": ("q",),
    "Jacobian": ("q",), "derivatives": ("q", "v", "a"), "forward derivatives": ("q", "v", "tau"),
    "regressor": ("q", "v", "a"),
}  # fmt: skip
"""Inputs of each.  Jacobian: of the flange, along the world's axes.  Derivatives: d inverse dynamics / d (q, v, a), and
d forward dynamics / d (q, v, tau)."""

Call = Callable[[], object]


@dataclass(frozen=True, eq=False)
class Entry:
    """One contender's side of a task: a call that works through all rows, and the rows that come of it."""

    call: Call
    results: np.ndarray


@dataclass(frozen=True, eq=False)
class Case:
    """A robot for all contenders; the models come from the same file, each library's by its own reader."""

    name: str
    robot: cutpoint.Robot
    model: pin.Model

    @property
    def flange(self) -> str | None:
        return FLANGES.get(self.name)

    @cached_property
    def data(self) -> pin.Data:
        return self.model.createData()

    def shape(self, task: str) -> tuple[int, ...]:
        """Of a row of results."""
        n = self.model.nv
        shapes = {"mass matrix": (n, n), "Jacobian": (6, n), "regressor": (n, 10 * n)}
        return shapes.get(task, (3, n, n) if "derivatives" in task else (n,))

    def inputs(self, task: str) -> list[np.ndarray]:
        """Random rows, (count, n) each, as many as BYTES hold of inputs and outputs; whole packs."""
        n, rng = self.model.nv, np.random.default_rng(0)
        numbers = len(TASKS[task]) * n + int(np.prod(self.shape(task)))
        count = BYTES // (8 * numbers) // 8 * 8
        return [rng.uniform(-2, 2, (count, n)) for _ in TASKS[task]]


def robot_file(name: str) -> str:
    """Of the package example-robot-data."""
    return next(str(entry.locate()) for entry in files("example-robot-data") or () if entry.name == name)


def case(name: str) -> Case:
    file, locked = ROBOTS[name]
    path = robot_file(file)
    robot = cutpoint.load(path, lock=dict.fromkeys(locked, 0.0))
    model = pin.buildModelFromUrdf(path)
    model = pin.buildReducedModel(model, [model.getJointId(j) for j in locked], pin.neutral(model))
    model.armature = np.zeros(model.nv)
    return Case(name, robot, model)
