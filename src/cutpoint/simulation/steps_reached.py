"""After a run of fixed steps: whether speeds that it reached, unknown before, would have asked for shorter ones."""

import warnings

import numpy as np

from cutpoint.robot import Robot
from cutpoint.simulation.log import Log
from cutpoint.simulation.substeps import MOST_SUBSTEPS, SETTINGS, StiffnessWarning, fastest_wave

ALLOWED = 2.0
"""How many times faster than foreseen waves may become: less than a whole wave a step, which no step would see."""


def check_steps(robot: Robot, log: Log) -> None:
    """Warns if motors turned so fast, as far as the log has their speeds, that waves asked for shorter steps."""
    taken = log.meta["substeps"]
    if "theta_dot" not in log or taken >= MOST_SUBSTEPS:
        return
    wave = fastest_wave(robot, log.max("theta_dot"))
    asked = int(np.ceil(log.meta["control_period"] * wave.rate / SETTINGS[log.meta["accuracy"]].wave))
    if asked > ALLOWED * taken:
        told = f"the run reached speeds at which {wave.cause} would take {asked} integration steps a control period"
        warnings.warn(f"{told}, {taken} were taken: give substeps={asked}", StiffnessWarning, stacklevel=3)
