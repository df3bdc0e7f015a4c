"""Simulation of large robots: how many steps they take, and what is refused."""

import time
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from cutpoint import Coulomb, Drive, LinearSpring, Robot, Rotor, simulate
from cutpoint.errors import InputError
from cutpoint.simulation.steps.fastest import FEW, fastest_mode, posture
from large_robots import assert_close, chain


def test_the_fastest_mode_of_a_long_chain_is_found_within_four_percent() -> None:
    size = FEW // 2 + 1
    stiffness = dict(zip(range(size), np.linspace(1e4, 2e4, size), strict=True))
    drives = {f"joint{k}": Drive(100.0, Rotor(1e-4), LinearSpring(K)) for k, K in stiffness.items()}
    robot = Robot(chain(size), drives)
    q, K = robot.random(1), np.diag([*stiffness.values()])
    inertia = scipy.linalg.block_diag(robot.mass_matrix(q), np.eye(size))  # J = ratio^2 1e-4 = 1 kg m2
    squares = scipy.linalg.eigh(np.block([[K, -K], [-K, K]]), inertia, eigvals_only=True)
    found = fastest_mode(robot, [posture(robot, q)])
    assert found.rate**2 == pytest.approx(squares.max(), rel=0.04)
    assert found.cause.startswith("the spring of 'joint")


class Hold:
    """On motors at zero."""

    def step(self, memory: Any, measured: Any, reference: Any) -> Any:
        return memory, -50.0 * measured.theta - 2.0 * measured.theta_dot


@pytest.mark.parametrize("size", [5, 17, 20])
def test_alike_drives_in_lanes_of_any_number_move_as_in_numpy(size: int) -> None:
    """Also where the lanes are no power of two: 17 and 20 drives take 24."""
    drive = Drive(100.0, Rotor(1e-5), LinearSpring(1e4), motor_friction=Coulomb(1.0, 1.0, 0.05), damping=2.0)
    logs = []
    for backend in ("llvm", "numpy"):
        robot = Robot(chain(size), backend=backend)
        logs.append(simulate(robot.with_drives(dict.fromkeys(robot.joints, drive)), Hold(), duration=0.01))
    for channel in ("q", "v", "theta", "theta_dot", "joint_torque"):
        assert_close(logs[0][channel], logs[1][channel])
    assert np.abs(logs[0]["v"]).max() > 1e-3


def test_a_robot_too_large_to_simulate_is_refused_at_once() -> None:
    robot, start = Robot(chain(1001)), time.perf_counter()
    with pytest.raises(InputError, match=r"1001 bodies are too many for one compiled step, at most 1000; integrate"):
        simulate(robot, duration=0.01)
    assert time.perf_counter() - start < 2.0
