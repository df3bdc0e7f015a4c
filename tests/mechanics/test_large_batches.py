"""Batches of functions as loops: several configurations side by side are each what it is alone, to the last bit."""

from collections import namedtuple
from typing import Any

import numpy as np
import pytest

from cutpoint import Robot
from cutpoint.mechanics.drives.compliance import LinearSpring
from cutpoint.mechanics.drives.friction import Coulomb
from cutpoint.model import Drive, Joint, Link
from cutpoint.model.build import build
from cutpoint.model.drive import Rotor
from cutpoint.rolled import RECIPES, RolledFunction
from cutpoint.rolled.recipes import OF_FRAMES
from random_trees import placement

LIMBS, LENGTH = 4, 5
LANES = 8


def limbs(kind: str | None) -> Robot:
    """A trunk with limbs, which carry nothing of each other, so that few pairs of bodies matter; with springs."""
    rng = np.random.default_rng(7)

    def mass() -> tuple[float, np.ndarray, np.ndarray]:
        return rng.uniform(0.5, 2.0), rng.normal(0.0, 0.1, 3), np.diag(rng.uniform(0.01, 0.015, 3))

    links = [Link("world"), Link("trunk", *mass())]
    joints = [Joint("base", kind or "revolute", "world", "trunk", placement(rng))]  # type: ignore[arg-type]
    for limb in range(LIMBS):
        for k in range(LENGTH):
            parent, name = f"limb{limb}.{k - 1}" if k else "trunk", f"limb{limb}.{k}"
            links.append(Link(name, *mass()))
            joints.append(Joint(f"joint {name}", "revolute", parent, name, placement(rng), np.eye(3)[k % 3]))
    turning = [joint.name for joint in joints if joint.kind == "revolute"]
    drive = Drive(100.0, Rotor(1e-4), LinearSpring(2e4), damping=2.0, link_friction=Coulomb(0.5, 0.3, 0.02))
    return Robot(build("limbs", links, joints), dict.fromkeys(turning, drive), backend="numpy")


ROBOTS = {"fixed": limbs(None), "floating": limbs("floating")}
CASES = [(robot, key) for robot in ROBOTS for key, r in RECIPES.items() if r.takes_base or robot == "fixed"]


def given_to(robot: Robot, key: Any, count: int) -> list[np.ndarray]:
    """Motions, or states near rest of the springs."""
    rng, n = np.random.default_rng(3), len(robot.drives)
    sizes = dict.fromkeys(("theta", "theta_dot", "motor_torque"), n)
    q = robot.random(2, (count,))
    given = [q if x == "q" else rng.uniform(-1.0, 1.0, (count, sizes.get(x, robot.nv))) for x in RECIPES[key].inputs]
    near = q[:, robot.nq - n :]
    return [near + 1e-3 * x if name == "theta" else x for name, x in zip(RECIPES[key].inputs, given, strict=True)]


@pytest.mark.parametrize(("robot", "key"), CASES, ids=str)
def test_each_of_a_batch_is_what_it_is_alone(robot: str, key: Any) -> None:
    count = 2 * LANES + 3
    given = given_to(ROBOTS[robot], key, count)
    name = key[0] if isinstance(key, tuple) else key
    frame = "limb2.3" if name in OF_FRAMES else None
    record = namedtuple("Found", RECIPES[key].outputs) if len(RECIPES[key].outputs) > 1 else None
    function = RolledFunction(key, ROBOTS[robot].machine, "llvm", record, frame)
    alone = [function(*one) for one in zip(*given, strict=True)]
    batch = function(*given)
    if record is None:
        alone, batch = [(one,) for one in alone], (batch,)
    assert max(np.abs(whole).max() for whole in batch) > 0
    for k, whole in enumerate(batch):
        np.testing.assert_array_equal(whole, [one[k] for one in alone])
