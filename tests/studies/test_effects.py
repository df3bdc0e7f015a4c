"""The study of a drive's effects: what it switches is what it says, and its words follow its numbers.

A move of 2 s instead of 10 s serves the tests; the study's own is in test_paper_study.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib import pyplot

from cutpoint import LinearSpring
from cutpoint.control import Feedforward
from cutpoint.mechanics.drives.presliding import ElastoPlastic
from cutpoint.reporting.style import png, styled
from cutpoint.studies.drive_effects import (
    COLD,
    EFFECTS,
    ERROR,
    FRICTION,
    GEARS,
    HYSTERESIS,
    LAG,
    NEEDS,
    PRESLIDING,
    detent_stiffness,
    drive_with,
    with_effects,
)
from cutpoint.studies.paper import effects, effects_figures
from cutpoint.studies.paper.bench import Bench, pd
from cutpoint.studies.paper.effects_runs import Runs, Share, Shares, arm
from cutpoint.studies.paper.effects_waves import by_order
from cutpoint.studies.paper.printed import GOAL
from cutpoint.trajectories import cycloid

MARGIN = 1e-4
"""Degrees: what vibration and the held command make of a run, whatever the feedforward knows."""


class Quick(Bench):
    @cached_property
    def reference(self):
        return cycloid(GOAL, 2.0)


@pytest.fixture(scope="module")
def bench():
    return Quick()


@pytest.fixture(scope="module")
def page(bench):
    with styled():
        return effects.page(bench)


@pytest.fixture(scope="module")
def table(page):
    return page.results["table_a5"]


@pytest.fixture(scope="module")
def drive(bench):
    return drive_with(bench.robot.drives["joint2"], GEARS[1], EFFECTS)


def error(bench, plant, model):
    """RMS tracking errors in degrees, (6,)."""
    log = bench.run(plant, pd() + Feedforward(model, "elastic"))
    return np.rad2deg(log.rms("position_error"))


# what is switched


def test_with_everything_off_the_arm_is_one_on_linear_springs(bench):
    bare = {}
    for (name, drive), gear in zip(bench.robot.drives.items(), GEARS, strict=True):
        stiffness = drive_with(drive, gear, ()).compliance.k1
        bare[name] = replace(drive, compliance=LinearSpring(stiffness), link_friction=None)
    linear, off = bench.robot.with_drives(bare), with_effects(bench.robot, ())
    np.testing.assert_allclose(error(bench, off, off), error(bench, linear, linear), rtol=1e-6, atol=1e-9)


def test_an_effect_switched_off_again_gives_the_earlier_number(bench, table):
    runs = Runs(bench)
    for k in (3, 0):
        np.testing.assert_array_equal(runs.error(EFFECTS[:k], EFFECTS[:k]), _before(table, k))


def test_a_loop_whose_log_was_wanted_is_not_run_again_for_its_errors(bench, monkeypatch):
    runs, counted, run = Runs(bench), [], Bench.run
    monkeypatch.setattr(Bench, "run", lambda *given: counted.append(given) or run(*given))
    log = runs.log((ERROR,), ())
    np.testing.assert_array_equal(runs.error((ERROR,), ()), np.rad2deg(log.rms("position_error")))
    assert len(counted) == 1


def _before(table, k):
    return table["added"][EFFECTS[k - 1]]["known"] if k else table["without effects"]


@pytest.mark.parametrize("effect", NEEDS)
def test_an_effect_brings_what_it_needs(bench, effect):
    law = with_effects(bench.robot, (effect,)).drives["joint1"].motor_friction
    assert getattr(law, "sliding", law).coulomb > 0


@pytest.mark.parametrize("effect", EFFECTS)
def test_each_effect_changes_the_drives_of_all_joints(bench, effect):
    before = with_effects(bench.robot, [NEEDS[effect]] if effect in NEEDS else [])
    after = with_effects(bench.robot, [effect])
    assert all(before.drives[name] != after.drives[name] for name in before.drives)


def test_the_drives_keep_the_arms_ratio_and_rotor(bench):
    for name, drive in with_effects(bench.robot, EFFECTS).drives.items():
        assert (drive.ratio, drive.rotor) == (bench.robot.drives[name].ratio, bench.robot.drives[name].rotor)


def test_no_motor_cogs_more_stiffly_than_its_feedback_holds(bench):
    stiff = [detent_stiffness(d, gear) for d, gear in zip(bench.robot.drives.values(), GEARS, strict=True)]
    assert (np.array(stiff) < pd().kp).all()


# what it costs


@pytest.mark.parametrize("kind", ["added", "alone"])
@pytest.mark.parametrize("effect", EFFECTS)
def test_no_effect_costs_more_when_the_feedforward_knows_it(table, kind, effect):
    found = table[kind][effect]
    assert found["arm"]["known"] <= found["arm"]["not_known"] + MARGIN


@pytest.mark.parametrize("effect", [effect for effect in EFFECTS if effect not in (LAG, HYSTERESIS)])
def test_a_feedforward_that_knows_an_effect_recovers_nearly_all_of_it(table, effect):
    assert table["alone"][effect]["recovered"] > 0.9


def test_hysteresis_is_recovered_for_the_most_part(table):
    assert table["alone"][HYSTERESIS]["recovered"] > 0.5


def test_a_share_is_what_the_error_grows_by(table):
    for kind in ("added", "alone"):
        for found in table[kind].values():
            for so in ("not_known", "known"):
                assert found["share"][so] == pytest.approx(arm(found[so]) - found["arm"]["before"], abs=1e-15)


def test_friction_known_a_tenth_wrong_costs_about_a_tenth(table):
    """Linear where the loop is: PD turns torque into error."""
    share = arm(table["gear_friction_mistaken"]["alone"]) / table["alone"][FRICTION]["arm"]["not_known"]
    assert share == pytest.approx(0.1, rel=0.2)


def test_all_effects_cost_more_than_any_alone(table):
    together = arm(table["feedforward_of_linear_springs"])
    assert together > max(found["arm"]["not_known"] for found in table["alone"].values())


# the page


def test_the_page_has_its_figures_and_tables_and_they_can_be_drawn(page):
    assert [x.key for x in page.pictures()] == ["figure_a5", "figure_a6"]
    assert [x.key for x in page.tables()] == ["table_a5", "table_a6", "table_a7"]
    assert all(len(png(picture.figure)) > 20_000 for picture in page.pictures())
    assert not pyplot.get_fignums()
    for each in page.tables():
        assert {len(cells) for cells in each.rows} == {len(each.columns)}


def made_up(**costs):
    """Shares of these costs in degrees, unknown and known; those of other effects are small."""
    at_all = {effect: costs.get(effect.replace(" ", "_"), (0.1, 0.02)) for effect in EFFECTS}
    one = np.ones(6)
    found = {effect: Share(one, (1 + unknown) * one, (1 + known) * one) for effect, (unknown, known) in at_all.items()}
    return Shares(found, found, 9 * one, 2 * one)


def test_the_words_follow_the_numbers():
    text = " ".join(effects.readings(made_up(hysteresis=(5.0, 0.1), gear_friction=(0.01, 0.01))))
    assert "hysteresis 5000.00, stiffness curve 100.00" in text
    assert "50.0 times the second" in text
    assert "Less than 1 % of the first: gear friction." in text
    assert "all but wholly: hysteresis 98 %;" in text and "not: gear friction 0 %." in text
    assert "The largest share that is left is that of hysteresis, 100.00." in text


@pytest.mark.parametrize(("known", "said"), [(0.1, True), (0.02, False)])
def test_what_feedforward_lacks_is_said_only_while_it_lacks_it(known, said):
    text = " ".join(effects.readings(made_up(**{LAG.replace(" ", "_"): (0.1, known)})))
    assert ("no term for the current loop" in text) is said


# the figures' numbers


def test_minor_loops_close(drive):
    top = 30.0 / 16e3
    for deflection, torque in effects_figures.minor_loops(drive, top):
        np.testing.assert_allclose([deflection[-1], torque[-1]], [deflection[0], torque[0]], rtol=1e-9)
        assert np.trapezoid(torque, deflection) > 0


def test_slow_friction_stays_below_breakaway_and_reaches_it(bench):
    law = drive_with(bench.robot.drives["joint2"], GEARS[1], (FRICTION, PRESLIDING)).motor_friction
    assert isinstance(law, ElastoPlastic)
    _, torque = effects_figures.dragged(law, (0.0, 5e-3, -5e-3))
    breakaway = law.sliding.plateau(0)
    assert np.abs(torque).max() <= breakaway * (1 + 1e-6)
    assert torque.max() > 0.999 * breakaway and torque.min() < -0.999 * breakaway


@given(order=st.integers(1, 10), amplitude=st.floats(1e-6, 1e3), forwards=st.sampled_from([-1, 1]))
def test_a_wave_along_an_angle_is_found_at_its_order_however_the_angle_grows(order, amplitude, forwards):
    time = np.linspace(0.0, 1.0, 40_001)
    angle = forwards * 2 * np.pi * 20 * (time - np.sin(2 * np.pi * time) / (2 * np.pi))
    orders, found = by_order(angle, amplitude * np.sin(order * angle + 0.4))
    assert orders[found.argmax()] == pytest.approx(order)
    assert found.max() == pytest.approx(amplitude, rel=1e-3)


def test_the_feedforward_brings_down_the_wave_of_the_kinematic_error():
    runs = Runs(Bench())  # slow enough for links to follow their drives
    heights = []
    for known in ((), (ERROR,)):
        log = runs.log((ERROR,), known)
        orders, found = by_order(100 * log["theta"][:, 1], log["position_error"][:, 1])
        heights.append(found[np.abs(orders - 2).argmin()])
    assert heights[1] < 0.1 * heights[0]
    assert heights[0] == pytest.approx(np.deg2rad(0.5 / 60), rel=0.15)  # half an arc minute


def test_cold_grease_is_thicker(bench):
    nominal = bench.robot.drives["joint1"]
    warm, cold = (drive_with(nominal, GEARS[0], (FRICTION, *more)).motor_friction for more in ((), (COLD,)))
    assert 1.5 < cold.viscosity / warm.viscosity < 3
