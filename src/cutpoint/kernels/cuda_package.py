"""A graph as files of CUDA C."""

from importlib.resources import files
from pathlib import Path
from string import Template

from cutpoint.errors import InputError
from cutpoint.files import replacing
from cutpoint.kernels import c99, cuda
from cutpoint.kernels.c99_texts import GENERATED, Notes, Values, comment
from cutpoint.kernels.graph import Graph
from cutpoint.kernels.ports import Port
from cutpoint.kernels.precision import Precision

_NO_NOTES = Notes()


def write_package(
    graph: Graph, name: str, folder: str | Path, notes: Notes = _NO_NOTES, *, force: bool = False
) -> tuple[Path, ...]:
    """Writes the CUDA kernel of a graph and its header; returns the files' paths.

    force: overwrite files that cutpoint has not written.
    Raises InputError for names that CUDA C cannot take, and for files in the way.
    """
    folder = Path(folder)
    contents = {folder / file: text for file, text in _texts(graph, name, notes).items()}
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"folder {str(folder)!r} cannot be made: {error.strerror}", path=folder) from None
    for path in contents:
        if path.exists() and not (force or _is_ours(path)):
            raise InputError(
                f"{str(path)!r} was not written by cutpoint; choose another folder, or force it", path=path
            )
    for path, text in contents.items():
        with replacing(path) as file:
            file.write(text.encode())
    return tuple(contents)


def _texts(graph: Graph, name: str, notes: Notes) -> dict[str, str]:
    from cutpoint import __version__

    code = cuda.code(name, graph)
    inputs, outputs = cuda.full(graph)
    fields = {
        "version": __version__, "about": comment(notes.about), "name": name, "guard": name.upper(),
        "declaration": cuda.declaration(name, graph), "code": code, "precision": graph.precision.dtype.name,
        "arguments": "\n".join([*(_told("in ", p, notes) for p in inputs), *(_told("out", p, notes) for p in outputs)]),
        "values": "".join(_values(f"{name}_{key}", values, graph.precision) for key, values in notes.values.items()),
    }  # fmt: skip
    templates = files("cutpoint.kernels") / "cuda_templates"
    return {
        f"{name}.{kind}": Template((templates / f"kernel.{kind}").read_text("utf-8")).substitute(fields)
        for kind in ("cu", "cuh")
    }


def _told(side: str, port: Port, notes: Notes) -> str:
    shape = " x ".join(map(str, port.shape)) or "a number"
    told = comment(notes.arguments.get(port.name, ""))
    return f"   {side}  {port.name}: {shape}{', ' if told else ''}{told}"


def _values(name: str, values: Values, precision: Precision) -> str:
    pairs = zip(values.numbers, values.labels, strict=True)
    rows = "".join(f"  {c99.number(float(x), precision)}, /* {comment(label)} */\n" for x, label in pairs)
    return f"\n#include <math.h>\n\nstatic const {precision.c} {name}[{len(values.numbers)}] = {{\n{rows}}};\n"


def _is_ours(path: Path) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return GENERATED.encode() in file.read(80)
