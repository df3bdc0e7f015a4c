"""Laws that cannot run are refused before they run, with the reason."""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, Log, Sensors, simulate
from cutpoint.control import PD, Command, Guard, Law, SpeedFilter
from cutpoint.simulation import UntracedControllerWarning
from cutpoint.trajectories import cycloid
from robot_library import frictionless, robot

MOVE = cycloid(np.array([0.3, 0.9, -0.6, 0.4, 0.8, -0.5]), 0.5)


@dataclass
class Small:
    """Nothing, for a number of drives."""

    size: int = 6

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        return memory, 0.0


class Leading(Law):
    """A motor reference without its speed, ahead of the links'."""

    def step(self, memory: Any, m: Any, r: Any) -> Any:
        return memory, Command(0.0, theta=r.q + 0.1)


class Announced(Leading):
    makes_motor_reference = True


def run(law: Any, **options: Any) -> Log:
    return simulate(frictionless(robot("xia2019")), law, MOVE, duration=0.01, **options)


@pytest.mark.parametrize("within", [lambda law: law, lambda law: Guard(robot("xia2019"), law)])
def test_a_law_of_ones_own_that_reads_what_is_not_there_is_refused(within):
    def of_links(memory: Any, m: Any, r: Any) -> Any:
        return memory, 300.0 * (r.q - m.q)

    law = within(type("OfLinks", (), {"step": staticmethod(of_links)})())
    with pytest.raises(InputError, match="OfLinks reads q, but sensors are on the motor side only"):
        run(law, sensors=Sensors(sides="motor"))
    run(law, sensors=Sensors(sides="link"))


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (PD, r"controller PD is a class; pass an instance, PD\(...\)"),
        (lambda m, r: m.q, r"lambda>: step must take \(memory, measurement, reference\), but takes \(m, r\)"),
        (7, r"controller 7 has no step\(memory, measurement, reference\)"),
    ],
)
def test_what_is_no_law_is_refused(law, message):
    with pytest.raises(InputError, match=message):
        run(law)
    with pytest.raises(InputError, match=message):
        PD([1.0] * 6, [1.0] * 6) + law


def test_a_law_within_others_is_for_as_many_drives():
    inner = PD([1.0] * 6, [1.0] * 6) + PD([1.0], [1.0])
    for law in (SpeedFilter(inner), Guard(robot("xia2019"), Small()) + SpeedFilter(inner)):
        with pytest.raises(InputError, match="PD is for 1 drive, but the robot has 6: make it for as many"):
            run(law)
    with pytest.raises(InputError, match="Small is for 2 drives, but the robot has 6"):
        run(SpeedFilter(PD([1.0] * 6, [1.0] * 6) + Small(2)))


def test_a_motor_reference_in_a_sum_is_announced_and_may_lack_its_speed():
    """The others track it; that of a law that does not say so they would track or not, by their order."""
    track = PD([100.0] * 6, [1.0] * 6, side="motor")
    for law in (Leading() + track, track + Leading()):
        with pytest.raises(InputError, match="Leading: in a sum, a law that commands theta must set makes_motor_ref"):
            run(law)
    announced = [run(law) for law in (Announced() + track, track + Announced())]
    np.testing.assert_array_equal(announced[0]["command_torque"], announced[1]["command_torque"])
    np.testing.assert_array_equal(announced[0]["motor_reference"], announced[0]["reference_q"] + 0.1)
    np.testing.assert_array_equal(announced[0]["motor_speed_reference"], announced[0]["reference_v"])


def test_a_step_that_asks_for_what_is_not_measured_is_told_what_is():
    with warnings.catch_warnings(), pytest.raises(AttributeError) as caught:
        warnings.simplefilter("ignore", UntracedControllerWarning)
        run(lambda memory, m, r: (memory, m.position))
    assert caught.value.__notes__[:1] == ["a Measurement has time, period, q, v, theta, theta_dot"]


def test_a_step_that_finds_no_memory_is_told_that_there_is_no_start():
    def counting(memory: Any, m: Any, r: Any) -> Any:
        return memory["n"] + 1, 0.0

    with warnings.catch_warnings(), pytest.raises(TypeError, match=r"counting has no start\(\), so .* whose start\(\)"):
        warnings.simplefilter("ignore", UntracedControllerWarning)
        run(counting)
