"""What engineers of elastic joints look at first: linear models, modes of the drives, frequency responses."""

from cutpoint.analysis.frequency_response import FrequencyResponse, frequency_response
from cutpoint.analysis.linear_model import LinearModel, OperatingPoint
from cutpoint.analysis.linearize import linearize
from cutpoint.analysis.modes import Modes, modes

__all__ = ["FrequencyResponse", "LinearModel", "Modes", "OperatingPoint", "frequency_response", "linearize", "modes"]
