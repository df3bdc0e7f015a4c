"""Control laws as pure step functions, one file each."""

from cutpoint.control.feedforward import Feedforward
from cutpoint.control.gravity import GravityCompensation
from cutpoint.control.interface import Command, Controller, Measurement, Reference
from cutpoint.control.law import Law, Sum
from cutpoint.control.pd import PD
from cutpoint.control.tuning import pd_for_bandwidth

__all__ = [
    "PD",
    "Command",
    "Controller",
    "Feedforward",
    "GravityCompensation",
    "Law",
    "Measurement",
    "Reference",
    "Sum",
    "pd_for_bandwidth",
]
