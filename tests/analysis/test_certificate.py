"""The power-flow certificate: what holds in continuous time, and what a sampled or disturbed run shows."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from cutpoint import Coulomb, InputError, LinearSpring, Log, Robot, Sensors, State, simulate
from cutpoint.control import PD, VDC, tune
from cutpoint.trajectories import cycloid
from robot_library import Array, frictionless, shoulder

MOVE = cycloid(np.radians([60.0, 60.0, -60.0]), 1.0)


@cache
def arm(kind: str) -> Robot:
    bare = frictionless(shoulder())
    if kind == "rigid":
        return bare.with_drives({name: replace(d, compliance=None) for name, d in bare.drives.items()})
    return bare.with_drives({name: replace(d, compliance=LinearSpring(8e3)) for name, d in bare.drives.items()})


@cache
def law(kind: str, body_gain: float | None = None) -> VDC:
    """Tuned, and of rigid drives with a gain of the motor as well, which `tune` leaves at zero."""
    tuned = tune(arm(kind), 4.0, VDC, body_gain=body_gain)
    return replace(tuned, motor_gain=tuned.speed_gain / 2) if kind == "rigid" else tuned


def run(kind: str, controller: Any, **options: Any) -> Log:
    """From a place off the reference."""
    q = np.full(3, 2e-3)
    start = State(q=q, theta=q + arm(kind).static_deflection(q), v=np.zeros(3), theta_dot=np.zeros(3))
    return simulate(arm(kind), controller, MOVE, 0.06, initial=start, **options)


@pytest.mark.parametrize(("kind", "body_gain"), [("elastic", None), ("elastic", 0.3), ("rigid", None), ("rigid", 0.3)])
def test_in_continuous_time_every_subsystem_keeps_its_inequality_as_an_equality(kind, body_gain):
    """Up to the quadrature over samples 0.1 ms apart: of order (h w)^4 of the power, w of the springs' 2 pi 300 Hz."""
    found = run(kind, law(kind, body_gain), control_period=1e-4, hold=False).certificate()
    power = np.abs(found.inflow).max() + np.abs(found.dissipation).max()
    assert power > 1e-3
    assert np.abs(found.slack).max() < (1e-4 * 2 * np.pi * 300) ** 4 * 1e-2 * power
    assert np.abs(found.imbalance).max() < 1e-12 * power
    assert (found.storage >= 0).all()
    assert (found.dissipation >= 0).all()
    assert (np.diff(found.storage.sum(axis=1)) < 0).all()


def slack(**changes: Any) -> float:
    """The largest of an arm whose drives are so, as a share of its power."""
    bent = arm("elastic")
    bent = bent.with_drives({name: replace(drive, **changes) for name, drive in bent.drives.items()})
    q = np.full(3, 2e-3)
    start = State(q=q, theta=q + bent.static_deflection(q), v=np.zeros(3), theta_dot=np.zeros(3))
    law = tune(bent, 4.0, VDC)
    found = simulate(bent, law, MOVE, 0.03, initial=start, control_period=1e-4, hold=False).certificate()
    return np.abs(found.slack).max() / (np.abs(found.inflow).max() + np.abs(found.dissipation).max())


def test_damping_friction_of_links_and_friction_that_grows_with_load_show_and_friction_of_motors_does_not():
    rubs = Coulomb(0.3, 5.0, smoothing=0.1)
    assert slack(motor_friction=rubs) < 1e-6
    for changes in ({"damping": 4.0}, {"link_friction": rubs}, {"motor_friction": replace(rubs, per_load=0.2)}):
        assert slack(**changes) > 1e-3


def test_what_friction_on_both_sides_of_rigid_drives_takes_is_accounted_for():
    """Up to (h w)^4, w twice the 100 1/s of the lightest joint's errors: 8 N m s/rad, and its gains, on 0.12 kg m2."""
    rubs = Coulomb(0.3, 5.0, smoothing=0.1)
    assert slack(compliance=None, link_friction=rubs, motor_friction=rubs) < (1e-4 * 2 * 100) ** 4


def test_finer_samples_bring_the_slack_of_continuous_control_to_zero():
    coarse, fine = (
        np.abs(run("elastic", law("elastic"), control_period=h, hold=False).certificate().slack[20:]).max()
        for h in (4e-4, 2e-4)
    )
    assert fine < coarse / 8


def violated(**options: Any) -> Array:
    found = run("elastic", law("elastic"), **options).certificate()
    return np.array([*found.violated.values()])


def test_holding_the_command_and_noise_are_seen_in_watts():
    exact = violated(control_period=1e-4, hold=False).max()
    sampled, slow = violated(control_period=5e-4).max(), violated(control_period=2e-3).max()
    noisy = violated(control_period=5e-4, sensors=Sensors(link_noise=1e-5, motor_noise=1e-5)).max()
    assert exact < sampled / 10 < slow / 20
    assert noisy > 3 * sampled


def test_a_wrong_model_is_seen_where_it_is_wrong():
    """Link 3 believed 20 % heavier: its own inequality suffers most among the links."""
    truth = arm("elastic")
    bodies = [replace(b, mass=1.2 * b.mass) if k == 2 else b for k, b in enumerate(truth.mechanism.bodies)]
    model = Robot(replace(truth.mechanism, bodies=tuple(bodies)), truth.drives)
    wrong = tune(model, 4.0, VDC)
    found = run("elastic", wrong, control_period=1e-4, hold=False).certificate()
    links = np.abs(found.slack[:, :3]).max(axis=0)
    assert links.argmax() == 2
    assert links[2] > 100 * np.delete(links, 2).max()


def test_the_certificate_prints_every_subsystem_and_what_it_does_not_say():
    told = str(run("elastic", law("elastic")).certificate())
    assert all(f"joint {name} " in told for name in arm("elastic").joints)
    assert told.endswith("61 samples: nothing is said of other times")


def test_there_is_no_certificate_where_it_would_say_nothing(tmp_path):
    log = run("elastic", PD([2e3] * 3, [60.0] * 3))
    with pytest.raises(InputError, match=r"certificate: only a VDC .* has one, but this run is of PD"):
        log.certificate()
    log = run("elastic", tune(arm("elastic"), 4.0, VDC, derivatives="filter"))
    with pytest.raises(InputError, match=r"this run is of VDC with derivatives='filter'"):
        log.certificate()
    run("elastic", law("elastic")).save(tmp_path / "run.npz")
    with pytest.raises(InputError, match=r"certificate: only a log simulated in this process knows its robot"):
        Log.load(tmp_path / "run.npz").certificate()


def test_acting_at_every_instant_is_for_what_has_no_memory():
    filtered = tune(arm("elastic"), 4.0, VDC, derivatives="filter")
    with pytest.raises(InputError, match=r"hold=False is for laws, .* without memory; VDC remembers"):
        run("elastic", filtered, hold=False)
    with pytest.raises(InputError, match=r"sensors with noise, delay or differences go by samples"):
        run("elastic", law("elastic"), hold=False, sensors=Sensors(link_noise=1e-5))
