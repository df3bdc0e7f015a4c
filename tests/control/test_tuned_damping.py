"""What `tune` promises of damping: of PID and full state feedback, of laws that learn, on any machine."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from law_library import elbow

from cutpoint import Harmonic, KinematicError, Robot, simulate
from cutpoint.control import (
    PD,
    PID,
    VDC,
    AdaptiveVDC,
    FullStateFeedback,
    Measurement,
    Reference,
    Robust,
    SlotineLi,
    slowest_pole,
    tune,
)
from cutpoint.control.stability.sampled_loop import sampled_loop
from cutpoint.model import Body, Limits
from cutpoint.trajectories import cycloid
from robot_library import Array

PERIOD, BANDWIDTH = 1e-3, 3.0
UPRIGHT, LEANING = np.zeros(2), np.array([0.8, -0.5])
LEARNING = [(SlotineLi, {}), (AdaptiveVDC, {}), (AdaptiveVDC, {"update": "natural"})]


def inertia(robot: Robot) -> tuple[Array, Array]:
    """Of links and of rotors at each joint, upright."""
    rotors = np.array([drive.reflected_inertia for drive in robot.drives.values()], float)
    return np.diag(robot.mass_matrix(UPRIGHT)), rotors


@pytest.mark.parametrize("damping", [0.3, 0.7, 1.0, 1.5, 3.0])
def test_a_joint_under_pid_has_the_damping_that_was_asked_and_the_stiffness_of_pd(damping: float):
    law, whole = tune(elbow(), BANDWIDTH, PID, damping=damping), sum(inertia(elbow()))
    np.testing.assert_allclose(law.kp, tune(elbow(), BANDWIDTH, PD).kp)
    u = 2.0 * np.pi * BANDWIDTH / np.sqrt(1.0 + damping / 2.0)
    expected = np.polymul([1.0, 2.0 * damping * u, u**2], [1.0, u / 4.0])
    for k in range(2):
        np.testing.assert_allclose(np.array([whole[k], law.kd[k], law.kp[k], law.ki[k]]) / whole[k], expected)


@pytest.mark.parametrize("shaping", [0.3, 0.5, 1.0])
def test_full_state_feedback_damps_the_inertia_that_it_leaves(shaping: float):
    law, (links, rotors) = tune(elbow(), BANDWIDTH, FullStateFeedback, damping=0.7, shaping=shaping), inertia(elbow())
    left = links + shaping * rotors
    np.testing.assert_allclose(law.kd / (2.0 * np.sqrt(law.kp * left)), 0.7)


def heavy(times: float) -> Robot:
    """Links so many times as heavy, with rotors and springs for them."""
    arm = elbow()

    def grown(body: Body) -> Body:
        return replace(body, mass=times * body.mass, inertia=times * body.inertia)

    mechanism = replace(arm.mechanism, bodies=tuple(map(grown, arm.mechanism.bodies)))
    drives = {
        name: replace(
            drive,
            rotor=replace(drive.rotor, inertia=times * drive.rotor.inertia),
            compliance=replace(drive.compliance, stiffness=times * drive.compliance.stiffness),
            damping=times * 5.0,
        )
        for name, drive in arm.drives.items()
    }
    return Robot(mechanism, drives)


def least_damping(robot: Robot, law: Any, q: Array) -> float:
    """Of poles that swing at less than five times the bandwidth."""
    poles = np.linalg.eigvals(sampled_loop("test", robot, law, q, PERIOD, None).closed)
    s = np.log(poles[np.abs(poles) > 0.5].astype(complex)) / PERIOD
    s = s[(np.abs(s) > 1e-3) & (np.abs(s) < 5.0 * 2.0 * np.pi * BANDWIDTH)]
    return float((-s.real / np.abs(s)).min())


@pytest.mark.parametrize("times", [0.01, 1.0, 100.0])
@pytest.mark.parametrize(("kind", "options"), LEARNING)
def test_what_a_tuned_law_learns_leaves_the_loop_its_damping(kind: Any, options: dict[str, str], times: float):
    arm, none = heavy(times), {"rate": 0.0} if kind is SlotineLi else {"body_rate": 0.0, "joint_rate": 0.0}
    law = tune(arm, BANDWIDTH, kind, q=LEANING, **options)
    still = tune(arm, BANDWIDTH, kind, q=LEANING, **options, **none)
    assert least_damping(arm, law, LEANING) > min(0.45, 0.9 * least_damping(arm, still, LEANING))
    # and it does learn: shares of the bodies' sizes change within some periods of the bandwidth
    move = cycloid(LEANING, 4.0 / BANDWIDTH)
    wrong = arm.with_payload(times, [0.0, 0.0, 0.2], 1e-3 * times * np.eye(3), "elbow_link")
    errors = [simulate(wrong, each, move, duration=5.0)["position_error"][-500:] for each in (law, still)]
    assert np.abs(errors[0]).max() < 0.5 * np.abs(errors[1]).max()


@pytest.mark.parametrize("bandwidth", [0.5, 2.0])
@pytest.mark.parametrize("options", [{}, {"update": "natural"}])
def test_rates_that_are_found_where_gravity_asks_nothing_hold_where_it_asks_most(options: Any, bandwidth: float):
    level = np.array([np.pi / 2, 0.0])
    laws = [tune(elbow(), bandwidth, AdaptiveVDC, q=q, **options) for q in (UPRIGHT, level)]
    for name in ("body_rate", "joint_rate"):
        upright, horizontal = (getattr(law, name)[0] for law in laws)
        assert upright == pytest.approx(horizontal, rel=1.0)
    assert slowest_pole(elbow(), laws[0], level, PERIOD).size < 1.0 + 1e-9


@pytest.mark.parametrize(("kind", "options"), LEARNING)
def test_nothing_is_learnt_while_a_motor_is_asked_for_more_than_it_has(kind: Any, options: dict[str, str]):
    drive = elbow().drives["shoulder"]
    weak = elbow().with_drives({"shoulder": replace(drive, limits=Limits(effort=12.0))})
    law = tune(weak, BANDWIDTH, kind, **options)
    np.testing.assert_array_equal(law.torque_limit, [12.0, 1e9])
    strong = replace(law, torque_limit=500.0)
    at = np.zeros(2)
    measured, wanted = Measurement(0.0, PERIOD, at, at, at, at), Reference(*[np.full(2, 0.3)] * 7)
    for each, learns in ((law, False), (strong, True)):
        memory, command = each.step(each.start(), measured, wanted)
        assert 12.0 < abs(command.torque[0]) < 500.0
        before, after = (x if kind is SlotineLi else [x.bodies, x.joints] for x in (each.start(), memory))
        changed = str(np.array(before, object).tolist()) != str(np.array(after, object).tolist())
        assert changed == learns


@pytest.mark.parametrize("kind", [PD, VDC, FullStateFeedback])
def test_the_slowest_pole_does_not_depend_on_where_in_a_wave_of_kinematic_error_a_joint_stands(kind: Any):
    error = KinematicError((Harmonic(2, 1e-4),))
    wavy = elbow().with_drives({name: replace(d, kinematic_error=error) for name, d in elbow().drives.items()})
    expected = slowest_pole(elbow(), tune(elbow(), 1.0, kind, q=LEANING), LEANING, PERIOD)
    for shift in np.linspace(0.0, np.pi / 100.0, 5):
        found = slowest_pole(wavy, tune(wavy, 1.0, kind, q=LEANING), LEANING + shift, PERIOD)
        assert found.size == pytest.approx(expected.size, abs=2e-4)


def test_the_bounded_term_of_a_tuned_robust_law_is_no_stiffer_than_its_speed_gain():
    for times in (0.01, 1.0):
        law = tune(heavy(times), BANDWIDTH, Robust, bound=50.0)
        assert (law.bound / law.width <= law.speed_gain * (1.0 + 1e-12)).all()
