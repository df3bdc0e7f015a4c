"""The result of rigid identification: a model, confidence intervals, and what could not be identified."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.door import checked_name
from cutpoint.identification.conditioning.decimation import Decimation
from cutpoint.identification.conditioning.motion import (
    Motion,
    motion_of,
    slide_with_motors,
    sliding_speeds,
    still_joints,
)
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.rigid.base_parameters import BaseParameters
from cutpoint.identification.rigid.friction_choice import FrictionChoice
from cutpoint.identification.rigid.lateness import lateness_notes, not_judged, without_reversals
from cutpoint.identification.rigid.least_squares import Estimate
from cutpoint.identification.rigid.physical import Physical
from cutpoint.identification.rigid.regression import Regression, other_side_columns
from cutpoint.identification.rigid.rigid_robot import RigidModel, friction_of_links, laws_with, stated_coefficient
from cutpoint.identification.rigid.torque_scale import scale_notes
from cutpoint.identification.rigid.uncertainty import (
    Parameter,
    base_sizes,
    friction_sizes,
    parameters,
    reversed_signs,
    strained,
    untold,
)
from cutpoint.joint_units import are_prismatic, at_joints
from cutpoint.mechanics.drives.friction import Sliding, Stribeck
from cutpoint.model.drive import Friction, KinematicError
from cutpoint.robot import Robot

FAST = 0.5
"""Share of the joint's top speed: with a larger Stribeck velocity, the log lacks the speeds at which the peak is over,
and any curved friction has such a law."""

HARDLY = 0.01
"""Share of the liveliest joint's travel, or for slides of what their limits allow: a joint that travels less hardly
moves."""


@dataclass(frozen=True, eq=False, repr=False)
class RigidEstimate:
    """Result of rigid identification.

    robot: with new inertias, rotors and friction, and physically consistent bodies.  model: the same as a torque model.
    parameters: base parameters, friction and offsets, each with its interval and whether the log determines it.
    residuals: (M, n) N m, of the fit behind the intervals, at times (M,), s; noise (n,), their size.
    cutoff: of the positions, Hz.
    friction: how each joint's law was chosen, if it was.  untold: what this log cannot determine, in sentences.
    doubts: signs, times and sizes of torques that the fit contradicts.  notes: how the recording was processed.
    """

    robot: Robot
    model: RigidModel
    parameters: tuple[Parameter, ...]
    residuals: Array
    times: Array
    noise: Array
    cutoff: float
    untold: tuple[str, ...]
    doubts: tuple[str, ...]
    notes: tuple[str, ...]
    friction: tuple[FrictionChoice, ...] = ()

    def __getitem__(self, name: str) -> Parameter:
        """A parameter by its name.  Raises InputError for an unknown one, with a list of the known ones."""
        named = {each.name: each for each in self.parameters}
        return named[checked_name("identified parameter", name, named)]

    def __repr__(self) -> str:
        return f"RigidEstimate({self.robot.name!r}: {self.told} of {len(self.parameters)} parameters told)"

    @property
    def told(self) -> int:
        """The number of parameters that the log determines."""
        return sum(each.told for each in self.parameters)

    def prediction(self, recording: Recording, cutoff: float | None = None) -> Array:
        """(N, n): predicted motor torques, N m at the joint, for a recording's motion; NaN where it is unknown.

        cutoff: of the positions, Hz, as in `identify_rigid`.
        Raises InputError for joints that were not recorded, no positions, or uneven times.
        """
        return self.model.torque(self.robot, motion_of(self.robot, recording, cutoff))


class TorqueData(NamedTuple):
    """A recording as used: all samples, and their decimation.

    of_motors: torques (N, n), N m, less those of rotors that are not sought.  stated: reflected inertias (n,), kg m2,
    of these, 0 for others.  width: Hz, of the means.  start: s, of the first sample.  slopes: (N, n), as in
    `error_slopes`.  loads: (N, n), N m, that the drives transmit, as far as they are known: friction may depend on
    them, and kinematic errors take a share of them.
    """

    motion: Motion
    of_motors: Array
    means: Decimation
    stated: Array
    width: float
    start: float
    slopes: Array
    loads: Array

    @property
    def torque(self) -> Array:
        """(N, n), N m: of drives without kinematic errors."""
        return self.of_motors + self.slopes * self.loads


class Fitted(NamedTuple):
    """Data and results of a fit.  link_friction, errors: by joint, known friction and kinematic errors."""

    base: BaseParameters
    laws: Mapping[str, Sliding]
    link_friction: Mapping[str, Friction]
    errors: Mapping[str, KinematicError]
    log: TorqueData
    regression: Regression
    estimate: Estimate
    bodies: Physical

    @property
    def model(self) -> RigidModel:
        """The model with physically consistent bodies."""
        robot, b = self.base.robot, self.base.independent.size
        others = dict(zip(self.regression.names[b:], self.bodies.others.tolist(), strict=True))
        offsets = np.array([others.get(f"offset.{joint}", 0.0) for joint in robot.joints])
        rotors = self.log.stated.copy()
        rotors[[*self.base.rotors]] = self.bodies.rotors
        laws = laws_with(self.laws, others)
        of_links = friction_of_links(robot, laws, self.link_friction)
        return RigidModel(self.bodies.inertial, rotors, offsets, laws, of_links, slide_with_motors(robot), self.errors)


def estimate_of(
    fitted: Fitted, level: float, choices: tuple[FrictionChoice, ...], notes: tuple[str, ...]
) -> RigidEstimate:
    """The estimate of a fit, with intervals at a level."""
    base, log, found, estimate, model = fitted.base, fitted.log, fitted.regression, fitted.estimate, fitted.model
    robot, table = base.robot, _table(fitted, level)
    steady = without_reversals(sliding_speeds(robot, log.motion), log.motion, log.means)
    return RigidEstimate(
        robot=model.robot(robot),
        model=model,
        parameters=table,
        residuals=estimate.residuals,
        times=log.start + found.times[len(found.times) - len(estimate.residuals) :],
        noise=estimate.noise,
        cutoff=log.motion.cutoff,
        untold=untold(table, base),
        doubts=(*reversed_signs(table), *_scaled(fitted), *_late(fitted, steady)),
        notes=(
            *notes,
            *_standing(robot, log),
            *_simplified(model, robot),
            *_notes(log, found, estimate),
            *strained(table, _costs(fitted)),
            *_curves(fitted, choices),
            *not_judged(found, steady),
        ),
        friction=choices,
    )


def _curves(fitted: Fitted, choices: Sequence[FrictionChoice]) -> list[str]:
    """Sentences on chosen laws that fit the speeds of the log, and say nothing about others."""
    robot, log, notes = fitted.base.robot, fitted.log, list[str]()
    units, tops = at_joints(robot, "rad/s"), np.nanmax(np.abs(sliding_speeds(robot, log.motion)), axis=0).tolist()
    chosen = {choice.joint for choice in choices}
    for (joint, law), top in zip(fitted.model.laws.items(), tops, strict=True):
        if joint not in chosen or not isinstance(law, Stribeck):
            continue
        is_bare, unit = law.coulomb == 0.0 < law.static, units[joint]
        if law.stribeck_velocity > FAST * top or is_bare:
            bound = ", coulomb at its bound, 0" if is_bare else ""
            speeds = f"up to {top:.3g} {unit} (stribeck_velocity {law.stribeck_velocity:.3g} {unit}{bound})"
            rule = "its numbers mean little singly, and it does not extrapolate: record faster motion to use it there"
            notes.append(f"{joint}: friction is a curve through this log's speeds, {speeds}: {rule}")
    return notes


def _scaled(fitted: Fitted) -> list[str]:
    robot, motion = fitted.base.robot, fitted.log.motion
    is_one_side = np.array_equal(motion.q, motion.theta, equal_nan=True)
    bend = is_one_side and any(drive.is_elastic for drive in robot.drives.values())
    return scale_notes(fitted.regression, fitted.estimate.values, robot.joints, bend)


def _late(fitted: Fitted, steady: NDArray[np.bool_]) -> list[str]:
    laws, robot, log = fitted.laws, fitted.base.robot, fitted.log
    beside = other_side_columns({joint: laws[joint] for joint in robot.joints}, log.motion, log.means)
    bend = any(drive.is_elastic for drive in robot.drives.values())
    return lateness_notes(fitted.regression, fitted.estimate.values, beside, steady, robot.joints, bend)


def _table(fitted: Fitted, level: float) -> tuple[Parameter, ...]:
    base, log, found, estimate, bodies = fitted.base, fitted.log, fitted.regression, fitted.estimate, fitted.bodies
    b = base.independent.size
    sizes = np.concatenate([base_sizes(base), sizes_of_others(base, log, found.names[b:])])
    stated = np.array([stated_coefficient(base.robot, name) for name in found.names[b:]])
    prior = np.concatenate([base.nominal, stated])
    return parameters(found.names, estimate, bodies.base, prior, sizes, level)


def _costs(fitted: Fitted) -> dict[str, float]:
    """By joint, the torque error with physically consistent bodies over that of the fit's own numbers."""
    errors = (fitted.regression.residuals(values) for values in (fitted.bodies.base, fitted.estimate.values))
    model, own = (np.sqrt(np.mean(each**2, axis=0)) for each in errors)
    ratios = np.where(own > 0.0, model, 1.0) / np.where(own > 0.0, own, 1.0)
    return dict(zip(fitted.base.robot.joints, ratios.tolist(), strict=True))


def sizes_of_others(base: BaseParameters, log: TorqueData, names: Sequence[str]) -> Array:
    """Usual sizes of friction and offsets (k,) in a robot that moves and works as in this log."""
    channels = log.torque, sliding_speeds(base.robot, log.motion)
    torque, speed = (np.sqrt(np.mean(log.means(x) ** 2, axis=0)) for x in channels)
    return friction_sizes(names, base.robot.joints, torque, speed)


def _standing(robot: Robot, log: TorqueData) -> list[str]:
    """Sentences on joints that stood still, and on those that hardly moved, as in a controller's hold."""
    still, travel = still_joints(robot, log.motion), np.ptp(log.motion.q[log.motion.known()], axis=0)
    slight = zip(robot.joints, travel < HARDLY * _lively(robot, travel), strict=True)
    hardly = [joint for joint, is_slight in slight if is_slight and joint not in still]
    notes: list[str] = []
    if still:
        notes.append(f"{', '.join(still)} stood still: what moves only with these, and their friction, is not told")
    if hardly:
        words = f"{', '.join(hardly)} hardly moved, less than {HARDLY:.0%} as far as another joint, or a slide's range"
        notes.append(f"{words}: its numbers, and those of joints beside it, may be outside their intervals: move it")
    return notes


def _lively(robot: Robot, travel: Array) -> Array:
    """What joints' travel is compared with, (n,): that of another of its kind, or a slide's range, if stated."""
    slides, ranges = np.array(are_prismatic(robot)), [each.upper - each.lower for each in robot.limits.values()]
    most = np.array([travel[slides == own].max() for own in slides])
    return np.where(slides & np.isfinite(ranges), np.maximum(most, ranges), most)


def _simplified(model: RigidModel, robot: Robot) -> list[str]:
    """Sentences on what a drive states but the model lacks."""
    coupled = [joint for joint, drive in robot.drives.items() if drive.is_coupled and drive.reflected_inertia]
    moved = [
        joint
        for joint, drive in robot.drives.items()
        if drive.link_friction and not drive.motor_friction and model.laws[joint].per_load is not None
    ]
    notes: list[str] = []
    if coupled:
        effect = "their carriers' rotation about their axes does not load them here, and bodies absorb its effect"
        notes.append(f"at {', '.join(coupled)}, rotors are fully coupled: {effect}")
    if moved:
        side = "only a motor's can, so it is now stated for the motor"
        notes.append(f"at {', '.join(moved)}, friction grows with load: {side}")
    return notes


def _notes(log: TorqueData, found: Regression, estimate: Estimate) -> list[str]:
    lag, step = estimate.spread.lag, float(np.median(np.diff(found.times)))
    return [
        f"positions low-passed at {log.motion.cutoff:.4g} Hz, torques explained up to {log.width:.4g} Hz: "
        f"{len(found.times)} means of {log.means.window.size} samples, {step:.4g} s apart",
        f"intervals treat residuals as correlated over {lag} means, {lag * step:.3g} s, "
        f"and have {estimate.spread.degrees:.0f} degrees of freedom",
    ]
