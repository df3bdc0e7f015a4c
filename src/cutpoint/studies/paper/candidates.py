"""What could have made Table 3: two programs that differ in one small thing.  Each is computed, none is claimed."""

from dataclasses import replace

import numpy as np

from cutpoint.arrays import Array
from cutpoint.robots import xia2019_mechanism
from cutpoint.studies.paper.chain import Chain, chain_of
from cutpoint.studies.paper.newton_euler import torques

_MISMATCH = 1e-3
_ROUNDED_GRAVITY = np.array([0.0, 0.0, -9.80])

TORQUE = "torques 0.1 % off, or the torques in N m under a heading of N mm"
LENGTHS = "all lengths and centroids 0.1 % off"
GRAVITY = "g = 9.81 in one, 9.80 m/s² in the other"
AS_PRINTED = "the same g, link 6 centred at z = −0.25 m as printed"


def candidates(q: Array, v: Array, a: Array) -> dict[str, Array]:
    """Differences of joint torques along a motion, each (N, 6) in N m, by what differs."""
    arm, printed = chain_of(xia2019_mechanism()), chain_of(xia2019_mechanism(as_printed=True))

    def between(one: Chain, other: Chain) -> Array:
        return torques(one, q, v, a) - torques(other, q, v, a)

    return {
        TORQUE: _MISMATCH * torques(arm, q, v, a),
        LENGTHS: between(_longer(arm), arm),
        GRAVITY: between(arm, replace(arm, gravity=_ROUNDED_GRAVITY)),
        AS_PRINTED: between(printed, replace(printed, gravity=_ROUNDED_GRAVITY)),
    }


def _longer(chain: Chain) -> Chain:
    placements = chain.placements.copy()
    placements[:, :3, 3] *= 1 + _MISMATCH
    return replace(chain, placements=placements, coms=(1 + _MISMATCH) * chain.coms)
