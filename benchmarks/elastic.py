"""Elastic inverse dynamics, reduced: motor torques of a motion, which need two time derivatives of the joint torque.

No peer offers it ready-made.  From Pinocchio it comes by finite differences of inverse dynamics along the motion, from
CasADi by its own differentiation of the same recursion as elsewhere.
"""

import ctypes
import sys
from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import casadi_peer
import codegen
import compilers
import numpy as np
import ours
import pinocchio_cpp
import symbolic_tasks
from cases import BYTES, ROBOTS, Case, Entry, case
from symbolic_models import SX
from tasks import agreed, in_columns

import cutpoint
from cutpoint import LinearSpring
from cutpoint.model import Drive, Rotor
from cutpoint.studies.cost.timing import in_turns

STIFFNESS, INERTIA, RATIO = 1e4, 1.0, 100.0
"""N m/rad; kg m2 of a rotor, reflected to the joint."""

MOTION = ("q", "v", "a", "jerk", "snap")
ACCURACY = 1e-8
"""Tolerance of finite differences, as a share of the largest motor torque."""

WAYS = [(points, h) for points in (3, 5) for h in np.geomspace(1e-1, 1e-4, 31)]
"""Inverse dynamics that a second difference takes, s between them; the cheapest first."""


def elastic(given: Case) -> cutpoint.Robot:
    """The robot with the same drive in every joint."""
    drive = Drive(RATIO, Rotor(INERTIA / RATIO**2), LinearSpring(STIFFNESS))
    bodies = [replace(b, joint=replace(b.joint, limits=cutpoint.model.Limits())) for b in given.robot.mechanism.bodies]
    mechanism = replace(given.robot.mechanism, bodies=tuple(bodies))
    return cutpoint.Robot(mechanism, dict.fromkeys(given.robot.joints, drive))


def elastic_inverse_dynamics() -> list[dict]:
    found = []
    for name in ROBOTS:
        print(f"{name}: elastic inverse dynamics", file=sys.stderr)
        found.append(measured(case(name)))
    return found


def measured(given: Case) -> dict:
    robot, n = elastic(given), given.robot.nv
    count = BYTES // (8 * 10 * n) // 8 * 8
    motion = [*np.random.default_rng(0).uniform(-2, 2, (5, count, n))]
    robot.elastic_inverse_dynamics(*(x[:2] for x in motion))
    kernel = robot.kernel("elastic_inverse_dynamics")
    expected = kernel(*motion, robot.drive_parameters)
    entries = ours.entries(kernel, [*motion, robot.drive_parameters])
    if compilers.version("gcc"):
        entries |= _casadi(given, motion)
    title = f"{given.name}, elastic inverse dynamics"
    differences = agreed(title, entries, np.stack(expected, axis=1))
    cpp, errors = _differences(given, motion, expected[0])
    times = in_turns({name: x.call for name, x in (entries | cpp).items()}, count)
    found = {"robot": given.name, "rows": count, "differences": differences, "accuracy": errors, "allowed": ACCURACY}
    return {**found, "times": in_columns(times, cpp)}


def _casadi(given: Case, motion: list[np.ndarray]) -> dict[str, Entry]:
    models = {"CasADi": casadi_peer.filed(given.robot), "CasADi, lean": casadi_peer.lean(given.robot)}
    return {name: casadi_peer.entry(_function(given, model), (5, given.robot.nv), motion)
            for name, model in models.items()}  # fmt: skip


def _function(given: Case, model: casadi_peer.Model) -> ca.Function:
    symbols = [SX.sym(name, given.robot.nv) for name in MOTION]
    found = symbolic_tasks.elastic_inverse_dynamics(model(symbols[0]), symbols, STIFFNESS, INERTIA)
    return codegen.function(symbols, *found)


def _differences(given: Case, motion: list[np.ndarray], torque: np.ndarray) -> tuple[dict[str, Entry], dict[str, str]]:
    """Each build of Pinocchio, in the cheapest way that is accurate enough; and what way that is."""
    found, told = {}, {}
    for name in pinocchio_cpp.COMPILERS:
        library = pinocchio_cpp.built(name)
        if library is None:
            continue
        robot, out = pinocchio_cpp.Robot(library, given.model), np.empty_like(torque)
        for points, h in WAYS:
            _run(robot, motion, out, points, h)
            error = np.abs(out - torque).max() / np.abs(torque).max()
            if error < ACCURACY:
                key = f"{name}, {points} inverse dynamics {h:.2g} s apart"
                found[key], told[key] = Entry(_call(robot, motion, points, h), out.copy()), f"{error:.0e}"
                break
    return found, told


def _call(robot: pinocchio_cpp.Robot, motion: list[np.ndarray], points: int, h: float) -> Callable[[], None]:
    return lambda: _run(robot, motion, None, points, h)


def _run(robot: pinocchio_cpp.Robot, motion: list[np.ndarray], out: np.ndarray | None, points: int, h: float) -> None:
    constants = map(ctypes.c_double, (h, STIFFNESS, INERTIA))
    robot.run("elastic", motion, out, ctypes.c_int(points), *constants)
