"""Adaptive VDC against its own NumPy version; laws against each other where they must be the same."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy_adaptive_vdc
import pytest
from numpy_laws import TURN
from numpy_plant import Plant
from test_laws_against_numpy import agree, body_gains, samples, spread

from cutpoint import Drive, InputError, LinearSpring, Robot, Rotor
from cutpoint.control import VDC, AdaptiveVDC, ElasticComputedTorque, FullStateFeedback, Measurement, Reference
from cutpoint.control.laws.command_filter import FilterState
from robot_library import assert_close, robot


def gains(n: int) -> tuple[np.ndarray, ...]:
    return spread(n, 4.0, 9.0), spread(n, 30.0, 5.0), spread(n, 8.0, 3.0), spread(n, 20.0, 60.0)


@pytest.mark.parametrize("update", ["projection", "natural"])
@pytest.mark.parametrize(("name", "pulled"), [("linear", True), ("xia2019", False), ("mixed", True)])
def test_adaptive_vdc_is_its_equations_while_it_learns(name, pulled, update):
    ours = robot(name)
    gain = body_gains(len(ours.mechanism.bodies)) if pulled else None
    # fast enough that bounds are met and that what is learnt shows in the torque
    law = AdaptiveVDC(ours, *gains(len(ours.drives)), body_gain=gain, update=update, body_rate=0.3, joint_rate=0.3)
    agree(law, numpy_adaptive_vdc.adaptive_vdc, Plant(ours), 1e-10, stiff=True)


def fully_coupled(compliance: LinearSpring | None) -> Robot:
    """The paper's arm whose rotors turn along with the links that carry them."""
    arm = robot("xia2019")
    drive = Drive(100.0, Rotor(1e-4, coupling="full"), compliance)
    return arm.with_drives(dict.fromkeys(arm.joints, drive))


@pytest.mark.parametrize("update", ["projection", "natural"])
@pytest.mark.parametrize("name", ["rigid", "linear", "xia2019", "mixed", "fully coupled"])
def test_without_learning_adaptive_vdc_is_vdc(name, update):
    ours = fully_coupled(None) if name == "fully coupled" else robot(name)
    n = len(ours.drives)
    law = AdaptiveVDC(ours, *gains(n), update=update, body_rate=0.0, joint_rate=0.0)
    plain = VDC(ours, *gains(n), derivatives="filter")
    memory, own = law.start(), plain.start()
    for m, r in samples(n, stiff=True):
        memory, command = law.step(memory, m, r)
        own, expected = plain.step(own, m, r)
        assert_close(command.torque, expected.torque, 1e-12, scale=10.0)


LAWS = {
    "VDC": lambda ours: VDC(ours, *gains(6)),
    "VDC with body gains": lambda ours: VDC(ours, *gains(6), body_gain=2.0),
    "full state feedback": lambda ours: FullStateFeedback(ours, 900.0, 9.0),
    "elastic computed torque": lambda ours: ElasticComputedTorque(ours, 20.0),
}
NAMES = [(robot_, law) for robot_ in ("linear", "xia2019", "damped") for law in LAWS]
NAMES += [("rigid and coupled", law) for law in [*LAWS][:3]] + [("coupled", "full state feedback")]


def on_motion(ours: Robot) -> Iterator[tuple[Measurement, Reference, Any]]:
    """States of random motions, motors included, with what motors must do."""
    for motion in 0.7 * np.random.default_rng(8).normal(size=(4, 5, 6)):
        u = ours.elastic_inverse_dynamics(*motion, quasi_rigid=True)
        yield Measurement(0.0, 1e-3, *motion[:2], u.theta, u.theta_dot), Reference(*motion, *motion[:2]), u


@pytest.mark.parametrize(("name", "law"), NAMES)
def test_on_the_desired_motion_itself_a_law_for_bending_joints_is_the_feedforward(name, law):
    coupled = {"rigid and coupled": None, "coupled": LinearSpring(8e3)}
    ours = fully_coupled(coupled[name]) if name in coupled else robot(name)
    made = LAWS[law](ours)
    for m, r, u in on_motion(ours):
        command = made.step(made.start(), m, r)[1]
        assert_close(command.torque, u.motor_torque, 1e-10, scale=1.0)
        if command.theta is not None:
            assert_close(command.theta, u.theta, 1e-12, scale=1.0)


@pytest.mark.parametrize("adaptive", [False, True])
def test_vdc_bears_what_fully_coupled_rotors_add(adaptive):
    """On the desired motion, with a filter that holds the true derivatives of the required torque."""
    ours, w, K = fully_coupled(LinearSpring(8e3)), TURN * 20.0, 8e3
    made = AdaptiveVDC(ours, *gains(6)) if adaptive else VDC(ours, *gains(6), derivatives="filter")
    for m, r, u in on_motion(ours):
        tau, rate, rate_2 = K * (u.theta - r.q), K * (u.theta_dot - r.v), K * (u.theta_ddot - r.a)
        filters = FilterState([*(tau - (rate_2 + 2 * w * rate) / w**2)], [*rate], 1.0)
        memory = made.start()._replace(filters=filters) if adaptive else filters
        assert_close(made.step(memory, m, r)[1].torque, u.motor_torque, 1e-10, scale=1.0)


@pytest.mark.parametrize("make", [LAWS["VDC"], LAWS["elastic computed torque"]])
def test_a_law_that_takes_links_jerk_from_springs_refuses_fully_coupled_rotors(make):
    with pytest.raises(InputError, match=r"rotor of 'joint1' has full coupling, so links.*; use ") as raised:
        make(fully_coupled(LinearSpring(8e3)))
    assert raised.value.evidence["joint"] == "joint1"
