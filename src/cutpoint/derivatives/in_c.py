"""Derivatives of large robots' accelerations as C: put together as `large` does it, without Python between."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cutpoint.functions.compiled import compiled_of
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.targets.c99 import Source, joined
from cutpoint.kernels.targets.c99_program import check_stack
from cutpoint.robot import Robot
from cutpoint.rolled import DERIVATIVES, RolledFunction

Array = np.ndarray


class InC(NamedTuple):
    """A function in C, and the same on arrays (m, n), for whatever numbers."""

    source: Source
    computed: Callable[..., tuple[Array, ...]]


def forward_dynamics(robot: Robot) -> InC | None:
    """Where derivatives run as loops, and the mass matrix' factors are sparse; the drives' numbers are folded in.

    Raises InputError: it takes more memory than a stack holds.
    """
    n, name = robot.nv, "forward_dynamics_derivatives"
    if not compiled_of(robot).derivatives_loop or not (solver := compiled_of(robot).solver(n, n)):
        return None
    motion, slopes = (RolledFunction(key, robot.machine, robot.backend) for key in ("forward_dynamics", DERIVATIVES))

    def computed(q: Array, v: Array, tau: Array) -> tuple[Array, ...]:
        (a,) = motion.computed([q, v, tau])
        d_q, d_v, M = slopes.computed([q, v, a])
        _, *found = solver.solutions(M, d_q, d_v)
        return tuple(found)

    steps = motion.to_c("a"), slopes.to_c("d_q", "d_v", "M"), solver.to_c("M", ("d_q", "d_v"), ("d_q", "d_v", "d_tau"))
    inputs = [Port("q", (robot.nq,)), Port("v", (n,)), Port("tau", (n,))]
    source = joined(steps, inputs, [Port(x, (n, n)) for x in ("d_q", "d_v", "d_tau")])
    check_stack(name, source.stack)
    return InC(source, computed)
