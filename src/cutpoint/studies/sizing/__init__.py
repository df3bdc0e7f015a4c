"""Whether drives are large enough for a motion: demands on each, limits, and the life of gears."""

from cutpoint.studies.sizing.demand import Demand, Peak
from cutpoint.studies.sizing.drive_sizing import DriveSizing
from cutpoint.studies.sizing.fastest import fastest
from cutpoint.studies.sizing.margins import Margin
from cutpoint.studies.sizing.sizing import Sizing, sizing

__all__ = ["Demand", "DriveSizing", "Margin", "Peak", "Sizing", "fastest", "sizing"]
