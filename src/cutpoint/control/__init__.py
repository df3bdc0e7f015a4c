"""Control laws as pure step functions, one file each; wrappers around laws; gains."""

from cutpoint.control.interface import Command, Controller, Measurement, Reference
from cutpoint.control.law import Law, Sum
from cutpoint.control.laws.adaptive_vdc import AdaptiveVDC
from cutpoint.control.laws.computed_torque import ComputedTorque
from cutpoint.control.laws.elastic_computed_torque import ElasticComputedTorque
from cutpoint.control.laws.feedforward import Feedforward
from cutpoint.control.laws.full_state_feedback import FullStateFeedback
from cutpoint.control.laws.gravity import GravityCompensation
from cutpoint.control.laws.pd import PD
from cutpoint.control.laws.pid import PID
from cutpoint.control.laws.robust import Robust
from cutpoint.control.laws.slotine_li import SlotineLi
from cutpoint.control.laws.super_twisting import SuperTwisting
from cutpoint.control.laws.vdc import VDC
from cutpoint.control.stability.margins import Margins, margins
from cutpoint.control.stability.sampled_loop import SampledPole, slowest_pole
from cutpoint.control.tuning.holding import FragileWarning
from cutpoint.control.tuning.tune import tune
from cutpoint.control.wrappers.disturbance_observer import DisturbanceObserver
from cutpoint.control.wrappers.guard import Fault, Guard
from cutpoint.control.wrappers.speed_filter import SpeedFilter

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
    "FragileWarning",
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
