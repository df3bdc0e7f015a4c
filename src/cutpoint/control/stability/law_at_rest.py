"""A law that holds a robot at rest, and the response of its torque and memory to small motions there."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint import kernels
from cutpoint.arrays import Array
from cutpoint.control.interface import Measurement, Reference, name_of, start_of, stepped
from cutpoint.control.own_law import check_pure
from cutpoint.errors import InputError
from cutpoint.robot import Robot
from cutpoint.scalars import leaves, rebuild, with_float_leaves

if TYPE_CHECKING:
    from cutpoint.analysis import OperatingPoint

STEP = 1e-6
"""rad, rad/s: by which states are moved to see what the law does."""

SETTLING = 128
"""Periods that a law's memory is given to come to rest."""

NEWTON_STEPS = 3
"""Newton's steps towards rest, each of the times that they are taken."""


class _Step(NamedTuple):
    torque: Any
    memory: Any
    fault: Any


class Slopes(NamedTuple):
    """output = at_once @ input + from_memory @ memory, next memory = into_memory @ input + kept @ memory."""

    at_once: Array
    from_memory: Array
    into_memory: Array
    kept: Array

    @property
    def matter(self) -> NDArray[np.bool_]:
        """Which numbers of memory the input changes and the output feels, directly or through other numbers."""
        moved, felt = (self.into_memory != 0).any(axis=1), (self.from_memory != 0).any(axis=0)
        for _ in range(len(self.kept)):
            moved, felt = moved | (self.kept[:, moved] != 0).any(axis=1), felt | (self.kept[felt] != 0).any(axis=0)
        return moved & felt

    def of_what_matters(self) -> "Slopes":
        """Without the other numbers of memory."""
        m = self.matter
        return Slopes(self.at_once, self.from_memory[:, m], self.into_memory[m], self.kept[m][:, m])


class LawAtRest:
    """A law in equilibrium: it holds the robot at rest under its load, with constant reference and memory.

    With the pose itself as reference it would not carry the load, and integrators would wind up to their limits.
    point: at rest.  period: s.

    Raises:
        InputError: the law reports a fault there.
        TraceError: the law is a user's own, and cannot be compiled.
    """

    def __init__(self, robot: Robot, law: Any, point: "OperatingPoint", period: float) -> None:
        check_pure(law, len(robot.drives))
        start = with_float_leaves(start_of(law))
        self._step, self._time = _step_kernel(robot, law, start), 0.0
        self._numbers = np.array([*leaves(law), period], float)
        driven = [d.q for d in robot.machine.drives]
        self._seen = np.array([point.q[driven], 0 * point.theta, point.theta, 0 * point.theta])
        self._shift: Array = 0 * point.theta
        self.memory = np.array(leaves(start), float)
        self._balance(point.motor_torque, np.zeros(self.memory.size, bool))
        for k in range(1, SETTLING + 1):
            self.memory = self.response(0 * self._seen, self.memory)[1]
            self._time += period
            if k.bit_count() == 1:  # often at first, since a law changes most during its first samples
                self._balance(point.motor_torque, self.slopes().matter)
        around = (np.full_like(self._seen, x) for x in (0.0, STEP, -STEP))  # on a limit, one side is beyond it
        fault = max(self._answer(moved, self.memory, self._shift)[2] for moved in around)
        if fault > 0:
            rule = f"reports fault {fault:g} (see `control.Fault`) at rest at this pose, and then holds nothing"
            raise InputError(f"{name_of(law)} {rule}: choose a pose within its limits", q=point.q)

    def response(self, moved: Array, memory: Array) -> tuple[Array, Array]:
        """Torque and next memory, with q, v, theta and theta_dot moved by (4, n) from rest."""
        return self._answer(moved, memory, self._shift)[:2]

    def _answer(self, moved: Array, memory: Array, shift: Array) -> tuple[Array, Array, float]:
        asked = self._seen[[0, 2]] + shift
        return self._step(*(self._seen + moved), *asked, self._time, memory, self._numbers)

    def slopes(self) -> Slopes:
        """Of torque with respect to measured q, v, theta and theta_dot (4 n,)."""
        at_rest = 0 * self._seen
        of_seen = differences(lambda x: self.response(x.reshape(at_rest.shape), self.memory), at_rest.ravel())
        of_memory = differences(lambda m: self.response(at_rest, m), self.memory)
        return Slopes(of_seen[0], of_memory[0], of_seen[1], of_memory[1])

    def _balance(self, load: Array, free: NDArray[np.bool_]) -> None:
        """The smallest change of reference and free memory for which torque equals the load, N m, and that memory stays
        constant; Newton's method."""
        n, at_rest = len(load), 0 * self._seen

        def answer(x: Array) -> tuple[Array, Array]:
            memory = self.memory.copy()
            memory[free] = x[n:]
            torque, after, _ = self._answer(at_rest, memory, x[:n])
            return torque - load, after[free] - memory[free]

        x: Array = np.concatenate([self._shift, self.memory[free]])
        for _ in range(NEWTON_STEPS):
            slopes, off = np.vstack(differences(answer, x)), np.concatenate(answer(x))
            if not (np.isfinite(slopes).all() and np.isfinite(off).all()):
                return
            x = x - np.asarray(np.linalg.lstsq(slopes, off, rcond=None)[0], np.float64)
        self._shift, self.memory[free] = x[:n], x[n:]


def _step_kernel(robot: Robot, law: Any, start: Any) -> Any:
    """A law's step as a kernel: q, v, theta, theta_dot, reference pose, time, memory, own numbers with the period."""
    n = len(robot.drives)

    def step(
        q: Any, v: Any, theta: Any, theta_dot: Any, asked_q: Any, asked_theta: Any, time: Any, memory: Any, numbers: Any
    ) -> Any:
        rest = iter(numbers)
        own, period = rebuild(law, rest), next(rest)
        seen = Measurement(time, period, *(np.array(x) for x in (q, v, theta, theta_dot)))
        still = np.zeros(n)
        reference = Reference(np.array(asked_q), still, still, still, still, np.array(asked_theta), still)
        after, command = stepped(own, rebuild(start, iter(memory)), seen, reference)
        return _Step([*np.broadcast_to(command.torque, n)], leaves(with_float_leaves(after)), command.fault)

    sizes = dict.fromkeys(("q", "v", "theta", "theta_dot", "asked_q", "asked_theta"), n)
    counts = {"memory": len(leaves(start)), "numbers": len(leaves(law)) + 1}
    return kernels.compile(step, name="law", backend=robot.backend, **sizes, time=(), **counts)


def differences(function: Any, at: Array) -> tuple[Array, Array]:
    """Central differences of both results with respect to each number of `at`, one column each."""
    columns: list[tuple[Array, Array]] = []
    for k in range(len(at)):
        move = np.zeros(len(at))
        move[k] = STEP * max(1.0, abs(at[k]))
        ahead, behind = function(at + move), function(at - move)
        columns.append(tuple((a - b) / (2 * move[k]) for a, b in zip(ahead, behind, strict=True)))
    if not columns:
        torque, memory = function(at)
        return np.zeros((len(torque), 0)), np.zeros((len(memory), 0))
    return np.stack([c[0] for c in columns], axis=1), np.stack([c[1] for c in columns], axis=1)
