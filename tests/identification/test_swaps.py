"""Two joints whose columns are swapped are named, and joints with the wrong sign; and what is."""

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


@pytest.mark.parametrize("joint", [0, 1, 3])
@pytest.mark.parametrize("name", ["q", "torque"])
def test_a_joint_of_which_a_sign_is_reversed_is_named_with_what_is_reversed(joint: int, name: str):
    signs = np.where(np.arange(4) == joint, -1.0, 1.0)
    causes = identify(KNOWN.file, replace(LOG, **{name: LOG[name] * signs}), friction="stated", hold_out=0.0).causes
    what = {"q": "positions", "torque": "torques"}[name]
    told = f" of {KNOWN.robot.joints[joint]} look reversed: turned round, they fit what the files predict"
    assert len(causes) == 1 and causes[0].startswith("signs of ") and causes[0].endswith(told)
    assert what in causes[0]


@pytest.mark.parametrize("joints", [(0, 1), (0, 2), (1, 3), (2, 3)])
@pytest.mark.parametrize("name", ["q", "torque"])
def test_two_joints_of_which_signs_are_reversed_are_both_named(joints: tuple[int, int], name: str):
    signs = np.where(np.isin(np.arange(4), joints), -1.0, 1.0)
    causes = identify(KNOWN.file, replace(LOG, **{name: LOG[name] * signs}), friction="stated", hold_out=0.0).causes
    which = ", ".join(KNOWN.robot.joints[j] for j in joints)
    assert len(causes) == 1 and f" of {which} look reversed: turned round, they fit" in causes[0], causes
    assert {"q": "positions", "torque": "torques"}[name] in causes[0]


def test_all_joints_whose_torques_are_reversed_are_named():
    causes = identify(KNOWN.file, replace(LOG, torque=-LOG["torque"]), friction="stated", hold_out=0.0).causes
    assert len(causes) == 1 and causes[0].startswith(
        f"signs of torques of {', '.join(KNOWN.robot.joints)} look reversed"
    )


@pytest.mark.parametrize("turned", [[0], [1], [0, 1]])
def test_encoders_that_contradict_each_other_are_not_also_taken_for_swapped_columns_or_reversed_torques(
    turned: list[int],
):
    log = replace(LOG, theta=LOG["q"], q=LOG["q"] * np.where(np.isin(np.arange(4), turned), -1.0, 1.0))
    causes = identify(KNOWN.file, log, friction="stated", springs=False, hold_out=0.0).causes
    assert causes == tuple(f"theta of {KNOWN.robot.joints[j]!r} is -1 times q: a wrong sign?" for j in turned)
