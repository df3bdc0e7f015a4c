"""Drives as linear functions of their coefficients, held against the dynamics that they are part of."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutpoint import Coulomb, LinearSpring, Robot
from robot_library import Array, assert_close, robot, vectors


def with_all(ours: Robot) -> Robot:
    """Every coefficient in every drive that bends."""
    return ours.with_drives({
        name: replace(drive, damping=3.0, motor_friction=Coulomb(0.4, 0.2, 0.1))
        for name, drive in ours.drives.items()
        if drive.is_elastic
    })  # fmt: skip


ROBOTS = {"flexsplines": lambda: robot("xia2019"), "all coefficients": lambda: with_all(robot("xia2019"))}


@pytest.mark.parametrize("kind", ROBOTS)
@given(st.tuples(*[vectors(6)] * 5))
def test_links_and_motors_move_as_the_regressors_say(kind, x):
    ours = ROBOTS[kind]()
    q, v, theta_dot, theta_ddot, wound = x
    theta = q + 1e-3 * wound
    link, motor = ours.drive_regressor(q, v, theta, theta_dot, theta_ddot)
    c = np.array([*ours.drive_coefficients.values()])
    moved = ours.elastic_forward_dynamics(q, v, theta, theta_dot, motor @ c)
    assert_close(moved.theta_ddot, theta_ddot, 1e-9, scale=1 + np.abs(motor @ c).max() / 0.1)
    needed = ours.mass_matrix(q) @ moved.a + ours.bias_forces(q, v)
    assert_close(needed, link @ c, 1e-9, scale=1 + np.abs(link @ c).max() + np.abs(needed).max())


def test_a_rigid_drives_motor_row_lacks_the_torque_on_its_link():
    ours = robot("mixed")
    rng = np.random.default_rng(0)
    q, v = ours.random(rng), rng.normal(size=ours.nv)
    n = len(ours.drives)
    theta, theta_dot, theta_ddot = rng.normal(size=(3, n))
    link, motor = ours.drive_regressor(q, v, theta, theta_dot, theta_ddot)
    c = np.array([*ours.drive_coefficients.values()])
    for k, (name, drive) in enumerate(ours.drives.items()):
        if not drive.is_elastic:
            speed = v[ours.machine.drives[k].v]
            friction = sum(law.torque(speed) for law in (drive.link_friction, drive.motor_friction) if law)
            assert not link[k].any(), name
            assert motor[k] @ c == pytest.approx(drive.reflected_inertia * theta_ddot[k] + friction, abs=1e-12)


def test_coefficients_have_names_and_values_in_the_order_of_the_columns():
    ours = with_all(robot("xia2019")).with_drives({"joint2": replace(robot("xia2019").drives["joint2"],
                                                                     compliance=LinearSpring(5e3))})  # fmt: skip
    names = [*ours.drive_coefficients]
    assert ours.drive_coefficients["stiffness.joint2"] == 5e3
    first = ["inertia", "stiffness", "damping", "link_coulomb", "link_static", "link_viscous", "motor_coulomb"]
    assert names[:7] == [f"{x}.joint1" for x in first]
    state: list[Array] = [np.zeros(6)] * 5
    assert ours.drive_regressor(*state).motor.shape == (6, len(names))
