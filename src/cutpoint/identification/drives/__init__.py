"""Drives from measurements: springs, kinematic errors, hysteresis, rotors, motor friction, torque constants."""

from cutpoint.identification.drives.deflections import TorqueReading
from cutpoint.identification.drives.frequency_response import MotorResponse, ResponseFit, fit_response, motor_response
from cutpoint.identification.drives.identify_drives import DriveEstimates, identify_drives
from cutpoint.identification.drives.locked_output import LockedOutput, locked_output
from cutpoint.identification.drives.one_drive import DriveEstimate
from cutpoint.identification.drives.rotor import RotorEstimate, motor_side
from cutpoint.identification.drives.spring_estimate import SpringEstimate
from cutpoint.identification.drives.two_encoders import two_encoders
from cutpoint.identification.drives.two_masses import TwoMasses

__all__ = [
    "DriveEstimate",
    "DriveEstimates",
    "LockedOutput",
    "MotorResponse",
    "ResponseFit",
    "RotorEstimate",
    "SpringEstimate",
    "TorqueReading",
    "TwoMasses",
    "fit_response",
    "identify_drives",
    "locked_output",
    "motor_response",
    "motor_side",
    "two_encoders",
]
