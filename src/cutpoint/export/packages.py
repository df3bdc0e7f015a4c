"""Packages of a robot's functions and of control laws, with the numbers, notes and checks that go with them."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint import derivatives
from cutpoint.control.interface import Control, start_of
from cutpoint.control.law import law_in_words
from cutpoint.derivatives import in_c
from cutpoint.door import check_kind, positive
from cutpoint.errors import InputError, unknown_name
from cutpoint.export.notes import drive_labels, has_guard, labels_of, left_out_of, notes_of, notes_of_law, result_of
from cutpoint.functions.compiled import compiled_of
from cutpoint.functions.facts import FACTS
from cutpoint.functions.variants import motion_names
from cutpoint.kernels.graphs.ports import with_numbers
from cutpoint.kernels.graphs.precision import PRECISIONS
from cutpoint.kernels.targets import c99_package, cuda_package
from cutpoint.kernels.targets.c99 import Source
from cutpoint.kernels.targets.c99_texts import Values
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot
from cutpoint.scalars import with_float_leaves
from cutpoint.simulation.control_kernel import law_kernel, law_memory
from cutpoint.simulation.loop.parameters import law_parameters

_WRITERS = {"c": c99_package.write_package, "cuda": cuda_package.write_package}
"""What a function can be exported to."""

_SPEEDS_NEEDED = {"momentum": "theta_dot", "elastic_energy": "v"}
"""A further input of functions where links carry rotors with full coupling, which turn at speeds of their own."""


def export_function(
    robot: Robot,
    function: str,
    folder: str | Path,
    *,
    to: str = "c",
    precision: str = "float64",
    name: str | None = None,
    force: bool = False,
    **options: Any,
) -> tuple[Path, ...]:
    """Writes one of a robot's functions as a package of C99, or as CUDA C; returns the files' paths.

    function: a method's name, or a function's of `cutpoint.derivatives` with "_derivatives" behind it: one of FACTS.
    folder: of the package; created with its parents if missing.  Files that an earlier export wrote are replaced.
    to: "c" or "cuda".  precision: "float64" or "float32".  name: of the C function, the same if not given.
    options: the method's own, such as frame= for a Jacobian.  force: overwrite files that cutpoint has not written.
    Where drives count, their numbers are the function's last input, and the header holds them as <name>_parameters.
    Of rotors with full coupling behind springs, momentum also takes theta_dot, and elastic_energy v.
    Raises InputError for an unknown function or target, a missing option, a name C cannot take, files in the way, and
    for single precision of what runs as loops or of numbers that it would hold as 0 or infinite.
    """
    check_robot("export_function", robot)
    name = function if name is None else name
    _check_words(function=function, to=to, precision=precision, name=name)
    single = precision == "float32"
    # a fresh robot has compiled no other variant of the kernel
    fresh = Robot(robot.mechanism, robot.drives, backend=robot.backend)
    called = _called(fresh, function)
    if robot.machine.system.has_sprung_rotors and (speeds := _SPEEDS_NEEDED.get(function)):
        options[speeds] = _neutral(robot, speeds)
    called(*_neutral_arguments(fresh, function, called, options), **options)
    # arrays are told of where the arguments are
    told = {key: x for key, x in options.items() if isinstance(x, (str, bool, Mapping))}
    said = [f"{key} {', '.join(x) if isinstance(x, Mapping) else x}" for key, x in told.items()]
    left_out = left_out_of(robot, function, **options)
    about = ", ".join([f"{function} of {robot.name}", *said, *left_out, *["in single precision"] * single])
    values = {"parameters": Values(robot.drive_parameters, drive_labels(robot))}
    _check_bears(name, values, precision)
    result = result_of(robot, function, **options)
    if to == "c" and (found := _as_loops(fresh, function)):
        if single:
            told = f"for {robot.nv} degrees of freedom it is exported as loops, which need double precision"
            raise InputError(f"{function}: {told} (precision='float64', --precision float64)", name=function)
        notes = notes_of(robot, found[0], about, values, result)
        return c99_package.write_source(*found, name, folder, notes, force=force)
    graph = replace(fresh.kernel(function).graph, precision=PRECISIONS[precision])
    if not with_numbers(graph.outputs):
        raise InputError(f"{function}: it returns no numbers: {_lacking(robot)}", name=function)
    if named := FACTS[function].result:
        (port,) = graph.outputs
        graph = replace(graph, outputs=(replace(port, name=named),))
    notes = notes_of(robot, graph, about, values, result)
    return _WRITERS[to](graph, name, folder, notes, force=force)


def export_controller(
    robot: Robot,
    law: Control,
    folder: str | Path,
    *,
    control_period: float,
    precision: str = "float64",
    name: str = "control_step",
    force: bool = False,
) -> tuple[Path, ...]:
    """Writes one step of a control law as a package of C99, the same step that simulation compiles into its loop.

    folder, name, force: as for `export_function`; returns the files' paths.
    control_period: s.  The header holds as <name>_parameters the law's numbers and the period, and as <name>_memory
    the law's memory before the first step.  Torque limits are not applied.
    precision: "float64", or "float32", where a position at pi rad comes in steps of 2.4e-7 rad, and time after an hour
    in steps of 0.24 ms: a Guard's deadlines need the former.
    Raises InputError as `export_function` does, for a period that is not positive, and for a Guard in single precision;
    TraceError for a law that cannot be traced.
    """
    check_robot("export_controller", robot)
    check_kind("export_controller", "name", name, str, "the name of a C function")
    check_kind("export_controller", "precision", precision, str, "a name")
    _check_precision(precision)
    period, single = positive("export_controller", "control_period", control_period, "s"), precision == "float32"
    if single and has_guard(law):
        told = "a Guard measures its deadlines by time, whose steps in single precision exceed a period within hours"
        raise InputError(f"export_controller: {told}; use precision='float64', or export the law that it guards")
    graph = replace(law_kernel(robot, law, name=name).graph, precision=PRECISIONS[precision])
    labels = [*labels_of(law, type(law).__name__), "control period, s"]
    values = {"parameters": Values(law_parameters(law, period), labels)}
    memory = law_memory(law)
    if memory.size:
        values["memory"] = Values(memory, [*labels_of(with_float_leaves(start_of(law)), "memory")])
    _check_bears(name, values, precision)
    limits = "no limits but the guard's" if has_guard(law) else "limits not applied"
    told = "in single precision, " * single
    about = f"A step of {law_in_words(law)} for {robot.name}, {limits}, {told}to be called every {period:g} s"
    notes = notes_of_law(robot, law, graph, about, values)
    carried = {"memory": "next_memory"} if memory.size else {}
    notes = replace(notes, carried=carried, series={"time": partial(_passing, period)})
    return c99_package.write_package(graph, name, folder, notes, force=force)


def _check_words(**given: str) -> None:
    """Raises InputError for a function, a target or a precision that there is not, and for what is no name."""
    for key, text in given.items():
        check_kind("export_function", key, text, str, "a name")
    if given["function"] not in FACTS:
        raise unknown_name("function to export", given["function"], FACTS)
    if given["to"] not in _WRITERS:
        raise unknown_name("target of export", given["to"], _WRITERS)
    _check_precision(given["precision"])


def _lacking(robot: Robot) -> str:
    """What a robot lacks if a function has no numbers."""
    if not robot.nv:
        return f"no joint of {robot.name} moves"
    if not robot.drives:
        return f"{robot.name} has no joint with a drive"
    remedy = "state them in a drive file (drives= of load, --drives on the command line)"
    return f"no drive of {robot.name} has a rotor, a spring or friction; {remedy}"


def _check_precision(precision: str) -> None:
    if precision not in PRECISIONS:
        raise unknown_name("precision", precision, PRECISIONS)


def _check_bears(function: str, values: Mapping[str, Values], precision: str) -> None:
    """Raises InputError for a number that this precision holds as 0 or as infinite."""
    rounded = PRECISIONS[precision].rounded
    for table in values.values():
        for x, label in zip(map(float, table.numbers), table.labels, strict=True):
            if np.isfinite(x) and (bool(rounded(x)) != bool(x) or np.isinf(rounded(x))):
                told = f"{label} is {x:g}, but {rounded(x):g} in {precision}"
                raise InputError(f"{function}: {told}; export it in float64, or choose other units", name=label)


def _passing(period: float, steps: np.ndarray) -> np.ndarray:
    """Time at the check's steps; it stands still in the last."""
    return period * np.minimum(steps, steps[-1] - 1)


def _as_loops(robot: Robot, function: str) -> tuple[Source, Callable[..., Any]] | None:
    """A function that has been called, in C and on arrays, if it runs as loops that leave as C."""
    if loops := compiled_of(robot).looping(function):
        named = FACTS[function].result
        return loops.to_c(*([named] if named else [])), loops
    return in_c.forward_dynamics(robot) if function == "forward_dynamics_derivatives" else None


def _called(robot: Robot, function: str) -> Callable[..., Any]:
    """The function that users call in Python."""
    of = function.removesuffix("_derivatives")
    return getattr(robot, function) if of == function else partial(getattr(derivatives, of), robot)


def _neutral_arguments(
    robot: Robot, function: str, called: Callable[..., Any], options: Mapping[str, Any]
) -> list[Any]:
    """Arguments for a first call, which compiles it.

    Raises InputError for missing or unknown options.
    """
    inputs, parameters = FACTS[function].inputs, inspect.signature(called).parameters
    if any(p.kind is p.VAR_POSITIONAL for p in parameters.values()):
        inputs = motion_names(4 if options.get("quasi_rigid") else robot.derivatives_needed)
    known = {k: p for k, p in parameters.items() if k not in inputs.split() and p.kind is not p.VAR_POSITIONAL}
    for key in options:
        if key not in known:
            raise unknown_name(f"option of {function}", key, known)
    for key, parameter in known.items():
        if key not in options and parameter.default is parameter.empty:
            raise InputError(f"{function}: give {key}= (--{key} on the command line)", name=key)
    return [_neutral(robot, key) for key in inputs.split()]


def _neutral(robot: Robot, key: str) -> Any:
    if key in ("q", "q_next"):
        return robot.neutral()
    return 1e-3 if key == "dt" else np.zeros(compiled_of(robot).size_of(key))
