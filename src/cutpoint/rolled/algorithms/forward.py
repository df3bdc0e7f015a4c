"""Forward dynamics as passes: what one body's step reads and writes, by the mechanics' own steps."""

from collections.abc import Sequence
from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies.articulated import Articulated, AxisResponse
from cutpoint.mechanics.bodies.joints import dot
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Inertia, Motion, Pose, Vec3, Wrench
from cutpoint.mechanics.system import Segment
from cutpoint.rolled.algorithms.base import base_in, sizes_apart
from cutpoint.rolled.algorithms.placing import POSE, placing
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.packing import (
    RESISTANCE,
    added,
    by_columns,
    flat,
    motion_of,
    packed_resistance,
    pose_by_columns,
    resistance_of,
    wrench_of,
)
from cutpoint.rolled.passes import PLAIN, UPWARD, Pass, Steps
from cutpoint.rolled.subsystem import Subsystem
from cutpoint.scalars import Scalar

NUMBERS = ("q", "v", "tau", "a")

MOTION = {"turned": 12, "omega": 3, "coasting": 6}
KEPT = {**MOTION, "share": 6}
"""What is kept of each body, and in how many numbers, beside its pose and its own step."""

VIEWS = (
    View("above", "turned", "parent"),
    View("carrier", "omega", "parent"),
    View("carried", "coasting", "parent"),
    View("borne", "resistance", "own sum"),
    View("by others", "resistance", "sum so far"),
    View("handed", "resistance", "carrier's sum"),
    View("led", "share", "parent"),
)

WORLD_ROWS: dict[str, list[Any]] = {"turned": flat(IDENTITY), "coasting": [(UPWARD, k) for k in range(6)]}


def forward_dynamics(columns: Columns) -> Steps:
    """Accelerations a under torques tau.  Featherstone (2008) section 7.3, every body along the world's axes.

    So no inertia passed from body to body is ever rotated.  turned: the body's axes in the world's, and its position in
    its parent.  coasting: its acceleration at constant joint speeds.  rigid: inertia, and the wrench for that
    acceleration.  resistance: the same of all that a body carries.  share: what the joint takes of its
    carrier's acceleration; the last pass puts the acceleration that joints add in its place.
    """
    poses, base = placing(columns, PLAIN, ("q",)), base_in(columns)
    along = columns.along_the_world

    def moves(mounting: Any, at: Any, row: Any, v: Any, above: Any, carrier: Any, carried: Any) -> Any:
        turned = turned_pose(pose_by_columns(above), poses.of(mounting, at))
        omega, A = _coasting(along(row, by_columns(turned)).body, Vec3(*carrier), motion_of(carried), v)
        return by_columns(turned), [*omega], [*A]

    def resists(row: Any, turned: Any, omega: Any, coasting: Any) -> Any:
        M = along(row, turned).body.inertia
        P = _net_wrench(M, motion_of(coasting), Vec3(*omega))
        return packed_resistance(Articulated.of(M).T, P)  # R J R^T is computed by columns, but needed by rows

    def eliminates(
        row: Any, turned: Any, v: Any, tau: Any, rigid: Any, carrier: Any, carried: Any, borne: Any, by_others: Any
    ) -> Any:
        own, (M, P), left = along(row, turned), resistance_of(added(borne, rigid)), tau[0]
        M_p, P_p = resistance_of(by_others)
        if own.spin:
            left = left - own.spin.along(motion_of(carried).angular)
            P_p = P_p + own.spin.reaction(Vec3(*carrier), v[0], 0)
        M_p, P_p, step = eliminate(own, M, P, left, M_p, P_p)
        return [step.own], step.share, packed_resistance(M_p, P_p)

    def follows(row: Any, turned: Any, step: Any, share: Any, led: Any) -> Any:
        body, A = along(row, turned).body, motion_of(led)
        eased = A.power(wrench_of(share))  # on the critical path, so it comes last
        kept = body.placement.outward(A) + body.joint.motion(step)
        return [step[0] - eased], [*(kept + body.joint.motion([-eased]))]

    reads = ("body", "turned", "v", "tau", "rigid", "carrier", "carried", "borne", "by others")
    passes = [
        Pass("alone", poses.stage),
        *([base.resists()] if base else []),
        Pass("outward", Stage(moves, (*POSE, "body", "v", "above", "carrier", "carried"), (*MOTION,))),
        Pass("inward", Stage(resists, ("body", *MOTION), ("rigid",))),
        Pass("inward", Stage(eliminates, reads, ("step", "share", "handed"))),
        *([base.eliminates()] if base else []),
        Pass("outward", Stage(follows, ("body", "turned", "step", "share", "led"), ("a", "share"))),
    ]
    kept, (apart, constants) = {"pose": poses.size, "step": 1, **KEPT}, sizes_apart(base, NUMBERS)
    apart, sums, threes = {"rigid": RESISTANCE, **apart}, {"resistance": RESISTANCE}, (*KEPT, "rigid", "resistance")
    return Steps(kept, NUMBERS, VIEWS, WORLD_ROWS, passes, apart, constants, threes=threes, sums=sums)


def eliminate(
    own: Subsystem, M: Articulated, P: Wrench, tau: Scalar, M_p: Articulated, P_p: Wrench
) -> tuple[Articulated, Wrench, AxisResponse]:
    """Inertia and bias wrench of a parent with those of a child, as felt through its joint; and the joint's response.

    Featherstone (2008) eqs. (7.38)-(7.44).  The rank-one update is made at the parent's origin, and last, so that
    nothing else waits for the division.  A rotor with full coupling couples the joint to its carrier's rotation.
    """
    (z,), X = own.body.joint.axes, own.body.placement
    Mz = [dot(z, column) for column in zip(*M.rows, strict=True)]  # z^T M: rows are contiguous
    gain = 1 / (M.along(z) + own.armature)
    a = gain * (tau - dot(z, [*P]))
    tie = own.spin.axis * own.spin.geared if own.spin else ZERO
    column = X.inward(wrench_of(Mz) + Wrench(ZERO, tie))
    share = [gain * x for x in column]
    taken = Articulated([[-x * s for s in share] for x in column])
    P_left = P_p + X.inward(P) + Wrench(column.force * a, column.moment * a)
    return M_p + M.carried_along(X.position) + taken, P_left, AxisResponse(z, a, share)


def _coasting(body: Segment, omega_p: Vec3, A_p: Motion, v: Sequence[Scalar]) -> tuple[Vec3, Motion]:
    """Angular velocity and acceleration of a body whose joint keeps its speed, along its parent's axes.

    As `inverse_dynamics.move` has them, in cross products, since each is one operation on three numbers.  omega_p, A_p:
    of the parent.
    """
    own, X = body.motion(v), body.placement
    omega = omega_p + own.angular
    linear = omega_p.cross(omega_p.cross(X.position)) + (omega_p + omega).cross(own.linear)
    return omega, X.outward(A_p) + Motion(linear, omega_p.cross(own.angular))


def _net_wrench(M: Inertia, A: Motion, omega: Vec3) -> Wrench:
    """`rigid_body.net_wrench` of a body that turns with omega (rad/s), in cross products."""
    V = Motion(ZERO, omega)
    return M * A + V.cross_wrench(M * V)


def turned_pose(above: Pose, X: Pose) -> Pose:
    """A body's axes in the world's, and its position in its parent along the world's axes, from those of its parent."""
    return Pose(above.rotation @ X.rotation, above.rotation @ X.position)
