"""A graph as files of CUDA C."""

from importlib.resources import files
from pathlib import Path
from string import Template

from cutpoint.kernels.graphs.graph import Graph
from cutpoint.kernels.graphs.precision import FLOAT32
from cutpoint.kernels.targets import cuda
from cutpoint.kernels.targets.c99_texts import Notes, arguments, comment, values
from cutpoint.kernels.targets.cuda_results import THREADS
from cutpoint.kernels.targets.package_files import check_gives_numbers, write_files
from cutpoint.version import __version__

_NO_NOTES = Notes()

_FLUSHING = """\
   Build without -ftz=true and --use_fast_math: they make numbers below 1.2e-38 zero.  CuPy's RawModule does so always.
"""


def write_package(
    graph: Graph, name: str, folder: str | Path, notes: Notes = _NO_NOTES, *, force: bool = False
) -> tuple[Path, ...]:
    """Writes the CUDA kernel of a graph and its header; returns the files' paths.

    force: overwrite files that cutpoint has not written.
    Raises InputError for names that CUDA C cannot take, for files in the way, and for a function without a number.
    """
    check_gives_numbers(name, graph.outputs)
    return write_files(folder, _texts(graph, name, notes), force)


def _texts(graph: Graph, name: str, notes: Notes) -> dict[str, str]:
    code = cuda.code(name, graph)
    inputs, outputs = cuda.full(graph)
    fields = {
        "version": __version__, "about": comment(notes.about), "name": name,
        "declaration": cuda.declaration(name, graph), "code": code, "precision": graph.precision.dtype.name,
        "threads": THREADS, "last": THREADS - 1, "flushing": _FLUSHING if graph.precision is FLOAT32 else "",
        "arguments": arguments(inputs, outputs, notes), "values": _host_values(values(name, notes, graph.precision)),
    }  # fmt: skip
    templates = files("cutpoint.kernels.targets") / "cuda_templates"
    return {
        f"{name}.{kind}": Template((templates / f"kernel.{kind}").read_text("utf-8")).substitute(fields)
        for kind in ("cu", "cuh")
    }


def _host_values(tables: str) -> str:
    """Tables in host memory: NVRTC has none, and no <math.h> either."""
    return f"\n#ifndef __CUDACC_RTC__{tables}#endif\n" if tables else ""
