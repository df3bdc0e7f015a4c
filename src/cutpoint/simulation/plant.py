"""The plant as an ordinary differential equation: links and motors under motor torques held over a control period."""

from typing import Any, NamedTuple

from cutpoint.definitions import Machine
from cutpoint.mechanics.elastic import elastic_forward_dynamics
from cutpoint.mechanics.kinematics import coordinate_rates
from cutpoint.scalars import Scalar


class State(NamedTuple):
    """Links' coordinates q (nq,) and speeds v (nv,), motors' theta and theta_dot (one for each drive); rad, rad/s."""

    q: Any = None
    v: Any = None
    theta: Any = None
    theta_dot: Any = None


def split(machine: Machine, x: list[Scalar]) -> State:
    """A flat state by its parts."""
    nq, nv, nd = machine.system.nq, machine.system.nv, len(machine.drives)
    return State(x[:nq], x[nq : nq + nv], x[nq + nv : nq + nv + nd], x[nq + nv + nd :])


def rates(machine: Machine, x: list[Scalar], motor_torque: list[Scalar], disturbance: list[Scalar]) -> list[Scalar]:
    """dx/dt.  A rigid drive's motor is carried along with its link."""
    s = split(machine, x)
    a, alpha = elastic_forward_dynamics(machine.system, machine.drives, *s, motor_torque, disturbance)
    motor_speeds = [w if d.drive.is_elastic else s.v[d.v] for d, w in zip(machine.drives, s.theta_dot, strict=True)]
    return [*coordinate_rates(machine.system, s.q, s.v), *a, *motor_speeds, *alpha]
