"""A small robot, and every law tuned for it."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from cutpoint import Drive, LinearSpring, Robot, Rotor
from cutpoint.control import (
    PID,
    VDC,
    AdaptiveVDC,
    ComputedTorque,
    DisturbanceObserver,
    ElasticComputedTorque,
    Feedforward,
    FullStateFeedback,
    GravityCompensation,
    Robust,
    SlotineLi,
    SpeedFilter,
    SuperTwisting,
    tune,
)
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from robot_library import Array

BANDWIDTH = 3.0
"""Hz."""


@cache
def elbow() -> Robot:
    """An arm of two links, upper arm and forearm, whose joints bend; no friction."""
    links = [Link("base")]
    joints = []
    for k, (name, mass, length) in enumerate([("shoulder", 4.0, 0.0), ("elbow", 2.5, 0.4)]):
        I = np.diag([0.06, 0.06, 0.004]) * mass / 4
        links.append(Link(name + "_link", mass, np.array([0.0, 0.0, 0.2]), I))
        place = np.eye(4)
        place[2, 3] = length
        joints.append(Joint(name, "revolute", links[k].name, links[-1].name, place, np.array([0.0, 1.0, 0.0])))
    bare = Robot(build("elbow", links, joints))
    kinds = [
        Drive(100.0, Rotor(5e-5), LinearSpring(12e3)),
        Drive(80.0, Rotor(3e-5), LinearSpring(6e3)),
    ]
    return bare.with_drives(dict(zip(bare.joints, kinds, strict=True)))


LAWS: dict[str, Callable[[Robot], Any]] = {
    "PD": lambda r: tune(r, BANDWIDTH),
    "PD + feedforward": lambda r: tune(r, BANDWIDTH) + Feedforward(r),
    "PD + gravity": lambda r: tune(r, BANDWIDTH) + GravityCompensation(r),
    "PID": lambda r: tune(r, BANDWIDTH, PID, limit=np.array([200.0, 100.0])),
    "computed torque": lambda r: tune(r, BANDWIDTH, ComputedTorque),
    "elastic computed torque": lambda r: tune(r, BANDWIDTH, ElasticComputedTorque),
    "full state feedback": lambda r: tune(r, BANDWIDTH, FullStateFeedback),
    "VDC, model": lambda r: tune(r, BANDWIDTH, VDC),
    "VDC, filter": lambda r: tune(r, BANDWIDTH, VDC, derivatives="filter"),
    "VDC, body gains": lambda r: tune(r, BANDWIDTH, VDC, body_gain=0.5),
    "adaptive VDC, projection": lambda r: tune(r, BANDWIDTH, AdaptiveVDC),
    "adaptive VDC, natural": lambda r: tune(r, BANDWIDTH, AdaptiveVDC, update="natural"),
    "Slotine-Li": lambda r: tune(r, BANDWIDTH, SlotineLi),
    "robust": lambda r: tune(r, BANDWIDTH, Robust, width=1.0),
    "super-twisting": lambda r: tune(r, BANDWIDTH, SuperTwisting, root_gain=0.5, twist=0.5),
    "disturbance observer": lambda r: DisturbanceObserver(r, tune(r, BANDWIDTH), 20.0),
    "speed filter": lambda r: SpeedFilter(tune(r, BANDWIDTH)),
}


@cache
def law(name: str) -> Any:
    return LAWS[name](elbow())


def at_rest(q: Array) -> tuple[Array, Array]:
    """Links and motors where gravity lets the springs rest."""
    return q, q + elbow().static_deflection(q)
