"""How equations with a robot's mass matrix are solved best."""

from collections.abc import Sequence

from cutpoint.mechanics.system import System
from cutpoint.rolled.equations.factored import Factored, is_sparse
from cutpoint.rolled.equations.solver import Solver
from cutpoint.rolled.equations.yielding import Yielding, takes


def solver_of(system: System, widths: Sequence[int]) -> Solver | None:
    """For right-hand sides of so many columns; None where they are better dense."""
    if is_sparse(system):
        return Solver(Factored(system), widths)
    return Solver(Yielding(system), widths) if takes(system) else None
