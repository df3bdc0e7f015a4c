"""Compiled loops, reused for runs that differ in numbers only."""

from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import replace
from typing import Any

from cutpoint.control.sensors import Encoders
from cutpoint.kernels import Program
from cutpoint.robot import Robot
from cutpoint.scalars import structure_of
from cutpoint.simulation.controllers import Admitted

KEPT = 16

_kept: OrderedDict[Hashable, tuple[dict[Hashable, Program], Any]] = OrderedDict()


def programs_for(robot: Robot, law: Admitted, encoders: Encoders, memory: Any) -> dict[Hashable, Program]:
    """The programs compiled so far for loops of this structure, to be added to."""
    seedless = replace(encoders, seed=0)
    key = (robot.trace_key, law.structure, structure_of(seedless), structure_of(memory))
    # what the key names by identity must live as long as the key
    programs, owners = _kept.pop(key, ({}, (robot, law.law)))
    _kept[key] = programs, owners
    if len(_kept) > KEPT:
        _kept.popitem(last=False)
    return programs
