"""Spring and friction laws, alone."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from cutpoint import Coulomb, Flexspline, LinearSpring, ModelError, Sliding, Stribeck
from cutpoint.mechanics.drives.compliance import POLE_GUARD
from cutpoint.scalars import Scalar
from robot_library import assert_close, derivative, robot

SPRINGS = [LinearSpring(8e3), Flexspline(16e3, 0.0464), Flexspline(4.7e3, 0.119), Flexspline(100.0, 1e-6)]
FRICTIONS = [
    Stribeck(coulomb=0.49, static=3.5, viscous=0.15, stribeck_velocity=0.19, smoothing=0.02),
    Stribeck(coulomb=0.0, static=0.0, viscous=0.1, stribeck_velocity=0.03, smoothing=1e-3),
    Coulomb(coulomb=0.3, viscous=0.1, smoothing=0.1),
]

springs, frictions = (
    pytest.mark.parametrize("law", SPRINGS, ids=repr),
    pytest.mark.parametrize("law", FRICTIONS, ids=repr),
)
EPS = np.finfo(float).eps
SHARES = st.floats(-3.0, 3.0, allow_subnormal=False)
"""Of the deflection at which law (2) is continued by its tangent; beyond 1 in a third of all draws."""


def reach(law: LinearSpring | Flexspline) -> float:
    return POLE_GUARD / (law.hardening * law.stiffness) if isinstance(law, Flexspline) else 0.01


@springs
@given(share=SHARES)
def test_deflection_and_torque_undo_each_other(law, share):
    bend = share * reach(law)
    assert law.deflection(law.torque(bend)) == pytest.approx(bend, rel=1e-12)
    assert law.torque(law.deflection(law.torque(bend))) == pytest.approx(law.torque(bend), rel=1e-12)


@springs
@given(share=SHARES)
def test_springs_are_odd(law, share):
    bend = share * reach(law)
    assert law.torque(-bend) == -law.torque(bend)
    assert law.deflection(-law.torque(bend)) == -law.deflection(law.torque(bend))
    assert law.energy(-bend) == law.energy(bend) >= 0.0


@pytest.mark.parametrize("law", SPRINGS, ids=repr)
@pytest.mark.parametrize("share", [1e-150, 1e-12, 1e-8, 3e-6, 1e-5])
def test_energy_of_a_small_deflection_keeps_its_digits(law, share):
    """That of a linear spring: what hardens it adds less than share^2."""
    bend = share * reach(law)
    assert law.energy(bend) == pytest.approx(law.stiffness * bend * bend / 2, rel=1e-15 + share**2, abs=0.0)


@springs
@given(low=SHARES, high=SHARES)
def test_more_deflection_is_more_torque(law, low, high):
    low, high = sorted((low, high))
    assume(high - low > 1e-9)
    assert law.torque(high * reach(law)) > law.torque(low * reach(law))


@springs
@pytest.mark.parametrize("share", [0.0, 1e-6, -0.3, 0.7, 0.95, 1.2, -2.5])
def test_tangent_and_torque_are_derivatives_of_torque_and_energy(law, share):
    bend, step = share * reach(law), 1e-3 * reach(law)
    peak = law.torque(max(abs(bend), 0.1 * reach(law)))
    assert_close(derivative(lambda h: law.torque(bend + h), step), law.tangent(bend), 1e-9)
    assert_close(derivative(lambda h: law.energy(bend + h), step), law.torque(bend), 1e-9, scale=peak)


@pytest.mark.parametrize("law", SPRINGS[1:], ids=repr)
def test_flexspline_starts_at_its_rest_stiffness_and_is_smooth_where_it_is_continued(law):
    assert law.tangent(0.0) == law.stiffness
    at = reach(law)
    assert_close(law.torque(at * (1 + 1e-9)), law.torque(at * (1 - 1e-9)), 1e-6)
    assert_close(law.tangent(at * (1 + 1e-9)), law.tangent(at * (1 - 1e-9)), 1e-6)
    assert np.isfinite(law.torque(1e3 * at))
    assert law.tangent(10 * at) == law.tangent(2 * at)


@frictions
@given(speed=st.floats(-1e3, 1e3))
def test_friction_never_gives_power(law, speed):
    assert law.torque(speed) * speed >= 0.0
    assert law.torque(-speed) == -law.torque(speed)


@frictions
@given(wanted=st.floats(-2.0, 2.0), speed=st.floats(-2.0, 2.0), load=st.floats(-50.0, 50.0))
def test_what_a_law_compensates_never_drives_its_speed_error(law, wanted, speed, load):
    law = replace(law, asymmetry=0.3, per_load=0.1)
    excess = law.required_torque(wanted, speed, load) - law.torque(speed, load)
    assert (wanted - speed) * excess >= -1e-12
    assert law.required_torque(speed, speed, load) == law.torque(speed, load)


@frictions
@pytest.mark.parametrize(("speed", "share"), [(2.0, 0.1 * 1.3), (-2.0, -0.1 * 0.7)], ids=["forwards", "backwards"])
@given(load=st.floats(-50.0, 50.0, allow_subnormal=False))
def test_friction_grows_by_its_share_of_the_load_larger_forwards_and_smaller_backwards(law, speed, share, load):
    """At 2 rad/s all of them slide: 1 - tanh(20) is below 1e-17."""
    law = replace(law, asymmetry=0.3, per_load=0.1)
    assert law.share_of_load(speed) == pytest.approx(share, rel=4 * EPS)
    without = law.torque(speed, 0.0)
    rounding = 4 * EPS * (abs(without) + abs(share * load))
    assert law.torque(speed, load) - without == pytest.approx(share * abs(load), rel=0.0, abs=rounding)


@frictions
def test_friction_slides_at_its_coulomb_and_viscous_part(law):
    assert law.torque(50.0) == pytest.approx(law.coulomb + law.viscous * 50.0, rel=1e-12)


def test_stribeck_friction_falls_from_static_to_coulomb():
    law = FRICTIONS[0]
    assert max(law.torque(x) for x in np.linspace(0.0, 1.0, 200)) > 0.8 * law.static
    assert law.torque(1.0) < 0.2 * law.static


@dataclass(frozen=True)
class Plain(Sliding):
    """A user's law with a size alone."""

    size: float
    coefficients = ("size",)

    def plateau(self, speed: Scalar) -> Scalar:
        return self.size


@dataclass(frozen=True)
class Nameless(Sliding):
    size: float

    def plateau(self, speed: Scalar) -> Scalar:
        return self.size


def test_a_users_law_need_not_state_what_it_does_not_have():
    alike = Coulomb(2.0, 0.0)
    for speed in (-3.0, -1e-3, 0.0, 1e-3, 3.0):
        assert Plain(2.0).torque(speed, 7.0) == alike.torque(speed, 7.0)
        assert Plain(2.0).resistance(speed) == alike.resistance(speed)
        assert Plain(2.0).columns(speed) == [Coulomb(1.0, 0.0).torque(speed)]


class Bare(Sliding):
    coefficients = ("size",)

    def __init__(self, size: float) -> None:
        self.size = size

    def plateau(self, speed: Scalar) -> Scalar:
        return self.size


class Misspelt(Plain):
    coefficients = ("sise",)


class Single(Plain):
    coefficients = "size"  # pyright: ignore[reportAssignmentType]


@pytest.mark.parametrize(
    ("law", "told"),
    [
        (Nameless, "must state `coefficients`, a tuple of the names"),
        (Single, "must state `coefficients`, a tuple of the names"),
        (Misspelt, "states 'sise' in `coefficients`, which must name fields of it: 'size'"),
        (Bare, "states 'size' in `coefficients`, which must name fields of a dataclass, which it is not"),
    ],
)
def test_a_users_law_must_say_in_which_of_its_fields_it_is_linear(law: Any, told: str):
    arm = robot("xia2019")
    rubbing = replace(arm.drives["joint2"], link_friction=law(1.0))
    with pytest.raises(ModelError, match=f"link_friction, a {law.__name__}, {told}"):
        arm.with_drives({"joint2": rubbing})


@dataclass(frozen=True)
class Cubic:
    """A user's spring, written as one would: with powers and magnitudes."""

    stiffness: float
    rise: float

    def torque(self, deflection: Scalar) -> Scalar:
        return self.stiffness * deflection + self.rise * deflection**3

    def deflection(self, torque: Scalar) -> Scalar:
        x = torque / self.stiffness
        for _ in range(6):
            x = x - (self.torque(x) - torque) / self.tangent(x)
        return x

    def tangent(self, deflection: Scalar) -> Scalar:
        return self.stiffness + 3 * self.rise * abs(deflection) ** 2

    def energy(self, deflection: Scalar) -> Scalar:
        return self.stiffness * deflection**2 / 2 + self.rise * deflection**4 / 4


def test_a_users_spring_may_use_powers_and_magnitudes():
    arm = robot("linear")
    bent = arm.with_drives({"joint2": replace(arm.drives["joint2"], compliance=Cubic(1e4, 1e8))})
    q, v, a, jerk, snap = np.random.default_rng(5).normal(size=(5, 6))
    needed = bent.elastic_inverse_dynamics(q, v, a, jerk, snap)
    found = bent.elastic_forward_dynamics(q, v, needed.theta, needed.theta_dot, needed.motor_torque)
    np.testing.assert_allclose(found.a, a, rtol=1e-8)
    np.testing.assert_allclose(found.theta_ddot, needed.theta_ddot, rtol=1e-8)
