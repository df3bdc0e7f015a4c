"""Promises of elastic inverse dynamics: it inverts the forward dynamics, and its rates are those of its values."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutpoint import Coulomb, Drive, ElastoPlastic, Harmonic, KinematicError, LuGre, MaxwellSlip
from robot_library import BACKENDS, STRIBECK, Array, assert_close, derivative, frictionless, robot, vectors

ROBOTS = [("linear", "llvm"), ("flexspline", "llvm"), ("flexspline", "numpy"), ("friction", "llvm"), ("damped", "llvm"),
          ("rigid", "llvm"), ("mixed", "llvm"), ("mixed", "numpy")]  # fmt: skip


def five(size: int) -> st.SearchStrategy[tuple[Array, ...]]:
    """A position with four derivatives."""
    return st.tuples(*[vectors(size)] * 5)


class Path:
    """q(t), a sum of two sines a joint, with its derivatives to order 4."""

    def __init__(self, size: int, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        self.amplitude, self.phase = rng.uniform(-1, 1, (2, size)), rng.uniform(0, 6, (2, size))
        self.rate = rng.uniform(0.3, 2.5, (2, size))

    def __call__(self, t: float) -> list[Array]:
        angle = self.rate * t + self.phase
        return [(self.amplitude * self.rate**k * np.sin(angle + k * np.pi / 2)).sum(axis=0) for k in range(5)]


@pytest.mark.parametrize("friction_rates", [False, True])
@pytest.mark.parametrize(("name", "backend"), ROBOTS)
@given(data=st.data())
def test_forward_dynamics_returns_the_motion_that_inverse_dynamics_was_given(name, backend, friction_rates, data):
    ours = robot(name, backend)
    motion = data.draw(five(ours.nv))
    q, v, a = motion[:3]
    u = ours.elastic_inverse_dynamics(*motion, friction_rates=friction_rates)
    found = ours.elastic_forward_dynamics(q, v, u.theta, u.theta_dot, u.motor_torque)
    # a deflection is a small difference of angles: its rounding, times the stiffness, accelerates the lightest link
    rounding = 2e-16 * 1.6e4 * np.abs(u.theta).max() * np.linalg.norm(np.linalg.inv(ours.mass_matrix(q)), 2)
    assert_close(found.a, a, 1e-9, scale=max(1.0, 1e9 * rounding))
    assert_close(found.theta_ddot, u.theta_ddot, 1e-9, scale=max(1.0, 1e9 * rounding))


def test_strains_are_counted_there_and_back():
    """Bristles and elements of hysteresis, in any state, and one joint that has none."""
    ours, rng = robot("flexspline"), np.random.default_rng(0)
    bristles = ElastoPlastic(Coulomb(1.0, 0.5, 0.02, per_load=0.1), 2e-4, 3.0, 0.7)
    holding, slips = ElastoPlastic(STRIBECK, 2e-4, 3.0, 0.5), MaxwellSlip.smooth(1.4, 2.9e-4)
    parts = {"hysteresis": slips, "link_friction": holding, "motor_friction": bristles}
    drives = {name: replace(drive, **parts) for name, drive in ours.drives.items()}
    drives["joint3"] = replace(ours.drives["joint3"], motor_friction=LuGre(STRIBECK, 1e-4, 1.0))
    ours = ours.with_drives(drives)
    motion = rng.standard_normal((5, 20, ours.nv))
    strains = 1e-4 * rng.standard_normal((20, len(ours.strain_names)))
    u = ours.elastic_inverse_dynamics(*motion, strains=strains)
    found = ours.elastic_forward_dynamics(motion[0], motion[1], u.theta, u.theta_dot, u.motor_torque, strains)
    assert_close(found.a, motion[2], 1e-8)
    assert_close(found.theta_ddot, u.theta_ddot, 1e-8)
    without = ours.elastic_inverse_dynamics(*motion)
    assert np.abs(u.motor_torque - without.motor_torque).min(axis=0).max() > 0.1


def test_waves_before_damped_springs_are_counted_there_and_back():
    ours, rng = robot("damped"), np.random.default_rng(0)
    waves = KinematicError((Harmonic(2, 1e-3, 0.3), Harmonic(9, 1e-4, 1.0)))
    ours = ours.with_drives({name: replace(drive, kinematic_error=waves) for name, drive in ours.drives.items()})
    motion = rng.standard_normal((5, 20, ours.nv))
    u = ours.elastic_inverse_dynamics(*motion)
    found = ours.elastic_forward_dynamics(motion[0], motion[1], u.theta, u.theta_dot, u.motor_torque)
    assert_close(found.a, motion[2], 1e-8)
    assert_close(found.theta_ddot, u.theta_ddot, 1e-8)


def test_friction_that_load_and_direction_change_is_counted_there_and_back_by_rigid_drives():
    """A torque of 50 N m, rounded, accelerates the lightest link by 50 eps / 0.1 kg m2, some 1e-13 rad/s2."""
    ours, rng = robot("rigid", "numpy"), np.random.default_rng(0)
    rubs = Coulomb(1.0, 0.5, 0.02, asymmetry=0.3, per_load=0.2)
    ours = ours.with_drives({name: replace(drive, motor_friction=rubs) for name, drive in ours.drives.items()})
    q, v, a = motion = rng.standard_normal((3, 20, ours.nv))
    u = ours.elastic_inverse_dynamics(*motion, 0 * a, 0 * a)
    found = ours.elastic_forward_dynamics(q, v, u.theta, u.theta_dot, u.motor_torque)
    assert_close(found.a, a, 1e-12)


@pytest.mark.parametrize(("name", "backend"), ROBOTS[:3])
@pytest.mark.parametrize("t", [0.0, 0.7, 2.9])
def test_motor_speed_and_acceleration_are_time_derivatives_of_motor_position(name, backend, t):
    ours = robot(name, backend)
    path = Path(ours.nv)

    def motor(h: float) -> tuple[Array, ...]:
        return ours.elastic_inverse_dynamics(*path(t + h))

    _, _, theta_dot, theta_ddot, _ = motor(0.0)
    assert_close(derivative(lambda h: motor(h)[1], 0.01), theta_dot, 1e-10)
    assert_close(derivative(lambda h: motor(h)[2], 0.01), theta_ddot, 1e-10)
    # the lead, that which bending adds, and not only the link's own motion
    _, v, a, *_ = path(t)
    assert_close(derivative(lambda h: motor(h)[1] - path(t + h)[0], 0.01), theta_dot - v, 1e-8)
    assert_close(derivative(lambda h: motor(h)[2] - path(t + h)[1], 0.01), theta_ddot - a, 1e-8)


@pytest.mark.parametrize("name", ["friction", "mixed"])
def test_friction_counts_in_the_rates_when_asked(name):
    """Undamped springs: a damped one's lead leaves its own rate out."""
    whole = robot(name)
    ours = whole.with_drives(
        {n: Drive(d.ratio, d.rotor, d.compliance, None, d.link_friction) for n, d in whole.drives.items()}
    )
    path = Path(ours.nv, seed=1)

    def motor(h: float) -> tuple[Array, ...]:
        return ours.elastic_inverse_dynamics(*path(1.3 + h), friction_rates=True)

    assert_close(derivative(lambda h: motor(h)[1], 0.002), motor(0.0)[2], 1e-9)
    assert_close(derivative(lambda h: motor(h)[2], 0.002), motor(0.0)[3], 1e-8)


@pytest.mark.parametrize("name", ["flexspline", "mixed"])
def test_without_friction_motor_power_is_the_rate_of_all_energy(name):
    ours = frictionless(robot(name))
    path, driven = Path(ours.nv, seed=2), [d.v for d in ours.machine.drives]

    def energy(h: float) -> Array:
        q, v, *_ = motion = path(0.4 + h)
        u = ours.elastic_inverse_dynamics(*motion)
        own = ours.elastic_energy(q, u.theta, u.theta_dot)
        return ours.kinetic_energy(q, v) + ours.potential_energy(q) + own

    u = ours.elastic_inverse_dynamics(*path(0.4))
    elastic = np.array([d.is_elastic for d in ours.drives.values()])
    speeds = np.where(elastic, u.theta_dot, path(0.4)[1][driven])
    assert_close(derivative(energy, 0.01), u.motor_torque @ speeds, 1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
def test_torque_read_from_two_encoders_is_what_the_link_gets(backend):
    ours = robot("xia2019", backend)
    path = Path(6, seed=3)
    for t in (0.0, 1.0, 2.0):
        q, v, *_ = motion = path(t)
        u = ours.elastic_inverse_dynamics(*motion)
        assert_close(ours.drive_torque(u.theta, q), u.joint_torque + ours.friction_torques(v), 1e-10)


@given(q=vectors(6))
def test_static_deflection_bears_the_weight(q):
    ours = robot("xia2019")
    lead = ours.static_deflection(q)
    assert_close(ours.drive_torque(q + lead, q), ours.gravity_forces(q), 1e-10, scale=1.0)
    still = np.zeros(6)
    assert_close(ours.elastic_inverse_dynamics(q, *[still] * 4).theta, q + lead, 1e-14, scale=1.0)
