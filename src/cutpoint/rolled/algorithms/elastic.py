"""Robots with elastic joints, as passes: rigid bodies' passes, and each drive's own step.

Some joints may have rigid drives, or none.
"""

from typing import Any

from cutpoint.drive_slopes import EFFORT_SLOPES, STATE, effort_slopes
from cutpoint.kernels import Stage
from cutpoint.mechanics.drives.harmonic_drive import DriveState, static_lead
from cutpoint.mechanics.drives.motor_motion import motor_motion, motor_torque
from cutpoint.mechanics.drives.strains import UNKNOWN
from cutpoint.mechanics.elastic_forward import drive_effort
from cutpoint.mechanics.elastic_inverse import DEFAULT, Options
from cutpoint.rolled.algorithms import coupling
from cutpoint.rolled.algorithms.base import base_in, sizes_apart
from cutpoint.rolled.algorithms.forward import forward_dynamics
from cutpoint.rolled.algorithms.inverse import inverse_dynamics
from cutpoint.rolled.algorithms.placing import RATES
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.drives import Model
from cutpoint.rolled.passes import WITH_RATES, Pass, Steps

MOTOR = ("motor_torque", "theta", "theta_dot", "theta_ddot", "joint_torque")


def elastic_inverse_dynamics(columns: Columns, options: Options = DEFAULT) -> Steps:
    """Motor torques and motor motion, from joint torques with two derivatives."""
    rigid, m = inverse_dynamics(columns, WITH_RATES), WITH_RATES.numbers

    def motor(row: Any, tau: Any, q: Any, *rates: Any) -> Any:
        (torque,), (speed,) = WITH_RATES.scalars(tau), WITH_RATES.rate(rates, 0)

        def asked(drive: Model) -> list[Any]:
            if drive is None:
                return [0] * 4
            found = motor_motion(drive, torque, q[0], speed, UNKNOWN, friction_rates=options.friction_rates)
            return [motor_torque(drive, found), *(found.theta.derivative(k) for k in range(3))]

        return *([x] for x in columns.by_drive(row, asked)), [torque.derivative(0)]

    alone = Pass("alone", Stage(motor, ("body", "tau", *RATES[:-1]), MOTOR))
    kept, apart = {**rigid.kept, "tau": m}, {**rigid.apart}
    if base := base_in(columns):
        apart["base.joint_torque"] = apart.pop("base.tau")
        rigid.passes[-1] = base.bears(WITH_RATES, "joint_torque")
    passes = [*rigid.passes, alone]
    if columns.are_coupled:
        passes = _after_inward(passes, coupling.carried(columns, WITH_RATES, RATES[1:]))
        passes += [coupling.pushed(columns, WITH_RATES)]
    return rigid._replace(kept=kept, numbers=(*RATES, *MOTOR), passes=passes, apart=apart)


def elastic_forward_dynamics(columns: Columns) -> Steps:
    """Accelerations of links and motors under motor torques.  Spong (1987)."""
    rigid, state = forward_dynamics(columns), STATE[:4]

    def drive(row: Any, motor_torque: Any, *at: Any) -> Any:
        def effort(drive: Model) -> list[Any]:
            if drive is None:
                return [0, 0]
            found = drive_effort(drive, DriveState(*(x for (x,) in at)), motor_torque[0], UNKNOWN)
            return [found.on_link, found.alpha]

        return [[x] for x in columns.by_drive(row, effort)]

    def follow(row: Any, theta_ddot: Any, a: Any) -> Any:
        return columns.by_drive(row, lambda drive: theta_ddot if drive and drive.is_elastic else a)

    passes = [Pass("alone", Stage(drive, ("body", "motor_torque", *state), ("tau", "theta_ddot"))), *rigid.passes]
    if columns.are_coupled:
        passes = [*_after_inward(passes, coupling.with_free_rotor(columns)), coupling.left_behind(columns)]
    if not all(drive and drive.is_elastic for drive in columns.models):  # a rigid drive's motor moves with its link
        passes += [Pass("alone", Stage(follow, ("body", "theta_ddot", "a"), ("theta_ddot",)))]
    numbers = (*state, "motor_torque", "a", "theta_ddot")
    return rigid._replace(kept={**rigid.kept, "tau": 1}, numbers=numbers, passes=passes)


def drive_slopes(columns: Columns) -> Steps:
    """Derivatives of drives' efforts on links and rotors by their states."""

    def slopes(row: Any, *state: Any) -> Any:
        def of(drive: Model) -> list[Any]:
            return effort_slopes(drive, [x for (x,) in state]) if drive else [0] * len(EFFORT_SLOPES)

        return [[x] for x in columns.by_drive(row, of)]

    alone = Pass("alone", Stage(slopes, ("body", *STATE), EFFORT_SLOPES))
    return Steps({}, (*STATE, *EFFORT_SLOPES), (), {}, [alone], *sizes_apart(base_in(columns), STATE[:2]))


def static_deflection(columns: Columns) -> Steps:
    """How far each motor leads its link at rest under gravity, rad."""
    rigid = inverse_dynamics(columns)

    def bends(row: Any, q: Any, tau: Any) -> Any:
        def bent(drive: Model) -> list[Any]:
            return [0 if drive is None else static_lead(drive, q[0], tau[0])]

        return columns.by_drive(row, bent)

    alone = Pass("alone", Stage(bends, ("body", "q", "tau"), ("deflection",)))
    return rigid._replace(numbers=(*rigid.numbers, "deflection"), passes=[*rigid.passes, alone])


def _after_inward(passes: list[Pass], one: Pass) -> list[Pass]:
    """Adds an inward pass, which shares the loop of the others: each body's steps precede those of its carrier."""
    last = max(k for k, p in enumerate(passes) if p.way == "inward")
    return [*passes[: last + 1], one, *passes[last + 1 :]]
