"""Largest stiffness of springs: under gravity, on the flanks of backlash, and at the motors' largest torque."""

import numpy as np

from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.model.drive import Drive

RATTLE = 6.0
"""How much faster than a drive in contact one changes that goes from flank to flank of its play."""


def stiffest(drive: Drive, lead: float, most: float) -> float:
    """Stiffness that steps must resolve, N m/rad: at this lead, on backlash flanks, or at the largest motor torque."""
    law = drive.compliance
    if law is None:
        return 0.0
    stiffness = float(law.tangent(lead))
    if isinstance(law, Backlash) and stiffness < (contact := float(law.spring.tangent(0.0))):
        stiffness = contact * RATTLE**2
    if np.isfinite(most):
        stiffness = max(stiffness, float(law.tangent(law.deflection(most))))
    return stiffness + (sum(drive.hysteresis.stiffness) if drive.hysteresis else 0.0)
