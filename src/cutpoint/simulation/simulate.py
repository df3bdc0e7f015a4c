"""`simulate`: from a robot, a controller and a reference to a log."""

from collections.abc import Callable, Collection
from types import NoneType
from typing import Any, Literal, get_args

import numpy as np

from cutpoint.arrays import Array
from cutpoint.control.interface import Control, name_of, start_of
from cutpoint.control.own_law import check_encoders
from cutpoint.control.sensors import Sensors, encoders_of
from cutpoint.control.stability.sampled_loop import check_delays
from cutpoint.door import check_choice, check_kind, check_takes, checked_names, whole
from cutpoint.errors import InputError, SimulationError
from cutpoint.robot import Robot
from cutpoint.robot_arguments import A_ROBOT
from cutpoint.rolled import TOO_LARGE
from cutpoint.scalars import with_float_leaves
from cutpoint.simulation.beginning import beginning
from cutpoint.simulation.cache import programs_for
from cutpoint.simulation.controllers import Admitted, FreeResponse, admitted
from cutpoint.simulation.inputs import (
    MOST_STEPS,
    Disturbance,
    noise_of,
    reference_at,
    rows_of,
    sample_times,
)
from cutpoint.simulation.log.log import Log
from cutpoint.simulation.loop.loop import ClosedLoop
from cutpoint.simulation.plant import State
from cutpoint.simulation.recording import log_of
from cutpoint.simulation.runner import run, working_memory
from cutpoint.simulation.steps.steps_reached import check_steps, warn_of
from cutpoint.simulation.steps.substeps import Steps, substeps_for
from cutpoint.trajectories.trajectory import Moves, check_trajectory

Accuracy = Literal["standard", "fine", "reference"]

KINDS: dict[str, tuple[Any, str]] = {
    "robot": (Robot, A_ROBOT),
    "initial": ((State, NoneType), "a State, such as cutpoint.State(q=...)"),
    "sensors": ((Sensors, NoneType), "Sensors, such as cutpoint.Sensors(delay=1e-3)"),
    "disturbances": ((Callable, NoneType), "a function of times (N,) that gives torques (N, nv), or (nv,)"),
    "channels": ((Collection, NoneType), "a collection of names"),
    "hold": ((bool, np.bool_), "True or False"),
}
"""What arguments must be, and how that is said."""


def simulate(
    robot: Robot,
    controller: Control | None = None,
    trajectory: Moves | None = None,
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
    initial: State(q, v, theta, theta_dot, current, strains).  Parts left None start at the reference, with each motor
        leading its link by the static deflection, theta = q + delta(g(q)), at the link's speed; currents carry the
        gravity torques (zero without a controller), and strains are zero.
    sensors: encoders; perfect by default.
    disturbances: a function of the sample times (N,) that gives torques on the links' coordinates, N m, (N, nv), held
        over each period, or constant ones, (nv,).
    accuracy: "standard", Runge-Kutta steps fit for 1e-4 rad in well-posed cases; "fine", for 1e-6; "reference",
        adaptive DOP853 at rtol 1e-12, slow.
    substeps: integration steps per control period; chosen automatically by default, and a StiffnessWarning then says if
        a run needed more.
    hold: False lets the controller act in continuous time, as stability proofs assume, for laws, sensors and drives
        without memory; it is integrated as "reference" is, and logged each control period.
    channels: names of the channels to record, which saves time and memory; all by default.  Without q, theta and
        theta_dot among them nothing can warn of substeps that were too few.
    Returns a Log with one sample each control period, time 0 and the end, as rounded, included.
    Raises InputError for wrong arguments, SimulationError (with the log so far) on divergence, on a command that is not
    a number, or on Ctrl-C.
    """
    check_kinds(robot=robot, trajectory=trajectory, initial=initial, sensors=sensors, disturbances=disturbances,
                channels=channels, hold=hold)  # fmt: skip
    accuracy = _accuracy_of(accuracy, hold)
    times = sample_times(trajectory, duration, control_period)
    reference = reference_at(robot, trajectory, initial, times)
    law = admitted(robot, controller)
    loop, start, commanded = prepared(robot, law, control_period, initial, reference, sensors, channels)
    steps = steps_of(robot, accuracy, substeps, control_period, start, reference)
    rows, noise = rows_of(loop, times, reference, disturbances), noise_of(loop, len(times))
    memory = working_memory(loop, start, commanded, rows, noise, steps.number)
    integrate = _integrator(loop, trajectory, accuracy, hold)
    outcome = run(loop, memory, steps.number, integrate)
    settings: dict[str, object] = {"accuracy": accuracy, "substeps": steps.number, "steps_set_by": steps.cause}
    if integrate is not None:
        settings |= {"substeps": None, "hold": bool(hold)}
    if not outcome.ticks:
        raise SimulationError(outcome.cause or "", diverged=outcome.diverged)
    log = log_of(loop, memory["record"][: outcome.ticks], times, rows, settings)
    if outcome.cause:
        raise SimulationError(outcome.cause, log=log, time=float(times[outcome.ticks - 1]), diverged=outcome.diverged)
    if integrate is None and substeps is None:
        warn_of(check_steps(robot, log))
    return log


def _accuracy_of(accuracy: Accuracy, hold: bool) -> Accuracy:
    """The accuracy that a run has.  Raises InputError for one that is unknown, or that a run has not without hold."""
    check_choice("simulate", "accuracy", accuracy, get_args(Accuracy))
    if hold:
        return accuracy
    if accuracy == "fine":
        raise InputError("simulate: accuracy='fine' has no effect with hold=False, which is 'reference': leave it out")
    return "reference"


def check_kinds(**given: Any) -> None:
    """Raises InputError for an argument that is not of its kind."""
    if (trajectory := given.pop("trajectory", None)) is not None:
        check_trajectory("simulate", trajectory)
    for name, value in given.items():
        check_kind("simulate", name, value, *KINDS[name])
    if (disturbances := given.get("disturbances")) is not None:
        check_takes("simulate: disturbances", disturbances, "times")
    channels = given.get("channels")
    if isinstance(channels, str):
        rule = f"must be a collection of names: channels=[{channels!r}]"
        raise InputError(f"simulate: channels={channels!r} {rule}", name=channels)
    if channels is not None:
        checked_names("simulate", channels, "channels", "a collection of names")


def prepared(
    robot: Robot,
    law: Admitted,
    period: float,
    initial: State | None,
    reference: Array,
    sensors: Sensors | None,
    channels: Collection[str] | None,
) -> tuple[ClosedLoop, State, Array]:
    """The loop, its initial state, and the motors' commands until the first sample, N m."""
    check_size(robot)
    start, commanded = beginning(robot, initial, reference, not isinstance(law.law, FreeResponse))
    encoders = encoders_of(sensors or Sensors(), len(robot.drives), period)
    check_encoders("simulate", law.reads, encoders.sides)
    if encoders.delay >= (last := reference.shape[1] - 1) and law.reads:
        told = f"sensors: delay {encoders.delay * period:g} s is as long as the run, {last * period:g} s"
        raise InputError(f"{told}, so {name_of(law.law)} would see nothing but its start; is it in ms?")
    remembers = with_float_leaves(start_of(law.law))
    programs = programs_for(robot, law, encoders, remembers)
    kept = None if channels is None else frozenset(channels)
    return ClosedLoop(robot, law.law, encoders, remembers, period, programs, law.refusal, kept=kept), start, commanded


def check_size(robot: Robot) -> None:
    """Raises InputError early for a robot too large for its step to be compiled."""
    bodies = len(robot.mechanism.bodies)
    if bodies > TOO_LARGE:
        raise InputError(
            f"simulate: {bodies} bodies are too many for one compiled step, at most {TOO_LARGE}; integrate "
            "robot.elastic_forward_dynamics, which loops over bodies, with an integrator of your own",
            bodies=bodies,
        )


def _integrator(loop: ClosedLoop, trajectory: Moves | None, accuracy: str, hold: bool) -> Any:
    """The integrator from one sample to the next; None for fixed steps."""
    if not hold:
        from cutpoint.simulation.continuous import check_continuous, continuous_step  # with SciPy slow to import

        check_continuous(loop)
        return continuous_step(loop, trajectory)
    if accuracy != "reference":
        return None
    from cutpoint.simulation.adaptive import adaptive_step  # with SciPy slow to import

    return adaptive_step(loop)


def steps_of(robot: Robot, accuracy: str, substeps: int | None, period: float, start: State, reference: Array) -> Steps:
    """Integration steps per control period: the caller's, or those for the accuracy."""
    check_delays("simulate", robot, period)
    if accuracy == "reference":
        if substeps is not None:
            rule = "has no effect with accuracy 'reference' or hold=False: leave it out"
            raise InputError(f"simulate: substeps={substeps!r} {rule}")
        return Steps(1, "the adaptive integrator")
    if substeps is None:
        speeds = np.maximum(np.abs(reference[1]).max(axis=0), np.abs(start.theta_dot))
        return substeps_for(robot, accuracy, period, _poses(robot, start, reference), speeds)
    number = whole("simulate", "substeps", substeps)
    if number > MOST_STEPS:
        remedy = "leave it out for as many as the robot needs, or integrate with accuracy='reference'"
        raise InputError(f"simulate: substeps {number:.6g} must be at most {MOST_STEPS:,}; {remedy}", substeps=number)
    return Steps(number, "the caller")


def _poses(robot: Robot, start: State, reference: Array) -> Array:
    """Where stiffness is judged: the start, and a few places along the reference."""
    poses = np.repeat(np.asarray(start.q)[None], 5, axis=0)
    along = np.linspace(0, reference.shape[1] - 1, 4).round().astype(int)
    poses[1:, [d.q for d in robot.machine.drives]] = reference[0, along]
    return poses
