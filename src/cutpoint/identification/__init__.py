"""Models from logs of real machines.

This room reads logs and brings them into a state one can compute with.  It counts the parameters that a robot's motion
tells, and finds motions that tell most of them.
"""

from cutpoint.identification.alignment import aligned, skews
from cutpoint.identification.base_parameters import BaseParameters, base_parameters
from cutpoint.identification.clock_skew import Skew, clock_skew
from cutpoint.identification.excitation import Excitation, excitation
from cutpoint.identification.filtering import derivative, low_pass, low_passed, noise_cutoff
from cutpoint.identification.mapping import load_mapping, parse_mapping
from cutpoint.identification.read_recording import read_recording, recording_of
from cutpoint.identification.reading import read_table
from cutpoint.identification.recording import Recording
from cutpoint.identification.table import Channel, Table
from cutpoint.identification.torque_laws import arm_torque, single_joint_torque

__all__ = [
    "BaseParameters",
    "Channel",
    "Excitation",
    "Recording",
    "Skew",
    "Table",
    "aligned",
    "arm_torque",
    "base_parameters",
    "clock_skew",
    "derivative",
    "excitation",
    "load_mapping",
    "low_pass",
    "low_passed",
    "noise_cutoff",
    "parse_mapping",
    "read_recording",
    "read_table",
    "recording_of",
    "single_joint_torque",
    "skews",
]
