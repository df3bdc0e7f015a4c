"""Mimic joints tied to their leader, wherever in the tree either stands."""

import re
from pathlib import Path

import numpy as np
import pytest

import cutpoint
from cutpoint import Drive, LinearSpring, Robot, Rotor
from cutpoint.formats import MimicWarning, parse_urdf
from urdf_followers import arm

ORDERS = [("follower", "middle", "leader"), ("leader", "middle", "follower"), ("middle", "follower", "leader")]


@pytest.mark.parametrize("order", ORDERS, ids="-".join)
def test_a_follower_may_come_before_its_leader(order: tuple[str, ...]) -> None:
    """Tied coordinates are those of the free robot through q = G x + o, and its torques through the transpose."""
    tied = Robot(parse_urdf(arm(order), mimic="coupled"), backend="numpy")
    with pytest.warns(MimicWarning):
        free = Robot(parse_urdf(arm(order)), backend="numpy")
    led = [{"follower": "leader"}.get(name, name) for name in order]
    G = np.array([[(-0.7 if own == "follower" else 1.0) * (to == x) for x in tied.joints]
                  for own, to in zip(order, led, strict=True)])  # fmt: skip
    offset = np.array([0.1 * (name == "follower") for name in order])
    q, v, a = np.random.default_rng(0).normal(size=(3, tied.nv))
    tau = free.inverse_dynamics(G @ q + offset, G @ v, G @ a) @ G
    np.testing.assert_allclose(tied.inverse_dynamics(q, v, a), tau, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(tied.forward_dynamics(q, v, tau), a, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("order", ORDERS, ids="-".join)
def test_a_leaders_motor_bears_followers_before_and_after_it(order: tuple[str, ...]) -> None:
    tied = Robot(parse_urdf(arm(order), mimic="coupled"), backend="numpy")
    tied = tied.with_drives(dict.fromkeys(tied.joints, Drive(50.0, Rotor(1e-4), LinearSpring(900.0))))
    q, *rates = np.random.default_rng(1).normal(size=(5, tied.nv))
    u = tied.elastic_inverse_dynamics(q, *rates)
    back = tied.elastic_forward_dynamics(q, rates[0], u.theta, u.theta_dot, u.motor_torque)
    np.testing.assert_allclose(back.a, rates[1], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("order", ORDERS, ids="-".join)
def test_a_leader_loses_the_power_that_friction_takes_from_it_and_its_followers(
    order: tuple[str, ...], tmp_path: Path
) -> None:
    path, losses = tmp_path / "arm.urdf", iter([(0.3, 0.05), (0.1, 0.5), (0.2, 0.1)])
    lossy = '<dynamics damping="{}" friction="{}"/></joint>'
    path.write_text(re.sub("</joint>", lambda _: lossy.format(*next(losses)), arm(order)))
    tied = cutpoint.load(path, mimic="coupled", backend="numpy")
    with pytest.warns(MimicWarning):
        free = cutpoint.load(path, backend="numpy")
    v = np.array([0.9, -2.0])  # much faster than the speed over which dry friction changes sign
    of = dict(zip(tied.joints, v, strict=True))
    each = np.array([of[name] if name in of else -0.7 * of["leader"] for name in free.joints])
    assert np.isclose(lost(tied, v), lost(free, each), rtol=1e-12)


def lost(robot: Robot, v: np.ndarray) -> float:
    """W that friction takes at constant speeds."""
    q, still = np.zeros(robot.nq), np.zeros(robot.nv)
    u = robot.elastic_inverse_dynamics(q, v, still, still, still)
    return float(v @ (u.motor_torque - robot.inverse_dynamics(q, v, still)))
