"""cutpoint: dynamics, simulation and control of robots whose joints bend.

robot = cutpoint.load("arm.urdf", drives="arm.drives.yaml")
torque = robot.inverse_dynamics(q, v, a)
log = cutpoint.simulate(robot, controller, trajectory)
"""

from cutpoint import control, robots, trajectories
from cutpoint.errors import CutpointError, InputError, ModelError, SimulationError, TraceError
from cutpoint.kernels import Kernel, compile
from cutpoint.loading import load
from cutpoint.mechanics.catalogue import CatalogueSpring
from cutpoint.mechanics.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.friction import Coulomb, Stribeck
from cutpoint.mechanics.kinematic_error import KinematicError
from cutpoint.mechanics.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.model import Drive, Harmonic, Limits, Motor, Ratings, Rotor
from cutpoint.robot import Robot
from cutpoint.scalars import atan, clip, cos, exp, log, sin, sqrt, tan, tanh, where
from cutpoint.simulation import Log, Sensors, State, simulate

__version__ = "0.1.0"

__all__ = [
    "CatalogueSpring", "Coulomb", "CutpointError", "Drive", "Flexspline", "Harmonic", "HarmonicSpring", "InputError",
    "Kernel", "KinematicError", "Limits", "LinearSpring", "Log", "ModelError", "Robot", "Rotor", "Sensors",
    "SimulationError", "State", "Stribeck", "TraceError", "WaveGenerator", "atan", "clip", "compile", "control", "cos",
    "exp", "load", "log", "robots", "simulate", "sin", "sqrt", "tan", "tanh", "trajectories", "where",
]  # fmt: skip
