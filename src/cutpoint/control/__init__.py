"""Control laws as pure step functions, one file each."""

from cutpoint.control.feedforward import Feedforward
from cutpoint.control.gravity import GravityCompensation
from cutpoint.control.interface import Command, Controller, Law, Measurement, Reference
from cutpoint.control.pd import PD
from cutpoint.control.sum import Sum
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
