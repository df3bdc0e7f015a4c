"""Extracts from an MJCF document only what dynamics needs, so that MuJoCo opens no file and sees nothing else.

Meshes in files are kept only if their contents are supplied, under names that are not paths.

Elements are kept by name and parent; unknown ones are left out and counted.  Elements that would change the tree of
bodies by including other text are refused.
"""

import re
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from xml.sax.saxutils import quoteattr

from cutpoint.errors import ModelError
from cutpoint.formats.mjcf.meshes import ONE_FILE, MeshFile, name_of
from cutpoint.formats.reading import parse_number
from cutpoint.formats.safe_xml import Element
from cutpoint.formats.slips import meant

MAXIMUM_PIECES = 40_000
"""Largest number of tags that are kept, opening and closing: compile time grows faster than their number."""

NOT_A_NUMBER = re.compile(r"(?i)(?<!\S)[+-]?nan(?!\w)")
"""MuJoCo would only warn, in a log file of its own."""

INFINITE = re.compile(r"(?i)(?<!\S)[+-]?inf(inity)?(?!\w)")
FINITE = {
    *("pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "axis", "fromto", "size", "ref"),
    *("mass", "diaginertia", "fullinertia", "density", "damping", "armature", "frictionloss", "stiffness"),
}
"""Attributes from which MuJoCo would compute invalid numbers elsewhere."""

IN_BODY = ("body", "frame", "inertial", "joint", "freejoint", "geom", "site")

KEPT: dict[str, tuple[str, ...]] = {
    "mujoco": ("compiler", "option", "default", "asset", "worldbody"),
    "option": ("flag",),
    "default": ("default", "geom", "joint", "mesh", "site"),
    "asset": ("mesh",),
    "worldbody": IN_BODY,
    "body": IN_BODY,
    "frame": IN_BODY,
}
"""Children that are kept, by parent."""

LEFT_OUT = {
    "compiler": {"meshdir", "texturedir", "assetdir", "strippath", "discardvisual", "usethread"},
    "geom": {"material", "hfield"},
    "site": {"material"},
}
"""Attributes on parts that are left out anyway."""

OF_A_MESH = {"name", "class", "vertex", "face", "scale", "refpos", "refquat", "inertia", "maxhullvert"}
"""Others make MuJoCo build shapes itself, of any size."""

WITHOUT_EFFECT = {
    *("visual", "statistic", "size", "custom", "sensor", "keyframe"),
    *("camera", "light", "texture", "material", "hfield", "skin"),
}
"""Elements without effect on the motion of bodies and joints."""

SECTIONS = {"actuator", "contact", "deformable", "equality", "extension", "tendon"}
"""Elements that only hold others, of those that are left out."""

OTHER_TEXT = ("attach", "composite", "flexcomp", "replicate")


@dataclass
class Excerpt:
    """The kept document, each element on its original line, and the number of elements left out, by kind."""

    pieces: list[str] = field(default_factory=list[str])
    left_out: Counter[str] = field(default_factory=Counter[str])
    line: int = 1

    @property
    def text(self) -> str:
        return "".join(self.pieces)

    def open(self, element: Element, attributes: dict[str, str], *, holds: bool) -> None:
        """Writes a tag on its line in the file; for an included file, on the line that names it.

        holds: whether the element has contents; otherwise "/>" closes it, as MuJoCo counts an inside as depth.
        """
        lines = max((element.at or element.line) - self.line, 0)
        self.line += lines
        stated = "".join(f" {name}={quoteattr(value)}" for name, value in attributes.items())
        self.pieces.append("\n" * lines + f"<{element.tag}{stated}{'>' if holds else ''}")


def excerpt_of(root: Element, place: str, meshes: Mapping[str, MeshFile]) -> Excerpt:
    """meshes: those whose files were read, by name.

    Raises ModelError: no MJCF, elements that include other text, too many elements.
    """
    if root.tag != "mujoco":
        other = {
            "robot": " (a URDF file; its ending is .urdf)",
            "sdf": " (an SDF file)",
            "mujocoinclude": " (a part: give the file that includes it)",
        }.get(root.tag, "")
        raise ModelError(
            f"the root element of an MJCF file is <mujoco>, got <{root.tag}>{other}", place=root.where(place)
        )
    for element in root.walk():
        _refuse_other_text(element, place)
    for child in root.children:
        if child.tag in ("body", "joint", "freejoint", "geom"):
            complaint = f"<{child.tag}> outside <worldbody>: this file is a part, give the file that includes it"
            raise ModelError(complaint, place=child.where(place), tag=child.tag)
    if not any(root.all("worldbody")):
        complaint = "there is no <worldbody>: this file is a part, give the file that includes it"
        raise ModelError(complaint, place=root.where(place))
    return _copy(root, place, meshes)


def _refuse_other_text(element: Element, place: str) -> None:
    if element.tag == "include":
        complaint = "<include> is not read from text in memory, which has no folder; give the file's path"
        raise ModelError(complaint, place=element.where(place), tag=element.tag)
    if element.tag in OTHER_TEXT:
        complaint = f"<{element.tag}> is not read, for safety: it stands for text that is not in this file"
        raise ModelError(f"{complaint}; {ONE_FILE}", place=element.where(place), tag=element.tag)


def _copy(root: Element, place: str, meshes: Mapping[str, MeshFile]) -> Excerpt:
    """Copies all that is kept, tag by tag."""
    excerpt, waiting = Excerpt(), list[Element | str]([root])
    armoured = _sections_with_armature(root)
    while waiting:
        item = waiting.pop()
        if isinstance(item, str):  # a closing tag
            excerpt.pieces.append(item)
            continue
        if len(excerpt.pieces) > MAXIMUM_PIECES:
            complaint = f"MJCF holds more than {MAXIMUM_PIECES // 2:,} bodies, joints and geoms, the limit"
            raise ModelError(complaint, place=item.where(place))
        kept: list[Element] = []
        for child in item.children:
            if _is_kept(child, item, meshes):
                kept.append(child)
            else:
                _refuse_misspelled(child, item, place)
                _count(child, item, excerpt.left_out, armoured)
        excerpt.open(item, _kept_attributes(item, meshes, place), holds=bool(kept))
        waiting += [f"</{item.tag}>" if kept else "/>", *reversed(kept)]
    return excerpt


def _kept_attributes(element: Element, meshes: Mapping[str, MeshFile], place: str) -> dict[str, str]:
    """The attributes that are kept.  Raises ModelError for an invalid number."""
    dropped = LEFT_OUT.get(element.tag, set())
    if element.tag == "mesh":
        dropped = element.attributes.keys() - OF_A_MESH
    kept = {name: value for name, value in element.attributes.items() if name not in dropped}
    for name, value in kept.items():
        if NOT_A_NUMBER.search(value):
            raise ModelError(f"<{element.tag}> {name} {value!r} must not contain nan", place=element.where(place))
        if name in FINITE and INFINITE.search(value):
            raise ModelError(f"<{element.tag}> {name} {value!r} must be finite", place=element.where(place))
    if element.tag == "mesh" and (mesh := meshes.get(name_of(element))):
        kept |= {"name": name_of(element), "file": mesh.alias}
    return kept


def _is_kept(child: Element, parent: Element, meshes: Mapping[str, MeshFile]) -> bool:
    """A mesh is kept only if its points are in the document or supplied."""
    shape_is_elsewhere = parent.tag == "asset" and "vertex" not in child.attributes and name_of(child) not in meshes
    return child.tag in KEPT.get(parent.tag, ()) and not shape_is_elsewhere


def _refuse_misspelled(child: Element, parent: Element, place: str) -> None:
    """Raises ModelError for a misspelled name of an element that would be kept."""
    if right := meant(child.tag, KEPT.get(parent.tag, ())):
        complaint = f"<{parent.tag}> holds <{child.tag}>, which is not MJCF; did you mean <{right}>?"
        raise ModelError(complaint, place=child.where(place), tag=child.tag)


def _count(child: Element, parent: Element, left_out: Counter[str], armoured: Collection[str]) -> None:
    """Of a section, its elements; what has no effect, and defaults of what is left out, do not count.

    armoured: sections whose elements may have armature from a default, and count as if they had.
    """
    if child.tag not in WITHOUT_EFFECT and parent.tag not in ("default", "asset"):
        left_out[child.tag] += len(child.children) if child.tag in SECTIONS else max(len(child.children), 1)
        with_armature = [x for x in child.children if child.tag in armoured or _has_armature(x)]
        left_out[f"{child.tag} armature, in the mass matrix"] += len(with_armature)


def _sections_with_armature(root: Element) -> set[str]:
    """Of "tendon" and "actuator", those for whose elements a default states armature."""
    stated = {x.tag for each in root.walk() if each.tag == "default" for x in each.children if _has_armature(x)}
    return {"tendon" if tag == "tendon" else "actuator" for tag in stated - {"joint"}}


def _has_armature(element: Element) -> bool:
    return parse_number(element.attributes.get("armature", "0").strip()) != 0.0
