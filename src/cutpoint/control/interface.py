"""What a controller is: a pure step from memory, measurement and reference to memory and command.

One entry per drive, in the order of `robot.joints`, all at the joint's side.  In a compiled loop the entries are traced
numbers in NumPy object arrays, so a law is written with array arithmetic; in a callback they are plain float arrays.
"""

from collections.abc import Callable
from inspect import signature
from traceback import walk_tb
from typing import Any, NamedTuple, NoReturn, Protocol

import numpy as np

from cutpoint.callers import is_ours
from cutpoint.errors import InputError, TraceError
from cutpoint.scalars import is_of_cutpoint, leaves, with_float_leaves


class Measurement(NamedTuple):
    """Sensor readings: time and control period (s); link q, v and motor theta, theta_dot (rad, rad/s), each (n,).

    One entry per drive, all at the joint's side; NaN where there is no encoder.
    """

    time: Any
    period: Any
    q: Any
    v: Any
    theta: Any
    theta_dot: Any


SENSED = Measurement._fields[2:]
"""What sensors tell of joints: q, v, theta, theta_dot."""


class Reference(NamedTuple):
    """Desired motion of the links, with four derivatives, and of the motors: theta equals q unless a law changes it.

    Each (n,), one entry per drive, all at the joint's side: rad, rad/s, ..., rad/s4 (m, m/s, ...).
    """

    q: Any
    v: Any
    a: Any
    jerk: Any
    snap: Any
    theta: Any
    theta_dot: Any


class Command(NamedTuple):
    """Motor torque (N m), its part `feedforward` that needs no measurement, and a motor reference if the law makes one.

    Each (n,), one entry per drive, or one number for all; at the joint's side.  theta, theta_dot: rad, rad/s, or None.
    fault: a guard's finding, see `control.Fault`; 0 is none.
    """

    torque: Any
    feedforward: Any = 0
    theta: Any = None
    theta_dot: Any = None
    fault: Any = 0


class Controller(Protocol):
    """A control law.  Numbers in a dataclass's fields are inputs of the compiled loop.

    A law with memory also has `start()`, which gives the memory before the first step: any record of numbers.
    """

    def step(self, memory: Any, measurement: Measurement, reference: Reference, /) -> tuple[Any, Any]:
        """One control period: the memory after it, and the command."""
        ...


StepFunction = Callable[[Any, Measurement, Reference], tuple[Any, Any]]
"""A law that is nothing but its step."""

Control = Controller | StepFunction
"""What users give as a law."""


def stepped(law: Controller, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
    """Memory and command after a law's step.

    Raises:
        InputError: the step returns anything but (memory, command), or a command that is not one number per drive, or
            one for all.
        TraceError: a user's law cannot run its step on traced numbers.
    """
    result: Any = _returned(law, memory, measurement, reference)
    if not isinstance(result, (tuple, list)) or len(result) != 2:
        raise InputError(f"controller {name_of(law)}: step must return (memory, command), not {described(result)}")
    # a law may return bare torques
    command = result[1] if isinstance(result[1], Command) else Command(np.asarray(result[1]))
    n = len(measurement.q)
    for name in ("torque", "feedforward", "theta", "theta_dot"):
        part = getattr(command, name)
        if not (_is_one_each(part, n) or (part is None and name.startswith("theta"))):
            rule = f"step must return (memory, command) whose {name} is {n} numbers, one per drive, or one for all"
            raise InputError(f"controller {name_of(law)}: {rule}; it is {described(part)}")
    if np.shape(command.fault):
        rule = "step must return a command whose fault is one number, 0 for none"
        raise InputError(f"controller {name_of(law)}: {rule}; it is {described(command.fault)}")
    return result[0], command


def completed(command: Command, reference: Reference, n: int) -> Command:
    """The command with a list of n numbers in each part; a missing motor reference is taken from the reference."""
    theta = reference.theta if command.theta is None else command.theta
    theta_dot = reference.theta_dot if command.theta_dot is None else command.theta_dot
    parts = [[*np.broadcast_to(x, n)] for x in (command.torque, command.feedforward, theta, theta_dot)]
    return Command(*parts, fault=command.fault)


def start_of(law: Any) -> Any:
    """A law's memory before its first step; () if it has no `start`.

    Raises InputError for a `start` that takes arguments, or returns anything but numbers.
    """
    if not hasattr(law, "start"):
        return ()
    try:
        signature(law.start).bind()
    except TypeError as error:
        raise InputError(f"controller {name_of(law)}: start() must take no arguments: {error}") from None
    memory = law.start()
    try:
        np.array(leaves(with_float_leaves(memory)), float)
    except (TypeError, ValueError) as error:
        raise InputError(f"controller {name_of(law)}: start() must return real numbers: {error}") from None
    return memory


def numbers_after(law: Any, memory: Any, count: int) -> list[Any]:
    """The numbers of a memory that a step returned.  Raises InputError if start() did not give as many."""
    numbers = leaves(with_float_leaves(memory))
    if len(numbers) != count:
        rule = f"step must return as many numbers of memory as start() gave, {count}"
        raise InputError(f"controller {name_of(law)}: {rule}; it returned {len(numbers)}")
    return numbers


def is_own(law: Any) -> bool:
    """Whether a law is a user's own, not one of this package."""
    return not is_of_cutpoint(law) or hasattr(law, "function")


def name_of(law: Any) -> str:
    """The name of a law's class, or of its function."""
    function = getattr(law, "function", law) if is_of_cutpoint(law) else law
    return getattr(function, "__name__", type(function).__name__)


def _returned(law: Controller, memory: Any, measurement: Measurement, reference: Reference) -> Any:
    """What a step returns; an error in it is reported together with the step's arguments."""
    try:
        return law.step(memory, measurement, reference)
    except TraceError:
        raise
    except (TypeError, ValueError, AttributeError, LookupError) as error:
        if is_own(law) and np.asarray(measurement.q).dtype == object:
            _refuse_traced(law, error)
        if isinstance(error, AttributeError) and isinstance(error.obj, Measurement | Reference):
            error.add_note(f"a {type(error.obj).__name__} has {', '.join(error.obj._fields)}")
        elif isinstance(memory, tuple) and not memory:
            told = f"{name_of(law)} has no start(), so its step was given the memory ()"
            error.add_note(f"{told}: a law with memory is a class whose start() returns it before the first step")
        raise


def _refuse_traced(law: Controller, error: Exception) -> NoReturn:
    """Raises a TraceError that says where a step failed, and what to write instead."""
    told = f"step of {name_of(law)} fails with traced numbers, {type(error).__name__}: {error}"
    if "Cannot cast ufunc" in str(error):
        told += "; +=, -=, *= and /= write traced numbers into an array of floats: write x = x + y"
    if isinstance(error, InputError):
        told += (
            "; methods of a Robot take plain numbers only, functions of cutpoint.definitions with robot.machine these"
        )
    places = walk_tb(error.__traceback__)
    users = [f"{frame.f_code.co_filename}:{line}" for frame, line in places if not is_ours(frame)]
    raise TraceError(told, place=users[-1] if users else None) from error


def is_traced(array: Any) -> bool:
    """Whether an array holds numbers that are not NumPy's, such as traced ones, and neither text nor None."""
    return array.dtype == object and all(hasattr(type(x), "__neg__") for x in array.flat)


def _is_one_each(part: Any, n: int) -> bool:
    """Whether a part is one number for all drives, or one for each; numbers may be traced."""
    array = np.asarray(part)
    return (is_traced(array) or array.dtype.kind in "biuf") and array.shape in ((), (n,))


def described(thing: Any) -> str:
    """A short description of an object, for error messages."""
    if isinstance(thing, (tuple, list)):
        return f"a {type(thing).__name__} of {len(thing)}"
    array = np.asarray(thing)
    return f"an array of shape {array.shape} of {array.dtype}" if array.ndim else repr(array.item())
