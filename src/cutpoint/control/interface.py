"""What a controller is: a pure step from memory, measurement and reference to memory and command.

One entry a drive, in the order of `robot.joints`, all at the joint's side.  In a compiled loop the entries are traced
numbers in NumPy object arrays, so a law is written with array arithmetic; in a callback they are plain float arrays.
"""

from typing import Any, NamedTuple, Protocol

import numpy as np


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


def as_command(result: Any) -> Command:
    """A law may return bare torques."""
    return result if isinstance(result, Command) else Command(np.asarray(result))
