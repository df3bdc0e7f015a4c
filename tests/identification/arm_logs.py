"""Logs of an arm whose links are heavier and whose friction is larger than its files say, and runs on such logs."""

from pathlib import Path

import numpy as np
from machine_logs import positions
from two_joints import two_joints, urdf_text
from typer.testing import CliRunner

from cutpoint import Coulomb, Robot
from cutpoint.commands import app
from cutpoint.identification.rigid.bodies import with_parameters

Array = np.ndarray

TIME = 2e-3 * np.arange(5000)

LAW = Coulomb(4.0, 3.0, 0.05)

STATED = """version: 1
defaults:
  ratio: 100
  rotor: {inertia: 3.0e-5}
  compliance: {linear: {stiffness: 9000}}
  friction: {motor: {coulomb: 2.0, viscous: 1.0, smoothing: 0.05}}
drives: {shoulder: {}, elbow: {}}
"""

RIGID = """version: 1
defaults:
  ratio: 100
  motor: {torque_constant: 0.1}
  friction: {link: {coulomb: 2.0, viscous: 1.0, smoothing: 0.05}}
drives: {shoulder: {}, elbow: {}}
"""


def heavier(robot: Robot) -> Robot:
    return Robot(with_parameters(robot.mechanism, 1.3 * robot.inertial_parameters), robot.drives)


TRUTH = heavier(two_joints())
"""Of the links."""


def motions(time: Array = TIME) -> tuple[Array, Array, Array]:
    q, v, a = (positions(time, order) for order in range(3))
    return q, v, a


def channels(time: Array = TIME) -> dict[str, Array]:
    """Of a rigid arm with friction and without rotors."""
    q, v, a = motions(time)
    noise = np.random.default_rng(0).normal(size=(2, *q.shape))
    torque = TRUTH.inverse_dynamics(q, v, a) + LAW.torque(v) + 0.01 * noise[1]
    return {"q": q + 1e-6 * noise[0], "torque": torque}


def write_log(path: Path, columns: dict[str, Array], joints: tuple[str, ...] = ("shoulder", "elbow")) -> Path:
    """A CSV file whose columns are named obviously."""
    names = ["t", *(f"{name}.{joint}" for name in columns if name != "t" for joint in joints)]
    time = columns.get("t", TIME)
    rows = np.column_stack([time, *(x for name, x in columns.items() if name != "t")])
    text = "\n".join([",".join(names), *(",".join(f"{x:.9g}" for x in row) for row in rows.tolist())])
    path.write_text(text + "\n")
    return path


def wound(time: Array = TIME, step: float = 2.0 * np.pi / 2**20) -> dict[str, Array]:
    """Encoders on both sides of drives that bend, and the motors' torques.  step: rad, of those on the links."""
    q, v, a = motions(time)
    load = TRUTH.inverse_dynamics(q, v, a)
    theta = q + load / 7e3
    speed, acceleration = (np.gradient(x, time, axis=0) for x in (theta, np.gradient(theta, time, axis=0)))
    rng = np.random.default_rng(1)
    torque = 0.4 * acceleration + load + LAW.torque(speed) + 0.01 * rng.normal(size=q.shape)
    return {"q": step * np.round(q / step), "theta": 0.01 * step * np.round(theta / (0.01 * step)), "torque": torque}


def write_arm(folder: Path) -> Path:
    """The arm's files: what they state of links and friction is less than the truth."""
    (folder / "arm.urdf").write_text(urdf_text())
    (folder / "rigid.yaml").write_text(RIGID)
    (folder / "sprung.yaml").write_text(STATED)
    return folder


def run(files: Path, log: Path, output: Path, *options: str) -> tuple[int, str]:
    """Exit status, and all words that were printed, on single blanks."""
    given = [str(files / "arm.urdf"), str(log), "--drives", str(files / "rigid.yaml"), "--output", str(output)]
    result = CliRunner().invoke(app, ["identify", *given, *options])
    return result.exit_code, " ".join(f"{result.output} {result.exception or ''}".split())
