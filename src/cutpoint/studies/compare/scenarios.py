"""Departures from the model, one at a time: the plant, the law's model, its sensors, the motion."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.model.drive import Drive, Harmonic
from cutpoint.robot import Robot
from cutpoint.simulation import Sensors
from cutpoint.studies.compare.bench import FAST, SLOW, USUAL, Bench
from cutpoint.studies.drive_effects import (
    ERROR,
    FRICTION,
    HYSTERESIS,
    LAG,
    PRESLIDING,
    RIPPLE,
    STIFFNESS,
    drive_with,
)
from cutpoint.studies.paper.bench import DAMPING
from cutpoint.trajectories import Trajectory

TURN = 2 * np.pi

LINK_STEP, MOTOR_STEP, NOISE = TURN / 2**16, TURN / 2**12, 1e-5
"""Steps of the encoders, rad at the link and at the rotor; noise of both, rad at the joint's side."""

STIFF = ("stiffness", "k1", "k2", "k3")
RUBS = ("coulomb", "static", "viscous", "per_load")
"""Numbers of springs and of frictions that are N m."""

KNOWN = (STIFFNESS, FRICTION)
WHOLE = (*KNOWN, ERROR, HYSTERESIS, PRESLIDING, LAG, RIPPLE)
"""Whole drives: the effects in the model, and those in the plant."""


class Case(NamedTuple):
    """One run: the plant, the model that laws believe in, the sensors, the reference, and the motor torques (N, n) that
    the plant needs for it, N m, but for effects that no model here knows."""

    plant: Robot
    model: Robot
    sensors: Sensors
    move: Trajectory
    ideal: Array


class Scenario(NamedTuple):
    """key: in results.  name: a column's.  what: in a sentence.  cases: of a bench, for so many seeds."""

    key: str
    name: str
    what: str
    cases: Callable[[Bench, int], Iterator[Case]]


def as_modelled(bench: Bench, duration: float = USUAL, plant: Robot | None = None) -> Case:
    """With perfect sensors; plant: the bench's robot, or another, and the model is that."""
    plant = plant or bench.robot
    move = bench.move(duration)
    times = np.arange(round(move.duration / bench.control_period) + 1) * bench.control_period
    ideal = plant.elastic_inverse_dynamics(*move(times), quasi_rigid=True).motor_torque
    return Case(plant, plant, Sensors(), move, ideal)


def _once(duration: float, bench: Bench, seeds: int) -> Iterator[Case]:
    yield as_modelled(bench, duration)


def _masses(size: float, bench: Bench, seeds: int) -> Iterator[Case]:
    """All too light, all too heavy, and alternating."""
    case, count = as_modelled(bench), len(bench.robot.mechanism.bodies)
    for even, odd in ((-1, -1), (1, 1), (1, -1), (-1, 1)):
        factors = [1 + size * (odd if k % 2 else even) for k in range(count)]
        yield case._replace(model=with_masses(bench.robot, factors))


def with_masses(robot: Robot, factors: Sequence[float]) -> Robot:
    """Mass and moments of inertia of each body, scaled by these factors."""
    bodies = [
        replace(body, mass=body.mass * x, inertia=body.inertia * x)
        for body, x in zip(robot.mechanism.bodies, factors, strict=True)
    ]
    return Robot(replace(robot.mechanism, bodies=tuple(bodies)), robot.drives, backend=robot.backend)


def _numbers(names: tuple[str, ...], size: float, bench: Bench, seeds: int) -> Iterator[Case]:
    """Numbers of each drive, wrong by a random share that depends on the seed."""
    case = as_modelled(bench)
    for seed in range(seeds):
        factors = 1 + size * np.random.default_rng(seed).uniform(-1, 1, len(bench.robot.drives))
        drives = zip(bench.robot.drives.items(), factors, strict=True)
        wrong = {name: scaled(drive, names, float(x)) for (name, drive), x in drives}
        yield case._replace(model=bench.robot.with_drives(wrong))


def scaled(record: Any, names: tuple[str, ...], factor: float) -> Any:
    """A drive, or a law in it, with the numbers of these names scaled."""
    changed: dict[str, Any] = {}
    for field in fields(record):
        value = getattr(record, field.name)
        if field.name in names and value is not None:
            changed[field.name] = value * factor
        elif is_dataclass(value) and field.name in _LAWS:
            changed[field.name] = scaled(value, names, factor)
    return replace(record, **changed)


_LAWS = ("compliance", "link_friction", "motor_friction", "spring", "flexspline", "wave_generator", "sliding")
"""Fields of drives, and of laws in them, that hold what bends or rubs; bristles and hysteresis stay as they are."""


def _sensors(delay: int, damped: bool, bench: Bench, seeds: int) -> Iterator[Case]:
    """delay: in periods.  damped: with drives that lose some of what swings in them, which the model knows."""
    case = as_modelled(bench, plant=with_damping(bench.robot) if damped else None)
    ratios = np.abs([drive.ratio for drive in bench.robot.drives.values()])
    for seed in range(seeds):
        sensors = Sensors(
            link_resolution=LINK_STEP, motor_resolution=MOTOR_STEP / ratios, link_noise=NOISE, motor_noise=NOISE,
            delay=delay * bench.control_period, speeds="differenced", seed=seed,
        )  # fmt: skip
        yield case._replace(sensors=sensors)


def with_damping(robot: Robot) -> Robot:
    """Drives that state no damping of their springs get DAMPING."""
    return robot.with_drives({name: replace(d, damping=d.damping or DAMPING) for name, d in robot.drives.items()})


def _payload(share: float, bench: Bench, seeds: int) -> Iterator[Case]:
    yield as_modelled(bench, plant=bench.loaded(share))._replace(model=bench.robot)


def _whole_drives(bench: Bench, seeds: int) -> Iterator[Case]:
    """Phases of waves are random and depend on the seed."""
    case, whole = as_modelled(bench, plant=bench.robot.with_drives(_gears(bench, KNOWN))), _gears(bench, WHOLE)
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        drives = {name: with_phases(drive, rng) for name, drive in whole.items()}
        yield case._replace(plant=bench.robot.with_drives(drives))


def _gears(bench: Bench, on: tuple[str, ...]) -> dict[str, Drive]:
    drives = zip(bench.robot.drives.items(), bench.gears, strict=True)
    return {name: replace(drive_with(drive, gear, on), limits=drive.limits) for (name, drive), gear in drives}


def with_phases(drive: Drive, rng: np.random.Generator) -> Drive:
    """The drive with its kinematic error, torque ripple and cogging at random phases."""

    def turned(waves: Sequence[Harmonic]) -> tuple[Harmonic, ...]:
        return tuple(replace(wave, phase=float(rng.uniform(0, TURN))) for wave in waves)

    error: Any = drive.kinematic_error
    motor: Any = drive.motor
    motor = replace(motor, ripple=turned(motor.ripple), cogging=turned(motor.cogging))
    return replace(drive, kinematic_error=replace(error, harmonics=turned(error.harmonics)), motor=motor)


SCENARIOS: tuple[Scenario, ...] = (
    Scenario("nominal", "as modelled", "the plant is the model", partial(_once, USUAL)),
    Scenario("masses_5", "masses 5 %", "masses in the model 5 % wrong, four patterns", partial(_masses, 0.05)),
    Scenario("masses_20", "masses 20 %", "masses in the model 20 % wrong, four patterns", partial(_masses, 0.2)),
    Scenario(
        "stiffness", "stiffness 30 %", "stiffness in the model up to 30 % wrong, each drive's by chance",
        partial(_numbers, STIFF, 0.3),
    ),
    Scenario(
        "friction", "friction 50 %", "friction in the model up to 50 % wrong, each drive's by chance",
        partial(_numbers, RUBS, 0.5),
    ),
    Scenario(
        "sensors", "sensors", "encoders with steps and noise on both sides, speeds differenced",
        partial(_sensors, 0, False),
    ),
    Scenario("late", "late", "the same sensors, one period late", partial(_sensors, 1, False)),
    Scenario(
        "damped", "late but damped", f"as late, on drives whose springs lose {DAMPING:g} N m s/rad, known to the model",
        partial(_sensors, 1, True),
    ),
    Scenario("payload_0.5", "payload 0.5", "half of the rated payload, unknown to the model", partial(_payload, 0.5)),
    Scenario("payload_1", "payload 1", "the rated payload, unknown to the model", partial(_payload, 1.0)),
    Scenario("payload_2", "payload 2", "twice the rated payload, unknown to the model", partial(_payload, 2.0)),
    Scenario("slow", f"{SLOW:g} s", f"{SLOW:g} s each way", partial(_once, SLOW)),
    Scenario("fast", f"{FAST:g} s", f"{FAST:g} s each way", partial(_once, FAST)),
    Scenario(
        "drives", "whole drives", "kinematic error, hysteresis, presliding, current loops, ripple and cogging that the "
        "model lacks; springs and friction of catalogue gears, which it knows", _whole_drives,
    ),
)  # fmt: skip
