"""Laws added up: torques add, and the one motor reference among them is what all the others track."""

from dataclasses import dataclass
from typing import Any

from cutpoint.control.interface import Command, Controller, Law, Measurement, Reference, as_command
from cutpoint.errors import InputError


@dataclass(frozen=True)
class Sum(Law):
    """Torques of all parts.  Raises InputError when two parts make a motor reference."""

    parts: tuple[Any, ...]

    def __post_init__(self) -> None:
        makers = [type(p).__name__ for p in self.parts if getattr(p, "makes_motor_reference", False)]
        if len(makers) > 1:
            raise InputError(f"{' and '.join(makers)} both make a motor reference; a sum may hold one such law")

    @property
    def makes_motor_reference(self) -> bool:  # type: ignore[override]
        return any(getattr(p, "makes_motor_reference", False) for p in self.parts)

    def start(self) -> Any:
        return tuple(part.start() for part in self.parts)

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        memories, commands = [*memory], {}
        # the maker of the motor reference first, so that the others see it
        order = sorted(range(len(self.parts)), key=lambda k: not getattr(self.parts[k], "makes_motor_reference", False))
        made = Command(0)
        for k in order:
            memories[k], result = self.parts[k].step(memory[k], measurement, reference)
            commands[k] = as_command(result)
            if commands[k].theta is not None:
                made = commands[k]
                reference = reference._replace(theta=made.theta, theta_dot=made.theta_dot)
        torque = sum(c.torque for c in commands.values())
        feedforward = sum(c.feedforward for c in commands.values())
        return tuple(memories), Command(torque, feedforward, made.theta, made.theta_dot)


def parts_of(law: Controller) -> tuple[Any, ...]:
    """The parts of a sum, or the law itself."""
    return law.parts if isinstance(law, Sum) else (law,)
