"""Detects a joint whose torques are on another scale than the others': a wrong torque constant, ratio or unit.

Bodies load several joints, so that one joint's torques follow from the others', except for its own friction.  A factor
that all joints have in common is that of all masses, and does not show.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.rigid.least_squares import with_further
from cutpoint.identification.rigid.regression import Regression, of_joint

CERTAIN = 4.0
"""Standard deviations above which a factor is reported."""

CERTAIN_IF_BENT = 5.0
"""The same if springs bend unseen, which looks like another scale of small joints' torques, and hides its size: in ten
right logs of a simulated arm two joints reached four."""

WORTH = 0.05
"""Least deviation from one that is reported: unmodelled springs and friction look like less."""

ALIKE = 0.9
"""Share of the most significant deviation with which another joint's explains the torques as well: of two joints that
bear the same bodies, and no others, either may be wrong."""


def scale_notes(found: Regression, values: Array, joints: Sequence[str], bend: bool) -> list[str]:
    """A sentence on the joint whose torques deviate most clearly from what the other joints' suggest, or the joints.

    values: the parameters (c,).  bend: whether springs bend unseen, with encoders on one side only.
    """
    certain = CERTAIN_IF_BENT if bend else CERTAIN
    excess, deviation = excesses(found, values)
    clear = np.where(np.abs(excess) > WORTH, np.abs(excess) / deviation, 0.0)
    scales = {j: _scale(found, j) for j in np.flatnonzero(clear >= certain).tolist()}
    # what no model explains enlarges the factor, until it contradicts the excess: then neither means anything
    clear[[j for j, scale in scales.items() if (scale - 1.0) * excess[j] < 0.0 or scale < 0.0]] = 0.0
    if clear.max() < certain:
        return []
    first, *others = np.argsort(-clear)[: int((clear > ALIKE * clear.max()).sum())].tolist()
    sizes = {j: f"about {scales[j]:.3g} times" for j in (first, *others)}
    if bend:
        sizes = {j: "more" if scales[j] > 1.0 else "less" for j in sizes}
    than = "than" if bend else "what"
    words = f"torques of {joints[first]} are {sizes[first]} {than} those of the others suggest"
    instead = "".join(f", or those of {joints[j]} {sizes[j]}" for j in others)
    return [f"{words}{instead}: check torque constants, gear ratios and units, and how the base is mounted"]


def excesses(found: Regression, values: Array) -> tuple[Array, Array]:
    """Excess of each joint's torques over those that all others suggest, as a share (n,), and its standard deviation.

    Estimated for one joint at a time, with all else, to first order; the deviation is infinite where nothing tells.
    """
    predicted, n = found.columns @ values, found.torque.shape[1]
    excess, deviation = np.zeros(n), np.full(n, np.inf)
    for j in range(n):
        estimate = with_further(found, of_joint(predicted[:, [j]], j, n))
        variance = float(estimate.spread.covariance[-1, -1])
        if 0.0 < variance < np.inf:
            excess[j], deviation[j] = estimate.values[-1], np.sqrt(variance)
    return excess, deviation


def _scale(found: Regression, joint: int) -> float:
    """What a joint's torques are multiplied by, also if that is far from one: 1 / g in 0 = columns p - g torque."""
    torque = found.torque.copy()
    torque[:, joint] = 0.0
    column = of_joint(-found.torque[:, [joint]], joint, torque.shape[1])
    return 1.0 / float(with_further(replace(found, torque=torque), column).values[-1])
