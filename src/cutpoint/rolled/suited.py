"""Which robots loops take."""

from cutpoint.definitions import Machine
from cutpoint.mechanics.joints import Helical, Prismatic, Revolute
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import structure_of


def unsuited(machine: Machine, elastic: bool) -> str | None:
    """What loops do not take, if there is anything: they need one coordinate of its own for each body.

    elastic: whether drives take part; then each body needs one, all of one structure.
    """
    for body in machine.system.segments:
        if body.follower:
            return f"the joint of {body.name!r}, which follows another"
        if type(body.joint) not in (Revolute, Prismatic, Helical):
            return f"the joint of {body.name!r}, of kind {type(body.joint).__name__.lower()}"
    return _odd_drive(machine) if elastic else None


def _odd_drive(machine: Machine) -> str | None:
    bodies, drives = machine.system.segments, machine.drives
    if [driven.segment for driven in drives] != [*range(len(bodies))]:
        return "joints without a drive"
    for body, driven in zip(bodies, drives, strict=True):
        if not driven.drive.is_elastic or structure_of(driven.drive) != structure_of(drives[0].drive):
            return f"drives of different kinds, or rigid ones, as at {body.name!r}"
        if driven.drive.rotor and driven.drive.rotor.coupling == "full" and body.parent != WORLD:
            return f"rotors with full coupling behind springs, as at {body.name!r}"
    return None
