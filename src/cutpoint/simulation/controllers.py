"""Validation of controllers: converted to laws that fit the robot, and examined before compilation."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Control, name_of
from cutpoint.control.law import Law, as_law, check_drives
from cutpoint.control.own_law import fields_read, own_parts, traced
from cutpoint.errors import TraceError
from cutpoint.robot import Robot
from cutpoint.scalars import leaves, structure_of


@dataclass(frozen=True)
class FreeResponse(Law):
    """No torque at all."""

    size: int

    def step(self, memory: Any, measurement: Any, reference: Any) -> tuple[Any, Command]:
        return memory, Command(np.zeros(self.size))


@dataclass(frozen=True, eq=False)
class Admitted:
    """A law that may control the robot.

    structure: equal for laws that one program serves.  reads: fields of a Measurement that a law needs, each with the
    law's name.  refusal: the reason if it is known that it cannot be compiled.
    """

    law: Any
    structure: Hashable
    reads: tuple[tuple[str, str], ...]
    refusal: TraceError | None


def fitting(robot: Robot, controller: Control) -> Any:
    """The controller as a law.  Raises InputError if it is not a law, or is for other drives."""
    law = as_law(controller)
    check_drives(law, robot.joints)
    return law


def admitted(robot: Robot, controller: Control | None) -> Admitted:
    """The controller (None for no torque) and its properties.

    User-written laws are traced each time, since state other than the numbers of a dataclass may have changed.
    """
    n = len(robot.drives)
    law = FreeResponse(n) if controller is None else fitting(robot, controller)
    own = {id(part): (part, traced(part, n)) for part in own_parts(law)}
    refusal = next((found.refusal for _, found in own.values() if found.refusal), None)
    structure = structure_of(law, {key: found.key for key, (_, found) in own.items()})
    if refusal:  # code compiled around a callback depends on the number of numbers
        structure = ("called back", name_of(law), len(leaves(law)))
    return Admitted(law, structure, fields_read(law, own.values()), refusal)
