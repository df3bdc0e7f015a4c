"""`simulate`: a robot, a controller and a reference in; a log out."""

from collections.abc import Callable, Collection, Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.control.interface import Command
from cutpoint.control.law import Law
from cutpoint.door import check_configuration, checked_array
from cutpoint.errors import InputError, SimulationError
from cutpoint.robot import Robot
from cutpoint.rolled import TOO_LARGE
from cutpoint.scalars import structure_of, with_float_leaves
from cutpoint.simulation.adaptive import adaptive_step
from cutpoint.simulation.cache import programs_for
from cutpoint.simulation.continuous import check_continuous, continuous_step
from cutpoint.simulation.integrator import Steps, substeps_for
from cutpoint.simulation.log import Log, Run
from cutpoint.simulation.loop import ClosedLoop
from cutpoint.simulation.noise import noise_beside
from cutpoint.simulation.plant import State, sizes
from cutpoint.simulation.recording import log_of
from cutpoint.simulation.runner import run, working_memory
from cutpoint.simulation.sensors import Sensors, encoders_of
from cutpoint.trajectories import Trajectory

Array = NDArray[np.float64]
Accuracy = Literal["standard", "fine", "reference"]
Disturbance = Callable[[Array], ArrayLike]

MOST_SAMPLES = 10_000_000
"""Of a run: hours at 1 kHz, and with six joints and all channels some 10 GB."""


@dataclass(frozen=True)
class FreeResponse(Law):
    """No torque at all."""

    size: int

    def step(self, memory: Any, measurement: Any, reference: Any) -> tuple[Any, Command]:
        return memory, Command(np.zeros(self.size))


@dataclass(frozen=True)
class _Function(Law):
    """A plain function step(state, measurement, reference) -> (state, command) as a law."""

    function: Callable[..., Any]

    def step(self, memory: Any, measurement: Any, reference: Any) -> Any:
        return self.function(memory, measurement, reference)


def simulate(
    robot: Robot,
    controller: Any = None,
    trajectory: Trajectory | None = None,
    duration: float | None = None,
    control_period: float = 1e-3,
    initial: State | None = None,
    *,
    sensors: Sensors | None = None,
    disturbances: Disturbance | None = None,
    accuracy: Accuracy = "standard",
    substeps: int | None = None,
    hold: bool = True,
    channels: Collection[str] | None = None,
) -> Log:
    """Simulate the robot under a sampled controller: plant, sensors, controller and limits in one compiled loop.

    controller: a law of `cutpoint.control`, or anything with a `step(memory, measurement, reference)` that returns
        (memory, command) and, if it remembers, `start() -> memory`; or that function itself.  None: no torque.
    trajectory: the links' reference; None holds the initial configuration.
    duration: s; the trajectory's own by default; rounded to the nearest whole number of control periods.
    control_period: s; the command is held between samples.
    initial: State(q, v, theta, theta_dot, current, strains); what is left None is where the reference starts, with each
        motor leading its link by what gravity bends the drive, theta = q + delta(g(q)), currents that hold against
        gravity, and no strains.
    sensors: encoders; perfect by default.
    disturbances: a function of the sample times (N,) that gives torques on the links' coordinates, (N, nv), N m, held
        over each period.
    accuracy: "standard", Runge-Kutta steps fit for 1e-4 rad in well-posed cases; "fine", for 1e-6; "reference",
        adaptive DOP853 at rtol 1e-12, slow.  substeps: integration steps a control period, instead of those.
    hold: False lets the controller act at every instant, as proofs in continuous time have it, for laws, sensors and
        drives without memory; it is integrated as "reference" is, and logged each control period.
    channels: names of those that the log is to have, which saves time and memory; all by default.
    Returns a Log with one sample each control period, time 0 and the end, as rounded, included.
    Raises InputError for wrong arguments, SimulationError (with the log so far) on divergence or Ctrl-C.
    """
    times = sample_times(trajectory, duration, control_period)
    reference = reference_at(robot, trajectory, initial, times)
    loop, start, told = prepared(robot, controller, control_period, initial, reference, sensors, channels)
    steps = steps_of(robot, accuracy if hold else "reference", substeps, control_period, start, reference)
    rows, noise = rows_of(loop, times, reference, disturbances), noise_of([loop], len(times))
    memory = working_memory(loop, start, told, rows, noise, torque_limits(robot), steps.number)
    integrate = _integrator(loop, trajectory, accuracy, hold)
    outcome = run(loop, memory, steps.number, integrate)
    settings: dict[str, object] = {"accuracy": accuracy, "substeps": steps.number, "steps_set_by": steps.cause}
    log = log_of(loop, memory["record"][: outcome.ticks], times, reference, settings)
    log = replace(log, run=Run(robot, loop.controller, reference[:, : outcome.ticks]))
    if outcome.cause:
        raise SimulationError(outcome.cause, log=log, time=float(times[outcome.ticks - 1]), diverged=outcome.diverged)
    return log


def prepared(
    robot: Robot,
    controller: Any,
    period: float,
    initial: State | None,
    reference: Array,
    sensors: Sensors | None,
    channels: Collection[str] | None,
    structure: Callable[[Any], Hashable] = structure_of,
) -> tuple[ClosedLoop, State, Array]:
    """The loop, the state it starts from, and what its motors are told until the first sample, N m.

    structure: `structure_of`, or one that knows what it was asked before.
    """
    check_size(robot)
    law, told = _law(robot, controller), np.zeros(len(robot.drives))
    start = _initial(robot, initial, reference)
    if controller is not None:
        told = robot.gravity_forces(start.q)[[d.v for d in robot.machine.drives]]
    start = _with_inner_states(robot, initial, start, told)
    encoders = encoders_of(sensors or Sensors(), len(robot.drives), period)
    _check_sensors(law, encoders.sides)
    remembers = with_float_leaves(law.start() if hasattr(law, "start") else ())
    programs = programs_for(robot, law, encoders, remembers, structure)
    if isinstance(channels, str):
        raise InputError(f"channels={channels!r} must be a collection of names: channels=[{channels!r}]", name=channels)
    kept = None if channels is None else frozenset(channels)
    return ClosedLoop(robot, law, encoders, remembers, period, programs, kept=kept), start, told


def check_size(robot: Robot) -> None:
    """Raises InputError for a robot whose step cannot be compiled, before time is spent on it."""
    bodies = len(robot.mechanism.bodies)
    if bodies > TOO_LARGE:
        raise InputError(
            f"simulate: {bodies} bodies are too many for one compiled step, at most {TOO_LARGE}; integrate "
            "robot.elastic_forward_dynamics, which loops over bodies, with an integrator of your own",
            bodies=bodies,
        )


def _integrator(loop: ClosedLoop, trajectory: Trajectory | None, accuracy: str, hold: bool) -> Any:
    """What goes from one sample to the next; None is fixed steps."""
    if not hold:
        check_continuous(loop)
        return continuous_step(loop, trajectory)
    return adaptive_step(loop) if accuracy == "reference" else None


def steps_of(robot: Robot, accuracy: str, substeps: int | None, period: float, start: State, reference: Array) -> Steps:
    """Integration steps a control period: the caller's, or what the accuracy takes."""
    if accuracy not in ("standard", "fine", "reference"):
        raise InputError(f"simulate: accuracy {accuracy!r} must be 'standard', 'fine' or 'reference'")
    delays = [d.motor.delay for d in robot.drives.values() if d.motor is not None and d.motor.delay is not None]
    if max(delays, default=0.0) > period:
        told = f"a motor's delay {max(delays)} s must not exceed the control period, {period} s"
        raise InputError(f"simulate: {told}; put whole periods into Sensors(delay=)", delay=max(delays))
    if substeps is None and accuracy == "reference":
        return Steps(1, "the adaptive integrator")
    if substeps is None:
        return substeps_for(robot, accuracy, period, _poses(robot, start, reference))
    if int(substeps) != substeps or substeps < 1:
        raise InputError(f"simulate: substeps {substeps!r} must be a whole number, at least 1")
    return Steps(int(substeps), "the caller")


def torque_limits(robot: Robot) -> Array:
    """What each motor can do at most, N m at the joint's side: the drive's limit or the joint's, the smaller.

    Robot files that do not know an effort limit often state 0: there it counts as none.
    """
    efforts = {body.joint.name: body.joint.limits.effort or np.inf for body in robot.mechanism.bodies}
    return np.array([min(drive.limits.effort, efforts[name]) for name, drive in robot.drives.items()])


def sample_times(trajectory: Trajectory | None, duration: float | None, period: float) -> Array:
    if duration is None:
        if trajectory is None:
            raise InputError("simulate: without a trajectory, give duration= in seconds")
        duration = trajectory.duration
    duration, period = float(duration), float(period)
    if not (np.isfinite(period) and period > 0):
        raise InputError(f"simulate: control_period {period} s must be positive")
    if not (np.isfinite(duration) and duration >= period):
        raise InputError(f"simulate: duration {duration} s must be at least one control period, {period} s")
    if not duration / period < MOST_SAMPLES:
        found = f"duration {duration:g} s at control_period {period:g} s takes {duration / period:.3g} samples"
        remedy = "shorten the duration, lengthen the control_period, or run in parts, each from where the last ended"
        raise InputError(f"simulate: {found}, at most {MOST_SAMPLES:,} are kept in memory; {remedy}")
    return np.arange(round(duration / period) + 1, dtype=np.float64) * period


def _law(robot: Robot, controller: Any) -> Any:
    """The controller as a law of the robot's size."""
    if controller is None:
        return FreeResponse(len(robot.drives))
    law = controller if hasattr(controller, "step") else _Function(controller)
    if isinstance(law, _Function) and not callable(controller):
        raise InputError(f"simulate: controller {controller!r} has no step(memory, measurement, reference)")
    for part in getattr(law, "parts", (law,)):
        size = getattr(part, "size", len(robot.drives))
        if size != len(robot.drives):
            raise InputError(f"simulate: {type(part).__name__} is for {size} drives, the robot has {len(robot.drives)}")
    return law


def _check_sensors(law: Any, sides: str) -> None:
    """Raises InputError for a law that reads encoders which are not there."""
    missing = {"both": (), "motor": ("q", "v"), "link": ("theta", "theta_dot")}[sides]
    for part in getattr(law, "parts", (law,)):
        if wanted := [name for name in getattr(part, "needs", ()) if name in missing]:
            told = f"{type(part).__name__} reads {', '.join(wanted)}, and sensors are on the {sides} side only"
            raise InputError(f"simulate: {told}; take a law of that side, or Sensors(sides='both')", needs=wanted)


def reference_at(robot: Robot, trajectory: Trajectory | None, initial: State | None, times: Array) -> Array:
    """The links' reference with four derivatives, (5, N, drives)."""
    n = len(robot.drives)
    if trajectory is None:
        hold = np.zeros((5, len(times), n))
        if initial is not None and initial.q is not None:
            q = checked_array("simulate", "initial.q", initial.q, robot.nq)
            hold[0] = q[[d.q for d in robot.machine.drives]]
        return hold
    if trajectory.size != n:
        raise InputError(f"simulate: the trajectory has {trajectory.size} joints, the robot has {n} drives")
    reference = trajectory.derivatives(times, 4)
    for extreme in (reference[0].min(axis=0), reference[0].max(axis=0)):
        check_configuration(robot.mechanism, extreme)
    return reference


def _initial(robot: Robot, initial: State | None, reference: Array) -> State:
    given = initial or State()
    q = robot.neutral()
    driven = [d.q for d in robot.machine.drives]
    q[driven] = reference[0, 0]
    v = np.zeros(robot.nv)
    v[[d.v for d in robot.machine.drives]] = reference[1, 0]
    q = q if given.q is None else checked_array("simulate", "initial.q", given.q, robot.nq)
    v = v if given.v is None else checked_array("simulate", "initial.v", given.v, robot.nv)
    theta = q[driven] + robot.static_deflection(q) if given.theta is None else given.theta
    omega = v[[d.v for d in robot.machine.drives]] if given.theta_dot is None else given.theta_dot
    theta = checked_array("simulate", "initial.theta", theta, len(driven))
    return State(q, v, theta, checked_array("simulate", "initial.theta_dot", omega, len(driven)))


def _with_inner_states(robot: Robot, initial: State | None, start: State, told: Array) -> State:
    """Currents that hold the arm, or none at all without a controller; drives without a past."""
    given, expected = initial or State(), sizes(robot.machine)
    lagging = [d.drive.motor is not None and d.drive.motor.bandwidth is not None for d in robot.machine.drives]
    current = told[lagging] if given.current is None else given.current
    strains = np.zeros(expected.strains) if given.strains is None else given.strains
    return start._replace(
        current=checked_array("simulate", "initial.current", current, expected.current),
        strains=checked_array("simulate", "initial.strains", strains, expected.strains),
    )


def _poses(robot: Robot, start: State, reference: Array) -> Array:
    """Where stiffness is judged: the start, and a few places along the reference."""
    poses = np.repeat(np.asarray(start.q)[None], 5, axis=0)
    along = np.linspace(0, reference.shape[1] - 1, 4).round().astype(int)
    poses[1:, [d.q for d in robot.machine.drives]] = reference[0, along]
    return poses


def rows_of(loop: ClosedLoop, times: Array, reference: Array, disturbances: Disturbance | None) -> Array:
    """What each control period is given: see `Layout.row`."""
    layout = loop.layout
    parts = [times[:, None], *reference]
    if disturbances is None:
        parts.append(np.zeros((len(times), layout.nv)))
    else:
        pushed = checked_array("simulate", "disturbances(times)", disturbances(times), layout.nv)
        if pushed.shape not in ((layout.nv,), (len(times), layout.nv)):
            expected = (len(times), layout.nv)
            raise InputError(f"simulate: disturbances(times) has shape {pushed.shape}, it must be {expected}")
        parts.append(np.broadcast_to(pushed, (len(times), layout.nv)))
    return np.ascontiguousarray(np.concatenate(parts, axis=1))


def noise_of(loops: Sequence[ClosedLoop], samples: int) -> Array:
    """Standard normal numbers of runs side by side, a row a sample."""
    seeds = [loop.encoders.seed for loop in loops]
    return noise_beside(seeds, samples, loops[0].layout.noise, loops[0].robot.backend)
