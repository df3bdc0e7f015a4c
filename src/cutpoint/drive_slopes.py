"""Derivatives of a drive's effort by its state, by the chain rule on its own laws: the drives' part of derivatives.

Only within traces.  Friction is that of steady sliding, and springs have no hysteresis.
"""

from typing import Any, Generic, NamedTuple, TypeVar

from cutpoint.kernels import jacobian_of
from cutpoint.mechanics.drives.harmonic_drive import DriveState
from cutpoint.mechanics.drives.motor_motion import motor_motion, motor_torque
from cutpoint.mechanics.drives.strains import UNKNOWN
from cutpoint.mechanics.elastic_forward import drive_effort
from cutpoint.mechanics.elastic_inverse import Options
from cutpoint.model import Drive
from cutpoint.scalars import Jet

Scalars = list[Any]
Row = TypeVar("Row")

STATE = ("q", "v", "theta", "theta_dot", "motor_torque")
"""What a drive's effort depends on."""


class EffortSlopes(NamedTuple, Generic[Row]):
    """Derivatives of `drive_effort`, on_link and alpha, by each number of STATE: a row with an entry for each drive."""

    d_on_link_d_q: Row
    d_on_link_d_v: Row
    d_on_link_d_theta: Row
    d_on_link_d_theta_dot: Row
    d_on_link_d_motor_torque: Row
    d_alpha_d_q: Row
    d_alpha_d_v: Row
    d_alpha_d_theta: Row
    d_alpha_d_theta_dot: Row
    d_alpha_d_motor_torque: Row


EFFORT_SLOPES = EffortSlopes._fields

MOTION = ("torque", "torque_dot", "torque_ddot", "q", "v", "a", "jerk", "snap")
"""What a motor's torque depends on: its joint's, with two rates, and the joint's motion."""


def effort_slopes(drive: Drive, state: Scalars) -> Scalars:
    """Derivatives of on_link and alpha of `drive_effort` by its STATE, in the order of EFFORT_SLOPES."""

    def effort(state: Scalars) -> Scalars:
        *at, torque = state
        found = drive_effort(drive, DriveState(*at), torque, UNKNOWN)
        return [found.on_link, found.alpha]

    return [x for row in jacobian_of(effort)(state=state)[0] for x in row]


def motor_slopes(drive: Drive, motion: Scalars, options: Options) -> Scalars:
    """Derivatives of the motor torque of elastic inverse dynamics by its MOTION."""

    def asked(motion: Scalars) -> Scalars:
        torque, (q, *rates) = Jet(*motion[:3]), motion[3:]
        found = motor_motion(drive, torque, q, Jet(*rates), UNKNOWN, friction_rates=options.friction_rates)
        return [motor_torque(drive, found)]

    return jacobian_of(asked)(motion=motion)[0][0]
