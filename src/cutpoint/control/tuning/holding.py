"""Whether a law holds a robot at a pose, and what would help if it does not."""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.callers import warn
from cutpoint.control.sensors import Sensors
from cutpoint.control.stability.margins import peak_sensitivity
from cutpoint.control.stability.sampled_loop import STEADY, SampledPole, sampled_loop, slowest_of
from cutpoint.control.tuning.design import inertias
from cutpoint.errors import InputError
from cutpoint.mechanics.drives.friction import Sliding
from cutpoint.mechanics.drives.harmonic_drive import friction_torque
from cutpoint.mechanics.drives.presliding import steady_sliding
from cutpoint.robot import Robot

STOPPED = 1.0
"""Nepers a second: what grows more slowly may be left to dry friction, which the linear plant lacks."""

SWINGING = 0.1
"""rad/s (m/s) of each joint, at which dry friction must still stop it."""

TINY = float(np.finfo(float).tiny)
"""kg m2, where a joint moves no inertia."""

CREEPING = 0.05
"""Hz: what would swing more slowly does not swing."""

SHORTER = 4
"""Times that a control period is shortened to see whether that would help."""

LONG = 0.1
"""s: a control period as long may be meant in ms."""

VERY_LONG = 20.0
"""s: a control period as long may be meant in microseconds."""

FRAGILE = 10.0
"""Times that a loop amplifies disturbances at most: a torque that is 11 % larger may then make it unstable."""

CHANGES = {"width": "wider", "rate": "lower", "body_rate": "lower", "joint_rate": "lower", "shaping": "nearer to 1"}
"""What may help of what only some laws have."""

LIGHT = 0.05
"""Of a link's inertia at its joint: few rotors have less, with their motors."""


class FragileWarning(UserWarning):
    """A law holds a robot at a pose, but hardly."""


class _Answer(NamedTuple):
    """pole: the slowest.  is_held: it decays, or grows so slowly that friction stops it.  peaks: the sensitivity of
    each joint's loop, zeros if the pole grows."""

    pole: SampledPole
    is_held: bool
    peaks: Array


def check_holds(
    robot: Robot,
    law: Any,
    q: Array,
    period: float,
    sensors: Sensors | None = None,
    others: Iterable[tuple[float, Callable[[], Any]]] = (),
) -> None:
    """Raises InputError if the law cannot hold the robot at q when it acts every period (s): see `slowest_pole`.

    Warns, FragileWarning, if it does, but amplifies disturbances by more than FRAGILE.
    Poles that grow slowly are left to dry friction, if all drives have enough: see `_stopped`.
    others: bandwidths, Hz, and a function that makes a law of each, to search for a remedy.
    """
    stopped = _stopped(robot, q)

    def answer(law: Any, period: float) -> _Answer:
        loop = sampled_loop("tune", robot, law, q, period, sensors)
        pole = slowest_of(loop, period)
        # friction has no time to act within a period in which a mode grows manyfold
        is_held = pole.size <= STEADY or np.log(pole.size) / min(period, 1.0) <= stopped
        return _Answer(pole, is_held, peak_sensitivity(loop) if pole.size <= STEADY else np.zeros(len(robot.drives)))

    def would_hold(law: Any, period: float) -> bool:
        try:
            found = answer(law, period)
        except InputError:  # the period is shorter than a motor's delay
            return False
        return found.is_held and found.peaks.max() <= FRAGILE

    worst, is_held, peaks = answer(law, period)
    if is_held:
        return _warn_if_fragile(robot, law, peaks)
    growth = np.log(worst.size) / period
    moves = f"swing at {worst.frequency:.1f} Hz" if worst.frequency > CREEPING else "run away"
    what = f"{worst.joint!r} would {moves} and grow by {growth:.3g} nepers a second"
    better = next((f"{hertz:.3g} Hz" for hertz, make in others if would_hold(make(), period)), "")
    remedies = [f"a bandwidth of {better} holds" if better else "ask for another bandwidth"]
    shorter = period / (SHORTER if period < LONG else 1e3 if period < VERY_LONG else 1e6)
    if would_hold(law, shorter):
        remedies.append(f"a control_period of {shorter:.3g} s holds")
    remedies += _other_remedies(robot, law, q, worst.joint)
    told = "; ".join([f"{type(law).__name__} does not hold at this pose: {what}", *remedies])
    raise InputError(told, joint=worst.joint, pole=worst)


def _warn_if_fragile(robot: Robot, law: Any, peaks: Array) -> None:
    k = int(peaks.argmax())
    if peaks[k] > FRAGILE:
        found = f"the loop of {robot.joints[k]!r} amplifies disturbances {peaks[k]:.3g} times, 2 or 3 is usual"
        told = f"{type(law).__name__} holds at this pose, but hardly: {found}; try another bandwidth, and see margins"
        warn(f"tune: {told}", FragileWarning)


def _other_remedies(robot: Robot, law: Any, q: Array, joint: str) -> list[str]:
    """What may help besides another bandwidth or period; joint: the one that swings."""
    is_undamped = any(drive.is_elastic and not drive.damping for drive in robot.drives.values())
    changes = [f"make {name}= {change}" for name, change in CHANGES.items() if np.any(getattr(law, name, 0.0))]
    return [*["give the springs damping"] * is_undamped, *changes, *_light_rotor(robot, q, joint)]


def _light_rotor(robot: Robot, q: Array, joint: str) -> list[str]:
    """A remedy if the joint's rotor inertia is nearly zero, like that of a gear without its motor."""
    k = robot.joints.index(joint)
    link, rotor = (each[k] for each in inertias(robot, q))
    if not 0 < rotor < LIGHT * link:
        return []
    felt = f"{joint!r} has a rotor of {rotor:.2g} kg m2 at the joint, under {link:.2g} of the link"
    return [f"{felt}: a catalogue gear's is without its motor, whose inertia belongs into it"]


def _stopped(robot: Robot, q: Array) -> float:
    """Growth that the drives' dry friction stops, nepers a second, at most STOPPED.

    Each second a mode that grows by g gains g m V^2 at a joint that swings with speed V, and dry friction takes
    2 / pi of its torque times V.
    """
    dry = np.array([_dry(x.link_friction) + _dry(x.motor_friction) for x in robot.drives.values()])
    fed = np.maximum(sum(inertias(robot, q)), TINY) * SWINGING
    return float(min(STOPPED, (2 / np.pi * dry / fed).min()))


def _dry(law: Any) -> float:
    """Dry friction at SWINGING, N m; all of it, of a law of the user's own."""
    known = steady_sliding(law)
    return float(known.plateau(SWINGING) if isinstance(known, Sliding) else friction_torque(known, SWINGING))
