"""Every law against its own few lines of NumPy and Pinocchio, sample after sample."""

from typing import Any

import numpy as np
import numpy_laws
import pytest
from numpy_plant import Plant

from cutpoint import Drive, Rotor
from cutpoint.control import (
    PD,
    PID,
    VDC,
    ComputedTorque,
    DisturbanceObserver,
    ElasticComputedTorque,
    Feedforward,
    FullStateFeedback,
    Measurement,
    Reference,
    Robust,
    SlotineLi,
    SpeedFilter,
    SuperTwisting,
    tune,
)
from cutpoint.control.laws.model_law import without_springs
from robot_library import Array, assert_close, robot

PERIOD = 1e-3
SAMPLES = 6


def samples(n: int, stiff: bool = False) -> list[tuple[Measurement, Reference]]:
    """At rest at zero; tiny; ordinary; motors near their links where springs shall not be torn (`stiff`)."""
    rng, found = np.random.default_rng(7), []
    for k, scale in enumerate([0.0, 1e-9, 1.0, 1.0, 1.0, 2.0]):
        q, v, e, w = rng.normal(size=(4, n)) * scale
        theta = q + 1e-3 * np.clip(e, -1, 1) if stiff else q + 0.1 * e
        m = Measurement(PERIOD * k, PERIOD, q, v, theta, v + 0.1 * w)
        found.append((m, Reference(*(q + 0.05 * scale * rng.normal(size=n), *rng.normal(size=(4, n)) * scale, q, v))))
    return found


def agree(law: Any, oracle: Any, plant: Plant, tolerance: float = 1e-11, stiff: bool = False) -> None:
    """The same torque in every sample, each side with its own memory of those before."""
    memory, own = law.start(), None
    for m, r in samples(len(plant.drives), stiff):
        memory, command = law.step(memory, m, r)
        own, torque, *reference = oracle(law, plant, own, m, r)
        assert_close(command.torque, torque, tolerance, scale=10.0)
        for ours, theirs in zip(command[2:4], reference, strict=False):
            assert_close(ours, theirs, tolerance, scale=1.0)


def spread(n: int, low: float, high: float) -> Array:
    return np.linspace(low, high, n)


def rigid_laws(ours: Any, side: str) -> dict[Any, Any]:
    n = len(ours.drives)
    gain, K = spread(n, 5.0, 20.0), spread(n, 2.0, 30.0)
    return {
        numpy_laws.computed_torque: ComputedTorque(ours, gain**2, 2 * gain, side=side),
        numpy_laws.robust: Robust(ours, gain, K, spread(n, 1.0, 3.0), 0.1, side=side),
        numpy_laws.super_twisting: SuperTwisting(ours, gain, K, spread(n, 1.0, 3.0), 40.0, side=side),
        numpy_laws.slotine_li: SlotineLi(ours, gain, K, 0.3, side=side),
        numpy_laws.disturbance_observer: DisturbanceObserver(ours, PD(K, gain), spread(n, 3.0, 9.0), side=side),
    }


@pytest.mark.parametrize("side", ["motor", "link"])
@pytest.mark.parametrize("name", ["xia2019", "mixed"])
@pytest.mark.parametrize("which", range(5))
def test_a_law_for_rigid_robots_is_its_equation_on_the_stiffened_robot(name, side, which):
    ours = robot(name)
    oracle, law = [*rigid_laws(ours, side).items()][which]
    agree(law, oracle, Plant(ours, rigid=True))


@pytest.mark.parametrize("side", ["motor", "link"])
def test_pd_and_pid_are_their_equations_and_the_integral_waits_at_the_limit(side):
    plant, K = Plant(robot("xia2019")), spread(6, 100.0, 600.0)
    agree(PD(K, K / 20, side=side), numpy_laws.pd, plant, 1e-14)
    for limit in (1.0, 1e4):
        agree(PID(K, 1e3 * K, K / 20, np.full(6, limit), side=side), numpy_laws.pid, plant, 1e-13)


def vdc_of(ours: Any, **options: Any) -> VDC:
    n = len(ours.drives)
    return VDC(ours, spread(n, 4.0, 9.0), spread(n, 30.0, 5.0), spread(n, 8.0, 3.0), spread(n, 20.0, 60.0), **options)


def body_gains(n: int) -> Array:
    """(n, 6, 6), symmetric and positive definite, another one for each body."""
    A = np.random.default_rng(4).normal(size=(n, 6, 6))
    return 0.1 * (A @ A.swapaxes(1, 2) + np.eye(6))


@pytest.mark.parametrize("pulled", [False, True])
@pytest.mark.parametrize(
    ("name", "derivatives"),
    [("rigid", "model"), ("linear", "model"), ("xia2019", "model"), ("linear", "filter"), ("mixed", "filter")],
)
def test_vdc_is_its_equations(name, derivatives, pulled):
    ours = robot(name)
    gain = body_gains(len(ours.mechanism.bodies)) if pulled else None
    # two derivatives of the required torque: 1e-16 * 17^2 / reach^2 of it, through the rotor's inertia over stiffness
    agree(vdc_of(ours, derivatives=derivatives, body_gain=gain), numpy_laws.vdc, Plant(ours), 1e-10, stiff=True)


@pytest.mark.parametrize("name", ["linear", "xia2019"])
def test_elastic_computed_torque_gives_the_links_the_snap_it_wants(name):
    ours = robot(name)
    law = ElasticComputedTorque(ours, spread(6, 10.0, 30.0))
    agree(law, numpy_laws.elastic_computed_torque, Plant(ours), 1e-10, stiff=True)


@pytest.mark.parametrize("name", ["xia2019", "damped"])
def test_full_state_feedback_is_its_equation(name):
    law = FullStateFeedback(robot(name), spread(6, 900.0, 100.0), 9.0, spread(6, 0.2, 1.0), 5e-4)
    agree(law, numpy_laws.full_state_feedback, Plant(robot(name)), 1e-10, stiff=True)


def test_full_state_feedback_is_pd_where_drives_do_not_bend():
    arm = robot("xia2019").with_drives({name: Drive(101.0, Rotor(2e-5)) for name in ("joint2", "joint5")})
    rigid, kp, kd = [1, 4], spread(6, 900.0, 100.0), spread(6, 9.0, 2.0)
    full, plain = FullStateFeedback(arm, kp, kd, 0.4), PD(kp, kd) + Feedforward(arm)
    memories = full.start(), plain.start()
    for m, r in samples(6):
        (first, ours), (second, theirs) = full.step(memories[0], m, r), plain.step(memories[1], m, r)
        memories = first, second
        assert_close(ours.torque[rigid], theirs.torque[rigid], 1e-12, scale=1.0)
    tuned = tune(without_springs(robot("xia2019")), 5.0, FullStateFeedback)
    assert_close(tuned.kp, tune(without_springs(robot("xia2019")), 5.0, PD).kp, 1e-12)


def test_a_speed_filter_tells_its_law_how_filtered_positions_change_in_a_period():
    law = SpeedFilter(PD(spread(6, 1.0, 2.0), spread(6, 3.0, 4.0)), 90.0)
    memory, filters = law.start(), numpy_laws.Filter(2 * np.pi * 90.0)
    for m, r in samples(6):
        memory, command = law.step(memory, m, r)
        filters.step(np.concatenate([m.q, m.theta]), PERIOD)
        speeds = (filters.state[0] - filters.before[0]) / PERIOD
        told = m._replace(v=speeds[:6], theta_dot=speeds[6:])
        assert_close(command.torque, numpy_laws.pd(law.law, None, None, told, r)[1], 1e-12, scale=1.0)
