"""The channels of a log: which follow from others, and what must be recorded for the requested ones."""

from collections.abc import Collection, Mapping

from cutpoint.errors import unknown_name
from cutpoint.mechanics.bodies.joints import Floating
from cutpoint.mechanics.system import Segment
from cutpoint.robot import Robot

BASE_COORDINATES = ("base_x", "base_y", "base_z", "base_qx", "base_qy", "base_qz", "base_qw")
BASE_SPEEDS = ("base_vx", "base_vy", "base_vz", "base_wx", "base_wy", "base_wz")
MEMORY = ("link_strain", "motor_strain", "hysteresis_torque")

DIFFERENCES = {
    "position_error": ("reference_q", "q"), "motor_position_error": ("motor_reference", "theta"),
    "feedback_torque": ("command_torque", "feedforward_torque"),
}  # fmt: skip
"""Channels that are one less another."""

SOURCES: Mapping[str, tuple[str, ...]] = {
    **DIFFERENCES, "reference_q": (), "reference_v": (), "disturbance_torque": (),
    **dict.fromkeys(MEMORY, ("strains",)), **dict.fromkeys(BASE_COORDINATES, ("q",)),
    **dict.fromkeys(BASE_SPEEDS, ("v",)),
}  # fmt: skip
"""Channels that are not recorded, and what they follow from."""

ONLY_RECORDED = ("current", "strains")
"""What is recorded without being a channel: a current is in motor_torque."""


def recordable(state: Mapping[str, int], n: int, nv: int) -> dict[str, int]:
    """What can be recorded each period, with its length, in order.  state: lengths of the state's parts."""
    return {
        **state, "measured_q": n, "measured_theta": n, "measured_v": n, "measured_theta_dot": n, "command_torque": n,
        "feedforward_torque": n, "motor_reference": n, "motor_speed_reference": n, "fault": 1, "motor_torque": n,
        "joint_torque": n, "friction_torque": nv, "motor_friction_torque": n,
    }  # fmt: skip


def absent_from(robot: Robot, recorded: Mapping[str, int], *, reports: bool) -> list[str]:
    """Channels that this run lacks but logs of other robots and laws have.  reports: whether the law reports faults."""
    remembers, base, fault = recorded["strains"] > 0, (*BASE_COORDINATES, *BASE_SPEEDS), ("fault",)
    return [*(() if base_of(robot) else base), *(() if reports else fault), *(() if remembers else MEMORY)]


def base_of(robot: Robot) -> Segment | None:
    """The first body that moves freely, if there is one."""
    return next((s for s in robot.machine.system.segments if isinstance(s.joint, Floating)), None)


def recorded_for(wanted: Collection[str], recorded: Mapping[str, int], absent: Collection[str]) -> dict[str, int]:
    """Recordable quantities needed for these channels.  absent: channels that the run does not have.

    Raises InputError for any other.
    """
    known = [name for name in (*recorded, *SOURCES) if name not in (*ONLY_RECORDED, *absent)]
    for name in wanted:
        if name not in known:
            raise unknown_name("channel", name, known)
    needed = {source for name in wanted for source in SOURCES.get(name, (name,))}
    return {name: size for name, size in recorded.items() if name in needed}
