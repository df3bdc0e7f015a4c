"""Trees of bodies with every kind of joint, along any axis, drawn from a seed."""

import numpy as np
from numpy.typing import NDArray

from cutpoint.model import Joint, Link, Mechanism, Mimic
from cutpoint.model.build import build
from cutpoint.model.mechanism import JointKind

Array = NDArray[np.float64]

KINDS = ("revolute", "prismatic", "continuous", "revolute")

EVERY_KIND: tuple[JointKind, ...] = (
    *("revolute", "continuous", "prismatic", "helical"),
    *("universal", "planar", "spherical", "floating"),
)


def random_tree(seed: int, size: int, floating: bool = False, mimic: bool = False) -> Mechanism:
    """`size` joints on randomly chosen parents, all on a floating base or on the world.

    mimic: joints 2 and 4 follow joints 0 and 1, whose kinds they share.
    """
    rng = np.random.default_rng(seed)
    links = [Link("base", *_mass_properties(rng))]
    joints = []
    for k in range(size):
        parent = links[rng.integers(max(0, k - 2), k + 1)].name
        links.append(Link(f"link{k}", *_mass_properties(rng)))
        joints.append(_joint(rng, k, parent, mimic))
    return build("tree", links, joints, floating_base=floating, coupled=mimic, gravity=rng.normal(0.0, 6.0, 3))


def tree_of_every_kind(seed: int) -> Mechanism:
    """Three to eight joints of kinds drawn at random, floating ones anywhere; fixed and moving roots."""
    rng = np.random.default_rng(seed)
    links, joints = [Link("base", *_mass_properties(rng))], []
    for k in range(rng.integers(3, 9)):
        along, across = rng.normal(size=(2, 3)) if rng.random() < 0.5 else np.eye(3)[rng.permutation(3)[:2]]
        parent, pitch = links[rng.integers(max(0, k - 2), k + 1)].name, rng.choice((-1, 1)) * rng.uniform(0.05, 0.5)
        kind = EVERY_KIND[rng.integers(len(EVERY_KIND))]
        links.append(Link(f"link{k}", *_mass_properties(rng)))
        numbers = {"pitch": pitch} if kind == "helical" else {"second_axis": across} if kind == "universal" else {}
        joints.append(Joint(f"joint{k}", kind, parent, f"link{k}", placement(rng), along, **numbers))
    return build("tree", links, joints, gravity=rng.normal(0.0, 6.0, 3))


def rotation(rng: np.random.Generator) -> Array:
    """(3, 3), any orientation."""
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Q * np.linalg.det(Q)


def placement(rng: np.random.Generator) -> Array:
    """(4, 4), any orientation, up to half a metre or so away."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation(rng), rng.normal(0.0, 0.3, 3)
    return T


def _mass_properties(rng: np.random.Generator) -> tuple[float, Array, Array]:
    """Of four random points of equal mass: a tensor that mass can have."""
    points = rng.normal(0.0, 0.2, (4, 3))
    mass, com = rng.uniform(0.5, 3.0), points.mean(axis=0)
    tensor = sum(mass / 4 * (r @ r * np.eye(3) - np.outer(r, r)) for r in points - com)
    return mass, com, np.asarray(tensor)


def _joint(rng: np.random.Generator, k: int, parent: str, mimic: bool) -> Joint:
    along = np.eye(3)[k % 3] if k % 2 else rng.normal(size=3)
    leader = {2: Mimic("joint0", -0.5, 0.3), 4: Mimic("joint1", 2.0, -0.1)}.get(k) if mimic else None
    kind = KINDS[int(leader.joint[-1]) if leader else k % len(KINDS)]
    return Joint(f"joint{k}", kind, parent, f"link{k}", placement(rng), axis=along, mimic=leader)
