"""Robots whose joints bend, as passes: rigid bodies' passes, and what each drive does alone.

Every joint has an elastic drive, all of one structure, and rotors with reduced coupling.
"""

from typing import Any

from cutpoint.kernels import Stage
from cutpoint.mechanics.elastic import DEFAULT, Driven, motor_motion, motor_torque
from cutpoint.mechanics.elastic_forward import DriveState, drive_effort
from cutpoint.mechanics.strains import UNKNOWN
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.forward import forward_dynamics
from cutpoint.rolled.passes import WITH_RATES, Pass, Steps
from cutpoint.rolled.steps import RATES, inverse_dynamics

MOTOR = ("motor_torque", "theta", "theta_dot", "theta_ddot", "joint_torque")


def elastic_inverse_dynamics(columns: Columns) -> Steps:
    """Motor torques and motor motion, from joint torques with two derivatives."""
    rigid, m = inverse_dynamics(columns, WITH_RATES), WITH_RATES.coefficients

    def motor(row: Any, tau: Any, q: Any, *rates: Any) -> Any:
        (torque,), (speed,) = WITH_RATES.scalars(tau), WITH_RATES.rate(rates, 0)
        driven = Driven(columns.drive(row), 0, 0, 0)
        found = motor_motion(driven, torque, q[0], speed, DEFAULT, UNKNOWN)
        theta = [[found.theta.derivative(k)] for k in range(3)]
        return [motor_torque(driven, found, None, [], None)], *theta, [torque.derivative(0)]

    alone = Pass("alone", Stage(motor, ("body", "tau", *RATES[:-1]), MOTOR))
    kept = {**rigid.kept, "tau": m}
    return rigid._replace(kept=kept, numbers=(*RATES, *MOTOR), passes=[*rigid.passes, alone])


def elastic_forward_dynamics(columns: Columns) -> Steps:
    """Accelerations of links and motors under motor torques.  Spong (1987)."""
    rigid, state = forward_dynamics(columns), ("q", "v", "theta", "theta_dot")

    def drive(row: Any, motor_torque: Any, *at: Any) -> Any:
        effort = drive_effort(columns.drive(row), DriveState(*(x for (x,) in at)), motor_torque[0], UNKNOWN)
        return [effort.on_link], [effort.alpha]

    alone = Pass("alone", Stage(drive, ("body", "motor_torque", *state), ("tau", "theta_ddot")))
    numbers = (*state, "motor_torque", "a", "theta_ddot")
    return rigid._replace(kept={**rigid.kept, "tau": 1}, numbers=numbers, passes=[alone, *rigid.passes])
