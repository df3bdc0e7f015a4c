"""Gear ratios and scales of encoders that are stated wrong: by them a motor seems to move farther than its link."""

from collections.abc import Mapping

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.filtering import low_pass
from cutpoint.identification.conditioning.motion import motion_of, still_joints, torques_of
from cutpoint.identification.drives.scatter import SIGNIFICANT, covariance
from cutpoint.identification.drives.two_encoders import LEAST_SAMPLES
from cutpoint.identification.logs.recording import Recording
from cutpoint.robot import Robot

LEAST_SHARE = 2e-3
"""Least share that is reported: an encoder that is mounted off its centre by a thousandth of its radius shows half."""

LARGEST = 0.1
"""Share above which another unit, side or joint is suspected, as `suspicions` says."""

AT_REST = 0.02
"""Speed over which dry friction is taken to change sign, as a share of the RMS speed."""


def gain_notes(
    robot: Robot, recording: Recording, constants: Mapping[str, float] | None, cutoff: float | None
) -> tuple[str, ...]:
    """A sentence for each joint whose encoders differ in how far it moves, if there are two.

    constants: N m at the joint per ampere, as for `torques_of`.  cutoff: Hz, of the positions.
    """
    if not {"q", "theta"} <= recording.channels.keys():
        return ()
    motion = motion_of(robot, recording, cutoff)
    load = low_pass(torques_of(robot, recording, constants), motion.period, motion.cutoff)
    still, notes = still_joints(robot, motion), list[str]()
    for j, joint in enumerate(robot.joints):
        lead, q, v, a, tau = (x[:, j] for x in (motion.theta - motion.q, motion.q, motion.v, motion.a, load))
        share, deviation = (0.0, np.inf) if joint in still else _share(lead, q, v, a, tau, recording.time)
        if max(LEAST_SHARE, SIGNIFICANT * deviation) < abs(share) < LARGEST:
            ratio = robot.drives[joint].ratio
            asked = f"is the ratio {ratio * (1.0 + share):.4g}, not {ratio:g}, or the scale of an encoder another?"
            notes.append(f"theta of {joint} moves {1.0 + share:.4g} times as far as q: {asked}")
    return tuple(notes)


def _share(lead: Array, q: Array, v: Array, a: Array, load: Array, time: Array) -> tuple[float, float]:
    """By what share theta moves farther than q, and its standard deviation, from channels (N,).

    Beside it: what a torque winds, less friction and inertia, on a curve; one encoder's delay; zeros and their drift.
    """
    known = np.isfinite([lead, q, v, a, load]).all(axis=0)
    if known.sum() < LEAST_SAMPLES:
        return 0.0, np.inf
    lead, q, v, a, load, time = (x[known] for x in (lead, q, v, a, load, time))
    wound = [load * np.abs(load) ** k for k in range(3)]
    rubs = np.tanh(v / (AT_REST * np.sqrt(np.mean(v**2))))
    columns = np.column_stack([q, *wound, rubs, v, a, np.ones_like(q), time])
    columns /= np.linalg.norm(columns, axis=0) / np.linalg.norm(q)
    weights = np.linalg.lstsq(columns, lead, rcond=None)[0]
    spread = covariance(columns, lead - columns @ weights)
    return float(weights[0]), float(np.sqrt(spread[0, 0]))
