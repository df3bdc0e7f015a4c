"""What motors' torques are against what models say of them, over the part of a log that was fitted and the rest."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutpoint.identification.conditioning.filtering import low_pass
from cutpoint.identification.conditioning.motion import Motion, motion_of, torques_of
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.rigid.identify_rigid import BANDWIDTH, RigidEstimate
from cutpoint.identification.rigid.rigid_robot import link_torques
from cutpoint.robot import Robot

Array = NDArray[np.float64]

WORSE = 2.0
"""Times the error of the part that was fitted: above that on the rest, the model does not carry over."""


STILL = 0.1
"""Of the RMS speed on the part that was fitted."""


@dataclass(frozen=True, eq=False)
class TorqueErrors:
    """Torques of the motors, each (N, n), N m at the joint, all through one filter; NaN where something is not known.

    measured: as recorded.  before, after: as the robot's files say, and as the identified model does, for the motion
    q, v.  load: what the links ask, as identified.  held_out: (N,), samples that had no part in the fit.
    bandwidth: Hz, of the torques.
    """

    time: Array
    measured: Array
    before: Array
    after: Array
    q: Array
    v: Array
    load: Array
    held_out: NDArray[np.bool_]
    bandwidth: float

    def rms(self, model: str, held_out: bool = False) -> Array:
        """(n,) N m: error of the model "before" or "after"; NaN where nothing was held out."""
        return self._rms(self.measured - getattr(self, model), held_out)

    def size(self) -> Array:
        """(n,) N m: RMS of the measured torques about their mean."""
        return self._rms(self.measured - np.nanmean(self.measured, axis=0), False)

    def speed(self, held_out: bool = False) -> Array:
        """(n,) rad/s: RMS."""
        return self._rms(self.v, held_out)

    def _rms(self, values: Array, held_out: bool) -> Array:
        squares = np.square(values[self.held_out == held_out])
        known = np.isfinite(squares).sum(axis=0)
        return np.sqrt(np.nansum(squares, axis=0) / np.where(known, known, np.nan))


def torque_errors(
    robot: Robot,
    rigid: RigidEstimate,
    recording: Recording,
    held_from: float,
    constants: Mapping[str, float] | None = None,
    cutoff: float | None = None,
) -> TorqueErrors:
    """Before and after, along a whole recording; samples from `held_from` s on count as held out."""
    motion = motion_of(robot, recording, cutoff)
    width = min(motion.cutoff, BANDWIDTH)
    torques = (
        torques_of(robot, recording, constants),
        stated_torque(robot, motion),
        rigid.model.torque(robot, motion),
        link_torques(robot, motion, rigid.model.inertial),
    )
    measured, before, after, load = (low_pass(x, motion.period, width) for x in torques)
    held = recording.time >= held_from
    return TorqueErrors(recording.time, measured, before, after, motion.q, motion.v, load, held, width)


def stated_torque(robot: Robot, motion: Motion) -> Array:
    """(N, n): what the motors need by what the robot's files say, its drives' springs taken to be stiff."""
    load = link_torques(robot, motion, robot.inertial_parameters)
    found = load.copy()
    for j, drive in enumerate(robot.drives.values()):
        found[:, j] += float(drive.reflected_inertia) * motion.w_dot[:, j]
        for law, speed in ((drive.link_friction, motion.v[:, j]), (drive.motor_friction, motion.w[:, j])):
            friction: Any = law
            found[:, j] += friction.torque(speed, load[:, j]) if friction else 0.0
    return found


def warnings_of(errors: TorqueErrors, joints: tuple[str, ...]) -> list[str]:
    """Sentences on joints whose held-out torques judge nothing, or are explained much worse than those fitted."""
    fitted, held, before = errors.rms("after"), errors.rms("after", True), errors.rms("before")
    moved, moves = errors.speed(), errors.speed(True)
    notes: list[str] = []
    for j, joint in enumerate(joints):
        if moves[j] < STILL * moved[j]:
            notes.append(f"{joint} hardly moves on the part held out: its error there judges nothing")
        if held[j] > WORSE * fitted[j]:
            times = f"{held[j] / fitted[j]:.1f} times that on the part that was fitted"
            reason = "it moves otherwise there, or the machine changed"
            notes.append(f"{joint}: torque error on the part held out is {times}: {reason}")
        if fitted[j] > before[j]:
            notes.append(f"{joint}: the identified model explains its torque worse than the files did")
    return notes
