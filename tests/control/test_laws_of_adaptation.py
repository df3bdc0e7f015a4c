"""Invariants of adaptation for any input, and quantities that it decreases."""

from typing import Any

import numpy as np
import pytest
from numpy_adaptive_vdc import DUALS
from numpy_adaptive_vdc import pseudo_inertia as pseudo_inertia_of

from cutpoint import Coulomb, Drive, LinearSpring, Robot, Rotor, simulate
from cutpoint.control import AdaptiveVDC, Command, Measurement, Reference, tune
from cutpoint.control.laws.adaptation import factor, inertial_of_factor, natural, projected
from cutpoint.mechanics.bodies.pseudo_inertia import pseudo_inertia
from cutpoint.simulation.control_kernel import law_kernel, law_memory
from cutpoint.simulation.loop.parameters import law_parameters
from cutpoint.trajectories import cycloid
from robot_library import Array, assert_close, derivative, robot, tree

RUNS = 1000


def random_bodies(rng: np.random.Generator, size: int = RUNS) -> Array:
    """(size, 10): clouds of five points each; every tenth is a rod, whose pseudo-inertia is singular."""
    points, masses = rng.normal(size=(size, 5, 3)), 10 ** rng.uniform(-3, 1, (size, 5))
    points[::10] = points[::10, :1] * np.linspace(0.5, 2, 5)[:, None]
    h, S = np.einsum("nk,nki->ni", masses, points), np.einsum("nk,nki,nkj->nij", masses, points, points)
    I = np.trace(S, axis1=1, axis2=2)[:, None, None] * np.eye(3) - S
    return np.column_stack([masses.sum(axis=1), h, I[:, *np.triu_indices(3)]])


def columns(p: Array) -> list[Any]:
    """An array's last axis as a list, so that one call of an update serves the whole batch."""
    return [*np.moveaxis(p, -1, 0)]


def test_projection_keeps_every_number_in_its_bounds_at_any_rate():
    rng = np.random.default_rng(0)
    low = rng.normal(size=RUNS)
    high, p = low + 10 ** rng.uniform(-9, 3, RUNS), low
    for _ in range(20):
        s, rate = rng.normal(size=RUNS) * 10 ** rng.uniform(-9, 9, RUNS), 10 ** rng.uniform(-9, 15, RUNS)
        p = projected(p, s, rate, low, high, 1e-3)
        assert (low <= p).all() and (p <= high).all()


def test_natural_adaptation_keeps_bodies_physical_at_any_rate():
    """Steps X of 1e-6 to 1e6, where the exact exponential overflows; beyond that twice in a row, doubles do."""
    rng = np.random.default_rng(1)
    p = random_bodies(rng)
    C = [columns(row) for row in np.moveaxis(np.array([factor(x) for x in p]), 1, 0)]
    for _ in range(2):
        s = rng.normal(size=(RUNS, 10)) * 10 ** rng.uniform(-6, 6, (RUNS, 1)) / np.abs(p).max(axis=1, keepdims=True)
        C = natural(C, columns(s), 1e3, 1e-3)
        p = np.array(inertial_of_factor(C)).T
        values = np.linalg.eigvalsh([pseudo_inertia_of(x) for x in p])
        assert np.isfinite(values).all()
        assert (values[:, 0] >= -1e-13 * values[:, -1]).all()
        assert (p[:, 0] > 0).all()


def test_an_estimate_that_is_to_fall_falls_however_long_the_step():
    for step in 10.0 ** np.arange(-3, 7):
        C = natural(np.eye(4).tolist(), [-step, *[0.0] * 9], 1.0, 1.0)
        assert np.exp(-2.0) - 0.2 < inertial_of_factor(C)[0] < 1.0


def test_a_body_survives_its_factor():
    p = random_bodies(np.random.default_rng(2), 50)
    for x in p:
        assert_close(inertial_of_factor(factor(x)), x, 1e-13)
        assert_close(pseudo_inertia(x), pseudo_inertia_of(x), 1e-15)


def test_projection_lowers_the_quadratic_distance_by_what_it_feeds_on():
    """V = (p - p*)^2 / (2 rate): V+ - V <= T s (p - p*) + T^2 rate s^2 / 2, exactly, for any p* within bounds."""
    rng = np.random.default_rng(3)
    low, high = -rng.random(RUNS), rng.random(RUNS)
    p, true = (low + (high - low) * x for x in rng.random((2, RUNS)))
    s, rate, T = rng.normal(size=RUNS), 10 ** rng.uniform(-2, 3, RUNS), 1e-2
    after = projected(p, s, rate, low, high, T)
    gained = ((after - true) ** 2 - (p - true) ** 2) / (2 * rate)
    fed = T * s * (p - true) + T**2 * rate * s**2 / 2
    # digits of the squares, over the rate
    assert (gained <= fed + 1e-15 / rate).all()
    assert (np.abs(gained - fed) < 1e-14 / rate)[(low < after) & (after < high)].all()


def divergence(L: Array, true: Array) -> float:
    """log det L - log det L* + tr(L^-1 L*) - 4: Bregman divergence of -log det.  Lee, Kwon and Park (2018)."""
    return np.linalg.slogdet(L)[1] - np.linalg.slogdet(true)[1] + np.trace(np.linalg.solve(L, true)) - 4


def test_natural_adaptation_lowers_the_divergence_by_what_it_feeds_on():
    """D+ - D = rate T s^T (p - p*), but for x^2 tr(L^-1 L*) / 2 and smaller, x = rate T |C^T S C| being small."""
    rng, x = np.random.default_rng(4), 1e-3
    bodies = np.delete(random_bodies(rng, 60), np.s_[::10], axis=0)
    for p, true in zip(bodies[::2], bodies[1::2], strict=False):
        s, C = rng.normal(size=10), np.array(factor(p))
        S = np.einsum("a,aij->ij", s, DUALS)
        T, L, L_true = x / np.linalg.norm(C.T @ S @ C, 2), pseudo_inertia_of(p), pseudo_inertia_of(true)
        after = pseudo_inertia_of(np.array(inertial_of_factor(natural(C.tolist(), [*s], 1.0, T))))
        rest = divergence(after, L_true) - divergence(L, L_true) - T * s @ (p - true)
        assert abs(rest) <= 0.6 * x * x * np.trace(np.linalg.solve(L, L_true)) + 4 * x**3


def two_joints() -> Robot:
    """Two links with all that a joint can learn: friction on both sides, rotor, spring."""
    rub = Coulomb(0.4, 0.1, 0.05)
    bare = tree(seed=4, size=2)
    kinds = [
        Drive(90.0, Rotor(2e-5), LinearSpring(4e3), link_friction=rub),
        Drive(-60.0, Rotor(1e-5), motor_friction=rub),
    ]
    return bare.with_drives(dict(zip(bare.joints, kinds, strict=True)))


@pytest.mark.parametrize("update", ["projection", "natural"])
def test_what_it_believes_is_told_in_the_frames_of_the_files(update):
    arm = robot("ur10")  # whose axes are not all z
    law = AdaptiveVDC(arm, 5.0, 10.0, 1.0, 40.0, update=update)
    assert_close(law.inertial_parameters(law.start()), arm.inertial_parameters)


@pytest.mark.parametrize("update", ["projection", "natural"])
def test_what_it_believes_can_be_recorded_while_it_runs(update):
    """By a wrapper that compiles: one that ran as a callback would warn, and warnings are errors."""
    arm = robot("ur10")
    heavy = arm.with_payload(5.0, com=np.zeros(3), inertia=0.01 * np.eye(3), frame=arm.joints[-1])
    law = tune(arm, 4.0, AdaptiveVDC, update=update, body_rate=10.0)

    class Recording:
        def start(self) -> Any:
            return law.start()

        def step(self, memory: Any, measured: Measurement, wanted: Reference) -> tuple[Any, Command]:
            memory, command = law.step(memory, measured, wanted)
            return memory, Command(command.torque, feedforward=law.inertial_parameters(memory)[::10])

    log = simulate(heavy, Recording(), cycloid(end=np.full(6, 0.5), duration=0.2))
    assert log.run is not None
    memory, seen = law.start(), (log[f"measured_{name}"] for name in ("q", "v", "theta", "theta_dot"))
    masses = []
    for time, *measured, wanted in zip(log.time, *seen, log.run.reference.swapaxes(0, 1), strict=True):
        memory, _ = law.step(memory, Measurement(time, 1e-3, *measured), Reference(*wanted, *wanted[:2]))
        masses.append(law.inertial_parameters(memory)[::10])
    assert_close(log["feedforward_torque"], np.array(masses))
    assert masses[-1].sum() > masses[0].sum()  # the payload


@pytest.mark.parametrize(("update", "rate"), [("projection", 1e12), ("natural", 1.0)])
def test_the_law_keeps_what_it_believes_within_bounds_and_physical_in_a_thousand_runs(update, rate):
    ours, rng = two_joints(), np.random.default_rng(5)
    law = AdaptiveVDC(ours, 10.0, 5.0, 3.0, 60.0, update=update, body_rate=rate, joint_rate=1e12, uncertainty=0.3)
    kernel, start = law_kernel(ours, law), law_memory(law)
    bodies = sum(np.size(x) for x in law.start().bodies)
    joints = sum(np.size(x) for x in law.start().joints)
    memory, numbers = np.broadcast_to(start, (RUNS, start.size)), law_parameters(law, 1e-3)
    for time in range(3):
        given = 10 ** rng.uniform(-9, 1 if update == "projection" else 0.3, (RUNS, 1, 1)) * rng.normal(
            size=(RUNS, 9, 2)
        )
        memory = kernel(*(given[:, k] for k in range(9)), np.full(RUNS, 1e-3 * time), memory, numbers).next_memory
        learnt = memory[:, bodies : bodies + joints] / start[bodies : bodies + joints]
        assert (learnt > 0.7 - 1e-15).all() and (learnt < 1.3 + 1e-15).all()
        p = memory[:, :bodies].reshape(RUNS, 2, -1)
        if update == "projection":
            moved = np.abs(p - start[:bodies].reshape(2, -1)) / 0.3
            assert (moved[..., 0] <= start[[0, 10]] * (1 + 1e-14)).all()
        else:
            p = np.array([[inertial_of_factor(C.reshape(4, 4)) for C in run] for run in p])
            values = np.linalg.eigvalsh([[pseudo_inertia_of(x) for x in run] for run in p])
            assert (values[..., 0] >= -1e-13 * values[..., -1]).all() and (p[..., 0] > 0).all()
    assert np.ptp(learnt, axis=0).min() > 0.1  # it has learnt something everywhere


@pytest.mark.parametrize("name", ["xia2019", "ur10"])
def test_rate_of_the_mass_matrix_less_twice_c_is_skew_with_fully_coupled_rotors(name):
    """Rotors that are heavy, geared rigidly in either sense, and turn along with what carries them."""
    arm, rng = robot(name), np.random.default_rng(6)
    ours = arm.with_drives({x: Drive((-1) ** k * 50.0, Rotor(2e-3, coupling="full")) for k, x in enumerate(arm.joints)})
    for scale in (0.0, 1e-9, 1.0, 3.0):
        q, v = rng.normal(size=(2, 6)) * scale
        M, C = ours.mass_matrix(q), ours.coriolis_matrix(q, v)
        S = derivative(lambda h, q=q, v=v: ours.mass_matrix(q + h * v)) - 2 * C
        # 1e-13 of M over the step of 1e-3
        assert_close(S, -S.T, 1e-9, scale=np.abs(M).max())
        assert_close(C @ v, ours.bias_forces(q, v) - ours.gravity_forces(q), 1e-11, scale=10.0)
