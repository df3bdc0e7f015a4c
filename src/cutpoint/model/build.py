"""From links and joints as a file lists them to a `Mechanism`: validated, ordered, lumped."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.arrays import Array
from cutpoint.callers import warn
from cutpoint.model.holding import hold
from cutpoint.model.lumping import NO_MASS, MassProperties, lumped, placed
from cutpoint.model.mechanism import STANDARD_GRAVITY, WORLD, Body, Frame, Joint, Link, Mechanism
from cutpoint.model.places import Places
from cutpoint.model.pose import unit_vector
from cutpoint.model.tree import depth_first
from cutpoint.model.universal import expanded
from cutpoint.model.validation import (
    WITH_AXIS,
    check_all_bear_mass,
    check_bodies,
    check_gravity,
    check_joint,
    check_link,
    fault_of,
    lacking,
    mended,
)

FLOATING_JOINT = "root_joint"
"""Name of the joint that `floating_base` adds, and `WORLD_LINK` of what carries it."""
WORLD_LINK = "world"


class MendedWarning(UserWarning):
    """A file has inertias that are physically impossible, and they were increased."""


def build(
    name: str,
    links: Sequence[Link],
    joints: Sequence[Joint],
    *,
    gravity: ArrayLike = STANDARD_GRAVITY,
    floating_base: bool = False,
    lock: Mapping[str, float] | None = None,
    coupled: bool = False,
    mend_inertia: bool = False,
    place: Places | str | Path | None = None,
) -> Mechanism:
    """The robot as a tree of moving bodies.

    gravity: acceleration of free fall in the world's frame, (3,), m/s2.
    floating_base: whether a floating joint, "root_joint", carries the root link; otherwise it is fixed to the world.
    lock: coordinates (rad or m) at which joints are held fixed, by name.
    coupled: whether mimic joints follow their leader, or are coordinates of their own.
    mend_inertia: increase physically impossible inertias until they are possible, with a warning.
    place: the file, for messages; a `Places` also knows the lines.

    Fixed links are lumped into the body that carries them (those on the world lose their mass); every link, and every
    joint without a link's name, is a frame of the result.  Axes come out with unit length.  A universal joint becomes
    two revolute ones, see `universal`.
    Raises ModelError for whatever `validation`, `tree` and `holding` find wrong.
    """
    places = place if isinstance(place, Places) else Places(place)
    fall = np.asarray(gravity)
    check_gravity(fall, places)
    for link in links:
        check_link(link, places)
    for joint in joints:
        check_joint(joint, places)
    links, joints = expanded(links, [_with_unit_axis(joint) for joint in joints])
    root, ordered = depth_first(links, joints, places)
    ordered = hold(ordered, lock or {}, coupled, places)
    carried = [_floating_joint(root, ordered, places), *ordered] if floating_base else ordered
    tree = _assemble(root, links, carried, floating_base)
    bodies = tuple(tree.bodies())
    if mend_inertia:
        bodies = _mended(bodies, places)
    check_bodies(bodies, tree.pieces, places)
    check_all_bear_mass(bodies, places)
    if floating_base:
        _check_floats_once(bodies, places)
    return Mechanism(name, bodies, tree.frames([link.name for link in links], carried), fall, coupled)


def _mended(bodies: Sequence[Body], places: Places) -> tuple[Body, ...]:
    """The bodies with impossible inertias increased, which is reported."""
    added = {body.name: lacking(body) for body in bodies if body.mass > 0.0 and fault_of(body)}
    if added:
        told = ", ".join(f"{name!r} by {more:.4g}" for name, more in added.items())
        file = f" ({places.file})" if places.file else ""
        warn(f"physically impossible inertias are increased, kg m2 about every axis: {told}{file}", MendedWarning)
    return tuple(mended(body) if body.name in added else body for body in bodies)


@dataclass
class _Assembly:
    """Bodies during assembly.

    seats: each link's body index and placement (4, 4) in that body.
    carriers: of each body, its joint, the index of the body that carries it, and the joint's placement there.
    pieces: the links that give each body its mass.
    """

    seats: dict[str, tuple[int, Array]]
    carriers: list[tuple[Joint, int, Array]] = field(default_factory=list)
    masses: list[MassProperties] = field(default_factory=list)
    pieces: list[list[str]] = field(default_factory=list)

    def start_body(self, joint: Joint, parent: int, placement: Array) -> None:
        self.carriers.append((joint, parent, placement))
        self.masses.append(NO_MASS)
        self.pieces.append([])

    def add(self, link: Link) -> None:
        """Adds a seated link's mass to its body; links on the world lose theirs."""
        (body, placement), own = self.seats[link.name], _properties(link)
        if body != WORLD and not own.is_nothing:
            self.masses[body] = lumped(self.masses[body], placed(placement, own))
            self.pieces[body].append(link.name)

    def bodies(self) -> list[Body]:
        return [
            Body(joint.child, joint, parent, placement, own.mass, own.com, own.inertia)
            for (joint, parent, placement), own in zip(self.carriers, self.masses, strict=True)
        ]

    def frames(self, links: Sequence[str], joints: Sequence[Joint]) -> dict[str, Frame]:
        """One frame for each link, and for each joint that shares no link's name: a joint's frame is its child's."""
        seats = {joint.name: self.seats[joint.child] for joint in joints} | {link: self.seats[link] for link in links}
        return {name: Frame(name, body, placement) for name, (body, placement) in seats.items()}


def _assemble(root: str, links: Sequence[Link], joints: Sequence[Joint], floating_base: bool) -> _Assembly:
    """Goes outward over the tree: a moving joint starts a body, a fixed one adds its link to the carrying body."""
    by_name = {link.name: link for link in links}
    tree = _Assembly({WORLD_LINK if floating_base else root: (WORLD, np.eye(4))})
    for joint in joints:
        carrier, seat = tree.seats[joint.parent]
        here = seat @ joint.placement
        if joint.kind == "fixed":
            tree.seats[joint.child] = (carrier, here)
        else:
            tree.seats[joint.child] = (len(tree.carriers), np.eye(4))
            tree.start_body(joint, carrier, here)
        tree.add(by_name[joint.child])
    return tree


def _properties(link: Link) -> MassProperties:
    return MassProperties(link.mass, link.com, (link.inertia + link.inertia.T) / 2.0)


def _with_unit_axis(joint: Joint) -> Joint:
    if joint.kind not in WITH_AXIS:
        return joint
    second = None if joint.second_axis is None else unit_vector(joint.second_axis)
    return replace(joint, axis=unit_vector(joint.axis), second_axis=second)


def _floating_joint(root: str, joints: Sequence[Joint], places: Places) -> Joint:
    if any(joint.name == FLOATING_JOINT for joint in joints):
        complaint = "this name is taken by the joint that floating_base adds; rename it"
        raise places.error(f"joint {FLOATING_JOINT!r}", complaint, joint=FLOATING_JOINT)
    return Joint(FLOATING_JOINT, "floating", parent=WORLD_LINK, child=root)


def _check_floats_once(bodies: Sequence[Body], places: Places) -> None:
    """Raises ModelError for a massless root between two floating joints: nothing says how it moves."""
    floating = [body.joint.name for body in bodies if body.parent == 0 and body.joint.kind == "floating"]
    if floating and bodies[0].mass == 0.0:
        remedy = "leave out floating_base (--floating-base)"
        complaint = f"already lets the robot float, from link {bodies[0].name!r}, which has no mass; {remedy}"
        raise places.error(f"joint {floating[0]!r}", complaint, joint=floating[0])
