"""Compiled loops, kept for runs that differ in numbers only."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import replace
from typing import Any

from cutpoint.kernels import Program
from cutpoint.robot import Robot
from cutpoint.scalars import structure_of
from cutpoint.simulation.sensors import Encoders

KEPT = 16

_kept: OrderedDict[Hashable, tuple[dict[Hashable, Program], Any]] = OrderedDict()


def programs_for(
    robot: Robot,
    controller: Any,
    encoders: Encoders,
    memory: Any,
    structure: Callable[[Any], Hashable] = structure_of,
) -> dict[Hashable, Program]:
    """The programs compiled so far for loops of this structure, to be added to.

    structure: of the controller; one may know it from before.
    """
    seedless = replace(encoders, seed=0)
    key = (robot.trace_key, structure(controller), structure_of(seedless), structure_of(memory))
    # what the key names by identity must live as long as the key
    programs, owners = _kept.pop(key, ({}, (robot, controller)))
    _kept[key] = programs, owners
    if len(_kept) > KEPT:
        _kept.popitem(last=False)
    return programs
