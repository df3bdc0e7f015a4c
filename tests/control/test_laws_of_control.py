"""Control laws alone: what they add, on which side, and what they refuse."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from law_library import elbow

from cutpoint import Coulomb, Drive, ElastoPlastic, InputError, LinearSpring, Rotor, simulate
from cutpoint.control import (
    PD,
    Command,
    ComputedTorque,
    DisturbanceObserver,
    Feedforward,
    GravityCompensation,
    Measurement,
    Reference,
    Robust,
    SlotineLi,
    SuperTwisting,
    tune,
)
from cutpoint.trajectories import septic
from robot_library import Array, assert_close, robot, vectors

KP, KD = np.linspace(100.0, 600.0, 6), np.linspace(5.0, 30.0, 6)


def seen() -> st.SearchStrategy[tuple[Measurement, Reference]]:
    """Any measurement and any reference, for six joints."""
    return st.tuples(*[vectors(6)] * 11).map(lambda x: (Measurement(0.0, 1e-3, *x[:4]), Reference(*x[4:11])))


def torque(law: Any, m: Measurement, r: Reference) -> Array:
    return np.asarray(law.step(law.start(), m, r)[1].torque, float)


@given(seen())
def test_pd_tracks_the_reference_of_its_side_by_the_encoder_of_its_side(x):
    m, r = x
    assert np.array_equal(torque(PD(KP, KD), m, r), KP * (r.theta - m.theta) + KD * (r.theta_dot - m.theta_dot))
    assert np.array_equal(torque(PD(KP, KD, side="link"), m, r), KP * (r.q - m.q) + KD * (r.v - m.v))


@given(seen())
def test_gravity_compensation_is_the_weight_at_the_encoder_it_reads(x):
    m, r = x
    ours = robot("xia2019")
    assert_close(torque(GravityCompensation(ours), m, r), ours.gravity_forces(m.q), 1e-12, scale=1.0)
    assert_close(torque(GravityCompensation(ours, side="motor"), m, r), ours.gravity_forces(m.theta), 1e-12, scale=1.0)


@given(seen())
def test_each_rung_of_feedforward_adds_to_the_one_before(x):
    m, r = x
    ours = robot("xia2019")
    reflected = np.array([d.reflected_inertia for d in ours.drives.values()])
    rungs = {name: torque(Feedforward(ours, name), m, r) for name in ("gravity", "rigid", "rotor", "friction")}
    rigid = ours.inverse_dynamics(r.q, r.v, r.a)
    assert_close(rungs["gravity"], ours.gravity_forces(r.q), 1e-12, scale=10.0)
    assert_close(rungs["rigid"], rigid, 1e-12, scale=10.0)
    assert_close(rungs["rotor"], rigid + reflected * r.a, 1e-12, scale=10.0)
    assert_close(rungs["friction"], rungs["rotor"] + ours.friction_torques(r.v), 1e-12, scale=10.0)


@given(seen())
def test_elastic_feedforward_is_the_elastic_inverse_dynamics_and_moves_the_motors_reference(x):
    m, r = x
    ours = robot("xia2019")
    _, command = Feedforward(ours).step((), m, r)
    u = ours.elastic_inverse_dynamics(r.q, r.v, r.a, r.jerk, r.snap)
    for given_, expected in zip(command[:4], (u.motor_torque, u.motor_torque, u.theta, u.theta_dot), strict=True):
        assert_close(np.asarray(given_, float), expected, 1e-11, scale=10.0)


@given(seen())
def test_the_friction_rung_counts_both_sides_and_a_rigid_rotor_once(x):
    m, r = x
    ours = robot("mixed")
    m, r = (type(y)(*[z[: ours.nv] if isinstance(z, np.ndarray) else z for z in y]) for y in (m, r))
    drives = [*ours.drives.values()]
    elastic = np.array([d.reflected_inertia if d.is_elastic else 0.0 for d in drives])
    motor = np.array(
        [d.motor_friction.torque(x) if d.motor_friction else 0.0 for d, x in zip(drives, r.v, strict=True)]
    )
    expected = ours.inverse_dynamics(r.q, r.v, r.a) + elastic * r.a + ours.friction_torques(r.v) + motor
    assert_close(torque(Feedforward(ours, "friction"), m, r), expected, 1e-12, scale=10.0)


@given(seen())
def test_a_sum_adds_torques_and_hands_the_motors_reference_to_all(x):
    m, r = x
    ours = robot("xia2019")
    pd, feedforward = PD(KP, KD), Feedforward(ours)
    u = feedforward.step((), m, r)[1]
    led = r._replace(theta=u.theta, theta_dot=u.theta_dot)
    for law in (pd + feedforward, feedforward + pd):
        _, command = law.step(law.start(), m, r)
        expected = np.asarray(u.torque, float) + torque(pd, m, led)
        assert_close(np.asarray(command.torque, float), expected, 1e-12, scale=10.0)
        assert_close(np.asarray(command.feedforward, float), np.asarray(u.torque, float), 1e-15, scale=1e-12)
        assert np.array_equal(command.theta, u.theta)


def test_a_users_own_law_is_added_from_either_side():
    def own(memory: Any, measurement: Any, reference: Any) -> Any:
        return memory, 2.0 * measurement.q

    class Own:
        def step(self, memory: Any, measurement: Any, reference: Any) -> Any:
            return own(memory, measurement, reference)

    m, r = Measurement(0.0, 1e-3, *np.ones((4, 6))), Reference(*np.zeros((7, 6)))
    expected = torque(PD(KP, KD), m, r) + 2.0
    for law in (Own() + PD(KP, KD), PD(KP, KD) + Own(), own + PD(KP, KD), PD(KP, KD) + own):
        assert np.array_equal(law.step(law.start(), m, r)[1].torque, expected)


def test_a_bare_torque_is_a_command_without_feedforward():
    class Bare(PD):
        def step(self, memory: Any, measurement: Any, reference: Any) -> Any:
            return memory, 2.0 * measurement.q

    m = Measurement(0.0, 1e-3, *np.ones((4, 6)))
    _, command = (Bare(KP, KD) + Bare(KP, KD)).step(((), ()), m, Reference(*np.zeros((7, 6))))
    assert isinstance(command, Command)
    assert np.array_equal(command.torque, np.full(6, 4.0))
    assert not np.any(command.feedforward)


@pytest.mark.parametrize(("bandwidth", "damping"), [(3.0, 0.7), (6.0, 1.0)])
def test_gains_for_a_bandwidth_make_a_second_order_system_of_each_joint(bandwidth, damping):
    ours = robot("xia2019")
    law = tune(ours, bandwidth, damping=damping)
    inertia = np.diag(ours.mass_matrix(np.zeros(6))) + [d.reflected_inertia for d in ours.drives.values()]
    assert_close(np.sqrt(law.kp / inertia) / (2 * np.pi), np.full(6, bandwidth), 1e-12)
    assert_close(law.kd / (2 * np.sqrt(law.kp * inertia)), np.full(6, damping), 1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: PD([-1.0] * 6, [1.0] * 6), r"PD: kp = \[-1.0.*must be .*not negative, one for each drive"),
        (lambda: PD([1.0] * 6, [np.nan] * 6), "PD: kd = .*must be .*finite"),
        (lambda: PD([1.0] * 6, [1.0] * 5), r"kp has shape \(6,\), (but|and) kd (has shape )?\(5,\)"),
        (lambda: PD([[1.0]], [[1.0]]), "PD: kp has shape .*one for each drive"),
        (lambda: PD([1.0], [1.0], side="base"), "side 'base' must be 'motor' or 'link'"),
        (lambda: GravityCompensation(robot("xia2019"), side="both"), "side 'both' must be 'motor' or 'link'"),
        (
            lambda: Feedforward(robot("xia2019"), "all"),
            "rung 'all' must be 'gravity', 'rigid', 'rotor', 'friction' or 'elastic'",
        ),
        (lambda: tune(robot("xia2019"), -3.0), "bandwidth -3.0 Hz .*must be positive"),
    ],
)
def test_laws_that_make_no_sense_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize("coupling", ["reduced", "full"])
def test_slotine_li_starts_as_its_model_whatever_the_rotors_are(coupling):
    """At first its torque is M a_r + C v_r + g + K s of the model, rotors with their own mass included."""
    rotor = Rotor(3e-4, in_link_inertia=False, mass=2.0, transverse=2e-4, position=0.05, coupling=coupling)
    ours = robot("xia2019")
    ours = ours.with_drives(dict.fromkeys(ours.joints, Drive(50.0, rotor)))
    law = SlotineLi(ours, 9.0, 4.0, side="link")
    x = np.random.default_rng(1).normal(size=(11, 6))
    m, r = Measurement(0.0, 1e-3, *x[:4]), Reference(*x[4:])
    v_r, a_r = r.v + 9.0 * (r.q - m.q), r.a + 9.0 * (r.v - m.v)
    expected = ours.mass_matrix(m.q) @ a_r + ours.coriolis_matrix(m.q, m.v) @ v_r + ours.gravity_forces(m.q)
    assert_close(torque(law, m, r), expected + 4.0 * (v_r - m.v), 1e-12)


def test_friction_that_grows_with_load_counts_that_of_the_link_among_it():
    rubbing = Drive(
        100.0, Rotor(5e-5), link_friction=Coulomb(5.0, 3.0, 0.05), motor_friction=Coulomb(1.0, 0.4, 0.05, per_load=0.3)
    )
    ours = elbow().with_drives(dict.fromkeys(elbow().joints, rubbing))
    move, feedforward = septic(end=[0.5, -0.4], duration=0.3), (Feedforward(ours, x) for x in ("friction", "elastic"))
    for law in (*feedforward, ComputedTorque(ours, 400.0, 40.0), Robust(ours, 9.0, 4.0, 1.0)):
        assert (simulate(ours, law, move, hold=False).max("position_error") < 1e-9).all()
    on_track = move.derivatives(np.array([0.1]), 4)[:, 0]
    m, r = Measurement(0.1, 1e-3, *[*on_track[:2]] * 2), Reference(*on_track, *on_track[:2])
    exact = torque(Feedforward(ours, "elastic"), m, r)
    for law in (SuperTwisting(ours, 9.0, 4.0, 1.0, 1.0), SlotineLi(ours, 9.0, 4.0)):
        assert_close(torque(law, m, r), exact, 1e-12)


def test_laws_for_rigid_robots_take_bristles_that_feel_the_load_as_sliding():
    sliding = Coulomb(2.0, 0.7, 0.02, per_load=0.14)
    sticking = ElastoPlastic(sliding, distance=3e-4, damping=3.0, elastic=0.7)
    plain, ours = (
        elbow().with_drives(
            dict.fromkeys(elbow().joints, Drive(100.0, Rotor(5e-5), LinearSpring(8e3), motor_friction=x))
        )
        for x in (sliding, sticking)
    )
    x = np.random.default_rng(2).normal(size=(11, 2))
    m, r = Measurement(0.0, 1e-3, *x[:4]), Reference(*x[4:])
    for kind in (ComputedTorque, SlotineLi, Robust, SuperTwisting):
        assert (torque(tune(ours, 4.0, kind), m, r) == torque(tune(plain, 4.0, kind), m, r)).all()
    observed = DisturbanceObserver(ours, tune(ours, 4.0) + Feedforward(ours, "friction"), 20.0)
    log = simulate(ours, observed, septic(end=[0.5, -0.4], duration=0.3))
    assert (log.max("position_error") < 0.01).all()


def test_an_observer_finds_little_where_the_model_is_right_and_friction_grows_with_load():
    rubbing = Coulomb(2.0, 0.7, 0.02, per_load=0.14)
    ours = elbow().with_drives({name: Drive(100.0, Rotor(5e-5), motor_friction=rubbing) for name in elbow().joints})
    move, law = septic(end=[1.0, -0.7], duration=1.0), tune(ours, 4.0) + Feedforward(ours, "friction")
    errors = [simulate(ours, x, move).rms("position_error") for x in (law, DisturbanceObserver(ours, law, 20.0))]
    assert (errors[1] < 1.5 * errors[0]).all()


def test_a_law_keeps_its_gains_whatever_becomes_of_the_array_they_came_in():
    given = np.full(6, 9.0)
    law = PD(given, given)
    given[:] = 0.0
    assert (law.kp == 9.0).all() and (law.kd == 9.0).all()
