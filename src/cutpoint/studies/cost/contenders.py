"""The compared formulations: one inverse dynamics each, on any scalar, all through one emitter."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from cutpoint.definitions import Machine
from cutpoint.kernels import Graph
from cutpoint.mechanics.elastic_inverse import elastic_inverse_dynamics
from cutpoint.mechanics.inverse_dynamics import inverse_dynamics
from cutpoint.studies.cost import buondonno_de_luca, christoffel, luh_walker_paul, uicker_kahn

Scalars = list[Any]


@dataclass(frozen=True)
class Contender:
    """A formulation.

    torques(machine, **motion) gives joint torques, or motor torques of one that is elastic, N m at the joint's side.
    motion: its inputs, position first.  largest: number of joints up to which operations are counted.
    """

    key: str
    name: str
    torques: Callable[..., Scalars]
    elastic: bool = False
    largest: int = 64

    @property
    def motion(self) -> tuple[str, ...]:
        return ("q", "v", "a", "jerk", "snap") if self.elastic else ("q", "v", "a")

    def on(self, machine: Machine) -> Callable[..., Scalars]:
        """The function of a motion alone."""
        return partial(self.torques, machine)


def _rigid(torques: Callable[..., Scalars]) -> Callable[..., Scalars]:
    """A function of the links' system as one of the machine."""

    def on_machine(m: Machine, q: Scalars, v: Scalars, a: Scalars) -> Scalars:
        return torques(m.system, q, v, a)

    return on_machine


def _by_jets(m: Machine, q: Scalars, v: Scalars, a: Scalars, jerk: Scalars, snap: Scalars) -> Scalars:
    return elastic_inverse_dynamics(m.system, m.drives, q, v, a, jerk, snap).motor_torque


VD, NE, JETS, EXPLICIT, CHRISTOFFEL, LAGRANGE = CONTENDERS = (
    Contender("vd", "virtual decomposition", _rigid(inverse_dynamics)),
    Contender("ne", "Newton-Euler (Luh, Walker, Paul)", _rigid(luh_walker_paul.torques)),
    Contender("vd_elastic", "elastic: virtual decomposition on jets", _by_jets, elastic=True),
    Contender(
        "ne_elastic",
        "elastic: Newton-Euler after Buondonno, De Luca",
        buondonno_de_luca.motor_torques,
        elastic=True,
    ),
    Contender("christoffel", "Lagrange by Christoffel symbols", _rigid(christoffel.torques), largest=16),
    Contender("uicker_kahn", "Lagrange by 4 x 4 matrices (Uicker, Kahn)", _rigid(uicker_kahn.torques), largest=12),
)


def arithmetic(graph: Graph) -> int:
    """Multiplications, additions, subtractions and divisions; a pair of sine and cosine a joint comes on top."""
    return sum(graph.operations.get(op, 0) for op in ("mul", "add", "sub", "div"))
