"""Logs of some channels: what is wanted is what the whole log has, to the last bit."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, Log, MaxwellSlip, Robot, Sensors, SimulationError, State, simulate
from cutpoint.control import PD
from cutpoint.model.build import build
from cutpoint.model.mechanism import Joint, JointKind, Link
from cutpoint.simulation import simulate_many
from cutpoint.trajectories import cycloid
from robot_library import robot

SOFT = PD([200.0] * 6, [20.0] * 6)
MOVE = cycloid(np.full(6, 0.4), 0.2)


def remembering() -> Robot:
    """Springs with hysteresis: their strains are recorded, and told as torques."""
    ours, loops = robot("linear"), MaxwellSlip((800.0,), (1e-5,))
    return ours.with_drives({name: replace(drive, hysteresis=loops) for name, drive in ours.drives.items()})


def run(kind: str, **options: Any) -> Log:
    if kind == "mixed_floating":
        moving = State(v=0.1 * np.cos(np.arange(robot(kind).nv)))
        return simulate(robot(kind), None, duration=5e-3, initial=moving, **options)
    return simulate(remembering(), SOFT, MOVE, duration=5e-3, sensors=Sensors(motor_noise=1e-5), **options)


@pytest.mark.parametrize("kind", ["remembering", "mixed_floating"])
def test_wanted_channels_are_those_of_the_whole_log(kind):
    """Every fourth, so that what some follow from is recorded but not wanted."""
    whole = run(kind)
    for first in range(4):
        wanted = [*whole.channels][first::4]
        some = run(kind, channels=wanted)
        assert [*some.channels] == wanted
        assert all(np.array_equal(some[name], whole[name]) for name in wanted)
        assert all(some.units[name] == whole.units[name] for name in wanted)


@pytest.mark.parametrize("channels", [(), ("friction_torque", "position_error"), ("reference_v",)])
def test_runs_side_by_side_keep_what_is_wanted_too(channels):
    sensors = [Sensors(motor_noise=1e-5, seed=k) for k in range(3)]
    common: dict[str, Any] = {"duration": 0.01, "substeps": 4}
    runs = simulate_many(robot("xia2019"), SOFT, MOVE, sensors=sensors, channels=channels, **common)
    for log, own in zip(runs, sensors, strict=True):
        whole = simulate(robot("xia2019"), SOFT, MOVE, sensors=own, **common)
        assert {*log.channels} == {*channels}
        assert all(np.array_equal(log[name], whole[name]) for name in channels)


def test_a_run_that_is_lost_among_many_tells_all_that_it_was():
    laws = [SOFT, PD([1e6] * 6, [1e5] * 6)]
    runs = simulate_many(robot("linear"), laws, MOVE, channels=["q"], substeps=4)
    with pytest.raises(SimulationError) as alone:
        simulate(robot("linear"), laws[1], MOVE, substeps=4)
    assert str(runs.errors[1]) == str(alone.value)
    assert np.array_equal(runs.errors[1].log["joint_torque"], alone.value.log["joint_torque"])
    assert [*runs[0].channels] == ["q"]


def test_a_run_that_is_lost_alone_says_so_without_its_state():
    with pytest.raises(SimulationError, match=r"diverged at t = \S+ s: ") as caught:
        simulate(robot("linear"), PD([1e6] * 6, [1e5] * 6), MOVE, substeps=4, channels=["joint_torque"])
    assert [*caught.value.log.channels] == ["joint_torque"]


def test_a_channel_that_no_log_has_is_refused_with_those_that_come_near():
    with pytest.raises(InputError, match=r"no channel is named 'torque'; did you mean .*'joint_torque'"):
        run("remembering", channels=["torque"])


@pytest.mark.parametrize("absent", ["base_x", "fault", "link_strain", "nothing"])
def test_a_channel_that_the_run_does_not_have_is_refused(absent):
    with pytest.raises(InputError, match=rf"no channel is named '{absent}'; there are: 'q', 'v'"):
        simulate(robot("linear"), SOFT, MOVE, duration=5e-3, channels=["q", absent])


def test_one_name_is_no_collection_of_names():
    with pytest.raises(InputError, match=r"channels='theta' must be a collection of names: channels=\['theta'\]"):
        simulate(robot("linear"), SOFT, MOVE, duration=5e-3, channels="theta")


@pytest.mark.parametrize("kinds", [("revolute", "spherical"), ("planar", "revolute"), ("revolute", "floating")])
def test_joints_without_a_drive_have_no_channels_but_a_floating_one_has_the_bases(kinds: tuple[JointKind, JointKind]):
    place = np.eye(4)
    place[2, 3] = 0.3
    piece = {"mass": 1.0, "com": np.array([0.0, 0.0, 0.1]), "inertia": 0.02 * np.eye(3)}
    links = [Link("world"), Link("first", **piece), Link("second", **piece)]
    across = np.array([0.0, 1.0, 0.0])
    names = ("world", "first", "second")
    joints = [Joint(names[k + 1], kind, names[k], names[k + 1], place, across) for k, kind in enumerate(kinds)]
    free = Robot(build("free", links, joints))
    log = simulate(free, None, duration=0.02)
    assert log["q"].shape == (21, 1)
    assert ("base_z" in log.channels) == ("floating" in kinds)
    if "floating" in kinds:  # nothing but its own weight moves it
        assert log["base_z"][-1] == pytest.approx(-9.81 * 0.02**2 / 2, rel=1e-6)
