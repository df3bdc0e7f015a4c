"""Every stiffness curve of the catalogue, exact in the equations of motion: there and back."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from cutpoint import Robot
from cutpoint.formats import catalogue_drive, catalogue_names
from cutpoint.model import Drive
from robot_library import Array, robot, tree

CURVES = {catalogue_drive(name).compliance: name for name in catalogue_names() if catalogue_drive(name).is_elastic}
"""Each curve once, by the first drive that has it."""


def smooth(name: str, coupling: str) -> Drive:
    """A catalogue's drive with its kinematic error, and its friction, by value."""
    drive = catalogue_drive(name)
    assert drive.rotor
    return replace(drive, rotor=replace(drive.rotor, coupling=coupling), hysteresis=None)


@cache
def bare(arm: str) -> Robot:
    return robot("xia2019") if arm == "xia2019" else tree(seed=5, size=3)


CASES = [(name, "three bodies", coupling) for name in CURVES.values() for coupling in ("reduced", "full")]
CASES += [(name, "xia2019", "reduced") for curve, name in CURVES.items() if curve.tangent(1.0) < 2e4]
"""A stiff drive on a light hand would only show how positions round: eps * 1 rad * K / M is above 1e-9 there."""


@pytest.mark.parametrize(("name", "on", "coupling"), CASES)
def test_inverse_then_forward_dynamics_returns_the_motion(name: str, on: str, coupling: str) -> None:
    arm = bare(on)
    arm = arm.with_drives(dict.fromkeys(arm.joints, smooth(name, coupling)))
    rng = np.random.default_rng(0)
    q = arm.random(seed=0, size=20)
    rates = [0.5 * rng.standard_normal((20, arm.nv)) for _ in range(arm.derivatives_needed)]
    u = arm.elastic_inverse_dynamics(q, *rates)
    found = arm.elastic_forward_dynamics(q, rates[0], u.theta, u.theta_dot, u.motor_torque)
    assert_returned(found.a, rates[1])
    assert_returned(found.theta_ddot, u.theta_ddot)


def assert_returned(found: Array, given: Array) -> None:
    assert np.abs(found - given).max() <= 1e-9 * max(1.0, np.abs(given).max())
