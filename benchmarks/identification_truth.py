"""Whether `identify` keeps its promises on arms of which the truth is known.

OPENBLAS_NUM_THREADS=1 PYTHONPATH=tests:tests/identification python benchmarks/identification_truth.py --arms 100

Random arms of two and three joints, with springs, dry friction, rotors, encoders with noise on both sides and noisy
torques, from files that are wrong about bodies, springs, rotors and friction.  The options are a user's: by default.
"""

import argparse
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from rich.progress import track
from simulated_logs import NOISE, Known, known_arm, motion

import cutpoint
from cutpoint import LinearSpring, Robot, Rotor
from cutpoint.control import PD
from cutpoint.errors import CutpointError
from cutpoint.identification import Recording, low_pass
from cutpoint.identification.conditioning.motion import motion_of
from cutpoint.identification.output import Identification, identify
from cutpoint.identification.output.torque_errors import stated_torque
from cutpoint.model.places import Places
from cutpoint.model.validation import check_body

PERIOD = 1e-3
STEP = 2.0 * np.pi / 2**20

DRIVES = {"stiffness": "stiffness", "rotor inertia": "rotor inertia", "damping": "damping"}


class Case(NamedTuple):
    """hits: by kind of number, whether intervals hold the truth.  ratio: (n,), held-out error to the true model's."""

    hits: dict[str, list[bool]]
    physical: bool
    ratio: np.ndarray


def case(seed: int) -> Case:
    known = _with_springs(known_arm(seed, 2 + seed % 2), seed)
    found = identify(known.file, _recorded(known.robot, seed), torque_delay=0.5 * PERIOD)
    errors, true = found.errors, motion_of(known.robot, found.recording)
    left = errors.measured - low_pass(stated_torque(known.robot, true), true.period, errors.bandwidth)
    floor = np.sqrt(np.nanmean(left[errors.held_out] ** 2, axis=0))
    return Case(_hits(known, found), _exists(found.robot), errors.rms("after", held_out=True) / floor)


def _with_springs(known: Known, seed: int) -> Known:
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


def _recorded(robot: Robot, seed: int) -> Recording:
    n = len(robot.joints)
    noise = {"link_noise": STEP, "motor_noise": STEP / 100.0, "seed": seed}
    sensors = cutpoint.Sensors(link_resolution=STEP, motor_resolution=STEP / 100.0, **noise)
    law = PD([400.0] * n, [40.0] * n, side="motor")
    log = cutpoint.simulate(robot, law, motion(seed, n, 12.0), sensors=sensors)
    torque = log["command_torque"] + NOISE * np.random.default_rng(seed).normal(size=log["command_torque"].shape)
    return Recording(log.time, log.joints, q=log["measured_q"], theta=log["measured_theta"], torque=torque)


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
    return first if first in ("coulomb", "viscous", "offset") else DRIVES.get(name, "base parameters")


def _exists(robot: Robot) -> bool:
    try:
        for body in robot.mechanism.bodies:
            check_body(body, [body.name], Places(None))
    except CutpointError:
        return False
    return all(body.mass > 0.0 for body in robot.mechanism.bodies)


def told(cases: list[Case]) -> str:
    """A report, a line for each kind of number."""
    hits: dict[str, list[bool]] = {}
    for each in cases:
        for kind, own in each.hits.items():
            hits.setdefault(kind, []).extend(own)
    ratio = np.concatenate([each.ratio for each in cases])
    worst = max(range(len(cases)), key=lambda k: cases[k].ratio.max())
    return "\n".join(
        [
            *(_covered(hits)),
            f"physical: {sum(each.physical for each in cases)} of {len(cases)}",
            f"held-out error over the true model's: median {np.median(ratio):.2f}, 95 % {np.quantile(ratio, 0.95):.2f},"
            f" worst {ratio.max():.2f} (arm {worst}), above 2: {(ratio > 2.0).sum()} of {ratio.size} joints",
        ]
    )


def _covered(hits: Mapping[str, list[bool]]) -> list[str]:
    return [f"{kind:16} {100.0 * np.mean(own):5.1f} % of {len(own)} intervals of 95 %" for kind, own in hits.items()]


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, help="number of the first arm")
    asked = parser.parse_args()
    with ProcessPoolExecutor(2) as pool:
        seeds = range(asked.first, asked.first + asked.arms)
        print(told([*track(pool.map(case, seeds), "arms", total=asked.arms)]))
