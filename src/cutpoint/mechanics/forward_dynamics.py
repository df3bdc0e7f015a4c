"""Joint accelerations under joint torques, in time proportional to the number of bodies.

Featherstone (2008) chapter 7.  Where few joints carry a body, as in most arms, solving with the mass matrix takes fewer
operations, chapter 6.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from cutpoint.mechanics.bodies.articulated import NO_ROTOR, Articulated, AxisResponse, JointRotor, accelerations
from cutpoint.mechanics.bodies.rotors import Spin
from cutpoint.mechanics.bodies.spatial import STILL, Motion, Vec3, Wrench
from cutpoint.mechanics.factors import factors_of, solve
from cutpoint.mechanics.inverse_dynamics import contact_wrenches, inverse_dynamics, motions, net_wrenches, rotor_efforts
from cutpoint.mechanics.mass_matrix import mass_matrix
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import Scalar, is_plain_zero

Scalars = Sequence[Scalar]

FEW = 4
"""Joints between the world and a body, averaged over all bodies: up to 7 in a chain, more on trees.

Counted on random chains and trees: at this many both ways take about as many operations, with fewer the mass matrix
takes fewer.  Of UR10 and the paper's arm the recursion takes 4 % fewer operations, but 6 to 10 % more time in batches.
"""


class FreeRotor(NamedTuple):
    """A rotor behind a spring, as it acts on its carrier, at the joint's side.

    speed: its own, rad/s.  alpha: the acceleration that it would have if neither carrier nor joint accelerated, rad/s2.
    mobility: acceleration per N m on it, 1/(kg m2).  follows: the share of the joint's acceleration that it takes on.
    """

    speed: Scalar
    alpha: Scalar
    mobility: Scalar
    follows: Scalar

    def acceleration(self, a: Scalar) -> Scalar:
        """Its own, rad/s2, where the joint accelerates with a and the carrier does not."""
        return self.alpha + self.follows * a


def forward_dynamics(
    system: System, q: Scalars, v: Scalars, tau: Scalars, contact: Mapping[str, Wrench] | None = None
) -> list[Scalar]:
    """Accelerations of the coordinates under joint torques tau, N m (N).  Featherstone (2008) section 7.3.

    contact: F_e by frame name, the wrench that the robot exerts on the environment there, in that frame's axes.
    """
    if system.has_followers or is_shallow(system):
        return through_mass_matrix(system, q, v, tau, contact)
    geared = replace(system, spins=tuple(spin for spin in system.spins if not spin.elastic))
    return articulated_accelerations(geared, q, v, tau, contact or {}, {})[0]


def is_shallow(system: System) -> bool:
    """Whether few joints carry a body, each of one axis."""
    bodies = system.segments
    return all(len(body.joint.axes) == 1 for body in bodies) and sum(system.depths) <= FEW * len(bodies)


def through_mass_matrix(
    system: System, q: Scalars, v: Scalars, tau: Scalars, contact: Mapping[str, Wrench] | None = None
) -> list[Scalar]:
    """Solves M a = tau - bias directly; also valid where followers couple distant joints."""
    bias = inverse_dynamics(system, q, v, [0] * system.nv, contact)
    return solve(factors_of(mass_matrix(system, q)), [t - b for t, b in zip(tau, bias, strict=True)])


def articulated_accelerations(
    system: System,
    q: Scalars,
    v: Scalars,
    tau: Scalars,
    contact: Mapping[str, Wrench],
    rotors: Mapping[int, FreeRotor],
) -> tuple[list[Scalar], list[Motion]]:
    """Accelerations of the coordinates and of the bodies, by the articulated-body recursion.

    Inverse dynamics at constant joint speeds (coasting) gives the torques that these take.  The remaining torques act
    on a robot at rest without gravity: Featherstone (2008) section 7.3 with v = 0.

    rotors: of each segment with an elastic drive and full coupling.
    """
    still = [0] * system.nv
    # outward: motion of the coasting bodies, and the wrenches and torques that this takes
    coast = motions(system, q, v, still)
    P = net_wrenches(system, coast, v, still)
    for i, F_e in contact_wrenches(system, contact):
        P[i] = P[i] + F_e
    M = [Articulated.of(body.inertia) for body in system.segments]
    tau_left = [t - taken for t, taken in zip(tau, rotor_efforts(system, coast, still), strict=True)]
    for spin in system.spins:
        if spin.elastic:
            i, k, rotor = spin.carrier, system.segments[spin.joint].v.start, rotors[spin.joint]
            inertia = spin.geared * spin.geared * rotor.mobility  # J, or less where damping adds to it
            omega, A_i = coast[i].V.angular, coast[i].A
            M[i], P[i] = with_free_rotor(spin, inertia, M[i], P[i], omega, A_i, rotor.speed, rotor.alpha)
            tau_left[k] = tau_left[k] - rotor.follows * spin.along(A_i.angular)
    # inward: inertia and bias of each body with all it carries, as its parent feels them through the joint
    responses: list[list[AxisResponse]] = []
    at_joint = joint_rotors(system, rotors)
    for i, body in reversed([*enumerate(system.segments)]):
        M_i, P_i, response = M[i].eliminate(body.joint.axes, P[i], tau_left[body.v], at_joint[i])
        responses.append(response)
        if body.parent != WORLD:
            M[body.parent] = M[body.parent] + M_i.seen_from_parent(coast[i].X)
            P[body.parent] = P[body.parent] + coast[i].X.inward(P_i)
    # outward: each joint's acceleration from its parent's, beyond coasting
    A: list[Motion] = []
    a: list[Scalar] = [0] * system.nv
    for m, body, response in zip(coast, system.segments, reversed(responses), strict=True):
        carried = STILL if body.parent == WORLD else m.X.outward(A[body.parent])
        a[body.v] = accelerations(response, carried)
        A.append(carried + body.motion(a))
    return a, [m.A + A_i for m, A_i in zip(coast, A, strict=True)]


def joint_rotors(system: System, rotors: Mapping[int, FreeRotor]) -> list[list[JointRotor]]:
    """Rotors as they act on each segment's axes: those rigidly geared, and others as far as they follow their joint."""
    shares = {spin.joint: rotors[spin.joint].follows if spin.elastic else 1 for spin in system.spins}
    couplings = {spin.joint: spin.geared * shares[spin.joint] for spin in system.spins}
    return [
        [NO_ROTOR if is_plain_zero(I_m) else JointRotor(I_m, couplings.get(i, 0)) for I_m in system.armature[body.v]]
        for i, body in enumerate(system.segments)
    ]


def with_free_rotor(
    spin: Spin, inertia: Scalar, M: Articulated, P: Wrench, omega: Vec3, A: Motion, speed: Scalar, alpha: Scalar
) -> tuple[Articulated, Wrench]:
    """Inertia and bias of the carrier of an elastic drive's rotor, which does not follow the carrier about its axis.

    Xia (2019) eqs. (4), (7), (11).  inertia: the rotor's about its axis.  M, P: as if it did follow.  omega, A: the
    carrier's.  speed, alpha: as of a `FreeRotor`.
    """
    apart = Articulated.about(spin.axis, -inertia)
    return M + apart, P + apart * A + spin.reaction(omega, speed, alpha)
