"""Base class of laws with a model of the robot."""

from collections.abc import Callable
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np

from cutpoint.control.gains import motor_limits, numbers_or_traced
from cutpoint.control.interface import is_traced
from cutpoint.control.law import Law
from cutpoint.definitions import Machine
from cutpoint.errors import InputError
from cutpoint.mechanics.drives.presliding import steady_sliding
from cutpoint.model.drive import Drive
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_all_driven


@dataclass(frozen=True, eq=False)
class ModelLaw(Law):
    """A law with a model: a robot all of whose coordinates have drives.

    robot: the model.  It may differ from the plant, as a real one does.
    parameters: numbers of the model's drives, its own unless given (see `Robot.drive_parameters`).
    """

    robot: Robot
    parameters: Any = field(default=None, repr=False, kw_only=True)

    def __post_init__(self) -> None:
        check_all_driven(type(self).__name__, self.robot, OF_LAWS)
        own, who = self.robot.drive_parameters, type(self).__name__
        if self.parameters is None:
            self._set(parameters=own)
            return
        rule = f"{own.size} numbers, as robot.drive_parameters"
        given = numbers_or_traced(who, "parameters", self.parameters, rule)
        if not is_traced(given):
            if given.shape != own.shape or np.isnan(given).any():
                found = f"shape {given.shape}" if given.shape != own.shape else "NaN among them"
                raise InputError(f"{who}: parameters must be {rule}, got {found}")
            self._set(parameters=given.copy())

    def _keep_torque_limit(self) -> None:
        """Stores torque_limit, by default the motor limits that robot and drives state."""
        limit: Any = getattr(self, "torque_limit", None)
        self._set(torque_limit=motor_limits(self.robot) if limit is None else limit)
        self._keep_gains("torque_limit", size=self.size, positive=("torque_limit",))

    @property
    def size(self) -> int:
        """Number of drives."""
        return len(self.robot.joints)

    @property
    def model(self) -> Machine:
        """The machine with this law's drive parameters, for quantities per joint."""
        return self.robot.machine_with(self.parameters, lean=True)


OF_LAWS = "laws only receive measurements of joints with motors; PD and PID with your own gains work without"


def check_no_full_coupling(law: str, robot: Robot, remedy: str) -> None:
    """Raises InputError if a bending drive's rotor has full coupling.  law: the caller; remedy: what to use instead."""
    for name, drive in robot.drives.items():
        if drive.is_elastic and drive.is_coupled:
            why = f"the rotor of {name!r} has full coupling, so links feel more than their springs"
            raise InputError(f"{law}: {why}; use {remedy}", joint=name)


def with_models(law: Any, model_of: Callable[[ModelLaw], Robot]) -> Any:
    """The same law and gains on other models; in sums and wrappers, each law with a model on another."""
    if isinstance(law, tuple):
        return tuple(with_models(part, model_of) for part in law)
    if not isinstance(law, Law) or not is_dataclass(law):
        return law
    found = {f.name: getattr(law, f.name) for f in fields(law)}
    changed: dict[str, Any] = {name: with_models(x, model_of) for name, x in found.items() if name in ("law", "parts")}
    if isinstance(law, ModelLaw):
        changed |= {"robot": model_of(law), "parameters": None}
    return replace(law, **changed) if changed else law


def without_springs(robot: Robot) -> Robot:
    """The same robot as laws for rigid robots see it: rigid drives, rotors as armature, friction in steady sliding."""
    return robot.with_drives({name: _without_spring(drive) for name, drive in robot.drives.items()})


def _without_spring(drive: Drive) -> Drive:
    """Its friction slides: laws do not know bristles' strains, and those that feel the load need a spring."""
    sliding = {side: steady_sliding(getattr(drive, side)) for side in ("link_friction", "motor_friction")}
    return replace(drive, compliance=None, damping=None, hysteresis=None, kinematic_error=None, **sliding)
