"""docs/log-channels.md: it lists the channels that logs have, with their units, and its equations hold in logs."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from cutpoint import ElastoPlastic, KinematicError, Log, MaxwellSlip, Sensors, simulate
from cutpoint.control import PD, Guard
from cutpoint.model.drive import Harmonic
from cutpoint.trajectories import cycloid
from robot_library import COULOMB, STRIBECK, robot

DOCUMENT = Path(__file__).parents[2] / "docs" / "log-channels.md"


def table() -> dict[str, str]:
    """Units by channel."""
    rows = re.findall(r"^\| (`.*?`) \| (.*?) ?\| .*\|$", DOCUMENT.read_text(), re.MULTILINE)
    names, units = ([x for row in rows for x in row[k].split(",")] for k in (0, 1))
    return {name.strip(" `"): unit.strip() for name, unit in zip(names, units, strict=True)}


def everything() -> Log:
    """A run whose drives remember all that drives can, under a law that reports faults."""
    bristles = {side: ElastoPlastic(law, 2e-4, 3.0, 0.7) for side, law in (("link", STRIBECK), ("motor", COULOMB))}
    parts = {f"{side}_friction": law for side, law in bristles.items()}
    arm = robot("linear")
    arm = arm.with_drives(
        {name: replace(d, hysteresis=MaxwellSlip((800.0,), (1e-5,)), **parts) for name, d in arm.drives.items()}
    )
    law = Guard(arm, PD([200.0] * 6, [20.0] * 6))
    motion, pushed = cycloid(np.full(6, 0.4), 0.2), lambda times: np.full((len(times), 6), 0.3)
    return simulate(arm, law, motion, duration=0.02, sensors=Sensors(delay=1e-3), disturbances=pushed)


def test_the_table_lists_the_channels_that_logs_have_with_their_units():
    held, free = everything(), simulate(robot("floating"), None, duration=2e-3)
    bases = {name: unit for name, unit in free.units.items() if name.startswith("base_")}
    assert {**held.units, **bases} == table()
    assert not free.channels.keys() - table().keys()


def test_the_torques_of_a_log_hang_together_as_the_page_says():
    """Rigid, linear, hardening and damped drives, friction on both sides, a kinematic error on those that bend."""
    waves, arm = KinematicError((Harmonic(2, 2e-4, 0.4),)), robot("mixed")
    arm = arm.with_drives({n: replace(d, kinematic_error=waves) if d.compliance else d for n, d in arm.drives.items()})
    n = len(arm.drives)
    motion, pushed = cycloid(np.full(n, 0.2), 0.1), lambda times: np.cos(40.0 * times)[:, None] + np.arange(arm.nv)
    log = simulate(arm, PD([50.0] * n, [5.0] * n), motion, duration=0.05, disturbances=pushed)
    assert np.array_equal(log["disturbance_torque"], pushed(log.time)[:, [d.v for d in arm.machine.drives]])
    moved = arm.elastic_forward_dynamics(log["q"], log["v"], log["theta"], log["theta_dot"], log["motor_torque"])
    scale = 1.0 + log.max("joint_torque").max()
    on_link = log["joint_torque"] - log["friction_torque"]
    assert np.abs(arm.inverse_dynamics(log["q"], log["v"], moved.a) - on_link).max() < 1e-10 * scale
    for k, drive in enumerate(arm.drives.values()):
        names = ("theta", "theta_dot", "joint_torque", "motor_friction_torque")
        at, speed, passed, rubbing = (log[name][:, k] for name in names)
        assert np.abs(rubbing - (drive.motor_friction.torque(speed) if drive.motor_friction else 0.0)).max() < 1e-12
        slope = 4e-4 * drive.ratio * np.cos(2 * drive.ratio * at + 0.4) if drive.compliance else 0.0
        turning = drive.reflected_inertia * moved.theta_ddot[:, k] if drive.compliance else 0.0
        left = log["motor_torque"][:, k] - (1 - slope) * passed - rubbing
        assert np.abs(left - turning).max() < 1e-10 * scale
