"""Robots that the laws are held against, states to hold them at, and how closeness is measured."""

import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib.metadata import files
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

import cutpoint
from cutpoint import Coulomb, Drive, Flexspline, LinearSpring, Robot, Rotor, Stribeck
from cutpoint.formats import MimicWarning
from random_trees import random_tree

Array = NDArray[np.float64]

BACKENDS = ("llvm", "numpy")

STRIBECK = Stribeck(coulomb=0.4, static=1.5, viscous=0.2, stribeck_velocity=0.2, smoothing=0.05)
COULOMB = Coulomb(coulomb=0.3, viscous=0.1, smoothing=0.1)


def urdf(name: str) -> Path:
    """A file of the package example-robot-data: `ur10_robot.urdf`."""
    (found,) = [entry for entry in files("example-robot-data") or () if entry.name == name]
    return Path(str(found.locate()))


def load(name: str, **options: Any) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MimicWarning)
        return cutpoint.load(urdf(name), **options)


def mixed_drives(robot: Robot) -> dict[str, Drive]:
    """Every level a drive may have, in turn: rigid with armature, linear, hardening, damped; friction on both sides."""
    kinds = [
        Drive(ratio=50.0, rotor=Rotor(2e-5), motor_friction=COULOMB, link_friction=STRIBECK),
        Drive(ratio=-80.0, rotor=Rotor(1e-5), compliance=LinearSpring(3e3), motor_friction=COULOMB),
        Drive(ratio=101.0, rotor=Rotor(1e-5), compliance=Flexspline(2e3, 0.05), link_friction=STRIBECK),
        Drive(ratio=60.0, rotor=Rotor(3e-5), compliance=LinearSpring(5e3), damping=4.0, link_friction=COULOMB),
        Drive(),
    ]
    return {name: kinds[k % len(kinds)] for k, name in enumerate(robot.joints)}


def frictionless(robot: Robot) -> Robot:
    """The same robot without friction and without damping in its springs."""
    fields = ("ratio", "rotor", "compliance", "limits")
    bare = {name: Drive(**{f: getattr(drive, f) for f in fields}) for name, drive in robot.drives.items()}
    return robot.with_drives(bare)


def tree(seed: int = 0, size: int = 6, floating: bool = False, **options: Any) -> Robot:
    return Robot(random_tree(seed, size, floating=floating), **options)


def mixed(floating: bool = False) -> Robot:
    bare = tree(seed=3, size=5, floating=floating)
    return bare.with_drives(mixed_drives(bare))


def driven_by(**drive: Any) -> Robot:
    """The paper's arm with one and the same drive in every joint."""
    arm = cutpoint.robots.xia2019()
    return arm.with_drives({name: Drive(100.0, Rotor(1.14e-5), **drive) for name in arm.joints})


def shoulder() -> Robot:
    """The first three joints of the paper's arm: simulations and derivatives compile in a third of the time."""
    arm = cutpoint.robots.xia2019()
    frames = {name: frame for name, frame in arm.mechanism.frames.items() if frame.body < 3}
    first = replace(arm.mechanism, bodies=arm.mechanism.bodies[:3], frames=frames)
    return Robot(first, {name: arm.drives[name] for name in arm.joints[:3]})


def coupled_panda() -> Robot:
    return load("panda.urdf", mimic="coupled")


MAKERS: dict[str, Callable[[], Robot]] = {
    "xia2019": cutpoint.robots.xia2019,
    "flexspline": lambda: frictionless(cutpoint.robots.xia2019()),
    "linear": lambda: driven_by(compliance=LinearSpring(8e3)),
    "damped": lambda: driven_by(compliance=LinearSpring(8e3), damping=5.0, link_friction=COULOMB),
    "rigid": lambda: driven_by(link_friction=STRIBECK, motor_friction=COULOMB),
    "friction": lambda: driven_by(compliance=Flexspline(8e3, 0.05), link_friction=STRIBECK, motor_friction=COULOMB),
    "ur10": lambda: load("ur10_robot.urdf"),
    "panda": lambda: load("panda.urdf"),
    "panda_coupled": coupled_panda,
    "tree": lambda: tree(seed=1, size=7),
    "mixed": mixed,
    "mixed_floating": lambda: mixed(floating=True),
    "floating": lambda: tree(seed=2, size=5, floating=True),
    "weightless": lambda: tree(seed=2, size=5, floating=True).with_gravity([0.0, 0.0, 0.0]),
    "talos": lambda: load("talos_reduced.urdf", floating_base=True),
}


@cache
def robot(name: str, backend: str = "llvm") -> Robot:
    """A robot of the library; its kernels are kept for the laws that follow."""
    made = MAKERS[name]()
    return Robot(made.mechanism, made.drives, backend=backend)


class States(NamedTuple):
    """Configurations and three more vectors for each, (m, n): speeds, and accelerations or torques."""

    q: Array
    v: Array
    a: Array


def turned(robot: Robot, q: Array) -> Array:
    """The configuration with a proper quaternion, if the robot floats."""
    if robot.nq > robot.nv:
        q[..., 6] = 1.0 + np.abs(q[..., 6])
        q[..., 3:7] /= np.linalg.norm(q[..., 3:7], axis=-1, keepdims=True)
    return q


def states(robot: Robot, seed: int = 0) -> States:
    """At rest at zero; tiny; random, the last one fast; and the singular straight pose in motion."""
    rng = np.random.default_rng(seed)
    q, v, a = (rng.uniform(-3, 3, (7, n)) for n in (robot.nq, robot.nv, robot.nv))
    q[:2] = q[-1] = 0.0
    for x in (v, a):
        x[0], x[1] = 0.0, 1e-9 * x[1]
    q[1] = 1e-9
    v[-2] *= 30.0
    return States(turned(robot, q), v, a)


def vectors(size: int, largest: float = 3.0) -> st.SearchStrategy[Array]:
    """Vectors of a length: zeros, tiny and ordinary entries."""
    return arrays(float, size, elements=st.floats(-largest, largest, allow_subnormal=False))


def motions(robot: Robot) -> st.SearchStrategy[States]:
    """A state with accelerations, drawn by hypothesis."""
    drawn = st.tuples(vectors(robot.nq), vectors(robot.nv), vectors(robot.nv))
    return drawn.map(lambda x: States(turned(robot, x[0]), x[1], x[2]))


def assert_close(ours: Any, theirs: Any, tolerance: float = 1e-10, scale: float = 0.0) -> None:
    """Equal within tolerance times the largest entry expected, or times `scale` where that is larger."""
    ours, theirs = np.asarray(ours, float), np.asarray(theirs, float)
    assert ours.shape == theirs.shape, f"shapes {ours.shape} and {theirs.shape}"
    allowed = tolerance * max(np.abs(theirs).max(initial=0.0), scale)
    worst = np.abs(ours - theirs).max(initial=0.0)
    assert worst <= allowed, f"differs by {worst:.3g}, allowed are {allowed:.3g}"


def derivative(function: Callable[[float], Any], step: float = 1e-3) -> Array:
    """d function / dt at 0 by central differences of order 8: exact to about 1e-13 / step of the function's size."""
    weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    pairs = ((w, k * step) for k, w in enumerate(weights, start=1))
    return sum(w * (np.asarray(function(h)) - np.asarray(function(-h))) for w, h in pairs) / step
