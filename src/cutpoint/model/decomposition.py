"""Virtual decomposition of a robot: link and joint subsystems, and the cutting points between them.

Xia (2019) sections II.B and III: every joint is a subsystem of its own, between the link that carries it and the link
that it drives.
"""

from dataclasses import dataclass
from typing import Literal

from cutpoint.model.mechanism import WORLD, Mechanism


@dataclass(frozen=True)
class Subsystem:
    """One piece of the decomposed robot; `body` is the index of the link, or of the link that the joint drives."""

    name: str
    kind: Literal["joint", "link"]
    body: int


@dataclass(frozen=True)
class Cut:
    """A cutting point between two subsystems; `inner` is the one nearer to the base."""

    inner: str
    outer: str


def subsystems_of(mechanism: Mechanism) -> tuple[Subsystem, ...]:
    """Joints and links, outward.  A floating joint is not a subsystem, since it constrains nothing; all others are."""
    found = []
    for i, body in enumerate(mechanism.bodies):
        if body.joint.kind != "floating":
            found.append(Subsystem(body.joint.name, "joint", i))
        found.append(Subsystem(body.name, "link", i))
    return tuple(found)


def cuts_of(mechanism: Mechanism) -> tuple[Cut, ...]:
    """Cuts between each link and the joints it carries, and each joint and the link it drives, outward."""
    found = []
    for body in mechanism.bodies:
        if body.joint.kind == "floating":
            continue
        if body.parent != WORLD:
            found.append(Cut(mechanism.bodies[body.parent].name, body.joint.name))
        found.append(Cut(body.joint.name, body.name))
    return tuple(found)
