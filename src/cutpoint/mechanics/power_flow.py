"""Power across the cutting points.  Xia (2019) section II; Zhu (2010) section 2.9."""

from collections.abc import Sequence

from cutpoint.mechanics.bodies.joints import Floating
from cutpoint.mechanics.bodies.spatial import Motion
from cutpoint.mechanics.inverse_dynamics import motions, net_wrenches, transmitted_wrenches
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


def power_flows(system: System, q: Scalars, v: Scalars, a: Scalars) -> list[Scalar]:
    """Power that passes outward through each cutting point, in the order of the robot's cuts, W.

    At a cut both sides have the same velocity V and wrench F: the power V^T F leaves one subsystem and enters the next.
    """
    moved = motions(system, q, v, a)
    F = transmitted_wrenches(system, [m.X for m in moved], net_wrenches(system, moved, v, a), {})
    flows: list[Scalar] = []
    for segment, m, F_i in zip(system.segments, moved, F, strict=True):
        if isinstance(segment.joint, Floating):
            continue
        # from the carrying link into the joint
        if segment.parent != WORLD:
            V_p: Motion = moved[segment.parent].V
            flows.append(V_p.power(m.X.inward(F_i)))
        # from the joint into the link that it drives
        flows.append(m.V.power(F_i))
    return flows
