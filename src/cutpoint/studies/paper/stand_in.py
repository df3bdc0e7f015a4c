"""The run of section IV.C on a simulated stand-in: an arm that is not quite its model, seen through coarse encoders."""

from collections.abc import Iterable
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control import PD, Feedforward
from cutpoint.model.build import build
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import Link, Mechanism
from cutpoint.robot import Robot
from cutpoint.simulation import simulate
from cutpoint.simulation.plant import State
from cutpoint.studies.paper import bench
from cutpoint.studies.paper.imperfections import (
    Chance,
    Imperfections,
    actual_drive,
    actual_mechanism,
    ripple_of,
    sensors_of,
)
from cutpoint.studies.paper.printed import DURATION_5, GOAL_5
from cutpoint.trajectories import cycloid

KP, KD = bench.KP[:2], bench.KD[:2]
"""Those of Table 4, N m/rad and N m s/rad at the joint's side."""

_SUBSTEPS = 4
"""Integration steps a sample: what `simulate` finds for these drives, stated so that it need not look for each arm."""

_LOCKED = ("joint3", "joint4", "joint5", "joint6")


class Run(NamedTuple):
    """One run: link positions and errors (N, 2) in rad, torques (N, 2) in N m; feedback is the compensation error."""

    q: Array
    position_error: Array
    feedforward: Array
    feedback: Array

    @property
    def control(self) -> Array:
        """Motor torques commanded by the controller, N m."""
        return self.feedforward + self.feedback

    @property
    def position_rms(self) -> Array:
        """Degrees."""
        return np.rad2deg(np.sqrt(np.mean(self.position_error**2, axis=0)))

    @property
    def position_peak(self) -> Array:
        """Degrees."""
        return np.rad2deg(np.abs(self.position_error).max(axis=0))

    @property
    def torque_rms(self) -> Array:
        return np.sqrt(np.mean(self.feedback**2, axis=0))


class StandIn:
    """The model of the arm with joints 3 to 6 locked at zero, and runs of arms that differ from it."""

    def __init__(self, arm: Robot) -> None:
        self._arm = arm
        self.model = Robot(locked(arm.mechanism), {name: arm.drives[name] for name in ("joint1", "joint2")})
        self.reference = cycloid(GOAL_5, DURATION_5)
        self._controller = PD(KP, KD, side="motor") + Feedforward(self.model, "elastic")
        self.time: Array = np.arange(round(DURATION_5 / bench.PERIOD) + 1, dtype=np.float64) * bench.PERIOD

    def run(self, sizes: Imperfections, seed: int) -> Run:
        """The loop with imperfections of these sizes, drawn by seed."""
        chance = Chance.of(seed)
        drives = self.model.drives.items()
        plant = self.model.with_drives(
            {name: actual_drive(drive, sizes, chance, k) for k, (name, drive) in enumerate(drives)}
        )
        excess = self._excess(locked(actual_mechanism(self._arm.mechanism, sizes, chance)))
        ratio = np.array([drive.ratio for drive in plant.drives.values()])
        ripple = ripple_of(sizes, chance, ratio)
        log = simulate(
            plant,
            self._controller + ripple,
            self.reference,
            control_period=bench.PERIOD,
            initial=self._settled(plant, excess[0]),
            sensors=sensors_of(sizes, seed, ratio),
            disturbances=lambda times: -excess,
            substeps=_SUBSTEPS,
        )
        feedback = log["feedback_torque"] - ripple.torque(log["measured_theta"])
        return Run(log["q"], log["position_error"], log["feedforward_torque"], feedback)

    @cached_property
    def _regressor(self) -> Array:
        """Of the reference, (N, 2, parameters)."""
        return self.model.regressor(*self.reference.derivatives(self.time, 2))

    def _excess(self, actual: Mechanism) -> Array:
        """(N, 2): what the actual links need beyond the model's along the reference, N m.

        Torque is linear in the inertial parameters, so the plant can keep the model's links and bear this as a load:
        one compiled loop then serves every arm.  What is lost is the product of two small numbers, parameter error and
        tracking error.
        """
        return self._regressor @ (Robot(actual).inertial_parameters - self.model.inertial_parameters)

    def _settled(self, plant: Robot, excess: Array) -> State:
        """Where the loop holds the arm still before it starts: off the reference by what the model does not know.

        But for torque ripple, and the kinematic error's share in it, which move with the last count of the encoder.
        """
        start = self.reference.start
        theta = start + self.model.static_deflection(start) - excess / KP
        weight = self.model.gravity_forces(start) + excess
        q = [_held(*each) for each in zip(plant.drives.values(), theta, weight, strict=True)]
        return State(np.array(q), np.zeros(2), theta, np.zeros(2))


def _held(drive: Drive, theta: float, torque: float) -> float:
    """The link's angle at rest with the motor at theta, rad."""
    assert drive.compliance is not None and drive.kinematic_error is not None
    return theta - drive.kinematic_error.value(theta, drive.ratio) - drive.compliance.deflection(torque)


def locked(mechanism: Mechanism) -> Mechanism:
    """The arm's mechanism with joints 3 to 6 fixed at zero."""
    bodies = mechanism.bodies
    links = [Link(body.name, body.mass, body.com, body.inertia) for body in bodies]
    base = Link(bodies[0].joint.parent)
    joints = [body.joint for body in bodies]
    return build(mechanism.name, [base, *links], joints, lock=dict.fromkeys(_LOCKED, 0.0))


def nearest_to_median(runs: Iterable[Run]) -> int:
    """Which run's RMS numbers depart least from their medians over all runs, at the worst of them."""
    numbers = np.array([[*run.position_rms, *run.torque_rms] for run in runs])
    medians = np.median(numbers, axis=0)
    return int(np.abs(numbers / medians - 1).max(axis=1).argmin())
