"""Functions in which each joint stands for itself: for large robots, a batch over joints agrees with the equations."""

from dataclasses import replace

import numpy as np
import pytest

from cutpoint import Drive, LinearSpring, Robot, Rotor, definitions
from cutpoint.errors import InputError
from cutpoint.mechanics.drives.compliance import Flexspline
from cutpoint.mechanics.drives.friction import Coulomb
from cutpoint.model import Mechanism
from large_robots import based, chain

SIZE = 300
EPS = np.finfo(float).eps
CHAIN = chain(SIZE, ("revolute", "prismatic", "helical"))
BASED = based("floating", SIZE)


def driven(mechanism: Mechanism) -> Robot:
    """Drives of several structures, each with numbers of its own."""
    rng, soft = np.random.default_rng(0), Drive(100.0, Rotor(1e-4), LinearSpring(2e4))
    bent = replace(soft, compliance=Flexspline(8e3, 1e-3), link_friction=Coulomb(0.5, 0.3, 0.02))
    kinds = (soft, Drive(), bent)
    drives = {name: kinds[k % 3] for k, name in enumerate(Robot(mechanism).joints)}
    stated = {name: replace(d, ratio=rng.uniform(50, 150)) if d.rotor else d for name, d in drives.items()}
    return Robot(mechanism, stated)


@pytest.mark.parametrize("mechanism", [CHAIN, BASED], ids=["chain", "floating"])
def test_each_joint_obeys_the_equations(mechanism: Mechanism) -> None:
    robot, rng = driven(mechanism), np.random.default_rng(1)
    machine, (q, q_next) = robot.machine, robot.random(rng, 2)
    v, twist = rng.normal(size=robot.nv), rng.normal(size=(2, len(robot.drives)))
    theta = q[[d.q for d in machine.drives]] + 1e-3 * twist[0]
    pairs = [
        (robot.integrate(q, v, 0.1), definitions.integrate(machine, [*q], [*v], 0.1)),
        (robot.difference(q, q_next), definitions.difference(machine, [*q], [*q_next])),
        (robot.coordinate_rates(q, v), definitions.coordinate_rates(machine, [*q], [*v])),
        (robot.drive_torque(theta, q), definitions.drive_torque(machine, [*theta], [*q])),
        (robot.friction_torques(v), definitions.friction_torques(machine, [*v])),
        (robot.elastic_energy(q, theta, twist[1]), definitions.elastic_energy(machine, [*q], [*theta], [*twist[1]])),
    ]
    for ours, expected in pairs:
        assert np.shape(ours) == np.shape(expected)
        np.testing.assert_allclose(ours, expected, rtol=0, atol=100 * EPS * np.abs(expected).max())
    with pytest.raises(InputError, match="has no kernel"):
        robot.kernel("integrate")


def test_a_batch_is_its_rows_and_times_may_differ() -> None:
    robot, rng = driven(BASED), np.random.default_rng(2)
    q, v, dt = robot.random(rng, (3, 2)), rng.normal(size=(2, robot.nv)), rng.uniform(0.1, 1.0, (3, 1))
    moved = robot.integrate(q, v, dt)
    np.testing.assert_array_equal(moved[2, 1], robot.integrate(q[2, 1], v[1], dt[2, 0]))
    back = robot.difference(q, moved) / dt[..., None]
    np.testing.assert_allclose(back, np.broadcast_to(v, back.shape), atol=1e-12)
    assert robot.integrate(q[:0], v, 0.1).shape == (0, 2, robot.nq)


def test_what_does_not_fit_is_named() -> None:
    robot = driven(CHAIN)
    with pytest.raises(InputError, match=rf"integrate: q has shape \({SIZE - 1},\): its last axis must be {SIZE}"):
        robot.integrate(np.zeros(SIZE - 1), np.zeros(SIZE), 0.1)
    with pytest.raises(InputError, match=r"friction_torques: v\[7\] is nan"):
        robot.friction_torques(np.where(np.arange(SIZE) == 7, np.nan, 0.0))
    with pytest.raises(InputError, match=r"integrate: leading axes do not broadcast: q \(2,\), v \(3,\), dt \(\)"):
        robot.integrate(np.zeros((2, SIZE)), np.zeros((3, SIZE)), 0.1)
