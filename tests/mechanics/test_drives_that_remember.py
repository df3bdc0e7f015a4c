"""Hysteresis, bristles and backlash: never a source of energy, independent of rate and of how a way is cut."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from cutpoint import Coulomb, InputError, LinearSpring, Stribeck
from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.friction import Grease
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.presliding import ElastoPlastic, LuGre

SIZE_20 = CatalogueSpring(16e3, 25e3, 29e3, 7.0, 25.0)
SLIP = MaxwellSlip.smooth(2.3, 3e-4, 4)
STRIBECK = Stribeck(0.5, 3.5, 0.15, 0.19, 0.02)
LOPSIDED = Stribeck(0.5, 3.5, 0.15, 0.19, 0.02, asymmetry=0.3, per_load=0.1)
BRISTLES = [
    LuGre(STRIBECK, 1e-4, 20.0),
    LuGre(LOPSIDED, 1e-4, 0.0),
    ElastoPlastic(STRIBECK, 1e-4, 20.0, 0.7),
    ElastoPlastic(LOPSIDED, 3e-4, 5.0, 0.0),
    ElastoPlastic(Coulomb(2.0, 0.0, 0.01), 1e-5, 0.0, 0.95),
]
each_law = pytest.mark.parametrize("law", BRISTLES, ids=lambda law: type(law).__name__)

seeds = st.integers(0, 2**32 - 1)


def random_way(seed: int, size: float, count: int = 400) -> np.ndarray:
    """Positions of a motion with reversals of every length, from a thousandth of size to all of it."""
    rng = np.random.default_rng(seed)
    steps = rng.standard_normal(count) * 10 ** rng.uniform(-3, 0, count)
    return size * np.concatenate([[0.0], np.cumsum(steps)])


# hysteresis


@settings(max_examples=10)  # of 400 reversals each
@given(seed=seeds, count=st.integers(1, 8))
def test_hysteresis_gives_back_no_more_than_it_took(seed, count):
    slip, way, strains = MaxwellSlip.smooth(2.3, 3e-4, count), random_way(seed, 1e-3), (0.0,) * count
    work = 0.0
    for displacement in np.diff(way):
        for part in np.full(50, displacement / 50):  # the torque is linear on almost every part
            after = slip.strains(strains, part)
            work += part * (slip.torque(strains) + slip.torque(after)) / 2
            strains = after
        assert work >= slip.energy(strains) - 1e-12


@given(seed=seeds, parts=st.integers(2, 9))
def test_strains_do_not_depend_on_how_a_way_is_cut(seed, parts):
    whole = pieces = (0.0,) * 4
    for displacement in np.diff(random_way(seed, 1e-3, 30)):
        whole = SLIP.strains(whole, displacement)
        for _ in range(parts):
            pieces = SLIP.strains(pieces, displacement / parts)
    assert pieces == pytest.approx(whole, abs=1e-15)


def test_a_loop_opens_by_the_loss_of_its_torque():
    deflection = np.concatenate([np.linspace(0, 2e-3, 500), np.linspace(2e-3, -2e-3, 20001)])
    strains, torques = (0.0,) * 4, []
    for before, after in zip(np.r_[0.0, deflection], deflection, strict=False):
        strains = SLIP.strains(strains, after - before)
        torques.append(SIZE_20.torque(after) + SLIP.torque(strains))
    back = np.interp(0.0, np.array(torques)[:499:-1], deflection[:499:-1])
    assert back == pytest.approx(SIZE_20.deflection(SLIP.friction), rel=1e-6)


@given(amplitude=st.floats(1e-6, 1e-3), start=st.floats(-1e-3, 1e-3))
def test_minor_loops_close(amplitude, start):
    strains = SLIP.strains((0.0,) * 4, start)
    turned = SLIP.strains(SLIP.strains(strains, amplitude), -amplitude)
    again = SLIP.strains(SLIP.strains(turned, amplitude), -amplitude)
    assert again == pytest.approx(turned, abs=1e-18)


# bristles


@each_law
@settings(max_examples=10)  # of 100 reversals each
@given(seed=seeds)
def test_bristles_give_back_no_more_than_they_took(law, seed):
    """Along a random motion at random speeds and loads."""
    rng, strain, work = np.random.default_rng(seed), 0.0, 0.0
    for displacement in np.diff(random_way(seed, 20 * law.distance, 100)):
        speed, load = np.sign(displacement) * 10 ** rng.uniform(-4, 1), rng.uniform(-20, 20)
        for part in np.full(100, displacement / 100):
            after = law.strain(strain, part, speed, load)
            torque = law.strained_torque((strain + after) / 2, speed, load)
            work += part * torque
            strain = after
        assert work >= law.stiffness * strain * strain / 2 - 1e-9


@each_law
@given(strain=st.floats(-1, 1), displacement=st.floats(-5, 5), parts=st.integers(2, 6))
def test_a_way_of_bristles_can_be_cut(law, strain, displacement, parts):
    start, way, speed = strain * 0.5 * law.distance, displacement * law.distance, np.sign(displacement) * 1e-3
    piece = start
    for _ in range(parts):
        piece = law.strain(piece, way / parts, speed)
    assert piece == pytest.approx(law.strain(start, way, speed), abs=1e-12 * law.distance)


@pytest.mark.parametrize("forwards", [1.0, -1.0])
@pytest.mark.parametrize("law", BRISTLES[:4], ids=lambda law: type(law).__name__)
def test_the_closed_form_solves_the_cited_differential_equation(law, forwards):
    """ds/dt = speed (1 - alpha sgn(speed) s / s_b) with LuGre's alpha = 1, and Dupont's beyond his elastic share."""
    speed = forwards * 0.03
    limit = law.sliding.dry(speed, 4.0, forwards) / law.stiffness
    elastic = getattr(law, "elastic", None)

    def rate(_: float, s: np.ndarray) -> np.ndarray:
        y = forwards * s
        if elastic is None:
            return speed * (1 - y / limit)
        onset = np.maximum(y - elastic * limit, 0.0) / (limit - elastic * limit)
        return speed * (1 - onset)

    for start in (-0.4 * limit, 0.0, 0.4 * limit):
        time = 2.5 * limit / abs(speed)
        found = solve_ivp(rate, (0.0, time), [start], rtol=1e-10, atol=1e-14, max_step=time / 200)
        assert law.strain(start, speed * time, speed, 4.0) == pytest.approx(found.y[0, -1], rel=1e-6)


@pytest.mark.parametrize("forwards", [1.0, -1.0])
@pytest.mark.parametrize("law", BRISTLES[1:4:2], ids=lambda law: type(law).__name__)
def test_bristles_that_slide_under_a_growing_load_wind_up_as_fast_as_it_lets_them(law, forwards):
    """Their damping goes with that: by the load half way alone it came out half as large again, however they slid."""
    speed, loads = forwards * 0.03, (4.0, 6.0)
    limit = law.sliding.dry(speed, 5.0, forwards) / law.stiffness
    way = 6.0 * limit
    time = way / abs(speed)

    def rate(t: float, s: np.ndarray) -> np.ndarray:
        return speed * law.winding(s, speed, loads[0] + (loads[1] - loads[0]) * t / time)

    start = 0.95 * forwards * limit
    true = solve_ivp(rate, (0.0, time), [start], rtol=1e-10, atol=1e-14, max_step=time / 200).y[0, -1]
    found = law.strain(start, forwards * way, speed, loads[1], halfway=(speed, 5.0))
    assert found == pytest.approx(true, rel=2e-3)
    assert law.winding(found, speed, loads[1]) == pytest.approx(law.winding(true, speed, loads[1]), rel=0.1)
    late = law.strain(start, forwards * way, speed, 5.0)
    assert law.winding(late, speed, loads[1]) > 1.5 * law.winding(true, speed, loads[1])


@each_law
def test_steady_sliding_is_the_sliding_law(law):
    for speed in (-1.0, -0.05, 0.05, 1.0):
        strain = law.strain(0.0, 1e3 * law.distance * np.sign(speed), speed, 5.0)
        sliding = law.sliding.dry(speed, 5.0, np.sign(speed)) * np.sign(speed) + law.sliding.viscous * speed
        assert law.strained_torque(strain, speed, 5.0) == pytest.approx(sliding, rel=1e-9)
        assert law.torque(speed, 5.0) == law.sliding.torque(speed, 5.0)


def test_elasto_plastic_bristles_hold_under_a_vibrating_load_where_lugre_creeps():
    """Dupont et al. (2002): below the elastic share a load leaves no displacement behind."""
    sliding = Coulomb(2.0, 0.0, 0.01)
    left = {}
    for law in (ElastoPlastic(sliding, 1e-4, 0.0, 0.7), LuGre(sliding, 1e-4, 0.0)):
        position, strain = 0.0, 0.0
        for torque in np.tile([1.2, 0.2], 500):  # up to 60 % of breakaway, one sign
            displacement = 0.0
            for _ in range(60):  # the displacement at which the bristles bear this torque
                s = law.strain(strain, displacement, np.sign(torque - law.stiffness * strain) * 1e-9)
                displacement += (torque - law.stiffness * s) / law.stiffness
            strain = law.strain(strain, displacement, np.sign(displacement) * 1e-9)
            position += displacement
        left[type(law).__name__] = position - 0.1 * law.distance
    assert abs(left["ElastoPlastic"]) < 1e-12
    assert left["LuGre"] > 0.5e-4


# sliding, with load, direction and temperature


def test_friction_follows_load_direction_and_temperature():
    law = Coulomb(2.0, 0.5, 1e-3, asymmetry=0.2, per_load=0.1, grease=Grease(45.0, 0.02))
    assert law.torque(1.0, -30.0) == pytest.approx((2.0 + 3.0) * 1.2 + 0.5 * np.exp(-0.4))
    assert law.torque(-1.0, 30.0) == pytest.approx(-(2.0 + 3.0) * 0.8 - 0.5 * np.exp(-0.4))


@given(speed=st.floats(-10, 10), load=st.floats(-50, 50))
def test_sliding_friction_takes_energy_whatever_load_and_direction(speed, load):
    for law in (STRIBECK, LOPSIDED, Coulomb(2.0, 0.5, 1e-2, asymmetry=-0.9, per_load=0.5, grease=Grease(-20.0, 0.03))):
        assert law.torque(speed, load) * speed >= 0


# backlash

PLAY = [Backlash(LinearSpring(1e4), 1e-3), Backlash(SIZE_20, 3e-4)]


@pytest.mark.parametrize("law", PLAY)
@given(torque=st.floats(-100, 100))
def test_backlash_inverts(law, torque):
    assert law.torque(law.deflection(torque)) == pytest.approx(torque, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("law", PLAY)
def test_backlash_is_play_and_then_its_spring(law):
    for beyond in (1e-4, 1e-3):
        torque = law.torque(law.gap / 2 + beyond)
        assert torque == pytest.approx(law.spring.torque(beyond + 0.015 * law.gap), rel=0.01)
        assert law.torque(-law.gap / 2 - beyond) == -torque
    assert law.torque(0.4 * law.gap) < 2e-3 * law.torque(law.gap)
    x = np.linspace(-law.gap, law.gap, 4001)
    work = np.concatenate([[0.0], np.cumsum(np.diff(x) * (law.torque(x)[1:] + law.torque(x)[:-1]) / 2)])
    assert work == pytest.approx(law.energy(x) - law.energy(x[0]), abs=1e-6 * law.energy(x[0]))
    assert law.tangent(x) == pytest.approx(np.gradient(law.torque(x), x, edge_order=2), rel=0.02, abs=30.0)


@pytest.mark.parametrize(
    ("torque", "reach", "elements", "message"),
    [
        *((1.0, 1e-4, elements, "elements .* must be a whole number, at least 1") for elements in (0, -3, 2.5)),
        *((1.0, reach, 4, "reach (.* must be positive|nan)") for reach in (0.0, -1e-4, np.nan)),
        (-1.0, 1e-4, 4, "torque -1.0 N m and reach .* must be positive"),
        (1.0, 1e-4, 1001, "elements 1001 at most 1000"),
    ],
)
def test_smooth_hysteresis_has_a_torque_a_reach_and_elements(torque, reach, elements, message):
    with pytest.raises(InputError, match=message):
        MaxwellSlip.smooth(torque, reach, elements)
