"""The classical recursive Newton-Euler formulation, in link frames.

Luh, Walker and Paul (1980), "On-line computational scheme for mechanical manipulators", ASME J. Dyn. Syst. Meas.
Control 102(2): angular velocity, angular acceleration and acceleration of the origin outward; Newton's and Euler's
equations about each centroid; force and moment inward.
"""

from cutpoint.mechanics.bodies.spatial import ZERO, Vec3
from cutpoint.mechanics.system import System
from cutpoint.scalars import Scalar
from cutpoint.studies.cost.bodies import Link, Z, links


def torques(system: System, q: list[Scalar], v: list[Scalar], a: list[Scalar]) -> list[Scalar]:
    """Joint torques, N m, of a chain of revolute joints."""
    chain = links(system, q)
    needs = _outward(chain, -system.gravity, v, a)
    tau: list[Scalar] = []
    f, n, carried = ZERO, ZERO, None
    # inward: force and moment about the joint, the link's own and what it hands on
    for link, (own_force, own_moment) in reversed([*zip(chain, needs, strict=True)]):
        moment = own_moment + link.com.cross(own_force)
        if carried is not None:
            f = carried.rotation @ f
            n = carried.rotation @ n + carried.position.cross(f)
        f, n, carried = own_force + f, moment + n, link.placement
        tau.append(n.dot(Z))
    return tau[::-1]


def _outward(chain: list[Link], lift: Vec3, v: list[Scalar], a: list[Scalar]) -> list[tuple[Vec3, Vec3]]:
    """Net force and net moment about its centroid of every link, in its frame; `lift` stands for gravity."""
    omega, alpha, acceleration = ZERO, ZERO, lift
    needs = []
    for link, v_i, a_i in zip(chain, v, a, strict=True):
        R_T, p = link.placement.rotation.T, link.placement.position
        acceleration = R_T @ _acceleration(acceleration, alpha, omega, p)
        carried = R_T @ omega
        alpha = R_T @ alpha + Z * a_i + carried.cross(Z * v_i)
        omega = carried + Z * v_i
        force = _acceleration(acceleration, alpha, omega, link.com) * link.mass
        moment = link.inertia @ alpha + omega.cross(link.inertia @ omega)
        needs.append((force, moment))
    return needs


def _acceleration(a: Vec3, alpha: Vec3, omega: Vec3, r: Vec3) -> Vec3:
    """Of a link's point at r from where it accelerates with a."""
    return a + alpha.cross(r) + omega.cross(omega.cross(r))
