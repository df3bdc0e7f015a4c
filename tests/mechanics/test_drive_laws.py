"""Catalogue curve, wave generator and kinematic error: smooth, monotone, invertible, conserving energy."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cutpoint
from cutpoint import Backlash, Drive, Flexspline, InputError, Limits, LinearSpring, ModelError, Robot, Rotor
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.kinematic_error import Harmonic, KinematicError
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.scalars import Jet
from robot_library import robot

CATALOGUE = {  # ratio above 50: K1, K2, K3 in N m/rad, T1, T2 in N m; Harmonic Drive CHA manual 1018854, table 50.4
    14: CatalogueSpring(4.7e3, 6.1e3, 7.1e3, 2.0, 6.9),
    17: CatalogueSpring(10e3, 14e3, 16e3, 3.9, 12.0),
    20: CatalogueSpring(16e3, 25e3, 29e3, 7.0, 25.0),
    25: CatalogueSpring(31e3, 50e3, 57e3, 14.0, 48.0),
    32: CatalogueSpring(67e3, 110e3, 120e3, 29.0, 108.0),
}
HARMONIC = HarmonicSpring(Flexspline(16e3, 0.0464), WaveGenerator(60.0, 2.0, 101.0, 0.02))
LAWS = [*CATALOGUE.values(), HARMONIC]
STRANGE = {
    "hardening behind little play": Backlash(Flexspline(16e3, 0.0464), 1e-4),
    "hardening behind play": Backlash(Flexspline(16e3, 0.0464), 5e-3),
    "hardening behind much play": Backlash(Flexspline(4.7e3, 0.119), 5e-2),
    "corners behind play": Backlash(CATALOGUE[20], 2e-3),
    "sharp corners": CatalogueSpring(1e4, 1e5, 1e6, 10.0, 40.0),
    "softening": CatalogueSpring(1e5, 3e4, 1e4, 10.0, 40.0),
    "soft wave generator": HarmonicSpring(Flexspline(2e4, 1e-3), WaveGenerator(1.0, 20.0, 100.0, 1e-3)),
}
"""Springs that no catalogue has, which may be stated nonetheless."""

deflections = st.floats(-5e-3, 5e-3)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
@given(deflection=deflections)
def test_the_inverse_law_inverts(law, deflection):
    assert law.deflection(law.torque(deflection)) == pytest.approx(deflection, rel=1e-12, abs=1e-17)


@pytest.mark.parametrize("name", STRANGE)
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_inverse_finds_every_torque_of_strange_springs_too(name, sign):
    law = STRANGE[name]
    for torque in sign * np.geomspace(1e-6, 300.0, 400):
        assert law.torque(law.deflection(torque)) == pytest.approx(torque, rel=1e-9)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
@given(deflection=deflections)
def test_laws_are_odd_and_their_tangent_and_energy_belong_to_them(law, deflection):
    jet = law.torque(Jet(deflection, 1.0, 0.0))
    assert law.torque(-deflection) == pytest.approx(-law.torque(deflection), abs=1e-12)
    assert law.tangent(deflection) == pytest.approx(jet.derivative(1), rel=1e-9)
    assert law.tangent(deflection) > 0
    assert law.energy(Jet(deflection, 1.0)).derivative(1) == pytest.approx(law.torque(deflection), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
def test_two_derivatives_of_the_torque_are_continuous(law):
    """A step of the second derivative would show as a jump that a finer grid does not shrink."""
    jumps = []
    for count in (20001, 40001):
        second = law.torque(Jet(np.linspace(-1.5e-3, 1.5e-3, count), 1.0, 0.0)).derivative(2)
        jumps.append(np.abs(np.diff(second)).max())
    assert jumps[1] < 0.6 * jumps[0]


@pytest.mark.parametrize("size", CATALOGUE)
def test_a_catalogue_spring_keeps_the_straight_segments_but_for_its_stated_fit_error(size):
    law = CATALOGUE[size]
    torque = np.linspace(0, 1.5 * law.t2, 2001)
    corners = np.cumsum([law.t1 / law.k1, (law.t2 - law.t1) / law.k2])
    knots = np.array([0, *corners, corners[1] + law.t2 / law.k3])
    straight = np.interp(law.deflection(torque), knots, [0, law.t1, law.t2, 2 * law.t2])
    assert np.abs(torque - straight).max() == pytest.approx(law.fit_error, rel=1e-2)
    assert law.fit_error < 0.04 * law.t1


@given(torque=st.floats(-80, 80))
def test_the_wave_generator_is_the_printed_law_beyond_its_blend(torque):
    wave = HARMONIC.wave_generator
    tau_w = torque / wave.ratio
    bent = (1 - np.exp(-wave.hardening * abs(tau_w))) / (wave.hardening * wave.stiffness)
    printed = np.sign(tau_w) * bent / wave.ratio
    close = 1e-15 if abs(tau_w) >= wave.blend else 2e-7
    assert wave.deflection(torque) == pytest.approx(printed, abs=close)


@pytest.mark.parametrize("hardening", [1e-4, 1e-8, 1e-15, 1e-100])
def test_a_wave_generator_that_hardly_hardens_is_a_linear_spring_to_the_last_digits(hardening):
    flexspline = Flexspline(1e4, 0.03)
    spring = HarmonicSpring(flexspline, WaveGenerator(60.0, hardening, 100.0, 0.01))
    energy, behind = cutpoint.compile(spring.energy, deflection=()), 100.0**2 * 60.0
    for torque in (1e-3, 0.3, -2.0, 30.0):
        bent = flexspline.deflection(torque)
        close = {"rel": 1e-13 + hardening * abs(torque) / 100.0}
        assert spring.deflection(torque) == pytest.approx(bent + torque / behind, **close)
        stored = flexspline.energy(bent) + torque * torque / (2 * behind)
        assert spring.energy(bent + torque / behind) == pytest.approx(stored, **close)
        assert energy(bent + torque / behind) == pytest.approx(stored, **close)


def erring(ratio: float = 100.0, amplitude: float = 2e-4) -> Drive:
    error = KinematicError((Harmonic(2, amplitude, 0.4), Harmonic(4, amplitude / 5, 1.0)))
    return Drive(ratio, Rotor(1.14e-5), LinearSpring(1e4), kinematic_error=error)


def test_a_kinematic_error_that_would_run_backwards_is_refused():
    arm = robot("xia2019", "numpy")
    with pytest.raises(ModelError, match="joint 'joint2': kinematic error is too large"):
        arm.with_drives({"joint2": erring(amplitude=5e-3)})
    with pytest.raises(ModelError, match="joint 'joint1': kinematic_error needs an elastic drive"):
        arm.with_drives({"joint1": Drive(100.0, Rotor(1e-5), kinematic_error=erring().kinematic_error)})
    with pytest.raises(InputError, match="no driven joint is named 'elbow'"):
        arm.with_drives({"elbow": erring()})


LAWS_IN_ARMS = {
    "kinematic error": erring(),
    "catalogue": Drive(100.0, Rotor(1.14e-5), CATALOGUE[20]),
    "harmonic": Drive(101.0, Rotor(1.14e-5), HARMONIC, kinematic_error=erring().kinematic_error),
}


@pytest.mark.parametrize("coupling", ["reduced", "full"])
@pytest.mark.parametrize("name", LAWS_IN_ARMS)
def test_elastic_inverse_then_forward_returns_the_motion(name, coupling):
    drive = replace(LAWS_IN_ARMS[name], rotor=Rotor(1.14e-5, coupling=coupling))
    arm = robot("xia2019", "numpy")
    arm = Robot(arm.mechanism, dict.fromkeys(arm.joints, drive), backend="numpy")
    rng = np.random.default_rng(1)
    rates = rng.normal(size=(4 if coupling == "reduced" else arm.derivatives_needed, 20, 6))
    q = rng.uniform(-3, 3, (20, 6))
    u = arm.elastic_inverse_dynamics(q, *rates)
    back = arm.elastic_forward_dynamics(q, rates[0], u.theta, u.theta_dot, u.motor_torque)
    np.testing.assert_allclose(back.a, rates[1], rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(back.theta_ddot, u.theta_ddot, rtol=1e-9, atol=1e-9 * np.abs(u.theta_ddot).max())


def test_energy_is_conserved_with_kinematic_error():
    """Rate of all energy, springs and rotors included, is zero without friction, motor torque and damping."""
    arm = robot("xia2019", "numpy")
    arm = Robot(arm.mechanism, dict.fromkeys(arm.joints, LAWS_IN_ARMS["harmonic"]), backend="numpy")
    rng = np.random.default_rng(2)
    q, v, omega = rng.normal(size=(3, 10, 6))
    theta = q + arm.static_deflection(q) + rng.normal(size=(10, 6)) * 1e-4
    acc = arm.elastic_forward_dynamics(q, v, theta, omega, np.zeros(6))

    def energy(h: float) -> np.ndarray:
        x, y = q + h * v, theta + h * omega
        links = arm.kinetic_energy(x, v + h * acc.a) + arm.potential_energy(x)
        return links + arm.elastic_energy(x, y, omega + h * acc.theta_ddot)

    h = 1e-7
    rate = (energy(h) - energy(-h)) / (2 * h)
    power = np.abs(arm.drive_torque(theta, q) * omega).sum(axis=-1)
    np.testing.assert_allclose(rate / power, 0, atol=1e-6)


def test_statics_with_kinematic_error_hold_the_links():
    arm = robot("xia2019", "numpy")
    arm = Robot(arm.mechanism, dict.fromkeys(arm.joints, LAWS_IN_ARMS["harmonic"]), backend="numpy")
    q, still = np.random.default_rng(3).uniform(-2, 2, (5, 6)), np.zeros(6)
    u = arm.elastic_inverse_dynamics(q, still, still, still, still)
    np.testing.assert_allclose(u.theta, q + arm.static_deflection(q), atol=1e-14)
    np.testing.assert_allclose(arm.drive_torque(u.theta, q), arm.gravity_forces(q), atol=1e-8)


def test_limits_that_are_no_number_are_refused():
    with pytest.raises(ModelError, match=r"joint 'joint1': limits .* contain nan; use infinity for no limit"):
        robot("xia2019", "numpy").with_drives({"joint1": Drive(limits=Limits(effort=np.nan))})
