"""The bench on which section IV.B is run: arm, reference, gains, and closed loops by name."""

import warnings
from dataclasses import replace
from functools import cached_property
from typing import Literal

import numpy as np

from cutpoint.analysis import LinearModel
from cutpoint.control import PD, Feedforward
from cutpoint.control.law import Law
from cutpoint.errors import SimulationError
from cutpoint.robot import Robot
from cutpoint.robots import xia2019
from cutpoint.simulation import Log, StiffnessWarning, simulate
from cutpoint.simulation.simulate import Accuracy
from cutpoint.studies.paper.printed import DURATION, GOAL
from cutpoint.trajectories import Trajectory, cycloid

KP = np.array([2000.0, 2000.0, 1000.0, 500.0, 300.0, 200.0])
"""N m/rad at the joint's side.  Ours: the paper prints no gains."""

KD = np.array([60.0, 60.0, 35.0, 20.0, 12.0, 10.0])
"""N m s/rad at the joint's side."""

DAMPING = 20.0
"""Of a damped drive, N m s/rad at the joint's side.  Ours: neither the paper nor a catalogue states any."""

PERIOD = 1e-3
"""Of control, s."""


class Bench:
    """Arm and reference of section IV; what several pages need is run once."""

    @cached_property
    def robot(self) -> Robot:
        return xia2019()

    @cached_property
    def frictionless(self) -> Robot:
        drives = {name: replace(drive, link_friction=None) for name, drive in self.robot.drives.items()}
        return self.robot.with_drives(drives)

    @cached_property
    def damped(self) -> Robot:
        """The arm with drives that lose some of what swings in them."""
        drives = {name: replace(drive, damping=DAMPING) for name, drive in self.robot.drives.items()}
        return self.robot.with_drives(drives)

    @cached_property
    def weightless(self) -> LinearModel:
        """The arm at q = 0 in small motions, without gravity and friction."""
        return self.robot.with_gravity(np.zeros(3)).linearize(np.zeros(6))

    @cached_property
    def reference(self) -> Trajectory:
        return cycloid(GOAL, DURATION)

    @cached_property
    def pd_alone(self) -> Log:
        """The closed loop without feedforward."""
        return self.run(self.robot, pd())

    @cached_property
    def elastic(self) -> Log:
        """The closed loop with the full feedforward."""
        return self.run(self.robot, pd() + Feedforward(self.robot, "elastic"))

    def run(self, robot: Robot, controller: Law, accuracy: Accuracy = "standard") -> Log:
        """The closed loop along (57)."""
        return simulate(robot, controller, self.reference, control_period=PERIOD, accuracy=accuracy)

    def run_until_it_diverges(self, robot: Robot, controller: Law) -> Log:
        """The closed loop along (57); where it diverges, what it reached.

        In fine steps: what chatters violently hardens the flexsplines, and they ring faster than at rest.  How large it
        grows counts, not where it is at an instant, so that steps need not follow all of that.
        """
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", StiffnessWarning)
                return self.run(robot, controller, "fine")
        except SimulationError as stopped:
            if not stopped.evidence["diverged"]:
                raise
            return stopped.log


def pd(scale: float = 1.0, side: Literal["motor", "link"] = "motor") -> PD:
    """The one gain set, or a multiple of it.  Xia (2019) eq. (58)."""
    return PD(scale * KP, scale * KD, side=side)
