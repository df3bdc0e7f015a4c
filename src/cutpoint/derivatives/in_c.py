"""Derivatives of large robots' accelerations as C: assembled as in `large`, without Python in between."""

from collections.abc import Callable
from typing import Any

import numpy as np

from cutpoint.functions.compiled import compiled_of
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.targets.c99 import Source, joined
from cutpoint.kernels.targets.c99_program import check_stack
from cutpoint.robot import Robot
from cutpoint.rolled import DERIVATIVES, RolledFunction


def forward_dynamics(robot: Robot) -> tuple[Source, Callable[..., Any]] | None:
    """The function in C, and the same on arrays (m, n) of any numbers, with the drives' parameters built in.

    None where derivatives do not run as loops.  Accelerations come from loops, so results differ in their last digits
    from those of robots that compute accelerations by straight-line code.
    Raises InputError if it takes more memory than a stack holds.
    """
    n, name = robot.nv, "forward_dynamics_derivatives"
    if not compiled_of(robot).derivatives_loop:
        return None
    solver = compiled_of(robot).solver
    motion, slopes = (RolledFunction(key, robot.machine, robot.backend) for key in ("forward_dynamics", DERIVATIVES))

    def computed(q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> tuple[np.ndarray, ...]:
        (a,) = motion.computed([q, v, tau])
        d_q, d_v, M = slopes.computed([q, v, a])
        _, *found = solver.solutions(solver.state(q, M), d_q, d_v)
        return tuple(found)

    outputs = ("d_q", "d_v", "d_tau")
    steps = motion.to_c("a"), slopes.to_c("d_q", "d_v", "M"), solver.to_c(name, ("d_q", "d_v"), outputs)
    inputs = [Port("q", (robot.nq,)), Port("v", (n,)), Port("tau", (n,))]
    source = joined(steps, inputs, [Port(x, (n, n)) for x in outputs])
    check_stack(name, source.stack)
    return source, computed
