"""Chains for counting and timing: revolute joints in series, with all parameters random, so that none is zero."""

import numpy as np

from cutpoint.arrays import Array
from cutpoint.definitions import Machine
from cutpoint.functions.compiled import machine_of
from cutpoint.mechanics.drives.compliance import LinearSpring
from cutpoint.model import Drive, Joint, Link, Rotor
from cutpoint.model.build import build

_RATIO = 100.0


def random_machine(n: int) -> Machine:
    """n joints with elastic drives, whose rotors are felt by their own spin only; each axis is its frame's z."""
    rng = np.random.default_rng(0)
    links = [Link(f"link{k}", *_mass_properties(rng)) for k in range(n + 1)]
    joints = [Joint(f"joint{k}", "revolute", f"link{k}", f"link{k + 1}", _placement(rng)) for k in range(n)]
    drives = {joint.name: _drive(rng) for joint in joints}
    return machine_of(build("chain", links, joints, gravity=rng.normal(0.0, 6.0, 3)), drives)


def _mass_properties(rng: np.random.Generator) -> tuple[float, Array, Array]:
    """Mass, centroid and inertia about it of ten points of equal mass: a physically consistent tensor."""
    points, mass = rng.normal(0.0, 0.2, (10, 3)), rng.uniform(0.5, 3.0)
    com = points.mean(axis=0)
    r = points - com
    return mass, com, mass / 10 * (np.sum(r**2) * np.eye(3) - r.T @ r)


def _placement(rng: np.random.Generator) -> Array:
    """(4, 4), any orientation, some decimetres away."""
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Q * np.linalg.det(Q), rng.normal(0.0, 0.2, 3)
    return T


def _drive(rng: np.random.Generator) -> Drive:
    return Drive(_RATIO, Rotor(rng.uniform(1e-5, 1e-4)), LinearSpring(rng.uniform(5e3, 3e4)))
