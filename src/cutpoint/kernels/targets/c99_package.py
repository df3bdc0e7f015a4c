"""A function as a C99 package that can be built, tested and installed with any C compiler."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays.arguments import as_numbers
from cutpoint.kernels.arrays.backends import array_function, chosen
from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.targets.c99 import Source, source_of
from cutpoint.kernels.targets.c99_texts import Notes, texts
from cutpoint.kernels.targets.package_files import check_gives_numbers, folder_of, is_ours, write_files
from cutpoint.version import __version__

_SCALES = (0.0, 1e-300, 1e-40, 1e-8, *[1e-3] * 4, *[1.0] * 8, 1e3)
"""Of the check's random inputs, a case each: what remembers sees small motions before large ones."""

_FEW = (0.0, 1.0)
"""The same for functions of so many numbers that the check would be larger than what it checks."""

_MANY = 2000
"""Numbers in and out."""

_NO_NOTES = Notes()


def write_package(
    graph: Graph, name: str, folder: str | Path, notes: Notes = _NO_NOTES, *, force: bool = False
) -> tuple[Path, ...]:
    """Writes the C function of a graph: see `write_source`.

    Raises InputError also where llvmlite is missing: the check records what machine code returns.
    """
    function = array_function(graph, name, chosen("llvm"))  # it must outlive its calls, whose code it owns
    return write_source(source_of(graph), function.call, name, folder, notes, force=force)


def write_source(
    source: Source,
    computed: Callable[..., Any],
    name: str,
    folder: str | Path,
    notes: Notes = _NO_NOTES,
    *,
    force: bool = False,
) -> tuple[Path, ...]:
    """Writes a C function with header, C++ header, check and CMake package; returns the files' paths.

    computed: the same function on arrays, for the check to record.
    force: overwrite files that cutpoint has not written, and the package of another function.
    Raises InputError for names that C cannot take, for files in the way, and where there is no number to give back.
    """
    check_gives_numbers(name, source.outputs)
    if not force:
        _check_alone(folder_of(folder), name)
    return write_files(folder, texts(source, name, notes, __version__, _recorded(source, computed, notes)), force)


def _check_alone(folder: Path, name: str) -> None:
    """Raises InputError for the folder of another function: its CMakeLists.txt would build that one no longer."""
    path = folder / "CMakeLists.txt"
    found = re.search(rb"^project\((\w+)", path.read_bytes(), re.MULTILINE) if is_ours(path) else None
    if found and (other := found[1].decode()) != name:
        remedy = "choose another folder, or use force=True (--force on the command line) to replace it"
        raise InputError(f"{str(path)!r} builds {other!r}, but a package holds one function; {remedy}", path=path)


def _recorded(source: Source, computed: Callable[..., Any], notes: Notes) -> tuple[np.ndarray, np.ndarray]:
    """Inputs and outputs, (cases, slots) each; cases follow each other as steps of what remembers do."""
    given = _inputs(source, notes)
    cases = len(given[0]) if given else len(_SCALES)
    steps = [slice(k, k + 1) for k in range(cases)] if notes.carried else [slice(None)]
    outputs = [np.empty((cases, *p.shape), source.precision.dtype) for p in source.outputs]
    names_in, names_out = ([p.name for p in ports] for ports in (source.inputs, source.outputs))
    for k, step in enumerate(steps):
        for name, before in notes.carried.items() if k else ():
            given[names_in.index(name)][k] = outputs[names_out.index(before)][k - 1]
        found = computed(*(x[step] for x in given))
        for column, result in zip(outputs, found if isinstance(found, tuple) else (found,), strict=True):
            column[step] = result
    return _side_by_side(given, cases), _side_by_side(outputs, cases)


def _inputs(source: Source, notes: Notes) -> list[np.ndarray]:
    """Random numbers, and the values that an argument usually has, varied."""
    rng = np.random.default_rng(0)
    is_small = sum(p.size for p in (*source.inputs, *source.outputs)) <= _MANY
    scales = np.array(_SCALES if is_small else _FEW)
    given: list[np.ndarray] = []
    for p in source.inputs:
        random = rng.standard_normal((len(scales), *p.shape))
        spread = scales.reshape(-1, *[1] * len(p.shape))
        if p.name in notes.series:
            numbers = notes.series[p.name](np.arange(len(scales)))
        elif p.name in notes.values:
            # the first case has scale 0: there the values are exact
            numbers = _varied(notes.values[p.name].numbers, random, np.minimum(spread, 1))
        else:
            numbers = random * spread
        given.append(as_numbers(numbers, source.precision))
    return given


def _varied(usual: np.ndarray, random: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """About as large as usual, and small where that is 0; as usual to the bit, -0 too, where nothing is spread."""
    return np.where((usual == 0) & (spread > 0), spread * np.abs(random) / 100, usual * (1 + spread * random / 20))


def _side_by_side(arrays: Sequence[np.ndarray], cases: int) -> np.ndarray:
    return np.concatenate([np.empty((cases, 0)), *(a.reshape(cases, -1) for a in arrays)], axis=1)
