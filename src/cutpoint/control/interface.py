"""What a controller is: a pure step from memory, measurement and reference to memory and command.

One entry a drive, in the order of `robot.joints`, all at the joint's side.  In a compiled loop the entries are traced
numbers in NumPy object arrays, so a law is written with array arithmetic; in a callback they are plain float arrays.
"""

from typing import Any, NamedTuple, Protocol

import numpy as np

from cutpoint.errors import InputError


class Measurement(NamedTuple):
    """What the sensors tell: time and control period (s); link q, v and motor theta, theta_dot (rad, rad/s)."""

    time: Any
    period: Any
    q: Any
    v: Any
    theta: Any
    theta_dot: Any


class Reference(NamedTuple):
    """What the links shall do, with four derivatives, and the motors: theta is q until a feedforward says better."""

    q: Any
    v: Any
    a: Any
    jerk: Any
    snap: Any
    theta: Any
    theta_dot: Any


class Command(NamedTuple):
    """Motor torque (N m), of which `feedforward` needed no measurement; a motor reference, where the law makes one.

    fault: what a guard has found, see `control.Fault`; 0 is nothing.
    """

    torque: Any
    feedforward: Any = 0
    theta: Any = None
    theta_dot: Any = None
    fault: Any = 0


class Controller(Protocol):
    """A law.  Numbers in a dataclass's fields are inputs of the compiled loop; `start` gives its memory, any record."""

    def start(self) -> Any: ...
    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Any]: ...


def stepped(law: Controller, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
    """Memory and command after a law's step.

    Raises:
        InputError: the step returns anything but (memory, command), or a command that is not one number a drive, or
            one for all.
    """
    result: Any = law.step(memory, measurement, reference)
    if not isinstance(result, (tuple, list)) or len(result) != 2:
        raise InputError(f"controller {name_of(law)}: step must return (memory, command), not {_described(result)}")
    # a law may return bare torques
    command = result[1] if isinstance(result[1], Command) else Command(np.asarray(result[1]))
    n = len(measurement.q)
    for name in ("torque", "feedforward", "theta", "theta_dot"):
        part = getattr(command, name)
        if not (_is_one_each(part, n) or (part is None and name.startswith("theta"))):
            rule = f"step must return (memory, command) whose {name} is {n} numbers, one a drive, or one for all"
            raise InputError(f"controller {name_of(law)}: {rule}; it is {_described(part)}")
    return result[0], command


def name_of(law: Any) -> str:
    """A law's class, or the name of the function that it is."""
    function = getattr(law, "function", law)
    return getattr(function, "__name__", type(function).__name__)


def _is_one_each(part: Any, n: int) -> bool:
    """Whether it is one number for all drives, or one each; numbers may be traced."""
    array = np.asarray(part)
    traced = array.dtype == object and all(hasattr(type(x), "__neg__") for x in array.flat)
    return (traced or array.dtype.kind in "biuf") and array.shape in ((), (n,))


def _described(thing: Any) -> str:
    if isinstance(thing, (tuple, list)):
        return f"a {type(thing).__name__} of {len(thing)}"
    array = np.asarray(thing)
    return f"an array of shape {array.shape} of {array.dtype}" if array.ndim else repr(array.item())
