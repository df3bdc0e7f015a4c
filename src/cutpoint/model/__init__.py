"""The model of a robot: bodies, joints, frames and drives.  Immutable data, validated where it is built."""

from cutpoint.model.drive import Compliance, Drive, Friction, Harmonic, Hysteresis, Motor, Ratings, Rotor
from cutpoint.model.mechanism import WORLD, Body, Frame, Joint, Limits, Link, Mechanism, Mimic

__all__ = [
    "WORLD",
    "Body",
    "Compliance",
    "Drive",
    "Frame",
    "Friction",
    "Harmonic",
    "Hysteresis",
    "Joint",
    "Limits",
    "Link",
    "Mechanism",
    "Mimic",
    "Motor",
    "Ratings",
    "Rotor",
]
