"""Robots so large that they run as loops over their bodies, or small ones of the same kind."""

from typing import Any

import numpy as np

from cutpoint.model import Joint, Link, Mechanism
from cutpoint.model.build import build
from cutpoint.rolled import RECIPES
from random_trees import placement


def chain(size: int, kinds: tuple[str, ...] = ("revolute",)) -> Mechanism:
    """Random bodies and places, all within some metres."""
    rng, links, joints = np.random.default_rng(size), [Link("base")], []
    for k in range(size):
        com, T = rng.normal(0.0, 0.1, 3), placement(rng)
        T[:3, 3] *= min(1.0, 10 / size)
        links.append(Link(f"link{k}", rng.uniform(0.5, 2.0), com, np.diag(rng.uniform(0.01, 0.015, 3))))
        kind, along, pitch = kinds[k % len(kinds)], np.eye(3)[k % 3], 0.1
        stated = {"pitch": pitch} if kind == "helical" else {}
        joints.append(Joint(f"joint{k}", kind, links[-2].name, links[-1].name, T, along, **stated))  # type: ignore[arg-type]
    return build("chain", links, joints)


def longest(key: Any, first: int = 1) -> int:
    """Bodies of the longest chain for which a function is code without loops.  first: axes of its first joint."""
    recipe = RECIPES[key]
    return max(n for n in range(1, recipe.most_bodies + 1) if n * first + n * (n - 1) / 2 <= recipe.pairs)


def based(kind: Any, size: int, branching: bool = True) -> Mechanism:
    """`size` bodies on a base, or in one chain; with branches, some of them stand on the world beside it."""
    rng = np.random.default_rng(size)
    links, joints = [Link("world"), Link("trunk", *_mass(rng))], [Joint("base", kind, "world", "trunk", placement(rng))]
    for k in range(size):
        parent = links[int(rng.integers(max(0, k - 3), k + 2))] if branching else links[-1]
        links.append(Link(f"link{k}", *_mass(rng)))
        T, turns = placement(rng), ("revolute", "prismatic", "revolute")[k % 3]
        T[:3, 3] *= min(1.0, 10 / size)
        joints.append(
            Joint(f"joint{k}", turns if branching else "revolute", parent.name, f"link{k}", T, np.eye(3)[k % 3])
        )
    return build("based", links, joints, gravity=rng.normal(0.0, 6.0, 3))


def _mass(rng: np.random.Generator) -> tuple[float, np.ndarray, np.ndarray]:
    return rng.uniform(0.5, 2.0), rng.normal(0.0, 0.1, 3), np.diag(rng.uniform(0.01, 0.015, 3))


def star(size: int) -> Mechanism:
    """Bodies that stand side by side on the world: none carries another."""
    rng, names = np.random.default_rng(size), [f"link{k}" for k in range(size)]
    links = [Link("world"), *(Link(name, *_mass(rng)) for name in names)]
    axes = [np.eye(3)[k % 3] for k in range(size)]
    pairs = zip(names, axes, strict=True)
    return build("star", links, [Joint(f"to {n}", "revolute", "world", n, placement(rng), axis) for n, axis in pairs])


def assert_close(ours: np.ndarray, theirs: np.ndarray, rtol: float = 1e-12) -> None:
    """To within a share of the largest number: torques at the tips of long chains are sums that all but vanish."""
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=rtol * np.abs(theirs).max())
