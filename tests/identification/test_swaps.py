"""Two joints whose columns are swapped are named, and what is swapped."""

from dataclasses import replace

import numpy as np
import pytest
from simulated_logs import known_arm, recorded

from cutpoint.identification import identify

KNOWN = known_arm(3, 4)
LOG = recorded(KNOWN.robot, 3)


@pytest.mark.parametrize(
    ("what", "channels"),
    [("torques", ["torque"]), ("positions", ["q"]), ("positions and torques", ["q", "torque"]), ("", [])],
)
@pytest.mark.parametrize("order", [(0, 1, 3, 2), (3, 1, 2, 0)])
def test_two_joints_whose_columns_are_swapped_are_named_with_what_is_swapped(
    what: str, channels: list[str], order: tuple[int, ...]
):
    changed = {name: LOG[name][:, order] for name in channels}
    doubts = identify(KNOWN.file, replace(LOG, **changed), friction="stated", hold_out=0.0).doubts
    first, second = (KNOWN.robot.joints[j] for j in np.flatnonzero(np.array(order) != np.arange(4)))
    told = f"columns of {what} of {first} and {second} look swapped: exchanged, they fit what the files predict"
    assert [doubt for doubt in doubts if "swapped" in doubt] == ([told] if channels else [])
