"""Joint torques as a linear function of inertial parameters.  Atkeson, An and Hollerbach (1986)."""

from collections.abc import Sequence

from cutpoint.mechanics.inverse_dynamics import motions
from cutpoint.mechanics.kinematics import velocity_columns
from cutpoint.mechanics.rigid_body import body_regressor
from cutpoint.mechanics.spatial import Motion
from cutpoint.mechanics.system import Segment, System
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


def torque_regressor(system: System, q: Scalars, v: Scalars, a: Scalars) -> list[list[Scalar]]:
    """Y(q, v, a), nv x 10 n, with tau = Y p: ten columns a body, in the order of `body_regressor`.

    p is expressed in the bodies' own frames, as a file gives them; armature is no part of it.
    """
    moved = motions(system, q, v, a)
    columns = velocity_columns(system, [m.X for m in moved])
    Y: list[list[Scalar]] = [[0] * (10 * len(moved)) for _ in range(system.nv)]
    for i, (segment, m) in enumerate(zip(system.segments, moved, strict=True)):
        wrenches = body_regressor(_in_own_axes(segment, m.A), segment.turn @ m.V.angular)
        # a joint bears of a wrench what power it takes at unit speed
        for j, column in columns[i].items():
            own = _in_own_axes(segment, column)
            for k, F in enumerate(wrenches):
                Y[j][10 * i + k] = own.power(F)
    return Y


def _in_own_axes(segment: Segment, V: Motion) -> Motion:
    return Motion(segment.turn @ V.linear, segment.turn @ V.angular)
