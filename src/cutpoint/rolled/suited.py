"""Which robots loops take."""

from cutpoint.definitions import Machine
from cutpoint.mechanics.joints import Helical, Prismatic, Revolute
from cutpoint.rolled.bodies import bodies_of
from cutpoint.rolled.drives import models_of

MOST_STRUCTURES = 6
"""Of drives: each body computes what it would do with every one of them, and chooses."""


def unsuited(machine: Machine, elastic: bool, takes_coupled: bool) -> str | None:
    """What loops do not take, if there is anything: they need one coordinate of its own for each body,
    but for a base that moves freely.

    elastic: whether drives take part; takes_coupled: also with rotors with full coupling.
    """
    for body in (machine.system.segments[i] for i in bodies_of(machine.system)):
        if body.follower:
            return f"the joint of {body.name!r}, which follows another"
        if type(body.joint) not in (Revolute, Prismatic, Helical):
            return f"the joint of {body.name!r}, of kind {type(body.joint).__name__.lower()}"
    return _odd_drive(machine, takes_coupled) if elastic else None


def _odd_drive(machine: Machine, takes_coupled: bool) -> str | None:
    system, models = machine.system, models_of(bodies_of(machine.system), machine.drives)
    if len(models) > MOST_STRUCTURES:
        return f"drives of {len(models)} structures, but {MOST_STRUCTURES} at most"
    for spin in system.spins:
        if spin.elastic and not takes_coupled:
            joint = system.segments[spin.joint].name
            return f"rotors with full coupling behind springs, as at {joint!r}, unless quasi_rigid=True"
    return None
