"""Every numbered equation of the paper that the package implements, against its transcription, at random states."""

import numpy as np
import pytest

from agreements import body, drive, manipulator
from agreements.registry import AGREEMENTS
from paper import DEFINITIONS, EQUATIONS
from robot_library import assert_close

NOT_IMPLEMENTED = {
    "(39)": "the inverse of (38), which does not exist where (57) starts: joint speeds come first instead",
}

SEEDS = range(3)
ROOMS = (body, manipulator, drive)


def test_every_equation_is_compared_or_accounted_for():
    assert AGREEMENTS.keys() | NOT_IMPLEMENTED.keys() == EQUATIONS.keys()
    assert not AGREEMENTS.keys() & NOT_IMPLEMENTED.keys()
    assert not NOT_IMPLEMENTED.keys() & DEFINITIONS.keys()
    assert {comparison.__module__ for comparison in AGREEMENTS.values()} == {room.__name__ for room in ROOMS}


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("number", sorted(AGREEMENTS, key=lambda n: int(n.strip("()"))))
def test_equation(number, seed):
    for ours, theirs in AGREEMENTS[number](np.random.default_rng(seed)):
        assert_close(ours, theirs, 1e-12, scale=1e-3)


@pytest.mark.parametrize("seed", range(10))
def test_torques_of_the_whole_arm(seed):
    for ours, theirs in manipulator.whole_arm(np.random.default_rng(seed)):
        assert_close(ours, theirs, 1e-12)
