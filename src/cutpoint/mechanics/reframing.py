"""Where the bodies' frames sit best: along their joints' axes, placed so that most numbers between them are 0 or 1.

A joint's motion is the same for every frame that is turned about its axis or shifted along it (for a prismatic joint:
shifted anywhere).  Frames with x along the common normal of a joint's axis and the next leave a turn about x and two
numbers of position between bodies, Khalil and Dombre (2002) section 3.2; what is left of a turn about the joint's own
axis is a constant beside its coordinate.  With several bodies borne, or none, the candidate with the least cost wins.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

import numpy as np

from cutpoint.mechanics import regrouping
from cutpoint.mechanics.joints import Revolute
from cutpoint.mechanics.regrouping import NEGLIGIBLE, pseudo_inertia, regrouped, transformed
from cutpoint.mechanics.spatial import Pose
from cutpoint.model.mechanism import WORLD, Array, Body
from cutpoint.scalars import Scalar

TURNING = ("revolute", "continuous")
"""Kinds that take a constant beside their coordinate."""

FREE_TO_TURN = (*TURNING, "helical", "prismatic")
"""Kinds whose frame may be turned about z and shifted along it."""


@dataclass(frozen=True, eq=False)
class Framing:
    """A frame for each body, and what the equations need in it.

    world (4, 4): a turn of the world's frame.  frames (4, 4): in the bodies' own frames.  placements (4, 4): in their
    carriers'.  zeros: rad, what to add to a coordinate.  inertias (4, 4): pseudo-inertias, regrouped.
    """

    world: Array
    frames: list[Array]
    placements: list[Array]
    zeros: list[float]
    inertias: list[Array]


@dataclass(frozen=True)
class RevoluteFrom(Revolute):
    """Turns about z by q + zero (rad)."""

    zero: Scalar

    def pose(self, q: Sequence[Scalar]) -> Pose:
        return super().pose([q[0] + self.zero])


def about_z(angle: float) -> Array:
    """(4, 4) turn about z, exact for quarter turns."""
    turn = np.eye(4)
    c, s = (round(x) if abs(x - round(x)) < NEGLIGIBLE else x for x in (cos(angle), sin(angle)))
    turn[:2, :2] = (c, -s), (s, c)
    return turn


def shift(by: Array) -> Array:
    """(4, 4) translation by (3,)."""
    moved = np.eye(4)
    moved[:3, 3] = by
    return moved


def inverse(T: Array) -> Array:
    """Of a pose (4, 4)."""
    R_T = T[:3, :3].T
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = R_T, -R_T @ T[:3, 3]
    return out


def joined(*factors: Array) -> Array:
    """Product of poses (4, 4), without what is only rounding; 1 and -1 where rounding hides them."""
    product, reach = np.eye(4), 0.0
    for T in factors:
        product, reach = product @ T, reach + np.abs(T[:3, 3]).max()
    R, p = product[:3, :3], product[:3, 3]
    for whole in (-1.0, 0.0, 1.0):
        R[np.abs(R - whole) <= NEGLIGIBLE] = whole
    p[np.abs(p) <= NEGLIGIBLE * reach] = 0.0
    return product


class Tree:
    """Bodies with the frames chosen so far."""

    def __init__(self, bodies: Sequence[Body], turns: Sequence[Array]) -> None:
        """turns (4, 4): frames with z along the joints, in the bodies' own."""
        self.bodies = bodies
        self.children: list[list[int]] = [[] for _ in bodies]
        self.edges = [
            joined(b.placement, turn) if b.parent == WORLD else joined(turns[b.parent].T, b.placement, turn)
            for b, turn in zip(bodies, turns, strict=True)
        ]
        for i, b in enumerate(bodies):
            if b.parent != WORLD:
                self.children[b.parent].append(i)
        self.own = [transformed(turn.T, pseudo_inertia(b)) for b, turn in zip(bodies, turns, strict=True)]
        self.inertias = regrouped(bodies, self.own, self.edges)
        self.moves = [np.eye(4) for _ in bodies]
        self.world = np.eye(4)

    def edge(self, i: int) -> Array:
        """(4, 4) placement of body i, as frames are now."""
        parent = self.bodies[i].parent
        carrier = self.world if parent == WORLD else self.moves[parent]
        return joined(inverse(carrier), self.edges[i], self.moves[i])

    def best(self, i: int, candidates: Sequence[Array], aligned: bool) -> None:
        """Takes the move with the least cost; the first of equals."""
        costs = []
        for move in candidates:
            self.moves[i] = move
            costs.append(self._cost(i, aligned))
        self.moves[i] = candidates[int(np.argmin(costs))]

    def _cost(self, i: int, aligned: bool) -> float:
        joint = self.bodies[i].joint
        P = transformed(inverse(self.moves[i]), self.inertias[i])
        part = np.ix_(regrouping.UNMOVED[joint.kind], regrouping.UNMOVED[joint.kind])
        if self.bodies[i].parent != WORLD:
            P[part] = 0.0
        total = float(regrouping.cost(P))
        within = [i] if self.bodies[i].parent != WORLD else []
        for k in (*within, *self.children[i]):
            T, zero = best_zero(self.edge(k), self.bodies[k].joint.kind)
            total += (zero != 0.0) + rotation_cost(T[:3, :3], self.bodies[k].joint.kind in TURNING)
            total += position_cost(T, aligned)
        return total


def rotation_cost(R: Array, turning: bool) -> float:
    """Operations of turning R with the joint, and five vectors with both, about."""
    total = 0.0
    for a, b, c in R.tolist():
        if turning:
            if a and b:
                total += 6 + 20
            elif a or b:
                total += (2 if abs(a + b) != 1.0 else 0) + 20
        else:
            total += sum(5 if abs(x) == 1.0 else 10 for x in (a, b) if x)
        total += (5 if abs(c) == 1.0 else 10) if c else 0
    return total + 0.1 * np.count_nonzero(R < 0.0)


def position_cost(T: Array, aligned: bool) -> float:
    """7 for each number of position; before frames are shifted, for each that no shift along either axis can undo."""
    p, z = T[:3, 3], T[:3, 2]
    if aligned:
        return 7.0 * np.count_nonzero(p)
    if hypot(z[0], z[1]) > NEGLIGIBLE:
        normal = np.array([-z[1], z[0], 0.0]) / hypot(z[0], z[1])
        return 0.0 if abs(normal @ p) <= NEGLIGIBLE * np.abs(p).sum() else 7.0 * np.count_nonzero(np.abs(normal) > NEGLIGIBLE)
    return 7.0 * np.count_nonzero(p[:2])


def best_zero(T: Array, kind: str) -> tuple[Array, float]:
    """A placement and a constant angle beside the coordinate (rad) that together cost least; the turn stays the same."""
    if kind not in TURNING:
        return T, 0.0
    best, least = (T, 0.0), rotation_cost(T[:3, :3], True)
    for a, b, _ in T[:3, :3].tolist():
        if a and b:
            zero = atan2(b, a)
            zero -= round(zero / (pi / 2)) * pi / 2
            turned = joined(T, about_z(zero))
            found = rotation_cost(turned[:3, :3], True) + 1
            if found < least:
                best, least = (turned, -zero), found
    return best


def turns_of(tree: Tree, i: int) -> list[Array]:
    """Candidates for a turn about z: as it is, towards common normals, towards the centre of mass, principal axes."""
    angles = [0.0]
    for k in tree.children[i]:
        T = tree.edges[k]
        z, p = T[:3, 2], T[:3, 3]
        if hypot(z[0], z[1]) > NEGLIGIBLE:
            angles.append(atan2(-z[0], z[1]))
        elif hypot(p[0], p[1]) > 0.0:
            angles.append(atan2(p[1], p[0]))
    P = tree.inertias[i]
    if P[0, 3] or P[1, 3]:
        angles.append(atan2(P[1, 3], P[0, 3]))
    if P[0, 1]:
        angles.append(atan2(2 * P[0, 1], P[0, 0] - P[1, 1]) / 2)
    if tree.bodies[i].joint.kind not in TURNING:
        angles += [-atan2(b, a) for a, b, _ in tree.edge(i)[:3, :3].tolist() if a and b]
    return [about_z(x - round(x / (pi / 2)) * pi / 2) for x in angles]


def shifts_of(tree: Tree, i: int) -> list[Array]:
    """Candidates for a shift: none, to the feet of common normals; a prismatic joint's also to centres and origins."""
    turn = tree.moves[i].copy()
    turn[:3, 3] = 0.0
    tree.moves[i] = turn
    back = inverse(tree.edge(i))
    steps = feet(back)[:1]
    for k in tree.children[i]:
        steps += feet(tree.edge(k))
    steps += [*feet(back)[1:], np.zeros(3)]
    if tree.bodies[i].joint.kind == "prismatic":
        P = transformed(turn.T, tree.inertias[i])
        steps += [T[:3, 3] for T in (back, *(tree.edge(k) for k in tree.children[i]))]
        steps += [P[:3, 3] / P[3, 3]] if P[3, 3] else []
    return [turn @ shift(by) for by in steps]


def feet(T: Array) -> list[Array]:
    """Along z: to the foot of the common normal with the other frame's z axis, and level with its origin."""
    z, p = T[:3, 2], T[:3, 3]
    across = z[0] ** 2 + z[1] ** 2
    level = [np.array([0.0, 0.0, p[2]])]
    if across <= NEGLIGIBLE:
        return level
    along = -(p[0] * z[0] + p[1] * z[1]) / across
    return [np.array([0.0, 0.0, p[2] + along * z[2]]), *level]


def framing_of(bodies: Sequence[Body], turns: Sequence[Array], gravity: Array) -> Framing:
    """Frames that make the equations short.  turns (4, 4): z along the joints, in the bodies' own frames."""
    tree = Tree(bodies, turns)
    movable = [i for i, b in enumerate(bodies) if b.joint.kind in FREE_TO_TURN]
    for i in movable:
        tree.best(i, turns_of(tree, i), aligned=False)
    for i in (*movable, *movable):
        tree.best(i, shifts_of(tree, i), aligned=True)
    tree.world = turn_of_world(tree, gravity)
    placements, zeros = map(list, zip(*(best_zero(tree.edge(i), b.joint.kind) for i, b in enumerate(bodies)), strict=True))
    own = [transformed(inverse(m), P) for m, P in zip(tree.moves, tree.own, strict=True)]
    # at coordinate zero the joint has turned by its constant already
    still = [T @ about_z(zero) for T, zero in zip(placements, zeros, strict=True)]
    inertias = regrouped(bodies, own, still)
    frames = [turn @ move for turn, move in zip(turns, tree.moves, strict=True)]
    return Framing(tree.world, frames, placements, zeros, inertias)


def turn_of_world(tree: Tree, gravity: Array) -> Array:
    """(4, 4): as it is, or along the frame of a body on the world, whose turn then vanishes."""
    roots = [i for i, b in enumerate(tree.bodies) if b.parent == WORLD and b.joint.kind != "prismatic"]
    candidates = [np.eye(4)]
    for i in roots:
        turn = tree.edge(i)
        turn[:3, 3] = 0.0
        candidates.append(turn)
    costs = []
    for tree.world in candidates:
        found = [best_zero(tree.edge(i), tree.bodies[i].joint.kind) for i in roots]
        turned = sum(rotation_cost(T[:3, :3], True) + (zero != 0.0) for T, zero in found)
        costs.append(turned + 10 * np.count_nonzero(fallen(tree.world, gravity)))
    return candidates[int(np.argmin(costs))]


def fallen(world: Array, gravity: Array) -> Array:
    """Gravity (3,) along the axes of a turned world."""
    g = world[:3, :3].T @ gravity
    return np.where(np.abs(g) <= NEGLIGIBLE * np.linalg.norm(g), 0.0, g)
