"""Random arms with encoders on both sides: what benchmarks/identification_truth.py asks of a hundred, of four."""

import numpy as np
import pytest
from judged_arms import Case, case
from scipy.stats import binom

ARMS = (*range(200, 203), 247)
"""The last one's third spring is hardly wound: compliances of a catalogue's curve come out next to nothing."""


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    return [case(seed) for seed in ARMS]


def test_intervals_of_links_and_drives_hold_the_truth_as_often_as_they_say(cases: list[Case]):
    hits = [hit for each in cases for own in each.hits.values() for hit in own]
    kinds = {kind for each in cases for kind in each.hits}
    assert kinds >= {"base parameters", "coulomb", "viscous", "offset", "stiffness", "damping", "rotor inertia"}
    # hits of one arm are related: as if a third of them were not, the count lies within what chance allows
    assert binom.cdf(sum(hits) // 3, len(hits) // 3, 0.95) > 0.005


def test_bodies_exist_and_torques_held_out_are_missed_by_twice_what_the_truth_misses_at_most(cases: list[Case]):
    assert all(each.physical for each in cases)
    assert np.concatenate([each.ratio for each in cases]).max() < 2.0


def test_torques_that_do_not_separate_rotor_and_link_make_no_rotor_heavy():
    """A slide without weight: its link's torque has the shape of its rotor's, whose inertia came out 13 times too large
    in noise of 14 % of the torques."""
    arm = case(120, noise=0.5)
    assert arm.ratio.max() < 1.5


def test_a_spring_that_turns_lose_is_found_with_the_rotor_that_the_links_show():
    """In noise of a fifth of a joint's torque spring and rotor went astray together, to a fifth of the stiffness."""
    assert case(103, noise=0.5).hits["stiffness"] == [True, True, True]
