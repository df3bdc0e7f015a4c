"""Newton-Euler for robots with elastic joints: every vector's derivatives propagated by the product rule.

After Buondonno and De Luca (2015), "A recursive Newton-Euler algorithm for robots with elastic joints and its
application to control", IROS, for rotors that are felt by their own spin only (Spong 1987): angular velocity with three
derivatives and acceleration with two go outward, force and moment with two derivatives inward.  Derivatives are those
of the vectors themselves, told in link frames; the arrangement of terms is ours.
"""

from collections.abc import Callable, Sequence
from math import comb
from typing import Any

from cutpoint.definitions import Machine
from cutpoint.mechanics.bodies.spatial import ZERO, Mat3, Vec3
from cutpoint.mechanics.drives.compliance import LinearSpring
from cutpoint.mechanics.system import Driven, System
from cutpoint.scalars import Scalar
from cutpoint.studies.cost.bodies import Link, Z, links

Scalars = list[Scalar]
Rates = list[Vec3]
"""A vector and its time derivatives."""


def motor_torques(m: Machine, q: Scalars, v: Scalars, a: Scalars, jerk: Scalars, snap: Scalars) -> Scalars:
    """Motor torques at the joint's side, N m: I theta'' + tau with theta = q + tau / K."""
    tau = _torques(m.system, q, [*zip(v, a, jerk, snap, strict=True)])
    theta_ddot = [a_i + t[2] / _stiffness(d) for d, t, a_i in zip(m.drives, tau, a, strict=True)]
    return [d.drive.reflected_inertia * x + t[0] for d, t, x in zip(m.drives, tau, theta_ddot, strict=True)]


def _stiffness(driven: Driven) -> Scalar:
    assert isinstance(driven.drive.compliance, LinearSpring), "springs are linear in this formulation"
    return driven.drive.compliance.stiffness


def _torques(system: System, q: Scalars, rates: list[tuple[Scalar, ...]]) -> list[Scalars]:
    """Torque of each joint with its first two derivatives."""
    chain = links(system, q)
    omega: Rates = [ZERO] * 4
    a: Rates = [-system.gravity, ZERO, ZERO]
    moved: list[tuple[Rates, Rates, Rates]] = []
    # outward: each link's motion, and its net force and moment
    for link, rate in zip(chain, rates, strict=True):
        R_T = link.placement.rotation.T
        at_joint = turned_with(omega, link.placement.position)[2:]
        a = [R_T @ (x + y) for x, y in zip(a, at_joint, strict=True)]
        omega = _turned([R_T @ x for x in omega], rate)
        moved.append((omega, *_needs(link, omega, a)))
    # inward: forces, and moments about the joints, each with its derivatives
    tau: list[Scalars] = []
    f: Rates = [ZERO] * 3
    n: Rates = [ZERO] * 3
    for i in reversed(range(len(chain))):
        omega, force, moment = moved[i]
        if tau:
            f, n = _handed_on(chain[i + 1], omega, f, n)
        f = [x + y for x, y in zip(force, f, strict=True)]
        n = [x + y for x, y in zip(moment, n, strict=True)]
        tau.append([product(Vec3.dot, turned_with(omega, Z), n, k) for k in range(3)])
    return tau[::-1]


def _turned(omega: Rates, rate: tuple[Scalar, ...]) -> Rates:
    """Angular velocity and derivatives of a link that turns about Z, at rates v, a, ..., on one that has omega."""
    axis = turned_with(omega, Z)
    return [own + product(Vec3.__mul__, axis, rate, k) for k, own in enumerate(omega)]


def _needs(link: Link, omega: Rates, a: Rates) -> tuple[Rates, Rates]:
    """Net force of a link and net moment about its origin, with two derivatives."""
    arm = turned_with(omega, link.com)
    force = [(x + y) * link.mass for x, y in zip(a, arm[2:], strict=True)]
    moment = _euler(link.inertia, omega)
    return force, [m + product(Vec3.cross, arm, force, k) for k, m in enumerate(moment)]


def _euler(inertia: Mat3, omega: Rates) -> Rates:
    """Rates 1 to 3 of the angular momentum, told in the body's axes, which turn."""
    w0, w1, w2, w3 = omega

    def drift(u: Vec3) -> Vec3:
        """(I u)' - I u': what the turning of the tensor adds."""
        return w0.cross(inertia @ u) - inertia @ w0.cross(u)

    L, L_1 = inertia @ w0, inertia @ w1 + w0.cross(inertia @ w0)
    turned, change = inertia @ w1, drift(w1)
    L_2 = inertia @ w2 + change + w1.cross(L) + w0.cross(L_1)
    change_rate = w1.cross(turned) + w0.cross(inertia @ w2 + change) - inertia @ w0.cross(w2) - drift(w0.cross(w1))
    L_3 = inertia @ w3 + drift(w2) + change_rate + w2.cross(L) + 2 * w1.cross(L_1) + w0.cross(L_2)
    return [L_1, L_2, L_3]


def _handed_on(child: Link, omega: Rates, f: Rates, n: Rates) -> tuple[Rates, Rates]:
    """Force of a child and its moment about its carrier's origin, in the carrier's frame; omega is the carrier's."""
    R, arm = child.placement.rotation, turned_with(omega, child.placement.position)
    f = [R @ x for x in f]
    return f, [R @ x + product(Vec3.cross, arm, f, k) for k, x in enumerate(n)]


def turned_with(omega: Rates, r: Vec3) -> Rates:
    """A vector fixed in what turns with omega, and as many derivatives as omega allows: r' = omega x r."""
    rates = [r]
    for k in range(len(omega)):
        rates.append(product(Vec3.cross, omega, rates, k))
    return rates


def product(times: Callable[[Any, Any], Any], x: Sequence[Any], y: Sequence[Any], k: int) -> Any:
    """The k-th derivative of a product, by Leibniz's rule."""
    terms = [times(x[j], y[k - j]) * comb(k, j) for j in range(k + 1)]
    return sum(terms[1:], terms[0])
