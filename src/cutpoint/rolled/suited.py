"""Which robots loops support, and which are too large for functions without loops."""

from cutpoint.definitions import Machine
from cutpoint.errors import InputError
from cutpoint.kernels.arrays import backends
from cutpoint.kernels.graphs import nodes
from cutpoint.kernels.graphs.ports import Port
from cutpoint.mechanics.bodies.joints import Helical, Prismatic, Revolute
from cutpoint.mechanics.system import System
from cutpoint.model.mechanism import WORLD
from cutpoint.rolled.bodies import base_of, bodies_of
from cutpoint.rolled.drives import models_of
from cutpoint.rolled.recipes import Recipe

LEAST = {"coriolis_matrix": 8, "regressor": 9, "velocity_map": 3}
"""Operations for each pair of a body and a joint that turns it: half of what chains with parallel axes take, counted on
24 bodies; of all trees without followers these take fewest."""

MOST_STRUCTURES = 6
"""Of drives: each body computes what it would do with every one of them, and chooses."""


def unsuited(machine: Machine, recipe: Recipe) -> str | None:
    """Why loops do not support the machine, or None: each body but a floating base needs one coordinate of its own."""
    if base_of(machine.system) and not recipe.takes_base:
        return f"a base that moves freely, by joint {machine.system.segments[0].name!r}"
    for spin in machine.system.spins:
        if not spin.elastic and not recipe.takes_geared:
            return f"rigidly geared rotors with full coupling, as at {machine.system.segments[spin.joint].name!r}"
    for body in (machine.system.segments[i] for i in bodies_of(machine.system)):
        if body.follower:
            return f"the joint of {body.name!r}, which follows another"
        if type(body.joint) not in (Revolute, Prismatic, Helical):
            return f"the joint of {body.name!r}, of kind {type(body.joint).__name__.lower()}"
    return _odd_drive(machine, recipe.takes_coupled) if recipe.reads_drives else None


def _odd_drive(machine: Machine, takes_coupled: bool) -> str | None:
    system, models = machine.system, models_of(bodies_of(machine.system), machine.drives)
    if not models:
        return "no drive at all"
    if len(models) > MOST_STRUCTURES:
        return f"drives of {len(models)} structures, more than {MOST_STRUCTURES}"
    for spin in system.spins:
        if spin.elastic and not takes_coupled:
            joint = system.segments[spin.joint].name
            return f"rotors with full coupling behind springs, as at {joint!r}, unless quasi_rigid=True"
    return None


def check_compiles(name: str, system: System, backend: str) -> None:
    """Raises InputError, before tracing, for a function that certainly exceeds this backend's limit of operations or
    numbers."""
    most = backends.MOST_COMPILED if backends.chosen(backend) == "llvm" else nodes.MOST_TRACED
    turning: list[int] = []
    for body in system.segments:
        carried = 0 if body.parent == WORLD else turning[body.parent]
        turning.append(carried + int(not isinstance(body.joint, Prismatic)))
    if LEAST.get(name, 0) * sum(turning) > most and not system.has_followers:
        complaint = f"with {len(turning)} bodies it takes far more than {most} operations; use a smaller model"
        raise InputError(f"{name}: {complaint}", bodies=len(turning))
    n, bodies = system.nv, len(system.segments)
    rows = {"mass_matrix": n, "coriolis_matrix": n, "velocity_map": 6 * bodies, "regressor": 10 * bodies}
    if name in rows and backends.chosen(backend) == "llvm":
        backends.check_size(name, [Port(name, (rows[name], n))])
