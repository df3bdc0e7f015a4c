"""Texts of an exported function's files: templates, filled in."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from string import Template
from typing import Any, NamedTuple

import numpy as np

from cutpoint.kernels.graphs.ports import Port, slot_names, with_numbers
from cutpoint.kernels.graphs.precision import Precision
from cutpoint.kernels.targets import c99, c_names

FILES = {
    "{}.c": "function.c", "{}.h": "function.h", "{}.hpp": "function.hpp", "{}_check.c": "check.c",
    "CMakeLists.txt": "CMakeLists.txt", "README.txt": "README.txt",
}  # fmt: skip
"""Templates by the names of the files that they make."""


class Values(NamedTuple):
    """Default numbers of an argument, and what each of them is."""

    numbers: np.ndarray
    labels: Sequence[str]


@dataclass(frozen=True)
class Notes:
    """Notes on a function beyond its graph.

    about: what it is of, in a sentence.  arguments: unit and order of an argument, by name.  values: of arguments that
    have defaults; the header then holds them as <function>_<argument>.
    carried: by argument, the output of the previous step that it takes.  series: by argument, its numbers as a function
    of the steps.
    """

    about: str = ""
    arguments: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, Values] = field(default_factory=dict)
    carried: Mapping[str, str] = field(default_factory=dict)
    series: Mapping[str, Callable[[np.ndarray], np.ndarray]] = field(default_factory=dict)


class _Template(Template):
    """Placeholders are @{name}: C and CMake themselves use the dollar sign."""

    delimiter = "@"


def texts(
    source: c99.Source, name: str, notes: Notes, version: str, recorded: tuple[np.ndarray, np.ndarray]
) -> dict[str, str]:
    """Every file's text by file name.

    recorded: inputs and outputs of the check, (cases, slots) each.
    Raises InputError for names that C cannot take.
    """
    inputs, outputs = map(with_numbers, (source.inputs, source.outputs))
    precision = source.precision
    c_names.check_names(name, inputs, outputs)
    helpers = "".join(f"{text}\n" for text in source.helpers)
    steps = f"loops of fixed lengths, {source.stack:,} bytes of the stack" if source.stack else "no loops"
    fields = {
        **c99.words(precision),
        "version": version, "about": comment(notes.about), "name": name, "guard": name.upper(),
        "parameters": c99.parameters(inputs, outputs, precision) or "void", "helpers": helpers,
        "body": source.body, "steps": steps, "names": ", ".join(p.name for p in (*inputs, *outputs)),
        "arguments": arguments(inputs, outputs, notes), "values": values(name, notes, precision),
        "tables": _tables(name, inputs, notes),
        **_check(inputs, outputs, *recorded, precision), **_cpp(inputs, outputs, name, precision),
    }  # fmt: skip
    folder = files("cutpoint.kernels.targets") / "c99_templates"
    return {
        target.format(name): _Template((folder / source).read_text("utf-8")).substitute(fields)
        for target, source in FILES.items()
    }


def comment(text: str) -> str:
    """A text that cannot end or break a C comment: other characters are replaced by their Unicode numbers."""
    return re.sub(r"[^A-Za-z0-9_ .,:;()\[\]=<>+'/-]|/(?=/)", lambda found: f"U+{ord(found[0]):04X}", text)


def arguments(inputs: Sequence[Port], outputs: Sequence[Port], notes: Notes) -> str:
    """The notes on every argument, a line each."""
    lines = []
    for side, ports in (("in ", inputs), ("out", outputs)):
        for p in ports:
            shape = " x ".join(map(str, p.shape)) or "a number"
            about = comment(notes.arguments.get(p.name, ""))
            lines.append(f"   {side}  {p.name}: {shape}{', ' if about else ''}{about}")
    return "\n".join(lines)


def values(name: str, notes: Notes, precision: Precision) -> str:
    """The notes' values as tables."""
    arrays = []
    for argument, (numbers, labels) in notes.values.items():
        pairs = zip(numbers, labels, strict=True)
        rows = [f"  {c99.number(float(x), precision)}, /* {comment(label)}: {x:.6g} */" for x, label in pairs]
        arrays.append(f"static const {precision.c} {name}_{argument}[{len(rows)}] = {{\n" + "\n".join(rows) + "\n};\n")
    return "\n".join(["", "#include <math.h>", "", *arrays]) if arrays else ""


def _tables(name: str, inputs: Sequence[Port], notes: Notes) -> str:
    """The header's tables against the first case, which was recorded with their numbers."""
    lines, start = list[str](), 0
    for p in inputs:
        if p.name in notes.values:
            table = f"{name}_{p.name}"
            lines.append(f"  if (memcmp(cutpoint_inputs[0] + {start}, {table}, sizeof {table}) != 0) {{\n")
            lines.append(f'    puts("{table}: not the table that was recorded");\n    tables++;\n  }}\n')
        start += p.size
    return "".join(lines)


def _check(
    inputs: Sequence[Port], outputs: Sequence[Port], given: np.ndarray, found: np.ndarray, precision: Precision
) -> dict[str, Any]:
    return {
        "cases": len(given), "input_count": max(1, given.shape[1]), "output_count": found.shape[1],
        "inputs": _table(given, precision), "expected": _table(found, precision),
        "call": ", ".join(_call(inputs, outputs)),
        "output_names": "".join(f'  "{label}",\n' for label in slot_names(outputs)),
    }  # fmt: skip


def _table(rows: np.ndarray, precision: Precision) -> str:
    lines = (", ".join(c99.number(x, precision) for x in row.tolist()) for row in rows)
    return "".join(f"  {{{line or '0'}}},\n" for line in lines)


def _call(inputs: Sequence[Port], outputs: Sequence[Port]) -> list[str]:
    """The check's arguments: offset of each in the rows."""
    call = []
    for memory, ports, by_value in (("cutpoint_in", inputs, True), ("cutpoint_out", outputs, False)):
        start = 0
        for p in ports:
            call.append(f"{memory}[{start}]" if by_value and not p.shape else f"{memory} + {start}")
            start += p.size
    return call


def _cpp(inputs: Sequence[Port], outputs: Sequence[Port], name: str, precision: Precision) -> dict[str, str]:
    """A template parameter for each array; a number is passed by value, and one that is an output by reference."""
    kinds, parameters, arguments = [], [], []
    for p, is_output in [*((p, False) for p in inputs), *((p, True) for p in outputs)]:
        if not p.shape:
            parameters.append(f"{precision.c} {'&' if is_output else ''}{p.name}")
            arguments.append(f"{'&' if is_output else ''}{p.name}")
            continue
        kind = f"cutpoint_{len(kinds)}"
        kinds.append(f"class {kind}")
        parameters.append(f"{kind} &&{p.name}" if is_output else f"const {kind} &{p.name}")
        is_matrix = str(len(p.shape) > 1).lower()
        arguments.append(f"detail_{name}::address<{p.size}, {is_matrix}>({p.name})")
    head = f"template <{', '.join(kinds)}>\n" if kinds else ""
    return {
        "template": head, "cpp_parameters": ", ".join(parameters), "cpp_arguments": ", ".join(arguments)
    }  # fmt: skip
