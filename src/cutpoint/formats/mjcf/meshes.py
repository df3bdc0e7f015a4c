"""Meshes in files beside an MJCF file, for bodies whose inertia comes from them."""

from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from cutpoint.errors import ModelError
from cutpoint.formats.beside import file_within
from cutpoint.formats.reading import read_bytes
from cutpoint.formats.safe_xml import Element

MAXIMUM_BYTES = 256 * 2**20
"""Bytes of all meshes of a robot together."""

ENDINGS = (".stl", ".obj", ".msh")

INERTIAL = "an <inertial>; MuJoCo writes one if MjSpec.compiler.saveinertial is true"

ONE_FILE = (
    "let MuJoCo write all of it into one file (spec = mujoco.MjSpec.from_file(...); spec.compiler.saveinertial = True; "
    "spec.compile(); spec.to_xml())"
)
"""How to state what is spread over files, or stands for more than its own text."""


class MeshFile(NamedTuple):
    """A mesh's points as MuJoCo gets them: under a generated name, which is not a path; file: the user's."""

    alias: str
    file: str
    content: bytes


class MeshElement(NamedTuple):
    """A <mesh> with a file: its name for geoms, and the file's path relative to the document's folder."""

    name: str
    file: str
    element: Element


def name_of(mesh: Element) -> str:
    """The name by which geoms refer to a <mesh>: its file's if it has none of its own."""
    return mesh.attributes.get("name") or PurePosixPath(_file_of(mesh)).stem


def mesh_files(root: Element) -> list[MeshElement]:
    """The meshes of a document that are in files, in the folder that its <compiler> names."""
    folder, stripped = "", "false"
    for compiler in root.all("compiler"):
        stated = compiler.attributes
        folder = stated.get("meshdir", stated.get("assetdir", folder))
        stripped = stated.get("strippath", stripped)
    meshes: list[MeshElement] = []
    for mesh in (mesh for asset in root.all("asset") for mesh in asset.all("mesh")):
        file = PurePosixPath(_file_of(mesh))
        if file.name:
            path = PurePosixPath(folder) / (file.name if stripped == "true" else file)
            meshes.append(MeshElement(name_of(mesh), str(path), mesh))
    return meshes


def read_meshes(meshes: Iterable[MeshElement], path: Path) -> dict[str, MeshFile]:
    """The contents of their files, by name; path: the document's.

    Raises ModelError: a file is missing, outside the document's folder, of another format, or too large.
    """
    contents: dict[str, MeshFile] = {}
    left = MAXIMUM_BYTES
    for name, file, element in meshes:
        try:
            content = _content(path.parent, file, left)
        except ModelError as problem:
            complaint = f"mesh {name!r}, which gives a body its inertia: {problem}"
            raise ModelError(complaint, place=element.where(str(path)), mesh=name, file=file) from problem
        contents[name] = MeshFile(f"{len(contents)}{PurePosixPath(file).suffix.lower()}", file, content)
        left -= len(content)
    return contents


def _file_of(mesh: Element) -> str:
    return mesh.attributes.get("file", "").replace("\\", "/")


def _content(folder: Path, file: str, limit: int) -> bytes:
    if not file.lower().endswith(ENDINGS):
        raise ModelError(f"{file!r} does not end in {', '.join(ENDINGS)}; give its bodies {INERTIAL}")
    return read_bytes(file_within(folder, file, f"give its bodies {INERTIAL}"), limit)
