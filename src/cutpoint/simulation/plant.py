"""The plant as an ordinary differential equation: links, motors and their currents under commands held over a period.

What drives remember beside that, their strains, follows displacements: see `mechanics.strains`.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

from cutpoint.definitions import Machine
from cutpoint.mechanics import strains as memory
from cutpoint.mechanics.elastic import Driven, driving_torques, elastic_forward_dynamics, link_friction
from cutpoint.mechanics.kinematics import coordinate_rates
from cutpoint.mechanics.motor import lag_rate, shaft_torque
from cutpoint.mechanics.strains import Place, Strains
from cutpoint.scalars import Scalar, where

Scalars = list[Any]


class State(NamedTuple):
    """Links' coordinates q (nq,) and speeds v (nv,), motors' theta and theta_dot (one for each drive); rad, rad/s.

    current: torque of each motor whose current loop has a bandwidth, N m at the joint's side.  strains: what drives
    remember, rad, drive by drive; see `Robot.strain_names`.
    """

    q: Any = None
    v: Any = None
    theta: Any = None
    theta_dot: Any = None
    current: Any = None
    strains: Any = None


def sizes(machine: Machine) -> State:
    """How long each part of a state is."""
    n = len(machine.drives)
    strained = sum(memory.count(d.drive) for d in machine.drives)
    return State(machine.system.nq, machine.system.nv, n, n, sum(_lags(d) for d in machine.drives), strained)


def split(machine: Machine, x: Scalars) -> State:
    """A flat state by its parts."""
    numbers = iter(x)
    return State(*([next(numbers) for _ in range(size)] for size in sizes(machine)))


def rates(machine: Machine, x: Scalars, origin: Scalars, command: Scalars, disturbance: Scalars) -> Scalars:
    """dx/dt at x, on a way from origin without turning back.  A rigid drive's motor is carried along with its link."""
    s = split(machine, x)
    electric, torque = motor_torques(machine, s, command)
    held = strains_at(machine, s, split(machine, origin))
    a, alpha = elastic_forward_dynamics(machine.system, machine.drives, *s[:4], torque, disturbance, held)
    motor_speeds = [w if d.drive.is_elastic else s.v[d.v] for d, w in zip(machine.drives, s.theta_dot, strict=True)]
    still = [0] * len(s.strains)
    return [*coordinate_rates(machine.system, s.q, s.v), *a, *motor_speeds, *alpha, *electric, *still]


def settled(machine: Machine, x: Scalars, origin: Scalars) -> Scalars:
    """The state at the end of a way, with the strains that the way has left."""
    if not any(memory.count(d.drive) for d in machine.drives):
        return x
    s = split(machine, x)
    return [*x[: len(x) - len(s.strains)], *memory.flat(strains_at(machine, s, split(machine, origin)))]


def arrived(machine: Machine, command: Scalars, before: Scalars, elapsed: Scalar) -> Scalars:
    """The commands that have reached their current loops some time (s) after the sample: those before, until then."""
    return [
        u if d.drive.motor is None or d.drive.motor.delay is None else where(elapsed < d.drive.motor.delay, old, u)
        for d, u, old in zip(machine.drives, command, before, strict=True)
    ]


def motor_torques(machine: Machine, s: State, command: Scalars) -> tuple[Scalars, Scalars]:
    """d torque / dt of the current loops that lag, and what each motor's shaft gives, N m at the joint's side."""
    lagging = iter(s.current)
    electric, shaft = [], []
    for d, u, (theta, _) in zip(machine.drives, command, motor_states(machine, s), strict=True):
        if _lags(d):
            assert d.drive.motor is not None
            torque = next(lagging)
            electric.append(lag_rate(d.drive.motor, u, torque))
            u = torque
        shaft.append(shaft_torque(d.drive, u, theta))
    return electric, shaft


def motor_states(machine: Machine, s: State) -> list[tuple[Scalar, Scalar]]:
    """Each motor's position and speed over ratio; a rigid drive's motor is where its link is."""
    motors = zip(machine.drives, s.theta, s.theta_dot, strict=True)
    return [(theta, w) if d.drive.is_elastic else (s.q[d.q], s.v[d.v]) for d, theta, w in motors]


def strains_at(machine: Machine, s: State, origin: State) -> list[Strains]:
    """The drives' strains in a state, on a way from origin."""
    return [
        memory.moved(d.drive, before, start, end)
        for d, before, start, end in zip(
            machine.drives, strains_of(machine, origin), _places(machine, origin), _places(machine, s), strict=True
        )
    ]


def strains_of(machine: Machine, s: State) -> list[Strains]:
    """The drives' strains as a state holds them."""
    numbers: Iterator[Scalar] = iter(s.strains)
    return [memory.taken(d.drive, numbers) for d in machine.drives]


def torques_in(machine: Machine, s: State, motor_torque: Scalars) -> tuple[Scalars, Scalars]:
    """What each drive exerts on its link, and what link-side friction takes from each speed, N m."""
    held = strains_of(machine, s)
    driving = driving_torques(machine.drives, *s[:4], motor_torque, held)
    return driving, link_friction(machine.system, machine.drives, s.v, held)


def _places(machine: Machine, s: State) -> list[Place]:
    motors = zip(machine.drives, motor_states(machine, s), strict=True)
    return [Place(s.q[d.q], s.v[d.v], *motor) for d, motor in motors]


def _lags(driven: Driven) -> bool:
    return driven.drive.motor is not None and driven.drive.motor.bandwidth is not None
