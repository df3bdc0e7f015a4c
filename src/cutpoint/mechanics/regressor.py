"""Joint torques as a linear function of inertial parameters.  Atkeson, An and Hollerbach (1986)."""

from collections.abc import Sequence

from cutpoint.mechanics.inverse_dynamics import motions
from cutpoint.mechanics.rigid_body import body_regressor
from cutpoint.mechanics.spatial import ZERO, Motion, Pose
from cutpoint.mechanics.system import Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


def torque_regressor(system: System, q: Scalars, v: Scalars, a: Scalars) -> list[list[Scalar]]:
    """Y(q, v, a), nv x 10 n, with tau = Y p: ten columns a body, in the order of `body_regressor`.

    p is expressed in the bodies' own frames, as a file gives them; armature is no part of it.
    """
    moved = motions(system, q, v, a)
    Y = [[0] * (10 * len(moved)) for _ in range(system.nv)]
    for i, (segment, m) in enumerate(zip(system.segments, moved, strict=True)):
        own_axes = Pose(segment.turn.T, ZERO)
        for k, F in enumerate(body_regressor(_in_own_axes(segment, m.V), _in_own_axes(segment, m.A))):
            # inward: every joint that carries the body bears its share
            F, carrier = own_axes.inward(F), i
            while carrier != WORLD:
                own = system.segments[carrier]
                gain = own.follower.multiplier if own.follower else 1
                for j, effort in enumerate(own.joint.effort(F), own.v.start):
                    Y[j][10 * i + k] = Y[j][10 * i + k] + gain * effort
                F, carrier = moved[carrier].X.inward(F), own.parent
    return Y


def _in_own_axes(segment: Segment, V: Motion) -> Motion:
    return Motion(segment.turn @ V.linear, segment.turn @ V.angular)
