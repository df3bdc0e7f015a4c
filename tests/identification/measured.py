"""Where measurements of real machines are, and what their channels mean."""

from pathlib import Path
from typing import Any

from scipy.io import loadmat

from measured_data import DATA

EMPS = DATA / "emps" / "DATA_EMPS.mat"
KUKA = DATA / "kuka_kr300"
UR10 = DATA / "ur10_bag" / "exciting_trajectory.db3"

UR10_MAPPING = """
version: 1
joints: [shoulder_pan_joint, shoulder_lift_joint, elbow_joint, wrist_1_joint, wrist_2_joint, wrist_3_joint]
q: /joint_states.position
v: /joint_states.velocity
# what this robot publishes as effort is its motors' currents
current: {channels: /joint_states.effort, unit: A}
"""


def emps_mapping() -> dict[str, Any]:
    """A slide whose force is its drive's command, in V, times the gain that the file states."""
    gain = loadmat(EMPS, variable_names=["gtau"])["gtau"].item()
    return {
        "version": 1,
        "joints": ["slide"],
        "time": {"channel": "t"},
        "q": {"channels": "qm", "unit": "m"},
        "torque": {"channels": "vir", "unit": "V", "gain": gain},
    }


def kuka_mapping(path: Path) -> dict[str, Any]:
    """An arm with encoders on both sides; the ratios are the file's."""
    ratio = loadmat(path, variable_names=["para"], simplify_cells=True)["para"]["u"]
    return {
        "version": 1,
        "joints": ["A1", "A2", "A3", "A4", "A5", "A6"],
        "ratio": ratio.tolist(),
        "time": {"channel": "rec.time_cont"},
        "q": {"channels": "rec.act_pos_se_deg", "unit": "deg"},
        "theta": {"channels": "rec.act_pos_mot_deg", "unit": "deg"},
        "v": {"channels": "rec.act_vel_se_deg_per_s", "unit": "deg/s"},
        "theta_dot": {"channels": "rec.act_vel_mot_deg_per_s", "unit": "deg/s"},
        "torque": {"channels": "rec.act_torque_abs_nm", "unit": "N m", "side": "motor"},
    }
