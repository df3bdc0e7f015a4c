"""Recipes of functions that run as loops."""

from collections.abc import Callable, Mapping
from functools import partial
from itertools import product
from math import inf
from typing import Any, NamedTuple, get_args

from cutpoint.drive_slopes import EFFORT_SLOPES, STATE
from cutpoint.mechanics.elastic_inverse import DEFAULT, Options
from cutpoint.mechanics.kinematics import ExpressedIn
from cutpoint.rolled.algorithms import derivatives, elastic, forward, inverse, kinematics, mass, regressor, totals
from cutpoint.rolled.algorithms.placing import RATES
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.passes import Steps


class Recipe(NamedTuple):
    """A function as loops.

    inputs: those that are given; the others are zero.  most_bodies: the most bodies, of the robot or of the chain that
    carries the frame, for which straight-line code is used.  pairs: the most pairs of a body and a speed that moves
    it, where the code grows with these, or where only chains are faster as loops.  reads_drives: whether it uses
    drives' numbers.
    unsupported_inputs: those of its variants that loops do not support.  takes_coupled, takes_geared: whether it
    supports rotors with full coupling, behind springs or geared rigidly; takes_base: also with a floating base.
    is_rooted: whether it computes each tree about its first joint.  reads_user_axes: whether it uses the bodies'
    frames as users know them.

    Measured on chains of 12 to 128 joints and on humanoids of 29 to 101: up to these sizes straight-line code compiles
    in some 2 s, at most 5, takes half to all of the loops' time in batches and, except on chains, half to all of it in
    single calls.  Derivatives are faster as loops from some ten bodies on, with springs from seven on; those of forward
    dynamics, which have no loops of their own, are not, up to these sizes.
    """

    steps: Callable[[Columns], Steps]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    most_bodies: int
    reads_drives: bool = False
    unsupported_inputs: str = "external wrenches"
    takes_coupled: bool = False
    takes_geared: bool = True
    takes_base: bool = True
    is_rooted: bool = False
    pairs: float = inf
    reads_user_axes: bool = False


def _elastic_inverse(options: Options) -> Recipe:
    passes = partial(elastic.elastic_inverse_dynamics, options=options)
    return Recipe(
        passes,
        RATES,
        elastic.MOTOR,
        32,
        reads_drives=True,
        unsupported_inputs="strains",
        takes_coupled=options.quasi_rigid,
    )


def _elastic_derivatives(options: Options) -> Recipe:
    passes = partial(derivatives.elastic_inverse_dynamics, options=options)
    return Recipe(
        passes, RATES, derivatives.OF_MOTORS, 8, reads_drives=True, takes_geared=False, takes_base=False, is_rooted=True
    )


DERIVATIVES = "inverse_dynamics_derivatives"
"""Of rigid dynamics; those of forward dynamics follow from them."""

RECIPES: Mapping[Any, Recipe] = {
    "inverse_dynamics": Recipe(inverse.inverse_dynamics, ("q", "v", "a"), ("tau",), 96, pairs=1700),
    "bias_forces": Recipe(inverse.inverse_dynamics, ("q", "v"), ("tau",), 96, pairs=1700),
    "gravity_forces": Recipe(inverse.inverse_dynamics, ("q",), ("tau",), 96),
    "forward_dynamics": Recipe(forward.forward_dynamics, ("q", "v", "tau"), ("a",), 128, pairs=1000),
    "mass_matrix": Recipe(mass.mass_matrix, ("q",), ("matrix",), 128, pairs=500, is_rooted=True),
    DERIVATIVES: Recipe(
        derivatives.inverse_dynamics,
        ("q", "v", "a"),
        derivatives.MATRICES,
        24,
        pairs=120,
        takes_geared=False,
        is_rooted=True,
    ),
    "coriolis_matrix": Recipe(
        derivatives.coriolis_matrix,
        ("q", "v"),
        ("C",),
        24,
        pairs=120,
        takes_geared=False,
        is_rooted=True,
    ),
    **{
        ("elastic_inverse_dynamics_derivatives", Options(*choice)): _elastic_derivatives(Options(*choice))
        for choice in product((False, True), repeat=2)
    },
    "regressor": Recipe(
        regressor.torque_regressor,
        ("q", "v", "a"),
        ("Y",),
        48,
        pairs=160,
        is_rooted=True,
        reads_user_axes=True,
    ),
    ("frame_pose",): Recipe(kinematics.frame_pose, ("q",), ("placement",), 64),
    "kinetic_energy": Recipe(totals.kinetic_energy, ("q", "v"), ("total",), 64),
    "potential_energy": Recipe(totals.potential_energy, ("q",), ("total",), 64),
    "momentum": Recipe(totals.momentum, ("q", "v"), ("total",), 64),
    **{
        ("jacobian", way): Recipe(partial(kinematics.jacobian, expressed_in=way), ("q",), ("column",), 128)
        for way in get_args(ExpressedIn)
    },
    **{
        ("frame_acceleration", way): Recipe(
            partial(kinematics.frame_acceleration, expressed_in=way), RATES[:3], ("frame_acceleration",), 48
        )
        for way in get_args(ExpressedIn)
    },
    **{
        ("elastic_inverse_dynamics", *choice, True): _elastic_inverse(Options(*choice))
        for choice in product((False, True), repeat=2)
    },
    "elastic_inverse_dynamics": _elastic_inverse(DEFAULT),
    "static_deflection": Recipe(
        elastic.static_deflection, ("q",), ("deflection",), 64, reads_drives=True, takes_coupled=True
    ),
    "elastic_forward_dynamics": Recipe(
        elastic.elastic_forward_dynamics,
        STATE,
        ("a", "theta_ddot"),
        128,
        reads_drives=True,
        unsupported_inputs="strains",
        takes_coupled=True,
        pairs=1000,
    ),
    "drive_slopes": Recipe(elastic.drive_slopes, STATE, EFFORT_SLOPES, 12, reads_drives=True),
}
"""By name, or by a key that begins with it."""

OF_DRIVES = ("theta", "theta_dot", "theta_ddot", "motor_torque", "deflection", *EFFORT_SLOPES)
"""Inputs and outputs with a number for each drive."""

OF_FRAMES = ("frame_pose", "jacobian", "frame_acceleration")
"""Functions whose keys say a frame after the name."""
