"""Units at the side of a prismatic joint, and makers'."""

import math

RPM = math.pi / 30.0
"""rad/s"""

ARC_MINUTE = math.pi / 180 / 60
"""rad"""

SLIDING = {
    "N m": "N",
    "N m/rad": "N/m",
    "N m s/rad": "N s/m",
    "1/(N m)": "1/N",
    "N m/A": "N/A",
    "kg m2": "kg",
    "rad": "m",
    "rad/s": "m/s",
    "rad/s2": "m/s2",
    "mrad": "mm",
    "µrad": "µm",
}
"""What stands, of a joint that slides, for a unit of one that turns."""


def joint_unit(unit: str, slides: bool) -> str:
    """For one of these units of a joint that turns, that of a joint which may slide."""
    return SLIDING[unit] if slides else unit
