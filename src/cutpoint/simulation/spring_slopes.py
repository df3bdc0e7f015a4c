"""How stiff springs get: held by weight, on the flanks of a play, and at what motors can do at most."""

import numpy as np

from cutpoint.mechanics.backlash import Backlash
from cutpoint.model.drive import Drive

RATTLE = 6.0
"""How much faster than a drive in contact one changes that goes from flank to flank of its play."""


def stiffest(drive: Drive, lead: float, most: float) -> float:
    """N m/rad, at this lead of the motor, on the flanks of its play, or at the motor's torque, as steps must follow."""
    law = drive.compliance
    if law is None:
        return 0.0
    stiffness = float(law.tangent(lead))
    if isinstance(law, Backlash) and stiffness < (contact := float(law.spring.tangent(0.0))):
        stiffness = contact * RATTLE**2
    if np.isfinite(most):
        stiffness = max(stiffness, float(law.tangent(law.deflection(most))))
    return stiffness + (sum(drive.hysteresis.stiffness) if drive.hysteresis else 0.0)
