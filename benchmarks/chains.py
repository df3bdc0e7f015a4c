"""Long chains of revolute joints: 192 joints against Pinocchio, and the cost per joint in chains of 6 to 10,000."""

import sys
from collections.abc import Callable
from dataclasses import asdict

import numpy as np
import pinocchio as pin
import pinocchio_cpp
from tasks import in_columns

import cutpoint
from cutpoint.model import Joint, Link, Mechanism
from cutpoint.model.build import build
from cutpoint.studies.cost.timing import in_turns

LONG, SIZES = 192, (6, 24, 96, 192, 1000, 2000, 10_000)
"""Pinocchio's Data grows with the cube of the number of joints."""

ROWS = 64
FUNCTIONS = ("inverse_dynamics", "forward_dynamics")
AGREEMENT = 1e-10
"""Of inverse dynamics, as a share of the largest torque: of the given motion, or of what forward dynamics found."""

_ACROSS = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def chains() -> dict[str, list[dict]]:
    print(f"chains of {LONG}", file=sys.stderr)
    beside = [_beside_pinocchio(function) for function in FUNCTIONS]
    joints = []
    for n in SIZES:
        print(f"chain of {n}", file=sys.stderr)
        joints.append(_a_joint(n))
    return {"long": beside, "joints": joints}


def chain(n: int) -> Mechanism:
    """2 m and 20 kg whatever n is; every axis across the one before; no parameter zero."""
    rng, size = np.random.default_rng(n), 2.0 / n
    links, joints = [Link("link0")], []
    for k in range(n):
        points, mass = rng.uniform(-size, size, (8, 3)), 20.0 / n * rng.uniform(0.5, 1.5)
        r, com = points - points.mean(axis=0), points.mean(axis=0)
        links.append(Link(f"link{k + 1}", mass, com, mass / 8 * (np.sum(r**2) * np.eye(3) - r.T @ r)))
        placement = np.linalg.matrix_power(_ACROSS, 1 + 2 * (k % 2))
        placement[:3, 3] = size * rng.uniform(0.3, 1.0, 3)
        joints.append(Joint(f"joint{k}", "continuous", f"link{k}", f"link{k + 1}", placement))
    return build(f"chain of {n}", links, joints)


def model_of(mechanism: Mechanism) -> pin.Model:
    """The chain for Pinocchio; its joints turn about z."""
    model = pin.Model()
    model.gravity.linear = np.array(mechanism.gravity)
    for body in mechanism.bodies:
        at = pin.SE3(np.array(body.placement[:3, :3]), np.array(body.placement[:3, 3]))
        joint = model.addJoint(body.parent + 1, pin.JointModelRZ(), at, body.joint.name)
        model.appendBodyToJoint(joint, pin.Inertia(body.mass, body.com, body.inertia), pin.SE3.Identity())
    return model


def states(n: int) -> list[np.ndarray]:
    """(3, ROWS, n); the longer the chain, the slower its joints, so that its end moves as fast."""
    rng = np.random.default_rng(n)
    return [rng.uniform(-3, 3, (ROWS, n)), *rng.uniform(-6 / n, 6 / n, (2, ROWS, n))]


def _beside_pinocchio(function: str) -> dict:
    """Ours from Python, its call included; Pinocchio in loops of C++, and from Python."""
    mechanism, (q, v, third) = chain(LONG), states(LONG)
    robot, model = cutpoint.Robot(mechanism), model_of(mechanism)
    data, compute = model.createData(), getattr(robot, function)
    algorithm = {"inverse_dynamics": pin.rnea, "forward_dynamics": pin.aba}[function]
    if function == "forward_dynamics":
        third = robot.inverse_dynamics(q, v, third)
    rows = q, v, third
    each = [*zip(*rows, strict=True)]
    calls: dict[str, Callable[[], object]] = {
        "single": lambda: [compute(*state) for state in each],
        "rows": lambda: compute(*rows),
        "Pinocchio, Python": lambda: [algorithm(model, data, *state) for state in each],
    }
    found, cpp = {"single": np.array(calls["single"]()), "rows": calls["rows"]()}, {}
    for name in pinocchio_cpp.COMPILERS:
        library = pinocchio_cpp.built(name)
        for variant in pinocchio_cpp.FUNCTIONS[function.replace("_", " ")] if library else ():
            chained, out = pinocchio_cpp.Robot(library, model), np.empty_like(q)
            chained.run(variant, [*rows], out)
            found[f"{name}, {variant}"] = out
            cpp[f"{name}, {variant}"] = lambda r=chained, f=variant: r.run(f, [*rows], None)
    differences = {name: _off(model, function, rows, x) for name, x in found.items()}
    if not max(differences.values()) < AGREEMENT:
        sys.exit(f"chain of {LONG}, {function}: {differences}, more than {AGREEMENT}; not timed")
    times = in_columns(in_turns(calls | cpp, ROWS), dict.fromkeys(cpp))
    return {"task": function.replace("_", " "), "differences": differences, "times": times}


def _off(model: pin.Model, function: str, rows: tuple[np.ndarray, ...], found: np.ndarray) -> float:
    """How far torques are from Pinocchio's inverse dynamics, as a share of the largest."""
    data, (q, v, third) = model.createData(), rows
    tau, a = (found, third) if function == "inverse_dynamics" else (third, found)
    expected = np.array([pin.rnea(model, data, *state).copy() for state in zip(q, v, a, strict=True)])
    return float(np.abs(tau - expected).max() / np.abs(expected).max())


def _a_joint(n: int) -> dict:
    """Nanoseconds a joint: calls of one from Python, and of ROWS."""
    robot, (q, v, third) = cutpoint.Robot(chain(n)), states(n)
    found: dict[str, dict] = {}
    each = [*zip(q, v, third, strict=True)]
    for function in FUNCTIONS:
        compute = getattr(robot, function)
        calls = {
            f"{function}, single": lambda f=compute: [f(*state) for state in each],
            f"{function}, rows": lambda f=compute: f(q, v, third),
        }
        for call in calls.values():
            call()
        found |= {name: asdict(x) for name, x in in_turns(calls, ROWS * n).items()}
    return {"joints": n, "times": found}
