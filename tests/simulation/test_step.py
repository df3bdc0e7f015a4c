"""The integration step: order whatever resists, friction however stiff, and what it costs to be wrong about it."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from cutpoint import Coulomb, Drive, ElastoPlastic, LinearSpring, Log, Rotor, State, Stribeck, simulate
from cutpoint.control import PD, Command, Feedforward, Law
from cutpoint.model import Motor
from cutpoint.simulation.loop.step import GAMMA, TABLEAU
from cutpoint.simulation.steps.fastest import fastest_growth, posture
from cutpoint.simulation.steps.substeps import substeps_for
from cutpoint.trajectories import cycloid
from robot_library import Array, Robot, robot

B = TABLEAU[:, 1]
AHEAD = np.diag(TABLEAU[:-1, 0], -1)  # each stage starts from the one before
IMPLICIT = sum((np.diag(TABLEAU[: 3 - k, 2 + k], -1 - k) for k in range(3)), GAMMA * np.eye(4))
C, W = AHEAD.sum(axis=1), IMPLICIT.sum(axis=1)


def places() -> Array:
    """How much of each stage's acceleration, times h^2, is in each stage's coordinates."""
    speeds, last = np.vstack([AHEAD, np.zeros(4)]), np.cumsum(np.diag(B), axis=0)
    by = [
        current * speeds[i] + following * speeds[i + 1] + whole * last[i]
        for i, (current, following, whole) in enumerate(TABLEAU[:3, 6:])
    ]
    return np.vstack([np.zeros(4), *by])


PLACES = places()

CONDITIONS = {
    "1": (B.sum(), 1), "c": (B @ C, 1 / 2), "c2": (B @ C**2, 1 / 3), "ac": (B @ AHEAD @ C, 1 / 6),
    "c3": (B @ C**3, 1 / 4), "cac": (B @ (C * (AHEAD @ C)), 1 / 8), "ac2": (B @ AHEAD @ C**2, 1 / 12),
    "aac": (B @ AHEAD @ AHEAD @ C, 1 / 24),
    "w": (B @ W, 0), "aw": (B @ AHEAD @ W, 0), "wc": (B @ IMPLICIT @ C, 0), "ww": (B @ IMPLICIT @ W, 0),
    "c w": (B @ (C * W), 0),
    "p": (B @ PLACES.sum(axis=1), 1 / 6), "cp": (B @ (C * PLACES.sum(axis=1)), 1 / 8), "pc": (B @ PLACES @ C, 1 / 24),
    "ap": (B @ AHEAD @ PLACES.sum(axis=1), 1 / 24),
}  # fmt: skip


@pytest.mark.parametrize("name", CONDITIONS)
def test_the_order_conditions_hold(name):
    """Order 4 without resistance, 3 with any; "c w" keeps that where it changes from stage to stage.

    Hairer and Wanner (1996) section IV.7, W-methods; of places, Hairer et al. (1993) section II.14, Nystrom methods.
    """
    found, expected = CONDITIONS[name]
    assert found == pytest.approx(expected, abs=4 * np.finfo(float).eps)


def turned(z: float) -> Array:
    """What a step makes of (q, h v) where q'' = -(z / h)^2 q."""
    from_start = np.linalg.solve(np.eye(4) + z * z * PLACES, -z * z * np.column_stack([np.ones(4), C]))
    return np.array([[1.0, 1.0], [0.0, 1.0]]) + np.vstack([B @ AHEAD, B]) @ from_start


def test_coordinates_begin_with_the_speed_at_the_start():
    """The shares of speeds add up to how far a stage goes."""
    np.testing.assert_allclose(TABLEAU[:, 5:].sum(axis=1), TABLEAU[:, 0], atol=1e-15)


def test_what_swings_loses_no_amplitude():
    sizes = [np.abs(np.linalg.eigvals(turned(z))) for z in np.linspace(0.01, 2.9, 50)]
    np.testing.assert_allclose(sizes, 1.0, atol=1e-12)


def test_what_swings_keeps_its_phase_56_times_better_than_by_the_classical_step():
    """That is off by z^5 / 120 a step."""
    z = 0.05
    assert abs(np.angle(np.linalg.eigvals(turned(z))[0])) - z == pytest.approx(-(z**5) / 6720, rel=1e-2)


def gain(z: float, taken: float) -> float:
    """What a step makes of y' = z y / h where the implicit part takes it for `taken` y / h."""
    return float(1 + z * B @ np.linalg.solve(np.eye(4) - z * AHEAD - taken * IMPLICIT, np.ones(4)))


@pytest.mark.parametrize("share", [0.8, 1.0, 1.5, 4.0, 100.0])
def test_what_decays_decays_however_fast_and_however_well_it_is_known(share):
    assert all(abs(gain(z, share * z)) <= 1.0 for z in -np.logspace(-3, 8, 200))
    assert abs(gain(-1e9, -1e9)) < 1e-8


@cache
def arm() -> Robot:
    return robot("xia2019")


def each(ours: Robot, **parts: object) -> Robot:
    return ours.with_drives({name: replace(drive, **parts) for name, drive in ours.drives.items()})


@pytest.mark.parametrize(("substeps", "error"), [(2, 5e-7), (4, 2e-8)])
def test_springs_swing_in_time(substeps, error):
    """Over a second of swinging; steps of the classical method would be off by 7e-6 and 4e-7 rad."""
    ours = each(arm(), compliance=LinearSpring(1e4), link_friction=None)
    start = State(q=np.array([1.3, -1.0, 0.9, -0.4, 1.5, 0.2]))
    logs = [simulate(ours, duration=1.0, initial=start, substeps=n) for n in (substeps, 64)]
    assert np.abs(logs[0]["q"] - logs[1]["q"]).max() < error


@cache
def swing(kind: str, accuracy: Any = "standard", substeps: int | None = None) -> Array:
    """Where the arm is after it has fallen for 0.1 s, links and motors."""
    parts: dict[str, object] = {
        "link": {"link_friction": Coulomb(0.5, 0.2, 0.5)},
        "motor": {"link_friction": None, "motor_friction": Coulomb(1.0, 20.0, 0.5)},
        "spring": {"link_friction": None, "damping": 4.0},
        "rigid": {"link_friction": Coulomb(0.5, 0.5, 0.05), "compliance": None},
    }[kind]
    start = State(q=np.array([1.3, -1.0, 0.9, -0.4, 1.5, 0.2]))
    log = simulate(each(arm(), **parts), duration=0.1, initial=start, accuracy=accuracy, substeps=substeps)
    return np.concatenate([log["q"][-1], log["theta"][-1]])


@pytest.mark.parametrize("kind", ["link", "motor", "spring", "rigid"])
def test_with_friction_or_damping_the_step_is_of_order_three_or_more(kind):
    truth, steps = swing(kind, "reference"), np.array([12, 16, 20, 24])
    errors = [np.linalg.norm(swing(kind, substeps=int(n)) - truth) for n in steps]
    assert -np.polyfit(np.log(steps), np.log(errors), 1)[0] > 2.8


@pytest.mark.parametrize(("accuracy", "error"), [("standard", 1e-4), ("fine", 1e-6)])
@pytest.mark.parametrize("kind", ["link", "motor", "spring", "rigid"])
def test_an_accuracy_keeps_its_promise_with_friction(kind, accuracy, error):
    assert np.abs(swing(kind, accuracy) - swing(kind, "reference")).max() < error


class Push(Law):
    """A constant torque on joint 1, N m."""

    def __init__(self, torque: float) -> None:
        self.torque = torque

    def step(self, memory, measurement, reference):
        return memory, Command(np.array([self.torque, *[0.0] * 5]))


def pushed(smoothing: float, **parts: object) -> Log:
    """Joint 1, about the vertical, under less torque than it takes to break away."""
    drive = Drive(100.0, Rotor(1.14e-5), LinearSpring(16e3), damping=10.0)
    law = Stribeck(1.0, 2.0, 0.2, 100.0, smoothing)
    drives = {name: drive for name in arm().joints} | {"joint1": replace(drive, link_friction=law, **parts)}
    ours = arm().with_drives(drives).with_gravity([0.0, 0.0, 0.0])
    return simulate(ours, Push(1.2), duration=1.0, substeps=4)


@pytest.mark.parametrize("smoothing", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("spring", [{}, {"compliance": None, "damping": None}], ids=["elastic", "rigid"])
def test_smoothed_friction_creeps_as_it_must_however_sharp_it_is(smoothing, spring):
    """1.2 N m = 2 N m tanh(v / smoothing) + 0.2 N m s/rad v, at four steps a millisecond."""
    v = pushed(smoothing, **spring)["v"][-1, 0]
    assert 2.0 * np.tanh(v / smoothing) + 0.2 * v == pytest.approx(1.2, rel=1e-6)


def test_a_stiffly_damped_spring_moves_as_a_rigid_drive_does():
    """A damping of 1e5 N m s/rad decays in 20 ns; both ends go together."""
    start = State(q=np.array([1.3, -1.0, 0.9, -0.4, 1.5, 0.2]))
    bare = each(arm(), link_friction=None)
    tied = simulate(each(bare, damping=1e5), duration=0.1, initial=start, substeps=4)
    rigid = simulate(each(bare, compliance=None), duration=0.1, initial=start, substeps=4)
    assert np.abs(tied["q"] - rigid["q"]).max() < 2e-5
    assert np.abs(tied["v"] - tied["theta_dot"]).max() < 1e-2


RESISTS: dict[str, dict[str, Any]] = {
    "friction": {"motor_friction": Coulomb(1.0, 1.0, 0.05)},
    "friction under load": {"motor_friction": Coulomb(2.0, 0.5, 0.01, per_load=0.2)},
    "damping": {"damping": 300.0},
    "stiff damping": {"damping": 3e4},
}


@pytest.mark.parametrize("parts", RESISTS.values(), ids=RESISTS)
def test_a_rotor_that_its_carrier_turns_along_is_resisted_as_well_as_any(parts):
    """Full coupling, of gears of 10: what resists the rotor, and ties it to its link, is taken implicitly."""
    bare = each(arm(), compliance=LinearSpring(1e4), link_friction=None, damping=None)
    ours = each(bare, ratio=10.0, rotor=Rotor(1e-2, coupling="full"), **parts)
    start = State(q=np.array([1.3, -1.0, 0.9, -0.4, 1.5, 0.2]))
    coarse, fine = (simulate(ours, duration=0.2, initial=start, substeps=n) for n in (4, 100))
    assert np.abs(coarse["q"] - fine["q"]).max() < 1e-7


@cache
def paper(accuracy: Any, substeps: int | None = None) -> Array:
    """RMS errors of the paper's arm on a move of 1 s, rad."""
    law = PD([2000.0, 2000, 1000, 500, 300, 200], [60.0, 60, 35, 20, 12, 10], side="motor") + Feedforward(arm())
    move = cycloid(np.deg2rad([45.0, 30, 30, 45, 30, 45]), 1.0)
    return simulate(arm(), law, move, accuracy=accuracy, substeps=substeps).rms("position_error")


@pytest.mark.parametrize(("accuracy", "error"), [("standard", 2e-5), ("fine", 5e-6)])
def test_stick_slip_scores_are_those_of_much_finer_steps(accuracy, error):
    assert np.abs(paper(accuracy) - paper("standard", 100)).max() < error


def test_smoothing_does_not_set_the_steps_and_falling_friction_does():
    poses = np.zeros((1, 6))
    law = Stribeck(0.1, 0.7, 0.03, 0.03, 0.02)
    sharp = each(arm(), link_friction=replace(law, smoothing=1e-5, stribeck_velocity=1.0))
    falling = each(arm(), link_friction=replace(law, stribeck_velocity=1e-2, smoothing=1e-3))
    assert substeps_for(sharp, "standard", 1e-3, poses).number == 4
    steps = substeps_for(falling, "standard", 1e-3, poses)
    assert steps.number > 10
    assert steps.cause.startswith("slipping of 'joint")


BRISTLES = {"distance": 1e-9, "damping": 0.1, "elastic": 0.7}
CULPRITS: dict[str, dict[str, Any]] = {
    "the spring of": {"ratio": 100.0, "rotor": Rotor(1e-5), "compliance": LinearSpring(1e8)},
    "the link friction's bristles of": {"link_friction": ElastoPlastic(Coulomb(1.0, 0.1, 0.01), **BRISTLES)},
    "the motor friction's bristles of": {"motor_friction": ElastoPlastic(Coulomb(1.0, 0.1, 0.01), **BRISTLES)},
    "slipping of": {"link_friction": Stribeck(1.0, 30.0, 0.1, 1e-4, 1e-5)},
}


@pytest.mark.filterwarnings("ignore::cutpoint.simulation.steps.substeps.StiffnessWarning")
@pytest.mark.parametrize("part", CULPRITS)
@pytest.mark.parametrize("joint", arm().joints)
def test_what_sets_the_steps_is_found_where_it_is(joint, part):
    rigid = arm().with_drives({name: Drive() for name in arm().joints})
    steps = substeps_for(rigid.with_drives({joint: Drive(**CULPRITS[part])}), "fine", 1e-1, np.zeros((1, 6)))
    assert steps.cause == f"{part} {joint!r}"


def test_growth_is_that_of_the_steepest_fall():
    """Of Stribeck's exponential, sqrt(2/e) (f_s - f_c) / v_s at v_s / sqrt(2), far above where it is smoothed."""
    law = Stribeck(1.0, 2.0, 0.0, 0.1, 1e-5)
    ours = arm().with_drives({"joint6": replace(arm().drives["joint6"], link_friction=law)})
    others = [name for name in ours.joints if name != "joint6"]
    ours = ours.with_drives({name: replace(ours.drives[name], link_friction=None) for name in others})
    mobility = np.linalg.inv(ours.mass_matrix(np.zeros(6)))[5, 5]
    steepest = np.sqrt(2 / np.e) * 1.0 / 0.1
    assert fastest_growth(ours, [posture(ours, np.zeros(6))]).rate == pytest.approx(mobility * steepest, rel=1e-2)


def test_current_loops_still_set_the_steps():
    ours = each(arm(), motor=Motor(0.1, bandwidth=3e3))
    assert substeps_for(ours, "standard", 1e-3, np.zeros((1, 6))).cause.startswith("the current loop of 'joint")
