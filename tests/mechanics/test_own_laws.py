"""Spring and friction laws of the user's own that are no laws."""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from cutpoint import ModelError, Sliding, TraceError, atan, cos, log, simulate, simulate_many, tan, tanh
from cutpoint.control import PD
from cutpoint.mechanics.drives.backlash import Backlash
from robot_library import robot

Law = Callable[..., Any]


@dataclass(frozen=True)
class Spring:
    """A user's spring, given by its methods."""

    torque: Law = lambda x: 1e4 * x
    deflection: Law = lambda t: t / 1e4
    tangent: Law = lambda x: 1e4
    energy: Law = lambda x: 5e3 * x * x


@dataclass(frozen=True)
class Rubbing(Sliding):
    """A user's friction, given by what becomes of its size."""

    size: float
    law: Callable[..., Any]
    coefficients = ("size",)

    def plateau(self, speed: Any) -> Any:
        return self.law(self.size)


def softening(x: float) -> float:
    return 1e4 * x / (1 + abs(x))


@pytest.mark.parametrize(
    ("spring", "told"),
    [
        (Spring(deflection=lambda t: -t / 1e4), "deflection must be the exact inverse of torque"),
        (
            Spring(torque=softening),
            r"deflection\(0.1\d*\) is 1.0999989e-05, but torque\(1.0999989e-05\) is 0.109\d+: deflection must",
        ),
        (Spring(torque=lambda x: np.nan * x), r"torque\(1e-06\) is nan, which is not a finite number"),
        (Spring(torque=lambda x: -1e4 * x), r"torque\(1e-06\) is -0.01, but must be positive"),
        (Spring(torque=lambda: 1.0), r"torque\(1e-06\) fails: TypeError: .* 0 positional arguments but 1 was given"),  # pyright: ignore[reportArgumentType]
        (Spring(torque=lambda x: None), r"torque\(1e-06\) gives None: it must give a number"),
        (Spring(tangent=lambda x: 2e4), r"tangent\(1.1e-05\) is 20000, but torque rises there by 10000 per unit"),
        (Spring(energy=lambda x: 0.0), r"torque\(1.1e-05\) is 0.11, but energy rises there by 0 per unit"),
        (Spring(deflection=lambda t: np.nan * t), r"deflection\(0.11\) is nan, but torque\(nan\) is nan"),
        (
            Spring(lambda x: 1e4 * x * (1 if x > 0 else 2), lambda t: t / 1e4 / (1 if t > 0 else 2)),
            r"deflection\(0.11\) is 1.1e-05, but deflection\(-0.11\) is -5.5e-06: a spring's law must be odd",
        ),
        (
            Spring(lambda x: 1e4 * x if x > 0 else x * 1e4),
            r"torque of several numbers at once fails, ValueError: The truth .*, so it cannot be compiled: use",
        ),
        (
            Spring(deflection=lambda t: math.copysign(1e-4 * abs(t), t)),
            r"deflection of several numbers at once fails, TypeError: only .*, so it cannot be compiled: use cutpoint",
        ),
        (
            Spring(
                lambda x: np.sinh(1e3 * x),
                lambda t: np.arcsinh(t) / 1e3,
                lambda x: 1e3 * np.cosh(1e3 * x),
                lambda x: np.cosh(1e3 * x) / 1e3,
            ),
            r"torque of numbers with rates fails, TypeError: .* ufuncs .*, so it cannot be compiled: use cutpoint's",
        ),
    ],
)
def test_springs_whose_methods_contradict_each_other_are_refused(spring: Spring, told: str):
    arm = robot("linear")
    for law in (spring, Backlash(spring, 1e-3)):
        with pytest.raises(ModelError, match=f"joint 'joint2': compliance, a Spring: .*{told}"):
            arm.with_drives({"joint2": replace(arm.drives["joint2"], compliance=law)})


@pytest.mark.parametrize(
    "spring",
    [
        Spring(
            lambda x: tan(1e3 * x), lambda t: atan(t) / 1e3,
            lambda x: 1e3 / cos(1e3 * x) ** 2, lambda x: -log(cos(1e3 * x)) / 1e3,
        ),
        Spring(
            lambda x: tanh(1e3 * x), lambda t: (log(1 + t) - log(1 - t)) / 2e3,
            lambda x: 1e3 * (1 - tanh(1e3 * x) ** 2), lambda x: -log(1 - tanh(1e3 * x) ** 2) / 2e3,
        ),
    ],
    ids=["a pole", "a largest torque"],
)  # fmt: skip
def test_springs_may_end_within_their_trial(spring: Spring):
    arm = robot("linear")
    assert arm.with_drives({"joint2": replace(arm.drives["joint2"], compliance=spring)})


@pytest.mark.parametrize(
    ("law", "told"),
    [
        (lambda size: np.nan, r"torque\(0\) is nan, which is not a finite number"),
        (lambda: 1.0, r"torque\(0\) fails: TypeError: .* takes 0 positional arguments but 1 was given"),
        (lambda size: np.full(2, size), r"torque\(0\) gives array\(.*\): it must give a number"),
        (
            lambda size: size**2,
            r"its torque must be linear in its `coefficients`.* is 3.2\d*, but their parts .* 1.6\d*",
        ),
        (lambda size: size + 1, "its torque must be linear in its `coefficients`, and zero where they are"),
    ],
)
def test_friction_must_be_a_number_and_linear_as_it_says(law: Callable[..., Any], told: str):
    arm = robot("xia2019")
    for side in ("link_friction", "motor_friction"):
        rubbing = replace(arm.drives["joint2"], **{side: Rubbing(2.0, law)})
        with pytest.raises(ModelError, match=f"joint 'joint2': {side}, a Rubbing: {told}"):
            arm.with_drives({"joint2": rubbing})
    assert arm.with_drives({"joint2": replace(arm.drives["joint2"], link_friction=Rubbing(2.0, lambda size: size))})


class Rough(Rubbing):
    """A user's friction that grows at 1 rad/s."""

    def plateau(self, speed: Any) -> Any:
        return self.size if speed < 1.0 else 2.0 * self.size


class Unloaded(Rubbing):
    """A user's friction that knows nothing of loads."""

    def torque(self, speed: Any) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        return self.size * speed


def no_law(size: Any) -> Any:
    return size


@pytest.mark.parametrize("side", ["link_friction", "motor_friction"])
@pytest.mark.parametrize(
    ("rubbing", "told"),
    [
        (Rough(2.0, no_law), "a Rough: torque of several numbers at once fails, ValueError: .*cannot be compiled"),
        (Unloaded(2.0, no_law), r"an? Unloaded: torque\(0, 0\) fails: TypeError: .* 2 positional arguments but 3"),
    ],
)
def test_friction_takes_loads_and_many_speeds(side: str, rubbing: Rubbing, told: str):
    arm = robot("xia2019")
    with pytest.raises(ModelError, match=f"joint 'joint2': {side}, {told}"):
        arm.with_drives({"joint2": replace(arm.drives["joint2"], **{side: rubbing})})


@pytest.mark.parametrize("go", [simulate, lambda arm, law, **options: simulate_many(arm, [law], **options)])
def test_the_controller_is_not_blamed_for_a_spring_that_cannot_be_compiled(go: Callable[..., object]):
    arm = robot("linear")
    comparing = Spring(lambda x: 1e4 * x + 0.0 * (x == 1.0))
    arm = arm.with_drives({"joint2": replace(arm.drives["joint2"], compliance=comparing)})
    n = len(arm.joints)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(TraceError, match=r"so == and != have no meaning.*test_own_laws"):
            go(arm, PD(np.ones(n), np.ones(n)), duration=0.01)
