"""A robot does not change: nobody writes into it, and what is copied or sent to a process is the same robot."""

import copy
import pickle
from collections.abc import Callable
from multiprocessing import get_context
from typing import Any

import numpy as np
import pytest

import cutpoint
from cutpoint import Drive, LinearSpring, Log, Robot, Rotor, control, simulate, trajectories
from cutpoint.model import Joint, Link, Mechanism
from cutpoint.model.build import build
from robot_library import BACKENDS, Array, robot

MOON = np.array([0.0, 0.0, -1.62])


def elbow() -> Robot:
    """One joint that bends, and all that a mechanism may hold."""
    stick = Link("stick", 2.0, np.array([0.2, 0.0, 0.0]), 0.01 * np.eye(3))
    joint = Joint("joint", "revolute", "post", "stick", np.eye(4), np.array([0.0, 1.0, 0.0]))
    drive = Drive(100.0, Rotor(1e-5), LinearSpring(4e3))
    return Robot(build("elbow", [Link("post"), stick], [joint]), {"joint": drive})


def arrays_of(mechanism: Mechanism) -> list[Array]:
    parts = [mechanism, *mechanism.bodies, *(b.joint for b in mechanism.bodies), *mechanism.frames.values()]
    return [x for part in parts for x in vars(part).values() if isinstance(x, np.ndarray)]


OTHERS: dict[str, Callable[[Robot], Robot]] = {
    "as built": lambda r: r,
    "with_gravity": lambda r: r.with_gravity(MOON),
    "with_base": lambda r: r.with_base(np.diag([-1.0, -1.0, 1.0, 1.0])),
    "with_payload": lambda r: r.with_payload(1.0, np.zeros(3), np.eye(3), "tool"),
    "with_drives": lambda r: r.with_drives({"joint1": Drive()}),
    "pickled": lambda r: pickle.loads(pickle.dumps(r)),
    "deep copy": copy.deepcopy,
}


@pytest.mark.parametrize("other", OTHERS)
def test_nothing_that_a_robot_holds_or_hands_out_can_be_written_to(other: str) -> None:
    ours = OTHERS[other](robot("xia2019"))
    held = [*arrays_of(ours.mechanism), ours.gravity, ours.drive_parameters, ours.inertial_parameters]
    assert len(held) > 40 and not any(x.flags.writeable for x in held)
    for mapping in (ours.drives, ours.mechanism.frames):
        with pytest.raises(TypeError, match="does not support item assignment"):
            mapping["joint1"] = 3  # pyright: ignore[reportIndexIssue]
    with pytest.raises(AttributeError, match="a Robot is immutable, so its drives cannot be set: with_drives"):
        ours.drives = {}
    ours.drive_coefficients["stiffness.joint6"] = 0.0
    assert ours.drive_coefficients["stiffness.joint6"] > 0.0


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_robot_keeps_to_what_it_was_made_of(backend: str) -> None:
    """Gravity that the user's array says first, for functions that compile before and after it changes."""
    gravity, q, z = MOON.copy(), np.full(6, 0.3), np.zeros(6)
    ours = Robot(robot("xia2019").mechanism, backend=backend).with_gravity(gravity)
    Y = ours.regressor(q, z, z)
    gravity[2] = -9.81
    np.testing.assert_allclose(Y @ ours.inertial_parameters, ours.gravity_forces(q), rtol=1e-12, atol=1e-12)
    com, placement = np.array([0.1, 0.0, 0.0]), np.eye(4)
    made = ours.with_payload(2.0, com, np.eye(3), "tool").with_base(placement)
    expected = made.gravity_forces(q)
    com[:], placement[:3, 3] = 9.0, 9.0
    made_later = Robot(made.mechanism, made.drives, backend=backend)
    np.testing.assert_array_equal(made_later.gravity_forces(q), expected)


def test_links_and_joints_keep_to_what_they_were_made_of() -> None:
    com, inertia, placement, axis = np.ones(3), np.eye(3), np.eye(4), np.array([0, 1, 0])
    link, joint = Link("a", 1.0, com, inertia), Joint("j", "revolute", "a", "b", placement, axis)
    for x in (com, inertia, placement, axis):
        x[...] = 7
    assert link.com.max() == 1.0 and link.inertia.max() == 1.0 and joint.placement.max() == 1.0
    assert joint.axis.dtype == np.float64 and joint.axis.max() == 1.0


@pytest.mark.parametrize("backend", BACKENDS)
def test_kernels_take_the_drive_parameters_that_cannot_be_written_to(backend: str) -> None:
    ours = robot("xia2019", backend)
    motion = np.random.default_rng(0).uniform(-1, 1, (5, 4, 6))
    expected = ours.elastic_inverse_dynamics(*motion)
    found = ours.kernel("elastic_inverse_dynamics")(*motion, ours.drive_parameters)
    for mine, other in zip(expected, found, strict=True):
        np.testing.assert_array_equal(mine, other)


COPIES: dict[str, Callable[[Any], Any]] = {
    "pickled": lambda x: pickle.loads(pickle.dumps(x)),
    "copy": copy.copy,
    "deep copy": copy.deepcopy,
}


@pytest.mark.parametrize("name", ["xia2019", "mixed_floating", "panda_coupled"])
@pytest.mark.parametrize("way", COPIES)
def test_a_copy_of_a_robot_that_has_worked_is_the_same_robot(name: str, way: str) -> None:
    ours = robot(name, "numpy")
    q, v = ours.random(1), np.linspace(-1.0, 1.0, ours.nv)
    expected = ours.inverse_dynamics(q, v, v)
    found = COPIES[way](ours)
    assert (found.name, found.joints, found.frames, found.backend) == (ours.name, ours.joints, ours.frames, "numpy")
    assert dict(found.drives) == dict(ours.drives)
    np.testing.assert_array_equal(found.inverse_dynamics(q, v, v), expected)


@pytest.mark.parametrize("way", COPIES)
def test_a_law_can_be_copied_with_its_robot(way: str) -> None:
    ours = elbow()
    ours.elastic_inverse_dynamics(*np.zeros((5, 1)))
    found = COPIES[way](control.Feedforward(ours))
    np.testing.assert_array_equal(found.robot.gravity_forces([0.3]), ours.gravity_forces([0.3]))


def a_run(ours: Robot) -> Log:
    law = control.PD(kp=[400.0], kd=[40.0], side="motor") + control.Feedforward(ours)
    return simulate(ours, law, trajectories.cycloid(end=[0.2], duration=0.1), duration=0.02)


def test_a_log_comes_back_from_another_process_as_it_was() -> None:
    ours = elbow()
    here = a_run(ours)
    with get_context("spawn").Pool(1) as pool:
        there = pool.apply(a_run, (ours,))
    for log in (there, copy.deepcopy(here)):
        assert (log.joints, log.units, log.meta) == (here.joints, here.units, here.meta)
        for name in here.channels:
            np.testing.assert_array_equal(log[name], here[name])
        assert log.run is not None and log.run.robot.drives == ours.drives
        assert not any(x.flags.writeable for x in (log.time, *log.channels.values()))


def test_a_built_robot_is_pickled_before_and_after_its_first_call() -> None:
    ours = cutpoint.robots.xia2019()
    before = pickle.dumps(ours)
    ours.gravity_forces(np.zeros(6))
    assert pickle.dumps(ours) == before
