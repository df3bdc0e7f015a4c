"""Closed loops: plant, sensors, controller and integrator in one compiled step, and the resulting log."""

from cutpoint.control.sensors import Sensors
from cutpoint.simulation.log.log import Log
from cutpoint.simulation.many import Runs, simulate_many
from cutpoint.simulation.plant import State
from cutpoint.simulation.runner import UntracedControllerWarning
from cutpoint.simulation.simulate import simulate
from cutpoint.simulation.steps.substeps import StiffnessWarning

__all__ = [
    "Log", "Runs", "Sensors", "State", "StiffnessWarning", "UntracedControllerWarning", "simulate", "simulate_many",
]  # fmt: skip
