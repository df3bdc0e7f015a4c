"""The plant as an ordinary differential equation: links, motors and their currents under commands held over a period.

The drives' internal strains follow displacements instead: see `mechanics.drives.strains`.
"""

from typing import Any, NamedTuple

from cutpoint.definitions import Machine
from cutpoint.mechanics.drives import strains as memory
from cutpoint.mechanics.drives.harmonic_drive import DriveState, rigidly_transmitted
from cutpoint.mechanics.drives.motor import lag_rate, shaft_torque
from cutpoint.mechanics.drives.presliding import sliding_of
from cutpoint.mechanics.drives.strains import Strains
from cutpoint.mechanics.elastic_forward import DriveEffort, drive_effort
from cutpoint.mechanics.kinematics import coordinate_rates, of_unit_length
from cutpoint.model.drive import Drive
from cutpoint.scalars import Scalar, clip, structure_of

Scalars = list[Any]


class State(NamedTuple):
    """Links' coordinates q (nq,) and speeds v (nv,), motors' theta and theta_dot (one for each drive); rad, rad/s.

    current: torque of each motor whose current loop has a bandwidth, N m at the joint's side.  strains: internal
    states of drives, rad; see `Robot.strain_names`.
    """

    q: Any = None
    v: Any = None
    theta: Any = None
    theta_dot: Any = None
    current: Any = None
    strains: Any = None


class Own(NamedTuple):
    """One drive's part of a state; a rigid drive's motor is where its link is."""

    at: DriveState
    current: Scalars
    strains: Strains


class Lengths(NamedTuple):
    """Length of each part of a `State`."""

    q: int
    v: int
    theta: int
    theta_dot: int
    current: int
    strains: int


def lengths(machine: Machine) -> Lengths:
    """Of a robot's state."""
    n = len(machine.drives)
    lagging, strained = (sum(count(d.drive) for d in machine.drives) for count in (currents, memory.count))
    return Lengths(machine.system.nq, machine.system.nv, n, n, lagging, strained)


def currents(drive: Drive) -> int:
    """The number of a drive's current states."""
    return int(drive.has_current_lag)


def split(machine: Machine, x: Scalars) -> State:
    """A flat state by its parts."""
    numbers = iter(x)
    return State(*([next(numbers) for _ in range(size)] for size in lengths(machine)))


def by_drive(machine: Machine, x: Scalars) -> list[Own]:
    """A flat state drive by drive."""
    s = split(machine, x)
    electric = memory.dealt([currents(d.drive) for d in machine.drives], s.current)
    strains = memory.dealt([memory.count(d.drive) for d in machine.drives], s.strains)
    return [
        own_of(d.drive, [s.q[d.q], s.v[d.v], s.theta[k], s.theta_dot[k], *electric[k], *strains[k]])
        for k, d in enumerate(machine.drives)
    ]


def own_of(drive: Drive, numbers: Scalars) -> Own:
    """One drive's part of a state from its numbers: q, v, theta, theta_dot, then current and strains if it has any."""
    q, v, theta, theta_dot, *rest = numbers
    at = DriveState(q, v, theta, theta_dot) if drive.is_elastic else DriveState(q, v, q, v)
    cut = currents(drive)
    return Own(at, rest[:cut], memory.taken(drive, iter(rest[cut:])))


def is_uniform(machine: Machine) -> bool:
    """Whether every coordinate has a drive and all drives have the same structure: then a state is lanes of drives."""
    n, system = len(machine.drives), machine.system
    in_order = n == system.nq == system.nv and all(d.q == d.v == k for k, d in enumerate(machine.drives))
    return n > 0 and in_order and len({structure_of(d.drive) for d in machine.drives}) == 1


def drive_rates(drive: Drive, own: Own, past: Own, command: Scalar) -> tuple[DriveEffort, Scalars]:
    """A drive's effort under a command that has arrived, and d current / dt; on a path from past without reversals."""
    shaft, electric = shaft_and_current(drive, own, command)
    return drive_effort(drive, own.at, shaft, memory.moved(drive, past.strains, past.at, own.at)), electric


def shaft_and_current(drive: Drive, own: Own, command: Scalar) -> tuple[Scalar, Scalars]:
    """The motor's shaft torque, N m at the joint's side, and d current / dt if the current loop lags."""
    if not own.current:
        return shaft_torque(drive, command, own.at.theta), []
    assert drive.motor is not None
    rate = lag_rate(drive.motor, command, own.current[0])
    return shaft_torque(drive, own.current[0], own.at.theta), [rate]


def rigid_load(drive: Drive, own: Own, command: Scalar) -> Scalar:
    """Torque through a rigid drive under a command, N m, if its friction depends on load; otherwise 0."""
    law = sliding_of(drive.motor_friction)
    if drive.is_elastic or law is None or law.per_load is None:
        return 0
    return rigidly_transmitted(drive, shaft_and_current(drive, own, command)[0], own.at.v, own.strains.motor)


def arrived(drive: Drive, command: Scalar, before: Scalar, middle: Scalar, length: Scalar) -> Scalar:
    """The command at the current loop, averaged over a time of this length (s) about `middle`, s after the sample.

    The previous sample's command applies until the delay has passed.
    """
    if drive.motor is None or drive.motor.delay is None:
        return command
    share = clip((middle - drive.motor.delay) / length + 1 / 2, 0, 1)
    return before + share * (command - before)


def own_rates(drive: Drive, numbers: Scalars, a: Scalar, alpha: Scalar, electric: Scalar) -> Scalars:
    """d numbers / dt of one drive's part of a state, on a joint whose coordinate's rate is its speed."""
    own = own_of(drive, numbers)
    changing = [own.at.v, a, own.at.theta_dot, alpha, *([electric] if own.current else [])]
    return changing + [0] * (len(numbers) - len(changing))


def all_rates(machine: Machine, s: State, a: Scalars, alpha: Scalars, electric: Scalars) -> Scalars:
    """dx/dt without strains.  A rigid drive's motor is carried along with its link."""
    system, drives = machine
    motor_speeds = [w if d.drive.is_elastic else s.v[d.v] for d, w in zip(drives, s.theta_dot, strict=True)]
    return [*coordinate_rates(system, s.q, s.v), *a, *motor_speeds, *alpha, *electric]


def settled(machine: Machine, x: Scalars, origin: Scalars) -> Scalars:
    """The state at the end of a path without reversals, with its strains updated.

    Quaternions are normalised.
    """
    parts = zip(machine.drives, by_drive(machine, x), by_drive(machine, origin), strict=True)
    strains = [memory.flat(memory.moved(d.drive, past.strains, past.at, own.at)) for d, own, past in parts]
    count, nq = sum(map(len, strains)), machine.system.nq
    q = of_unit_length(machine.system, x[:nq])
    return [*q, *x[nq : len(x) - count], *memory.gathered(strains)]
