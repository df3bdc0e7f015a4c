"""cutpoint: dynamics, simulation, control and identification of robots with flexible joints.

robot = cutpoint.load("arm.urdf", drives="arm.drives.yaml")
torque = robot.inverse_dynamics(q, v, a)
log = cutpoint.simulate(robot, controller, trajectory)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from cutpoint.errors import CutpointError, InputError, ModelError, SimulationError, TraceError
from cutpoint.kernels import Kernel, compile
from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.drives.friction import Coulomb, Grease, Sliding, Stribeck
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.drives.presliding import ElastoPlastic, LuGre
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.model import Drive, Harmonic, Limits, Motor, Ratings, Rotor
from cutpoint.robot import Robot
from cutpoint.scalars import (
    absolute,
    acos,
    asin,
    atan,
    atan2,
    clip,
    cos,
    exp,
    log,
    maximum,
    minimum,
    sin,
    sqrt,
    tan,
    tanh,
    where,
)
from cutpoint.version import __version__ as __version__

if TYPE_CHECKING:
    from cutpoint import (
        analysis,
        control,
        derivatives,
        export,
        formats,
        identification,
        robots,
        simulation,
        trajectories,
    )
    from cutpoint.loading import load
    from cutpoint.simulation import Log, Sensors, State, simulate, simulate_many

__all__ = [
    "Backlash", "CatalogueSpring", "Coulomb", "CutpointError", "Drive", "ElastoPlastic", "Flexspline", "Grease",
    "Harmonic", "HarmonicSpring", "InputError", "Kernel", "KinematicError", "Limits", "LinearSpring", "Log", "LuGre",
    "MaxwellSlip", "ModelError", "Motor", "Ratings", "Robot", "Rotor", "Sensors", "SimulationError", "Sliding",
    "State", "Stribeck", "TraceError", "WaveGenerator", "absolute", "acos", "analysis", "asin", "atan", "atan2",
    "clip", "compile", "control", "cos", "derivatives", "exp", "export", "formats", "identification", "load", "log",
    "maximum", "minimum", "robots", "simulate", "simulate_many", "simulation", "sin", "sqrt", "tan", "tanh",
    "trajectories", "where",
]  # fmt: skip

_SUBPACKAGES = (
    "analysis", "control", "derivatives", "export", "formats", "identification", "robots", "simulation", "trajectories",
)  # fmt: skip
_SIMULATION = ("Log", "Sensors", "State", "simulate", "simulate_many")
_ELSEWHERE = {"load": "loading", **dict.fromkeys(_SIMULATION, "simulation")}
"""The modules of names that are imported at their first use: SciPy and the file formats cost more than all else."""


def __getattr__(name: str) -> Any:
    if name in _SUBPACKAGES:
        return import_module(f"cutpoint.{name}")
    if name not in _ELSEWHERE:
        raise AttributeError(f"module 'cutpoint' has no attribute {name!r}")
    found = globals()[name] = getattr(import_module(f"cutpoint.{_ELSEWHERE[name]}"), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
