"""Functions of a robot compile at their first call."""

import pytest

from cutpoint import InputError, robots


def test_a_kernel_before_its_first_call_is_told_to_need_one() -> None:
    robot = robots.xia2019()
    with pytest.raises(InputError, match=r"'gravity_forces', none exists yet; .* call it once first"):
        robot.kernel("gravity_forces")
    robot.gravity_forces(robot.neutral())
    assert robot.kernel("gravity_forces").name == "gravity_forces"
    with pytest.raises(InputError, match=r"'mass_matrix', there are: 'gravity_forces'; .* call it once first"):
        robot.kernel("mass_matrix")
