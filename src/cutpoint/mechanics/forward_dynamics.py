"""Joint accelerations under joint torques, in time proportional to the number of bodies.

Featherstone (2008) chapter 7.  Where few joints carry a body, as on most arms, solving with the mass matrix takes fewer
operations, chapter 6.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cutpoint.mechanics.articulated import NO_ROTOR, Articulated, FeltRotor, Yield, accelerations
from cutpoint.mechanics.inverse_dynamics import handed_on, inverse_dynamics
from cutpoint.mechanics.mass_matrix import mass_matrix
from cutpoint.mechanics.rigid_body import acceleration_gradient, net_wrench
from cutpoint.mechanics.rotors import Spin
from cutpoint.mechanics.spatial import NO_ROTATION, STILL, ZERO, Mat3, Motion, Pose, Vec3, Wrench
from cutpoint.mechanics.system import Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar, is_plain_zero

Scalars = Sequence[Scalar]

FEW = 6
"""Joints between the world and a body, averaged over all bodies: up to 11 in a chain, more on trees.

Counted on random chains and trees: at this many both ways cost about the same; for 6 joints in a chain the mass matrix
takes four fifths of the operations, and three quarters of the time on arms.
"""


@dataclass(slots=True, eq=False)
class ArticulatedBody:
    """A body's pose and velocity, what velocities add to its acceleration, and how it and all it carries resist.

    U is the gradient of the acceleration that its angular velocity alone makes, see `rigid_body`.
    """

    X: Pose
    V: Motion
    U: Mat3
    bias: Motion
    M: Articulated
    P: Wrench


def prepare(body: Segment, X: Pose, V_p: Motion, U_p: Mat3, v: Scalars) -> ArticulatedBody:
    """Velocity of a body, and acceleration and wrench that velocities alone make.  Featherstone (2008) eq. (7.46)."""
    zv = body.motion(v)
    carried = X.outward(V_p)
    V = carried + zv
    U = acceleration_gradient(ZERO, V.angular, V.angular)
    linear = X.rotation.T @ (U_p @ X.position) + (carried.angular + V.angular).cross(zv.linear)
    bias = Motion(linear, carried.angular.cross(zv.angular))
    return ArticulatedBody(X, V, U, bias, Articulated.of(body.inertia), net_wrench(body.inertia, STILL, U))


def spinning(body: Segment, omega_p: Vec3, v: Scalars) -> tuple[Vec3, Motion, Wrench]:
    """Of a body along its parent's axes, which turn with omega_p: its own turning, and what `prepare` finds beside it.

    In cross products: each is one operation on three numbers.  Featherstone (2008) eq. (7.46).
    """
    own, p = body.motion(v), body.placement.position
    omega = omega_p + own.angular
    bias = Motion(omega_p.cross(omega_p.cross(p)) + (omega_p + omega).cross(own.linear), omega_p.cross(own.angular))
    V = Motion(ZERO, omega)
    return omega, bias, V.cross_wrench(body.inertia * V)


def forward_dynamics(
    system: System, q: Scalars, v: Scalars, tau: Scalars, contact: Mapping[str, Wrench] | None = None
) -> list[Scalar]:
    """Accelerations of the coordinates under joint torques tau, N m (N).  Featherstone (2008) section 7.3.

    contact: F_e by frame name, the wrench that the robot exerts on the environment there, in that frame's axes.
    """
    if system.has_followers:
        return through_mass_matrix(system, q, v, tau, contact)
    rigid = replace(system, spins=tuple(spin for spin in system.spins if not spin.elastic))
    if is_shallow(rigid):
        return through_mass_matrix(rigid, q, v, tau, contact)
    return articulated_accelerations(rigid, q, v, tau, contact or {}, {})[0]


def is_shallow(system: System) -> bool:
    """Whether few joints carry a body, each of one axis."""
    bodies = system.segments
    return all(len(body.joint.axes) == 1 for body in bodies) and sum(system.depths) <= FEW * len(bodies)


def articulated_accelerations(
    system: System,
    q: Scalars,
    v: Scalars,
    tau: Scalars,
    contact: Mapping[str, Wrench],
    rotors: Mapping[int, tuple[Scalar, Scalar]],
) -> tuple[list[Scalar], list[Motion]]:
    """Accelerations of the coordinates and of the bodies, by the articulated-body recursion.

    rotors: for each segment with an elastic drive and full coupling, the torque that its rotor is left with, and its
    speed, at the joint's side.
    """
    bodies: list[ArticulatedBody] = []
    # outward: velocities, and what they alone cost
    for body in system.segments:
        V_p, U_p = (STILL, NO_ROTATION) if body.parent == WORLD else (bodies[body.parent].V, bodies[body.parent].U)
        bodies.append(prepare(body, body.pose(q), V_p, U_p, v))
    for i, F_e in handed_on(system, contact):
        bodies[i].P = bodies[i].P + F_e
    for spin in system.spins:
        _let_spin(spin, system, bodies[spin.carrier], v, rotors)
    # inward: what a body and all it carries still resist once its joint gives way
    gave: list[list[Yield]] = []
    felt = felt_rotors(system)
    for i, (own, body) in reversed([*enumerate(zip(bodies, system.segments, strict=True))]):
        M, P, steps = own.M.give_way(body.joint.axes, own.P + own.M * own.bias, tau[body.v], felt[i])
        gave.append(steps)
        if body.parent != WORLD:
            carrier = bodies[body.parent]
            carrier.M = carrier.M + M.seen_from_parent(own.X)
            carrier.P = carrier.P + own.X.inward(P)
    # outward: each joint gives way to what its parent's acceleration leaves it
    A: list[Motion] = []
    found: list[Scalar] = [0] * system.nv
    for own, body, steps in zip(bodies, system.segments, reversed(gave), strict=True):
        carried = own.X.outward(system.base_acceleration if body.parent == WORLD else A[body.parent])
        found[body.v] = accelerations(steps, carried)
        A.append(carried + own.bias + body.motion(found))
    return found, A


def felt_rotors(system: System) -> list[list[FeltRotor]]:
    """Rigidly geared rotors as each segment's axes feel them."""
    couplings = {spin.joint: spin.geared for spin in system.spins if not spin.elastic}
    return [
        [NO_ROTOR if is_plain_zero(I_m) else FeltRotor(I_m, couplings.get(i, 0)) for I_m in system.armature[body.v]]
        for i, body in enumerate(system.segments)
    ]


def _let_spin(
    spin: Spin, system: System, carrier: ArticulatedBody, v: Scalars, rotors: Mapping[int, tuple[Scalar, Scalar]]
) -> None:
    """What a rotor's spin costs its carrier.  An elastic drive's rotor does not follow its carrier about its axis."""
    if not spin.elastic:
        carrier.P = carrier.P + spin.reaction(carrier.V.angular, system.segments[spin.joint].speeds(v)[0], 0)
        return
    torque, speed = rotors[spin.joint]
    carrier.M = carrier.M + Articulated.about(spin.axis, -spin.inertia)
    pushed = Wrench(ZERO, spin.axis * (torque * spin.inertia / spin.geared))
    carrier.P = carrier.P + spin.reaction(carrier.V.angular, speed, 0) + pushed


def through_mass_matrix(
    system: System, q: Scalars, v: Scalars, tau: Scalars, contact: Mapping[str, Wrench] | None = None
) -> list[Scalar]:
    """M a = tau - bias, solved as it stands: also where coordinates that follow others tie distant joints together."""
    bias = inverse_dynamics(system, q, v, [0] * system.nv, contact)
    return solve_symmetric(mass_matrix(system, q), [t - b for t, b in zip(tau, bias, strict=True)])


def solve_symmetric(M: list[list[Scalar]], b: Scalars) -> list[Scalar]:
    """x with M x = b for a symmetric positive definite M, by L D L^T from the last row up; zeros of a tree stay zeros.

    Featherstone (2008) section 6.5.
    """
    n, L, x = len(b), [[*row] for row in M], [*b]
    inverse: list[Scalar] = [0] * n  # of D: a division costs ten products
    for k in reversed(range(n)):
        inverse[k] = 1 / L[k][k]
        for i in reversed(range(k)):
            share = L[k][i] * inverse[k]
            for j in range(i + 1):
                L[i][j] = L[i][j] - share * L[k][j]
            L[k][i] = share
            x[i] = x[i] - share * x[k]
    for k in range(n):
        x[k] = x[k] * inverse[k] - sum((L[k][i] * x[i] for i in range(k)), 0)
    return x
