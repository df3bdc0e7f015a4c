"""Laws that can be added: torques add up, and all track the one motor reference among them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any, cast

from cutpoint.control.gains import gains
from cutpoint.control.interface import (
    SENSED,
    Command,
    Controller,
    Measurement,
    Reference,
    described,
    is_own,
    name_of,
    start_of,
    stepped,
)
from cutpoint.door import check_kind, check_takes
from cutpoint.errors import InputError, counted, listed
from cutpoint.scalars import Scalar, where


class Law:
    """A law of this package: without memory unless it says so, and added to others with +.

    makes_motor_reference: whether its command holds the motors' reference.
    reports_faults: whether its command reports faults.
    jumps_at_rest: whether its torque, or memory, has no slope where errors vanish.
    """

    makes_motor_reference = False
    reports_faults = False
    jumps_at_rest = False

    def start(self) -> Any:
        """The memory before the first step: a record of numbers, () for none."""
        return ()

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        """One control period: the memory after it, and the command."""
        raise TypeError(f"{type(self).__name__} must define step(memory, measurement, reference)")

    def _set(self, **values: Any) -> None:
        """Stores the fields, after checks."""
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _keep_gains(self, *names: str, size: int | None = None, positive: tuple[str, ...] = ()) -> None:
        """Stores fields as arrays, one entry per drive: see `gains`.  positive: those that must not be zero."""
        for name in names:
            self._set(**{name: gains(type(self).__name__, name, getattr(self, name), size, name in positive)})

    def __add__(self, other: Controller) -> "Sum":
        return Sum((*parts_of(self), *parts_of(as_law(other))))

    def __radd__(self, other: Any) -> Any:
        if isinstance(other, int) and other == 0:  # sum() starts from 0
            return self
        return Sum((*parts_of(as_law(other)), *parts_of(self)))


@dataclass(frozen=True)
class FunctionLaw(Law):
    """A plain function step(memory, measurement, reference) -> (memory, command) as a law without memory."""

    function: Callable[..., Any]

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> Any:
        return self.function(memory, measurement, reference)


@dataclass(frozen=True)
class Sum(Law):
    """The sum of all parts' torques; reports the fault that came first.

    Raises InputError if two parts make a motor reference.
    """

    parts: tuple[Any, ...]

    def __post_init__(self) -> None:
        check_kind("Sum", "parts", self.parts, (tuple, list), "laws in a tuple")
        if not self.parts:
            raise InputError("Sum: it has no parts, so its number of drives is unknown; give it at least one law")
        makers = [type(part).__name__ for part in self.parts if makes_reference(part)]
        if len(makers) > 1:
            raise InputError(f"{' and '.join(makers)} both make a motor reference; a sum may hold only one such law")

    @property
    def makes_motor_reference(self) -> bool:  # type: ignore[override]
        """Whether one of its parts does."""
        return any(makes_reference(part) for part in self.parts)

    @property
    def reports_faults(self) -> bool:  # type: ignore[override]
        """Whether one of its parts does."""
        return self._reporters > 0

    @property
    def _reporters(self) -> int:
        return sum(getattr(part, "reports_faults", False) for part in self.parts)

    def start(self) -> Any:
        """The parts' memories, followed by the first fault if several parts report faults."""
        return (*map(start_of, self.parts), *([0.0] if self._reporters > 1 else []))

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        memories, made = [*memory], Command(0)
        commands: list[Command] = []
        # the law that makes the motors' reference goes first, so that the others see it
        for k in sorted(range(len(self.parts)), key=lambda k: not makes_reference(self.parts[k])):
            memories[k], command = stepped(self.parts[k], memory[k], measurement, reference)
            commands.append(command)
            if command.theta is None:
                continue
            _check_announced(self.parts[k])
            made = command if command.theta_dot is not None else command._replace(theta_dot=reference.theta_dot)
            reference = reference._replace(theta=made.theta, theta_dot=made.theta_dot)
        torque, feedforward = sum(c.torque for c in commands), sum(c.feedforward for c in commands)
        fault = reduce(_first, [*memory[len(self.parts) :], *(c.fault for c in commands)])
        if self._reporters > 1:
            memories[-1] = fault
        return tuple(memories), Command(torque, feedforward, made.theta, made.theta_dot, fault)


class Wrapper(Law):
    """A wrapper around another law, `law`, that changes its inputs or its command."""

    law: Any

    @property
    def size(self) -> int:
        """Number of drives."""
        for part in parts_of(self.law):
            if hasattr(part, "size"):
                return part.size
        raise InputError(f"{type(self).__name__}: none of its laws states its number of drives; give one a `size`")

    @property
    def needs(self) -> tuple[str, ...]:
        """Measurement fields that the law reads."""
        return needs_of(self.law)

    @property
    def makes_motor_reference(self) -> bool:  # type: ignore[override]
        """Whether the law inside does."""
        return makes_reference(self.law)

    @property
    def reports_faults(self) -> bool:  # type: ignore[override]
        """Whether the law inside does."""
        return getattr(self.law, "reports_faults", False)

    def inner_start(self) -> Any:
        return start_of(self.law)

    def inner_step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        return stepped(self.law, memory, measurement, reference)


def as_law(controller: Any) -> Any:
    """A controller, or a step function, as a law.

    Raises InputError for a class, for an object without a step, and for a step with other arguments.
    """
    if isinstance(controller, type):
        name = controller.__name__
        raise InputError(f"controller {name} is a class; pass an instance, {name}(...)")
    step = getattr(controller, "step", controller)
    if not callable(step):
        raise InputError(f"controller {described(controller)} has no step(memory, measurement, reference)")
    if is_own(controller):
        check_takes(f"controller {name_of(controller)}: step", step, "memory", "measurement", "reference")
        _check_needs(name_of(controller), getattr(controller, "needs", ()))
    return FunctionLaw(controller) if step is controller else controller


def needs_of(law: Controller) -> tuple[str, ...]:
    """Fields of a Measurement that a law declares to read; a law that declares nothing may read all."""
    return tuple(dict.fromkeys(name for part in parts_of(law) for name in getattr(part, "needs", ())))


def parts_of(law: Controller) -> tuple[Any, ...]:
    """The parts of a sum, or the law itself."""
    return law.parts if isinstance(law, Sum) else (law,)


def inner_laws(law: Any) -> tuple[Any, ...]:
    """The laws of which a sum or a wrapper is made; none of another law."""
    return law.parts if isinstance(law, Sum) else (law.law,) if isinstance(law, Wrapper) else ()


def law_in_words(law: Any) -> str:
    """A law in words, as `Guard(SpeedFilter(PD + Feedforward))`."""
    if isinstance(law, Sum):
        return " + ".join(map(law_in_words, law.parts))
    return f"{type(law).__name__}({law_in_words(law.law)})" if isinstance(law, Wrapper) else name_of(law)


def check_drives(law: Controller, joints: Sequence[str]) -> None:
    """Raises InputError if a law, or one of its parts, is for another number of drives, or models a robot with other
    joints."""
    for part in inner_laws(law):
        check_drives(part, joints)
    drives = len(joints)
    size = getattr(law, "size", drives)
    if size != drives:
        raise InputError(
            f"{name_of(law)} is for {counted(size, 'drive')}, but the robot has {drives}: make it for as many"
        )
    own = getattr(getattr(law, "robot", None), "joints", joints)
    if own != joints:
        found = f"the joints of its robot are {listed(own)}, but those of this one {listed(joints)}"
        remedy = "give both the same names in the same order"
        raise InputError(f"{name_of(law)}: {found}; {remedy}", joints=own)


def _check_announced(law: Any) -> None:
    """Raises InputError for a user's law that makes a motor reference without declaring it.

    Wrappers pass references on, and guards hold the last command.
    """
    if is_own(law) and not isinstance(law, Wrapper) and not makes_reference(law):
        rule = "in a sum, a law that commands theta must set makes_motor_reference = True"
        raise InputError(f"controller {name_of(law)}: {rule}, so that the others track it")


def _first(fault: Scalar, later: Scalar) -> Scalar:
    return where(fault > 0, fault, later)


def _check_needs(name: str, needs: Any) -> None:
    if not isinstance(needs, (tuple, list)) or any(x not in SENSED for x in cast(Any, needs)):
        rule = f"needs must be a tuple of names from {', '.join(SENSED)}"
        raise InputError(f"controller {name}: {rule}; it is {needs!r}", needs=needs)


def makes_reference(law: Any) -> bool:
    return getattr(law, "makes_motor_reference", False)
