"""Which functions loop, and how."""

from collections.abc import Callable
from typing import NamedTuple

from cutpoint.rolled import elastic, forward, mass, steps
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.passes import Steps


class Recipe(NamedTuple):
    """A function as loops.

    inputs: those that are given; the others are zero.  above: how many bodies the last robot has that straight-line
    code suits.  reads_drives: whether drives have numbers in it.  odd: what its variants want that loops do not take.

    Measured on chains: in single calls loops take two thirds of the time from some 12 bodies on, in batches twice the
    time up to the size given; beyond it straight-line code takes more than 2 s to compile, or its batches are slower.
    """

    steps: Callable[[Columns], Steps]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    above: int
    reads_drives: bool = False
    odd: str = "external wrenches"


STATE = ("q", "v", "theta", "theta_dot", "motor_torque")

RECIPES = {
    "inverse_dynamics": Recipe(steps.inverse_dynamics, ("q", "v", "a"), ("tau",), 64),
    "bias_forces": Recipe(steps.inverse_dynamics, ("q", "v"), ("tau",), 64),
    "gravity_forces": Recipe(steps.inverse_dynamics, ("q",), ("tau",), 64),
    "forward_dynamics": Recipe(forward.forward_dynamics, ("q", "v", "tau"), ("a",), 32),
    "mass_matrix": Recipe(mass.mass_matrix, ("q",), ("matrix",), 24),
    "elastic_inverse_dynamics": Recipe(
        elastic.elastic_inverse_dynamics, steps.RATES, elastic.MOTOR, 24, True, "friction's rates or strains"
    ),
    "elastic_forward_dynamics": Recipe(
        elastic.elastic_forward_dynamics, STATE, ("a", "theta_ddot"), 32, True, "strains"
    ),
}

PLAIN_VARIANTS = {("elastic_inverse_dynamics", False, quasi_rigid, True) for quasi_rigid in (False, True)}
"""Keys of variants that are what the recipes say: no rates of friction, no strains; without full coupling nothing is
quasi-rigid."""
