"""Analysis of robots with elastic joints: linear models, modes, frequency responses, torque from encoders."""

from cutpoint.analysis.encoder_torque import TorqueBound, followed_hysteresis, torque_bound
from cutpoint.analysis.frequency_response import FrequencyResponse, frequency_response
from cutpoint.analysis.linear_model import LinearModel, OperatingPoint
from cutpoint.analysis.linearize import linearize
from cutpoint.analysis.modes import Modes, modes

__all__ = [
    "FrequencyResponse",
    "LinearModel",
    "Modes",
    "OperatingPoint",
    "TorqueBound",
    "followed_hysteresis",
    "frequency_response",
    "linearize",
    "modes",
    "torque_bound",
]
