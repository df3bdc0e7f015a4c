"""Loops are compiled once for all robots that differ in numbers: every law must take those of its own."""

from dataclasses import replace

import numpy as np
import pytest
from law_library import LAWS, elbow

from cutpoint import Robot, Rotor, simulate
from cutpoint.control import AdaptiveVDC, SlotineLi
from cutpoint.simulation import cache
from cutpoint.trajectories import cycloid
from robot_library import Array

MOVE = cycloid([0.4, 0.8], 0.3)
LEARNING = {
    "Slotine-Li that learns": lambda r: SlotineLi(r, 5.0, 10.0, rate=20.0),
    "adaptive VDC that learns": lambda r: AdaptiveVDC(r, 5.0, 10.0, 5.0, 5.0, body_rate=20.0),
}


def with_rotors_of(mass: float) -> Robot:
    """No link's inertia holds them."""
    arm = elbow()
    rotor = Rotor(5e-5, in_link_inertia=False, mass=mass, transverse=1e-4, position=0.05)
    return arm.with_drives({name: replace(drive, rotor=rotor) for name, drive in arm.drives.items()})


def torques(make: object, mass: float) -> Array:
    arm = with_rotors_of(mass)
    return simulate(arm, make(arm), MOVE, duration=0.05)["command_torque"]


@pytest.mark.parametrize("name", [*LAWS, *LEARNING])
def test_a_run_does_not_depend_on_runs_before_it(name, monkeypatch):
    make = {**LAWS, **LEARNING}[name]
    monkeypatch.setattr(cache, "_kept", cache._kept.copy())
    cache._kept.clear()
    alone = torques(make, 3.0)
    cache._kept.clear()
    torques(make, 0.5)
    np.testing.assert_array_equal(torques(make, 3.0), alone)
