"""Promises of adaptive VDC: an arm with a wrong model adapts, with realistic encoders."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from cutpoint import Robot, Sensors, simulate
from cutpoint.control import VDC, AdaptiveVDC, tune
from robot_library import Array, frictionless, robot

CYCLE, CYCLES = 5.0, 5
TURN = 2 * np.pi

ENCODERS = Sensors(link_resolution=TURN / 2**20, motor_resolution=TURN / 2**14 / 100, link_noise=2e-6, motor_noise=2e-6)


class Exciting:
    """Three harmonics in every joint."""

    size, duration = 6, CYCLE * CYCLES

    def derivatives(self, times: Array, order: int) -> Array:
        sines, cosines = np.random.default_rng(3).uniform(-0.25, 0.25, (2, 3, 6))
        found = np.zeros((order + 1, len(times), 6))
        for h in range(1, 4):
            wave = (cosines[h - 1] - 1j * sines[h - 1]) * np.exp(1j * h * TURN / CYCLE * times)[:, None]
            found += [((1j * h * TURN / CYCLE) ** k * wave).real for k in range(order + 1)]
        return found


def wrong(arm: Robot) -> Robot:
    """The arm as somebody believes it to be: masses a fifth too large, friction half of what it is."""

    def less(law: Any) -> Any:
        return law and replace(law, coulomb=law.coulomb / 2, static=law.static / 2, viscous=law.viscous / 2)

    bodies = tuple(replace(b, mass=1.2 * b.mass, inertia=1.2 * b.inertia) for b in arm.mechanism.bodies)
    drives = {name: replace(d, link_friction=less(d.link_friction)) for name, d in arm.drives.items()}
    return Robot(replace(arm.mechanism, bodies=bodies), drives)


def plant(rubs: bool) -> Robot:
    return robot("xia2019") if rubs else frictionless(robot("xia2019"))


@cache
def last_cycle(rubs: bool, learns: str | None = None, believed: bool = True) -> float:
    """RMS position error of all joints in the last cycle, rad."""
    arm = plant(rubs)
    true = tune(arm, 4.0, VDC, derivatives="filter")
    gains = (true.position_gain, true.speed_gain, true.motor_gain, true.spring_gain)
    model = wrong(arm) if believed else arm
    law = VDC(model, *gains, derivatives="filter")
    if learns is not None:
        rate = {"projection": 100.0, "natural": 10.0}[learns]
        law = AdaptiveVDC(model, *gains, update=learns, body_rate=rate, joint_rate=100.0)
    log = simulate(arm, law, Exciting(), sensors=ENCODERS)
    return float(np.sqrt(np.mean(log.between(Exciting.duration - CYCLE, Exciting.duration)["position_error"] ** 2)))


@pytest.mark.parametrize("update", ["projection", "natural"])
@pytest.mark.parametrize("rubs", [True, False])
def test_a_wrong_model_learns_to_track_nearly_as_a_true_one_does(rubs, update):
    learnt, unlearnt, true = last_cycle(rubs, update), last_cycle(rubs), last_cycle(rubs, believed=False)
    told = f"learnt {learnt:.3g} rad, unlearnt {unlearnt:.3g}, with true numbers {true:.3g}"
    assert learnt <= unlearnt / 3, told
    assert learnt <= 3 * true, told
