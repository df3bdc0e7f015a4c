"""The best choice of body frames: on their joints' axes, so that most numbers between them are 0 or 1.

A joint's motion is the same in every frame that is turned about its axis or shifted along it (for a prismatic joint:
shifted anywhere).  Frames with x along the common normal of a joint's axis and the next leave a turn about x and two
numbers of position between bodies, Khalil and Dombre (2002) section 3.2; a remaining turn about the joint's own axis is
an offset of its coordinate, one addition.  For bodies with several children or none, and between equivalent choices,
operation counts decide, see `operation_costs`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import atan2, hypot

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.assembly.exact import inertia_from
from cutpoint.mechanics.assembly.operation_costs import (
    TURNING,
    cheapest_zero,
    inertia_cost,
    least_position_cost,
    position_cost,
    rotation_cost,
    within_quarter,
)
from cutpoint.mechanics.assembly.placements import NEGLIGIBLE, about_z, inverse, joined, shift
from cutpoint.mechanics.assembly.regrouping import extent, regrouped, transformed, without_unmoved
from cutpoint.mechanics.assembly.units import unit_of_length
from cutpoint.mechanics.bodies.joints import Revolute
from cutpoint.mechanics.bodies.pseudo_inertia import pseudo_inertia_of_body
from cutpoint.mechanics.bodies.spatial import Inertia, Pose
from cutpoint.model.mechanism import WORLD, Body
from cutpoint.scalars import Scalar

MOVABLE = (*TURNING, "helical", "prismatic")
"""Kinds whose frame may be turned about z and shifted along it."""

FAR = 4.0
"""Frames that move farther than this, times the robot's reach, lose too many digits: axes that are all but parallel
meet anywhere, and a robot may be mounted far from the world's origin."""


@dataclass(frozen=True, eq=False)
class Framing:
    """A frame for each body, and the equations' data in it.

    world (4, 4): a turn of the world's frame.  frames (4, 4): in the bodies' own frames.  placements (4, 4): in their
    carriers'.  zeros: rad, to be added to coordinates.  inertias: about the frames.  gravity (3,): along the world
    frame's axes.  length: the best unit of length for the equations, m; everything here is in m and kg.
    """

    world: Array
    frames: list[Array]
    placements: list[Array]
    zeros: list[float]
    inertias: list[Inertia]
    gravity: Array
    length: float = 1.0


@dataclass(frozen=True)
class RevoluteFrom(Revolute):
    """Turns about z by q + zero (rad)."""

    zero: Scalar

    def pose(self, q: Sequence[Scalar]) -> Pose:
        return super().pose([q[0] + self.zero])


def framing_of(bodies: Sequence[Body], turns: Sequence[Array], gravity: Array) -> Framing:
    """Frames that make the equations short.  turns (4, 4): z along the joints, in the bodies' own frames."""
    tree = _Tree(bodies, turns)
    movable = [i for i, body in enumerate(bodies) if body.joint.kind in MOVABLE]
    for i in movable:
        tree.settle(i, _turned(tree, i), least_position_cost)
    for i in (*movable, *movable):
        tree.settle(i, _shifted(tree, i), position_cost)
    tree.world = _turn_of_world(tree, gravity)
    placements, zeros = zip(*(tree.placed(i) for i in range(len(bodies))), strict=True) if bodies else ((), ())
    own = [transformed(inverse(move), P) for move, P in zip(tree.moves, tree.own, strict=True)]
    frames = [turn @ move for turn, move in zip(turns, tree.moves, strict=True)]
    inertias = [inertia_from(P) for P in regrouped(bodies, own, placements)]
    length = unit_of_length(bodies, placements)
    fallen = _fallen(tree.world, gravity)
    return Framing(tree.world, frames, [*placements], [*zeros], inertias, fallen, length)


def _fallen(world: Array, gravity: Array) -> Array:
    """Gravity (3,) along the axes of a turned world."""
    g = world[:3, :3].T @ gravity
    return np.where(np.abs(g) <= NEGLIGIBLE * np.linalg.norm(g), 0.0, g)


class _Tree:
    """Bodies with the frames chosen so far.

    moves (4, 4): where each body's frame sits in the one it had at first.  edges (4, 4): placements of those.
    own, inertias (4, 4): pseudo-inertias there, before and after regrouping.
    reach: the longest distance from a body to one that it carries, or to its own extent, m.
    """

    def __init__(self, bodies: Sequence[Body], turns: Sequence[Array]) -> None:
        self.bodies, self.world, self.moves = bodies, np.eye(4), [np.eye(4) for _ in bodies]
        carriers = [np.eye(4) if body.parent == WORLD else inverse(turns[body.parent]) for body in bodies]
        self.edges = [joined(T, body.placement, turn) for T, body, turn in zip(carriers, bodies, turns, strict=True)]
        self.children = [list[int]() for _ in bodies]
        for i, body in enumerate(bodies):
            if body.parent != WORLD:
                self.children[body.parent].append(i)
        given = map(pseudo_inertia_of_body, bodies)
        self.own = [transformed(inverse(turn), P) for turn, P in zip(turns, given, strict=True)]
        self.inertias = regrouped(bodies, self.own, self.edges)
        ways = [float(np.linalg.norm(self.edges[k][:3, 3])) for borne in self.children for k in borne]
        self.reach = max([*ways, *map(extent, self.own)], default=0.0)

    def edge(self, i: int) -> Array:
        """(4, 4) placement of body i in its carrier, as frames are now."""
        parent = self.bodies[i].parent
        return joined(inverse(self.world if parent == WORLD else self.moves[parent]), self.edges[i], self.moves[i])

    def placed(self, i: int) -> tuple[Array, float]:
        """The same, with the coordinate offset that makes it cheapest."""
        return cheapest_zero(self.edge(i), self.bodies[i].joint.kind)

    def settle(self, i: int, candidates: Sequence[Array], position: Callable[[Array], float]) -> None:
        """Takes the move with the least cost; the first of equals."""
        costs: list[float] = []
        for move in candidates:
            self.moves[i] = move
            costs.append(self._cost(i, position))
        self.moves[i] = candidates[int(np.argmin(costs))]

    def _cost(self, i: int, position: Callable[[Array], float]) -> float:
        """Cost of the body, its children's placements and its own, unless it stands on the world, which may turn."""
        P = transformed(inverse(self.moves[i]), self.inertias[i])
        borne = self.bodies[i].parent != WORLD
        total = inertia_cost(without_unmoved(P, self.bodies[i].joint.kind) if borne else P)
        for k in (*([i] if borne else []), *self.children[i]):
            T, zero = self.placed(k)
            total += rotation_cost(T, self.bodies[k].joint.kind in TURNING) + position(T) + (zero != 0.0)
        return total


def _turned(tree: _Tree, i: int) -> list[Array]:
    """Candidates for a turn about z: none, towards common normals, the centre of mass and principal axes."""
    angles, P = [0.0], tree.inertias[i]
    for k in tree.children[i]:
        (x, y, _), p = tree.edges[k][:3, 2], tree.edges[k][:3, 3]
        angles.append(atan2(-x, y) if hypot(x, y) > NEGLIGIBLE else atan2(p[1], p[0]))
    angles.append(atan2(P[1, 3], P[0, 3]))
    angles.append(atan2(2 * P[0, 1], P[0, 0] - P[1, 1]) / 2)
    if tree.bodies[i].joint.kind not in TURNING:  # these have no coordinate offset
        angles += [-atan2(b, a) for a, b, _ in tree.edge(i)[:3, :3].tolist()]
    return [about_z(angle) for angle in dict.fromkeys(within_quarter(x) for x in angles)]


def _shifted(tree: _Tree, i: int) -> list[Array]:
    """Candidates for a shift along z: to the feet of common normals, level with neighbours, none.

    A prismatic joint's frame may also move to its neighbours' origins and to the centre of mass.
    """
    turn = tree.moves[i].copy()
    turn[:3, 3] = 0.0
    tree.moves[i] = turn
    near = [inverse(tree.edge(i)), *(tree.edge(k) for k in tree.children[i])]
    steps = [_foot(near[0]), *(step for T in near[1:] for step in (_foot(T), _level(T))), _level(near[0])]
    if tree.bodies[i].joint.kind == "prismatic":
        P = transformed(inverse(turn), tree.inertias[i])
        steps += [T[:3, 3] for T in near] + ([P[:3, 3] / P[3, 3]] if P[3, 3] else [])
    close = [step for step in steps if np.linalg.norm(step) <= FAR * tree.reach]
    return [turn @ shift(step) for step in (*close, np.zeros(3))]


def _foot(T: Array) -> Array:
    """The foot on z of the common normal with another frame's z; where they are parallel, level with its origin."""
    z, p = T[:3, 2], T[:3, 3]
    across = z[0] ** 2 + z[1] ** 2
    if across <= NEGLIGIBLE:
        return _level(T)
    return np.array([0.0, 0.0, p[2] - z[2] * (p[0] * z[0] + p[1] * z[1]) / across])


def _level(T: Array) -> Array:
    """The point on z that is level with another frame's origin."""
    return np.array([0.0, 0.0, T[2, 3]])


def _turn_of_world(tree: _Tree, gravity: Array) -> Array:
    """(4, 4): none, or that of a body on the world, whose own then vanishes."""
    roots = [i for i, body in enumerate(tree.bodies) if body.parent == WORLD and body.joint.kind != "prismatic"]
    candidates = [np.eye(4), *(_rotation_alone(tree.edge(i)) for i in roots)]
    costs: list[float] = []
    for world in candidates:
        tree.world = world
        found = [tree.placed(i) for i in roots]
        turned = sum(rotation_cost(T, True) + (zero != 0.0) for T, zero in found)
        costs.append(turned + 10.0 * np.count_nonzero(_fallen(tree.world, gravity)))
    return candidates[int(np.argmin(costs))]


def _rotation_alone(T: Array) -> Array:
    turn = T.copy()
    turn[:3, 3] = 0.0
    return turn
