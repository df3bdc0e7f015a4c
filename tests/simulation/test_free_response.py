"""The plant left to itself: against SciPy over Pinocchio, and by the laws that need no second opinion."""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

import cutpoint
from cutpoint import Log, ModelError, State, simulate
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from robot_library import Array, Robot, assert_close, frictionless, robot
from twins import Twin, pinocchio_of

# rad: near the paper's start, folded, stretched out sideways; the arm falls and swings at up to 17 rad/s
STARTS = [np.zeros(6), np.array([1.3, -1.0, 0.9, -0.4, 1.5, 0.2]), np.array([-0.4, 1.6, 0.3, 1.9, -0.7, 1.1])]


STONE = """<robot name="stone"><link name="stone"><inertial><mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


@cache
def arm() -> Robot:
    return frictionless(robot("xia2019"))


@cache
def expected(start: int) -> Array:
    """q after 1 s of the paper's arm with flexsplines, let go in static equilibrium of links and drives."""
    twin, drives = Twin(arm(), pinocchio_of(arm().mechanism)), [*arm().drives.values()]
    J, K, c = (
        np.array(x) for x in zip(*[(d.reflected_inertia, *vars(d.compliance).values()) for d in drives], strict=True)
    )

    def rates(_: float, x: Array) -> Array:
        q, v, theta, theta_dot = np.split(x, 4)
        tau = np.tan((theta - q) * c * K) / c
        return np.concatenate([v, pin.aba(twin.model, twin.data, q, v, tau), theta_dot, -tau / J])

    q, still = STARTS[start], np.zeros(6)
    lead = np.arctan(c * twin.gravity_forces(q)) / (c * K)
    x = np.concatenate([q, still, q + lead, still])
    return solve_ivp(rates, (0.0, 1.0), x, method="DOP853", rtol=1e-12, atol=1e-13).y[:6, -1]


@cache
def fallen(start: int, accuracy: str = "standard", substeps: int | None = None) -> Log:
    return simulate(arm(), duration=1.0, initial=State(q=STARTS[start]), accuracy=accuracy, substeps=substeps)


@pytest.mark.parametrize(("accuracy", "error"), [("reference", 1e-8), ("fine", 1e-6), ("standard", 1e-4)])
@pytest.mark.parametrize("start", range(len(STARTS)))
def test_after_a_second_the_arm_is_where_scipy_has_it(start, accuracy, error):
    assert np.abs(fallen(start, accuracy)["q"][-1] - expected(start)).max() <= error


def energies(log: Log) -> tuple[Array, Array]:
    """All energy, and the kinetic part of it."""
    spin = sum(d.reflected_inertia * w**2 / 2 for d, w in zip(arm().drives.values(), log["theta_dot"].T, strict=True))
    kinetic = arm().kinetic_energy(log["q"], log["v"]) + spin
    stored = arm().potential_energy(log["q"]) + arm().elastic_energy(log["q"], log["theta"], log["theta_dot"])
    return kinetic - spin + stored, kinetic


@pytest.mark.parametrize(("accuracy", "drift"), [("reference", 1e-9), ("fine", 1e-8), ("standard", 1e-5)])
@pytest.mark.parametrize("start", range(len(STARTS)))
def test_energy_stays_without_friction(start, accuracy, drift):
    """Drift over a second, measured by the peak of kinetic energy."""
    total, kinetic = energies(fallen(start, accuracy))
    assert np.abs(total - total[0]).max() <= drift * kinetic.max()
    assert kinetic.max() > 1.0


def test_the_fixed_step_is_of_order_four():
    steps = np.array([16, 20, 24, 32, 40])
    errors = [np.abs(fallen(2, substeps=int(n))["q"][-1] - expected(2)).max() for n in steps]
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order == pytest.approx(4.0, abs=0.3)


def test_friction_takes_energy_and_never_gives_any():
    ours = robot("xia2019")
    log = simulate(ours, duration=0.3, initial=State(q=STARTS[1]))
    spin = sum(d.reflected_inertia * w**2 / 2 for d, w in zip(ours.drives.values(), log["theta_dot"].T, strict=True))
    total = ours.kinetic_energy(log["q"], log["v"]) + ours.potential_energy(log["q"])
    total = total + ours.elastic_energy(log["q"], log["theta"], log["theta_dot"])
    assert np.diff(total).max() <= 1e-9 * spin.max()
    assert total[0] - total[-1] > 0.01


@pytest.mark.parametrize("name", ["mixed", "mixed_floating", "tree"])
def test_slides_turns_and_rigid_and_bending_drives_together(name):
    """Against SciPy over the robot's own accelerations; a rigid drive's motor moves as its link does."""
    ours = frictionless(robot(name))
    n, nq, nv = len(ours.drives), ours.nq, ours.nv
    elastic = np.array([d.is_elastic for d in ours.drives.values()])
    driven_v = [d.v for d in ours.machine.drives]

    def rates(_: float, x: Array) -> Array:
        q, v, theta, theta_dot = np.split(x, [nq, nq + nv, nq + nv + n])
        a, alpha = ours.elastic_forward_dynamics(q, v, theta, theta_dot, np.zeros(n))
        return np.concatenate([ours.coordinate_rates(q, v), a, np.where(elastic, theta_dot, v[driven_v]), alpha])

    log = simulate(ours, duration=0.1, accuracy="reference")
    q, still = ours.neutral(), np.zeros(n)
    start = np.concatenate([q, np.zeros(nv), ours.static_deflection(q), still])
    found = solve_ivp(rates, (0.0, 0.1), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    assert_close(log["theta"][-1], found[nq + nv : nq + nv + n], 1e-8, scale=1.0)
    assert_close(log["q"][-1], found[[d.q for d in ours.machine.drives]], 1e-8, scale=1.0)
    rigid = ~elastic
    assert_close(log["theta"][:, rigid], log["q"][:, rigid], 1e-10, scale=1.0)


def test_momentum_stays_when_floating_free():
    ours = robot("weightless")
    v = np.random.default_rng(0).normal(size=ours.nv)
    log = simulate(ours, duration=0.5, initial=State(q=ours.neutral(), v=v))
    base = [log[f"base_{x}"] for x in ("x", "y", "z", "qx", "qy", "qz", "qw")]
    base_speeds = [log[f"base_{x}"] for x in ("vx", "vy", "vz", "wx", "wy", "wz")]
    momentum = ours.momentum(np.column_stack([*base, log["q"]]), np.column_stack([*base_speeds, log["v"]]))
    assert_close(momentum, np.broadcast_to(momentum[0], momentum.shape), 1e-8)


@pytest.mark.parametrize("floating", [True, False])
def test_a_robot_without_drives_falls_or_stands(tmp_path, floating):
    (tmp_path / "stone.urdf").write_text(STONE)
    log = simulate(cutpoint.load(tmp_path / "stone.urdf", floating_base=floating), duration=0.1)
    if floating:
        assert_close(log["base_z"], -0.5 * 9.81 * log.time**2, 1e-9)
    assert log["q"].shape == (101, 0)


def test_a_floating_base_without_inertia_is_told():
    """Where nothing moves that weighs, no step is short enough, and no gain low enough."""
    links = [Link("root"), Link("arm", 1.0, np.array([0.1, 0.0, 0.0]), np.eye(3) * 0.01)]
    joint = Joint("turn", "revolute", "root", "arm", np.eye(4), np.array([0.0, 0.0, 1.0]))
    root = Joint("root_joint", "floating", "world", "root", np.eye(4))
    ours = Robot(build("top", [Link("world"), *links], [root, joint]))
    with pytest.raises(
        ModelError, match="joints 'root_joint', 'turn' can move against each other without moving any inertia"
    ):
        simulate(ours, duration=0.01)
