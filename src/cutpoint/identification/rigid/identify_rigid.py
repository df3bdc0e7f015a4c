"""Rigid model from a recording: bodies, rotors, friction, and what the log cannot determine of them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.identification.conditioning.correlated_noise import independent
from cutpoint.identification.conditioning.decimation import decimation
from cutpoint.identification.conditioning.motion import Motion, check_friction, motion_of, sliding_speeds, torques_of
from cutpoint.identification.logs.recording import Recording, check_recording
from cutpoint.identification.one_thread import by_one_thread
from cutpoint.identification.rigid.arguments import (
    check_options,
    check_parts,
    check_rotor_errors,
    checked_errors,
    checked_friction,
)
from cutpoint.identification.rigid.base_parameters import BaseParameters, base_parameters, rotor_sizes
from cutpoint.identification.rigid.friction_choice import FrictionChoice, choose_friction
from cutpoint.identification.rigid.friction_shape import best_shapes, shape_slopes
from cutpoint.identification.rigid.instrumental import LATER, instrumental_variables
from cutpoint.identification.rigid.least_squares import Estimate, least_squares, solved
from cutpoint.identification.rigid.physical import Solver, check_solver, physical
from cutpoint.identification.rigid.physical_fit import fit_of
from cutpoint.identification.rigid.regression import Regression, regression
from cutpoint.identification.rigid.rigid_estimate import Fitted, RigidEstimate, TorqueData, estimate_of, sizes_of_others
from cutpoint.identification.rigid.rigid_robot import (
    error_slopes,
    friction_of_links,
    is_stated,
    laws_with,
    link_torques,
    stated_laws,
    transmitted,
)
from cutpoint.identification.rigid.uncertainty import are_told
from cutpoint.joint_units import at_joints
from cutpoint.mechanics.drives.friction import Sliding
from cutpoint.model.drive import Friction, KinematicError
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot

Method = Literal["ordinary", "weighted", "huber", "instrumental"]
FrictionWish = Literal["choose", "stated"] | Mapping[str, Sliding] | tuple[FrictionChoice, ...]

BANDWIDTH = 10.0
"""Largest default bandwidth of the fitted torques, Hz: arms are excited below, drives resonate above."""

WRONG = 3.0
"""Standard deviations by which links may be off while friction laws are compared."""

LITTLE = 0.5
"""Share of the numbers that are determined, below which the reason is given."""

LOADED_ROUNDS = 3
"""Rounds in which the load of load-dependent friction is updated."""


@by_one_thread
def identify_rigid(
    robot: Robot,
    recording: Recording,
    *,
    friction: FrictionWish = "choose",
    method: Method = "huber",
    instruments: Recording | None = None,
    rotors: bool | Collection[str] = True,
    offsets: bool = True,
    solver: Solver = "lmi",
    prior_spread: float = 0.5,
    level: float = 0.95,
    cutoff: float | None = None,
    bandwidth: float | None = None,
    torque_constants: Mapping[str, float] | None = None,
    rotor_errors: Mapping[str, float] | None = None,
    link_friction: Mapping[str, Friction] | None = None,
    kinematic_errors: Mapping[str, KinematicError] | None = None,
) -> RigidEstimate:
    """Estimates inertias of all bodies, rotors, friction and offsets from a recording's torques.

    friction: "choose" the law of each joint, see `choose_friction`; "stated" uses those of the drives, or Coulomb's; or
        laws by joint, as initial shapes; or another fit's choices, whose shapes are fitted again.
    method: "huber", where large residuals count linearly, such as those of a joint that shakes as it reverses;
        "ordinary" or "weighted" least squares; "instrumental" if noise of the positions matters;
        instruments: for the latter, the desired or simulated motion at the same times.
    rotors: whether to estimate every joint's rotor inertia, or those of which joints; others are as the drives state.
    offsets: whether to estimate a constant torque offset for each joint.
    solver: for physically consistent bodies, see `physical`.  prior_spread: their standard deviation from the file's,
        as a share: 0.5 is half of a body's mass.  level: confidence level of the intervals.
    cutoff: Hz, of the positions, by default where they fall below their noise.  bandwidth: Hz, of the fitted torques,
        by default the same, at most 10 Hz.
    torque_constants: N m at the joint per ampere, by joint, for recordings of currents.
    rotor_errors: standard deviations, kg m2 at the joint, of the inertias of rotors that are not estimated, by joint.
    link_friction: by joint, the link's part of its friction: the drive transmits it, which adds to friction that grows
        with load; by default the share that the drive states.
    kinematic_errors: by joint, in phase with the recording's motors, which bear their reaction; none by default, since
        files rarely state the right phase.
    Intervals include the uncertainty of fitted friction shapes and of known rotors.

    A commanded torque that is held over a control period acts half a period later: align it first.

    Raises:
        InputError: arguments that do not match each other or the recording.
        CutpointError: a missing solver.
    """
    check_robot("identify_rigid", robot)
    check_recording("identify_rigid", recording)
    check_options(method, instruments, level, prior_spread)
    check_solver(solver)
    check_friction("identify_rigid", robot)
    known, errors = checked_friction(link_friction, robot), checked_errors(kinematic_errors, robot)
    base = base_parameters(robot, rotors=rotors)
    check_rotor_errors(rotor_errors, robot, [robot.joints[j] for j in base.rotors])
    log = _log(robot, recording, base.rotors, cutoff, bandwidth, torque_constants, errors)
    stated = stated_laws(robot, log.motion)
    log = _loaded(log, robot, robot.inertial_parameters, friction_of_links(robot, stated, known))
    asked = None if instruments is None else _asked(robot, recording, instruments, log.motion.cutoff)
    how = _How(method, asked, offsets, (), rotor_errors or {}, known, errors, prior_spread, solver)
    if errors or friction == "choose" or isinstance(friction, tuple):
        # errors' reaction depends on the load, friction may; the file's bodies may be far off
        log = _loaded_as(_fitted(base, stated, log, how))
    choices = _choices(base, stated, log, offsets) if friction == "choose" else ()
    if isinstance(friction, tuple):
        choices = _shaped(friction, base, stated, log, offsets)
    how = how._replace(shaped=[choice.joint for choice in choices])

    def estimated(choices: tuple[FrictionChoice, ...]) -> RigidEstimate:
        laws = _laws(robot, stated, friction, choices)
        fitted = _fitted(base, laws, log, how)
        is_loaded = bool(errors) or any(law.per_load is not None for law in laws.values())
        for _ in range(LOADED_ROUNDS - 1 if is_loaded else 0):
            fitted = _fitted(base, laws, _loaded_as(fitted), how)
        return estimate_of(fitted, level, choices, recording.notes)

    result = estimated(choices)
    settled = _without_idle_loads(choices, stated, result)
    result = result if settled == choices else estimated(settled)
    return _with_note_on_lags(result) if method == "instrumental" and instruments is None else result


class _How(NamedTuple):
    """Options of a fit, as in `identify_rigid`.

    asked: the instruments' motion.  shaped: joints with fitted friction shapes.
    """

    method: Method
    asked: Motion | None
    offsets: bool
    shaped: Sequence[str]
    rotor_errors: Mapping[str, float]
    link_friction: Mapping[str, Friction]
    kinematic_errors: Mapping[str, KinematicError]
    prior_spread: float
    solver: Solver


def _fitted(base: BaseParameters, laws: Mapping[str, Sliding], log: TorqueData, how: _How) -> Fitted:
    """The fit of the torques, with physically consistent bodies."""
    of = partial(regression, base, laws, torque=log.torque, means=log.means, offsets=how.offsets, loads=log.loads)
    found, instead = of(log.motion), None if how.asked is None else of(how.asked).columns
    values = _estimate(found, how.method, instead).values.tolist()
    _, shapes = shape_slopes(base, laws_with(laws, dict(zip(found.names, values, strict=True))), how.shaped, log)
    estimate = _estimate(found, how.method, instead, shapes, _rotor_torques(base, log, how.rotor_errors))
    sizes = sizes_of_others(base, log, found.names[base.independent.size :])
    told = are_told(estimate, base.independent.size, sizes)
    fit = fit_of(base, found.names, laws, estimate.R, estimate.z, sizes, told, how.prior_spread)
    bodies = physical(fit, how.solver)
    return Fitted(base, laws, how.link_friction, how.kinematic_errors, log, found, estimate, bodies)


def _loaded_as(fitted: Fitted) -> TorqueData:
    """The log with the loads of drives according to its fit."""
    model = fitted.model
    return _loaded(fitted.log, fitted.base.robot, model.inertial, model.of_links)


def _loaded(log: TorqueData, robot: Robot, inertial: Array, of_links: Mapping[str, Friction]) -> TorqueData:
    """The log with the loads of drives by inertial parameters (10 bodies,) and the links' friction."""
    links = link_torques(robot, log.motion, inertial)
    return log._replace(loads=transmitted(robot, log.motion, links, of_links))


def bandwidth_of(motion: Motion, bandwidth: float | None) -> float:
    """Bandwidth of the fitted torques, Hz: that of the motion, at most BANDWIDTH, unless stated."""
    return min(motion.cutoff, BANDWIDTH) if bandwidth is None else bandwidth


def _log(
    robot: Robot,
    recording: Recording,
    rotors: Sequence[int],
    cutoff: float | None,
    bandwidth: float | None,
    torque_constants: Mapping[str, float] | None,
    errors: Mapping[str, KinematicError],
) -> TorqueData:
    motion, torque = motion_of(robot, recording, cutoff), torques_of(robot, recording, torque_constants)
    stated = np.array([float(drive.reflected_inertia) for drive in robot.drives.values()])
    stated[[*rotors]] = 0.0
    torque = torque - stated * motion.w_dot
    width = bandwidth_of(motion, bandwidth)
    known = motion.known() & np.isfinite(torque).all(axis=1)
    means, slopes = decimation(known, motion.period, width), error_slopes(robot, motion, errors)
    start = float(recording.time[0])
    return TorqueData(motion, torque, means, stated, width, start, slopes, loads=np.zeros_like(torque))


def _estimate(found: Regression, method: Method, instruments: Array | None, *beside: Array) -> Estimate:
    """beside: shapes and known, which the spread includes."""
    if method == "instrumental":
        return instrumental_variables(found, instruments, *beside)
    return least_squares(found, method, *beside)


def _choices(
    base: BaseParameters, laws: Mapping[str, Sliding], log: TorqueData, offsets: bool
) -> tuple[FrictionChoice, ...]:
    """The law of each moving joint, from its torques less those of the links.

    The links' torques come from a fit with the stated laws, and are uncertain by its deviations.  That fit lumps some
    rotors with their links: where friction reverses, their motors move otherwise, which counts as uncertain too.
    """
    b, found = base.independent.size, list[FrictionChoice]()
    first = regression(base, laws, log.motion, log.torque, log.means, offsets=offsets, loads=log.loads)
    estimate = least_squares(first)
    likely = WRONG * independent(solved(estimate.R, estimate.z)[1][:b, :b])
    torque = first.torque - first.columns[..., :b] @ estimate.values[:b]
    speeds, apart = sliding_speeds(base.robot, log.motion), np.zeros(len(base.robot.joints))
    apart[[*base.rotors]] = WRONG * rotor_sizes(base)[0]
    winding = log.means((log.motion.w_dot - log.motion.a) * apart)
    for j, joint in enumerate(base.robot.joints):
        speed, others = speeds[:, j], np.column_stack([first.columns[:, j, :b] @ likely, winding[:, j]])
        if np.nanstd(speed) > 0.0:
            noise = float(estimate.noise[j])
            own, load, law = torque[:, j], log.loads[:, j], laws[joint] if is_stated(base.robot, joint) else None
            found.append(choose_friction(joint, own, others, noise, speed, log.means, load, offsets, law))
    return _shaped(tuple(found), base, laws, log, offsets)


def _shaped(
    choices: tuple[FrictionChoice, ...],
    base: BaseParameters,
    laws: Mapping[str, Sliding],
    log: TorqueData,
    offsets: bool,
) -> tuple[FrictionChoice, ...]:
    """The same laws with the shapes that fit the torques of all joints best, and their units."""
    chosen = {each.joint: each.law for each in choices}
    shaped = best_shapes(base, {**laws, **chosen}, chosen, log, offsets)
    units = at_joints(base.robot, "N m")
    return tuple(replace(each, law=shaped[each.joint], unit=units[each.joint]) for each in choices)


def _without_idle_loads(
    choices: tuple[FrictionChoice, ...], stated: Mapping[str, Sliding], found: RigidEstimate
) -> tuple[FrictionChoice, ...]:
    """The choices, without growth with load where the interval holds none and no file states any."""

    def is_idle(choice: FrictionChoice) -> bool:
        is_new = choice.law.per_load is not None and stated[choice.joint].per_load is None
        return is_new and found[f"per_load.{choice.joint}"].low <= 0.0

    return tuple(choice.without_load() if is_idle(choice) else choice for choice in choices)


def _with_note_on_lags(found: RigidEstimate) -> RigidEstimate:
    """Adds a note if lagged instruments are weak."""
    if found.told > LITTLE * len(found.parameters):
        return found
    before = LATER * float(np.median(np.diff(found.times)))
    words = f"instruments tell {found.told} of {len(found.parameters)} numbers: their motion is {before:.3g} s old"
    remedy = "give identify_rigid the commanded motion as instruments, or use method='huber', --method huber"
    return replace(found, notes=(*found.notes, f"{words}, and has changed since; {remedy}"))


def _rotor_torques(base: BaseParameters, log: TorqueData, errors: Mapping[str, float]) -> Array:
    """(M, n, n): additional torques if each rotor's inertia were larger by its error."""
    sizes = np.array([errors.get(joint, 0.0) for joint in base.robot.joints])
    return np.asarray(log.means(log.motion.w_dot * sizes)[..., None] * np.eye(sizes.size))


def _laws(
    robot: Robot, stated: Mapping[str, Sliding], wish: FrictionWish, choices: tuple[FrictionChoice, ...]
) -> dict[str, Sliding]:
    """The law of each joint: stated, chosen, or wished for."""
    laws = {**stated, **{choice.joint: choice.law for choice in choices}}
    if isinstance(wish, Mapping):
        check_parts("friction", wish, robot, Sliding, "Coulomb's or Stribeck's law")
        laws |= wish
    elif not isinstance(wish, tuple) and wish not in ("choose", "stated"):
        raise InputError(f"friction {wish!r} must be 'choose', 'stated', or laws by joint", friction=wish)
    return laws


def _asked(robot: Robot, recording: Recording, instruments: Recording, cutoff: float) -> Motion:
    if not np.array_equal(recording.time, instruments.time):
        raise InputError("instruments must have the recording's times: sample the reference at recording.time")
    return motion_of(robot, instruments, cutoff)
