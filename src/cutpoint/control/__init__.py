"""Control laws as pure step functions, one file each; wrappers around laws; gains."""

from cutpoint.control.adaptive_vdc import AdaptiveVDC
from cutpoint.control.computed_torque import ComputedTorque
from cutpoint.control.disturbance_observer import DisturbanceObserver
from cutpoint.control.elastic_computed_torque import ElasticComputedTorque
from cutpoint.control.feedforward import Feedforward
from cutpoint.control.full_state_feedback import FullStateFeedback
from cutpoint.control.gravity import GravityCompensation
from cutpoint.control.guard import Fault, Guard
from cutpoint.control.interface import Command, Controller, Measurement, Reference
from cutpoint.control.law import Law, Sum
from cutpoint.control.margins import Margins, margins
from cutpoint.control.pd import PD
from cutpoint.control.pid import PID
from cutpoint.control.robust import Robust
from cutpoint.control.sampled_loop import SampledPole, slowest_pole
from cutpoint.control.slotine_li import SlotineLi
from cutpoint.control.speed_filter import SpeedFilter
from cutpoint.control.super_twisting import SuperTwisting
from cutpoint.control.tuning import tune
from cutpoint.control.vdc import VDC

__all__ = [
    "PD",
    "PID",
    "VDC",
    "AdaptiveVDC",
    "Command",
    "ComputedTorque",
    "Controller",
    "DisturbanceObserver",
    "ElasticComputedTorque",
    "Fault",
    "Feedforward",
    "FullStateFeedback",
    "GravityCompensation",
    "Guard",
    "Law",
    "Margins",
    "Measurement",
    "Reference",
    "Robust",
    "SampledPole",
    "SlotineLi",
    "SpeedFilter",
    "Sum",
    "SuperTwisting",
    "margins",
    "slowest_pole",
    "tune",
]
