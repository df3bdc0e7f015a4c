"""An MJCF file as read here, and as read by MuJoCo."""

import warnings
from pathlib import Path

import mujoco
import numpy as np

import cutpoint
from cutpoint import Robot
from cutpoint.formats import NotCarriedOver


def read(path: Path) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotCarriedOver)
        return cutpoint.load(path)


def assert_torques_are_mujocos(robot: Robot, path: Path, rows: int = 20) -> None:
    """At random places of hinges and slides."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    for row in np.random.default_rng(0).normal(size=(rows, 3, model.nv)):
        data.qpos[:], data.qvel[:], data.qacc[:] = row
        mujoco.mj_inverse(model, data)
        np.testing.assert_allclose(robot.inverse_dynamics(*row), data.qfrc_inverse, rtol=1e-10, atol=1e-12)
