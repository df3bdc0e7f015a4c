"""Models from logs of real machines.

`identify` does it all: it reads and conditions a log, identifies links, rotors, friction and springs with their
uncertainty, and states what the log cannot determine.  `excitation` finds the most informative motions.
"""

from cutpoint.identification.conditioning.alignment import aligned, skews
from cutpoint.identification.conditioning.clock_skew import Skew, clock_skew
from cutpoint.identification.conditioning.filtering import derivative, low_pass, low_passed, noise_cutoff
from cutpoint.identification.conditioning.torque_laws import arm_torque, single_joint_torque
from cutpoint.identification.drives.identify_drives import DriveEstimates, identify_drives
from cutpoint.identification.excitation.excitation import Excitation, excitation
from cutpoint.identification.logs.joining import joined
from cutpoint.identification.logs.mapping import load_mapping, parse_mapping
from cutpoint.identification.logs.read_recording import read_recording, recording_of
from cutpoint.identification.logs.reading import read_table
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.logs.table import Channel, Table
from cutpoint.identification.output.identify import Identification, identify
from cutpoint.identification.rigid.base_parameters import BaseParameters, base_parameters
from cutpoint.identification.rigid.identify_rigid import RigidEstimate, identify_rigid

__all__ = [
    "BaseParameters",
    "Channel",
    "DriveEstimates",
    "Excitation",
    "Identification",
    "Recording",
    "RigidEstimate",
    "Skew",
    "Table",
    "aligned",
    "arm_torque",
    "base_parameters",
    "clock_skew",
    "derivative",
    "excitation",
    "identify",
    "identify_drives",
    "identify_rigid",
    "joined",
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
