"""Arms of which all is known, with springs, and how `identify` does on logs of them.

Encoders on both sides and torques have noise; files are wrong about bodies, springs, rotors and friction.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from simulated_logs import NOISE, Known, exists, known_arm, motion

import cutpoint
from cutpoint import LinearSpring, Robot, Rotor, Sensors
from cutpoint.control import PD
from cutpoint.identification import Recording, low_pass
from cutpoint.identification.conditioning.motion import motion_of
from cutpoint.identification.output import Identification, identify
from cutpoint.identification.output.torque_errors import stated_torque

PERIOD = 1e-3
STEP = 2.0 * np.pi / 2**20
"""s; rad, of the links' encoders."""

KINDS = ("coulomb", "viscous", "offset", "stiffness", "rotor inertia", "damping")
"""Of numbers; all others are base parameters."""


class Case(NamedTuple):
    """hits: by kind of number, whether intervals hold the truth.  ratio: (n,), held-out error to the true model's.
    linear: whether each spring was found to be, as it is."""

    hits: dict[str, list[bool]]
    physical: bool
    ratio: np.ndarray
    linear: list[bool]


def case(seed: int, noise: float = NOISE) -> Case:
    """The arm of a seed, of two or three joints, identified by default options.  noise: N m RMS, of the torques."""
    known = with_springs(known_arm(seed, 2 + seed % 2), seed)
    found = identify(known.file, recorded(known.robot, seed, noise), torque_delay=0.5 * PERIOD)
    errors, true = found.errors, motion_of(known.robot, found.recording, found.rigid.cutoff)
    left = errors.measured - low_pass(stated_torque(known.robot, true), true.period, errors.bandwidth)
    floor = np.sqrt(np.nanmean(left[errors.held_out] ** 2, axis=0))
    linear = [isinstance(drive.compliance, LinearSpring) for drive in found.robot.drives.values()]
    return Case(_hits(known, found), exists(found.robot), errors.rms("after", held_out=True) / floor, linear)


def _hits(known: Known, found: Identification) -> dict[str, list[bool]]:
    told = {number.joint for number in found.numbers if number.name == "rotor inertia" and number.told}
    base, truth = known.base([joint for joint in known.robot.joints if joint not in told])
    true = dict(zip(base.names, truth.tolist(), strict=True))
    for joint, drive in known.robot.drives.items():
        law, spring = drive.link_friction, drive.compliance
        true |= {f"{name}.{joint}": float(getattr(law, name)) for name in law.coefficients}
        true |= {f"offset.{joint}": 0.0, f"stiffness {joint}": float(spring.stiffness)}
        true |= {f"damping {joint}": float(drive.damping), f"rotor inertia {joint}": float(drive.reflected_inertia)}
    hits: dict[str, list[bool]] = {}
    for number in found.numbers:
        name = number.name if number.name in true else f"{number.name} {number.joint}"
        if name in true and number.told:
            hits.setdefault(_kind(number.name), []).append(number.low <= true[name] <= number.high)
    return hits


def _kind(name: str) -> str:
    first = name.split(".")[0]
    return first if first in KINDS else "base parameters"


def with_springs(known: Known, seed: int) -> Known:
    """The arm with springs; its file states others, and rotors and friction that are wrong by half."""
    rng, true, file = np.random.default_rng(seed + 5000), {}, {}
    for joint, drive in known.robot.drives.items():
        stiffness = float(rng.uniform(1e3, 1e4))
        law = drive.link_friction
        sprung = replace(drive, compliance=LinearSpring(stiffness), damping=1e-3 * stiffness)
        wrong = law.with_coefficients([1.5 * getattr(law, name) for name in law.coefficients])
        true[joint] = sprung
        rotor = Rotor(1.5 * drive.rotor.inertia)
        file[joint] = replace(
            sprung, rotor=rotor, link_friction=wrong, compliance=LinearSpring(1.5 * stiffness), damping=None
        )
    return Known(known.robot.with_drives(true), known.file.with_drives(file))


def recorded(robot: Robot, seed: int, noise: float = NOISE) -> Recording:
    """12 s at 1 kHz under a PD law of the motors, encoders with noise of their own step, torques with noise.

    A command is stamped half a period before it acts in the mean.
    """
    n = len(robot.joints)
    of_encoders = {"link_noise": STEP, "motor_noise": STEP / 100.0, "seed": seed}
    sensors = Sensors(link_resolution=STEP, motor_resolution=STEP / 100.0, **of_encoders)
    law = PD([400.0] * n, [40.0] * n, side="motor")
    log = cutpoint.simulate(robot, law, motion(seed, n, 12.0), sensors=sensors)
    torque = log["command_torque"] + noise * np.random.default_rng(seed).normal(size=log["command_torque"].shape)
    return Recording(log.time, log.joints, q=log["measured_q"], theta=log["measured_theta"], torque=torque)
