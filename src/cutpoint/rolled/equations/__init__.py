"""The best solver for equations with a robot's mass matrix."""

from collections.abc import Sequence

from cutpoint.mechanics.system import System
from cutpoint.rolled.equations.articulated_bodies import ArticulatedBodies
from cutpoint.rolled.equations.factored import Factored, is_sparse
from cutpoint.rolled.equations.solver import Solver


def solver_of(system: System, widths: Sequence[int]) -> Solver:
    """The best solver for right-hand sides of so many columns."""
    return Solver(Factored(system) if is_sparse(system) else ArticulatedBodies(system), widths)
