"""The equations of one robot, traced and compiled at their first use.

Geometry and inertias are constants in the code; drive parameters are inputs of every function that reads them, so that
changing them never recompiles.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from operator import attrgetter
from typing import TYPE_CHECKING, Any
from weakref import WeakMethod

import numpy as np

from cutpoint import kernels
from cutpoint.definitions import Machine
from cutpoint.errors import InputError, those_that_exist
from cutpoint.functions.facts import FACTS, Facts
from cutpoint.functions.idle_joints import check_moves_inertia
from cutpoint.functions.quaternions import quaternions_of, with_quaternions
from cutpoint.functions.robot_function import RobotFunction
from cutpoint.kernels import Kernel
from cutpoint.mechanics.assembly.assembly import lean_framing, system_of
from cutpoint.mechanics.assembly.reframing import Framing
from cutpoint.mechanics.drives import strains
from cutpoint.mechanics.system import Driven
from cutpoint.model import Drive, Mechanism
from cutpoint.model.mechanism import frozen
from cutpoint.rolled import (
    DERIVATIVES,
    RolledFunction,
    check_compiles,
    joint_by_joint,
    loops_take,
    name_of,
    rolled,
)
from cutpoint.scalars import leaves, rebuild, structure_of

if TYPE_CHECKING:
    from cutpoint.rolled.equations.solver import Solver

Function = Callable[..., Any]


def machine_of(mechanism: Mechanism, drives: Mapping[str, Drive], framing: Framing | None = None) -> Machine:
    """The robot as the equations take it: rigid drives' rotors as armature, drives with indices of their coordinates.

    framing: frames and inertias other than the bodies' own.
    """
    system = system_of(mechanism, drives, framing)
    indices = {body.joint.name: i for i, body in enumerate(mechanism.bodies)}
    placed = [(drive, indices[name]) for name, drive in drives.items()]
    return Machine(system, [Driven(d, i, system.segments[i].q.start, system.segments[i].v.start) for d, i in placed])


def rotor_is_felt(drive: Drive) -> bool:
    """Whether a drive's rotor enters the links' equations: as armature, as a spin, or as mass."""
    return drive.rotor is not None and not (
        drive.is_elastic and drive.rotor.in_link_inertia and drive.rotor.coupling == "reduced"
    )


compiled_of: Callable[[Any], "RobotKernels"] = attrgetter("_compiled")
"""What a Robot keeps for its functions."""


class RobotKernels:
    """Kernels of one robot by name; each is compiled at its first use.

    machine: the robot with its bodies' own frames (z along the joints) and inertias, for functions of frames, single
    bodies and their parameters.  lean: the same robot, reframed, regrouped and in a unit of length of its own, for all
    others.
    parameters: the drives' numbers, in the order of the drives and of their fields.  structure: the drives
    without their numbers.  functions: made so far.
    """

    def __init__(self, mechanism: Mechanism, drives: Mapping[str, Drive], backend: str) -> None:
        self._mechanism, self._drives, self._backend = mechanism, dict(drives), backend
        self.machine = machine_of(mechanism, drives)
        self.parameters = frozen(np.array(leaves([*drives.values()]), dtype=float))
        self._rotors_are_felt = any(rotor_is_felt(drive) for drive in drives.values())
        self.functions = Functions(self.function)
        self._kernels: dict[str, Kernel] = {}
        self._shared: dict[Any, tuple[RobotFunction, Function]] = {}
        self._loops: dict[str, RolledFunction] = {}
        self._are_exported: dict[str, bool] = {}

    def size_of(self, name: str) -> int | tuple[()]:
        """Length of an input's last axis; () for a single number."""
        if name.startswith("wrench_"):
            return 6
        if name == "dt":
            return ()
        if name in ("theta", "theta_dot", "theta_ddot", "motor_torque"):
            return len(self._drives)
        if name == "strains":
            return sum(map(strains.count, self._drives.values()))
        return self.machine.system.nq if name in ("q", "q_next") else self.machine.system.nv

    @cached_property
    def structure(self) -> Hashable:
        return structure_of([*self._drives.items()])

    def share_kernels_with(self, other: "RobotKernels") -> None:
        """Shares kernels with a robot of the same mechanism, if their drives differ in numbers only."""
        if self.structure == other.structure:
            self._shared = other._shared

    @cached_property
    def quaternions(self) -> dict[str, slice]:
        """Their positions in q, by the joint's name."""
        return quaternions_of(self._mechanism, self.machine.system)

    @cached_property
    def derivatives_loop(self) -> bool:
        """Whether derivatives of rigid dynamics run as loops over bodies."""
        return self.loops(DERIVATIVES)

    def loops(self, key: Any) -> bool:
        """Whether a function runs as loops over bodies."""
        return loops_take(key, self.machine, self._backend)

    def remember_as_loops(self, name: str, *, are_exported: bool = False) -> None:
        """Notes that a function has no kernel, for the error when one is requested.

        are_exported: whether its loops can be exported as C.
        """
        self._are_exported[name] = are_exported

    @cached_property
    def lean(self) -> Machine:
        return machine_of(self._mechanism, self._drives, lean_framing(self._mechanism))

    def with_parameters(self, parameters: Sequence[Any], lean: bool) -> Machine:
        """The machine, or the lean one, with these drive parameters."""
        shape = parameters.shape if isinstance(parameters, np.ndarray) else (len(parameters),)
        if shape != (len(self.parameters),):
            rule = f"must be {len(self.parameters)} numbers, as drive_parameters"
            found = f"shape {shape}" if len(shape) != 1 else shape[0]
            raise InputError(f"machine_with: parameters {rule}, got {found}")
        new = dict(zip(self._drives, rebuild([*self._drives.values()], iter(parameters)), strict=True))
        if self._rotors_are_felt:
            return machine_of(self._mechanism, new, lean_framing(self._mechanism) if lean else None)
        driven = [replace(old, drive=drive) for old, drive in zip(self.machine.drives, new.values(), strict=True)]
        return Machine((self.lean if lean else self.machine).system, driven)

    def function(self, key: Any, facts: Facts) -> Function:
        """A definition, on a Machine and lists of scalars, as a function of arrays; compiled at its first use.

        key: its name; with what the definition closes over, a tuple that begins with its name.
        Raises ModelError if it divides by inertia, and a joint moves none.
        """
        found = self.functions.get(key)
        if found is None:
            name, inputs = name_of(key), facts.inputs.split()
            if facts.divides:
                check_moves_inertia(self._mechanism, self.machine)
            found = self._made(key, facts)
            if self.quaternions:
                nq = self.machine.system.nq
                found = with_quaternions(found, name, inputs, self.quaternions, nq, self._backend)
            if facts.is_matrix and not self.machine.system.nv:
                found = _with_empty_matrices(found)
            self.functions[key] = found
        return found

    def _made(self, key: Any, facts: Facts) -> Function:
        """A function as loops over bodies, if these support it and pay off, or as a kernel: code without loops."""
        name, sizes = name_of(key), {x: self.size_of(x) for x in facts.inputs.split()}
        assert facts.definition is not None
        if loops := rolled(key, self.machine, self._backend, facts.record):
            self._loops[name] = loops
            self.remember_as_loops(name, are_exported=True)
            return loops.quick()
        machine = self.machine if facts.reads_drives else self.machine._replace(drives=[])
        if by_joint := joint_by_joint(key, facts.definition, sizes, machine, self._backend):
            self.remember_as_loops(name)
            return by_joint
        check_compiles(name, self.machine.system, self._backend)
        if key not in self._shared:
            made = self._compile(name, facts, sizes)
            self._shared[key] = made, made.quick()
        made, quick = self._shared[key]
        self._kernels[name] = made.kernel
        return quick if made.knows(self.parameters) else made.bound_to(self.parameters).quick()

    @cached_property
    def solver(self) -> "Solver":
        """Solver for two systems with the mass matrix at once, with the same number of columns."""
        from cutpoint.rolled.equations import solver_of  # needs llvmlite

        return solver_of(self.machine.system, [self.machine.system.nv] * 2)

    def looping(self, name: str) -> RolledFunction | None:
        """A function that has been made as loops of one program."""
        return self._loops.get(name)

    def made(self, name: str) -> Kernel:
        """A kernel that has been made, the latest variant of this name."""
        if name not in self._kernels:
            if name in self._are_exported:
                n = len(self.machine.system.segments)
                to_export = "; loops are exported as C only" if self._are_exported[name] else " or to export"
                told = f"with {n} bodies it runs as loops over them and has no kernel to inspect{to_export}"
                raise InputError(f"{name}: {told}; with fewer it has one: lock joints that do not move", name=name)
            there = those_that_exist(name, self._kernels) if self._kernels else "none exists yet"
            remedy = "functions compile on their first call, so call it once first"
            told = f"no compiled function is named {name!r}, {there}; {remedy}"
            raise InputError(told, name=name, known=[*self._kernels])
        return self._kernels[name]

    def _compile(self, name: str, facts: Facts, sizes: Mapping[str, int | tuple[()]]) -> RobotFunction:
        """Compiles, with the drives' parameters as an input if the definition reads drives or links feel a rotor."""
        counts = facts.reads_drives or (self._rotors_are_felt and not facts.ignores_rotors)
        parametric = bool(self.parameters.size) and counts
        definition = facts.definition
        assert definition is not None

        def traced(**given: Any) -> Any:
            if parametric:
                return definition(self.with_parameters(given.pop("parameters"), facts.lean), **given)
            return definition(self.lean if facts.lean else self.machine, **given)

        shapes = {**sizes, "parameters": self.parameters.size} if parametric else sizes
        kernel = kernels.compile(traced, name=name, backend=self._backend, **shapes)
        return RobotFunction(name, kernel, sizes, [self.parameters] if parametric else [], facts.record)


class Functions(dict[Any, Function]):
    """Compiled functions, by name or by a tuple that begins with it; those of a name alone are made at first use."""

    def __init__(self, make: Function) -> None:
        """make: a method that makes the function of a name and its facts, and puts it here."""
        super().__init__()
        self._make = WeakMethod(make)  # weak, since its object holds these: code is freed with the robot

    def __missing__(self, name: str) -> Function:
        make = self._make()
        assert make is not None, "a robot holds what makes its functions"
        return make(name, FACTS[name])


def _with_empty_matrices(function: Function) -> Function:
    """The function of a robot without moving joints, whose kernel loses the columns of matrices without rows."""

    def shaped(*given: Any) -> Any:
        found = function(*given)
        if isinstance(found, tuple):
            return tuple.__new__(type(found), [x.reshape(*x.shape, 0) for x in found])
        return found.reshape(*found.shape, 0)

    return shaped
