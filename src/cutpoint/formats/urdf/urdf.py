"""URDF and xacro files to a `Mechanism`.

Read: links' inertials; joints' origins, axes, limits, dynamics and mimics.  Everything else (visuals, collisions,
transmissions, extensions) is ignored, with a warning what would change the dynamics: rotor inertias, closed loops and
forces that Drake or Gazebo would read, and friction by its name in early URDF; meshes are never opened.
"""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from types import NoneType
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.callers import warn
from cutpoint.door import check_choice, check_kind, check_truths, path_of
from cutpoint.errors import InputError, ModelError, listed
from cutpoint.formats.degrees import warn_of_degrees
from cutpoint.formats.not_carried_over import NotCarriedOver
from cutpoint.formats.reading import parse_number, read_bytes
from cutpoint.formats.safe_xml import MAXIMUM_BYTES, Element, parse_xml
from cutpoint.formats.slips import meant
from cutpoint.formats.urdf.elements import Reader, name_of
from cutpoint.formats.urdf.losses import losses
from cutpoint.formats.urdf.xacro_expansion import expand
from cutpoint.model.build import build
from cutpoint.model.mechanism import STANDARD_GRAVITY, Joint, JointKind, Limits, Link, Mechanism, Mimic
from cutpoint.model.places import Places

KINDS: tuple[JointKind, ...] = ("fixed", "revolute", "continuous", "prismatic", "planar", "floating")
PARTS = {
    "robot": ("link", "joint"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": ("parent", "child", "origin", "axis", "limit", "dynamics", "mimic"),
}
"""Elements that are read, by parent."""

ATTRIBUTES = {
    "origin": ("xyz", "rpy", "quat_xyzw"),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "velocity", "effort"),
    "dynamics": ("damping", "friction"),
    "mimic": ("joint", "multiplier", "offset"),
}
"""Those of which some may be missing."""

OF_XACRO = ("include", "macro", "property")
"""Elements that xacro once took without its prefix, and now passes over, with all that they would bring."""

X_AXIS = (1.0, 0.0, 0.0)
"""Default axis of a joint."""


class MimicWarning(UserWarning):
    """A file has mimic joints, which were read as independent coordinates."""


def load_urdf(
    path: str | Path,
    *,
    gravity: ArrayLike = STANDARD_GRAVITY,
    floating_base: bool = False,
    lock: Mapping[str, float] | None = None,
    mimic: Literal["independent", "coupled"] = "independent",
    mend_inertia: bool = False,
    xacro: Mapping[str, str] | None = None,
) -> Mechanism:
    """The robot of a URDF file, or of a .xacro file if the `xacro` package is installed.

    gravity: acceleration of free fall in the world's frame, (3,), m/s2.
    floating_base: whether a floating joint, "root_joint", carries the root link; otherwise it is fixed to the world.
    lock: coordinates (rad or m) at which joints are held fixed, by name.
    mimic: whether mimic joints are coordinates of their own (then a `MimicWarning` names them) or follow their leader.
    mend_inertia: increase physically impossible inertias until they are possible, with a warning.
    xacro: arguments of a .xacro file, by name.
    Warns, DegreesWarning, of limits and locks that look like degrees; NotCarriedOver, of rotor inertias, of closed
    loops and forces beside the tree, and of friction in <joint_properties>, which are left out.
    Raises ModelError, with file and line, for whatever is wrong in the file, for gravity, and for what cannot be
    locked; InputError for other arguments.
    """
    path = path_of("load_urdf", path)
    content = read_bytes(path, MAXIMUM_BYTES)
    place = str(path)
    if path.suffix.lower() == ".xacro":
        _check_prefixes(parse_xml(content, place), place)
        content, place = expand(path, xacro or {}), f"{path}, expanded"
    elif xacro:
        raise InputError(f"arguments {listed(xacro)} are for .xacro files, got {place!r}: leave them out", path=path)
    return parse_urdf(
        content, place, gravity=gravity, floating_base=floating_base, lock=lock, mimic=mimic, mend_inertia=mend_inertia
    )


def parse_urdf(
    content: str | bytes,
    place: str = "<string>",
    *,
    gravity: ArrayLike = STANDARD_GRAVITY,
    floating_base: bool = False,
    lock: Mapping[str, float] | None = None,
    mimic: Literal["independent", "coupled"] = "independent",
    mend_inertia: bool = False,
) -> Mechanism:
    """The robot of a URDF document in memory.

    content: its text, or a file's bytes; xacro must have been expanded.  place: its name in messages; a document that
    does not name its robot names it after this.  Options, warnings and errors are those of `load_urdf`; content that is
    neither text nor bytes raises InputError.
    """
    check_choice("parse_urdf", "mimic", mimic, ("independent", "coupled"))
    check_kind("parse_urdf", "content", content, (str, bytes), "the text of a URDF (load_urdf reads files)")
    check_kind("parse_urdf", "lock", lock, (Mapping, NoneType), "a coordinate for each joint that is held, by name")
    check_truths("parse_urdf", floating_base=floating_base, mend_inertia=mend_inertia)
    robot = parse_xml(content, place)
    _check_is_urdf(robot, place)
    _check_names(robot, place)
    _check_quaternions(robot, place)
    joints = [_joint(element, place) for element in robot.all("joint")]
    mechanism = build(
        robot.attributes.get("name") or Path(place).stem,
        [_link(element, place) for element in robot.all("link")],
        joints,
        gravity=gravity,
        floating_base=floating_base,
        lock=lock,
        coupled=mimic == "coupled",
        mend_inertia=mend_inertia,
        place=Places(place, {_label(element): element.line for element in robot.children}),
    )
    moving = {body.joint.name for body in mechanism.bodies}
    names = {joint.name for joint in joints if joint.kind != "fixed"}
    _warn([joint for joint in joints if joint.name in moving], names, mechanism.coupled, place)
    if lost := losses(robot, moving):
        warn(NotCarriedOver(lost, place))
    return mechanism


def _check_is_urdf(robot: Element, place: str) -> None:
    at = f"{place}:{robot.line}"
    if robot.tag != "robot":
        other = {"mujoco": " (an MJCF file)", "sdf": " (an SDF file)"}.get(robot.tag, "")
        raise ModelError(f"the root element of a URDF is <robot>, got <{robot.tag}>{other}", place=at)
    _check_prefixes(robot, place)
    for child in robot.children:
        if "xacro" in child.tag:
            own = f"<xacro:{child.tag.rpartition('}')[2]}> is an element of xacro"
            remedy = "give the file the ending .xacro, or remove the element if the file is already expanded"
            raise ModelError(f"{own}; {remedy}", place=f"{place}:{child.line}", tag=child.tag)
        dialect, _, tag = child.tag.removeprefix("{").rpartition("}")
        if dialect and tag in ("link", "joint"):
            told = f"<{tag}> of the dialect {dialect!r} is not read, and the tree lacks it: state it in plain URDF"
            raise ModelError(told, place=f"{place}:{child.line}", tag=child.tag)


def _check_prefixes(robot: Element, place: str) -> None:
    """Raises ModelError for elements of xacro without its prefix: the robot would lack what they bring."""
    for child in robot.children:
        if child.tag in OF_XACRO:
            remedy = f"write <xacro:{child.tag}>, in a file with the ending .xacro, or remove it"
            told = f"<{child.tag}> lacks the prefix of xacro, which therefore passes it over; {remedy}"
            raise ModelError(told, place=f"{place}:{child.line}", tag=child.tag)


def _check_names(element: Element, place: str) -> None:
    """Raises ModelError for a misspelled name, since ignoring it would change the robot."""
    parts = PARTS.get(element.tag, ())
    for child in element.children:
        if right := meant(child.tag, parts):
            complaint = f"<{element.tag}> holds <{child.tag}>, which is not URDF; did you mean <{right}>?"
            raise ModelError(complaint, place=f"{place}:{child.line}", tag=child.tag)
        if child.tag in parts:
            _check_names(child, place)
    for name in element.attributes:
        if right := meant(name, ATTRIBUTES.get(element.tag, ())):
            complaint = f"<{element.tag}> has the attribute {name!r}, which is not URDF; did you mean {right!r}?"
            raise ModelError(complaint, place=f"{place}:{element.line}", attribute=name)


def _check_quaternions(robot: Element, place: str) -> None:
    """Raises ModelError for quaternions in a file of a version without them: other readers ignore them."""
    version = robot.attributes.get("version", "1.0").strip()
    if (parse_number(version) or 0.0) >= 1.2:
        return
    for part in (*robot.all("joint"), *(x for link in robot.all("link") for x in link.all("inertial"))):
        for origin in part.all("origin"):
            if "quat_xyzw" in origin.attributes:
                rule = 'is for files of version 1.2: state version="1.2" in <robot>, or rpy here'
                raise ModelError(f"<origin> quat_xyzw {rule}", place=f"{place}:{origin.line}", version=version)


def _label(element: Element) -> str:
    """The name of a link or a joint in messages."""
    return f"{element.tag} {name_of(element)!r}"


def _link(element: Element, file: str) -> Link:
    reader = Reader(element, _label(element), file)
    name = reader.text("name")
    inertial = reader.child("inertial")
    if inertial is None:
        return Link(name)
    tensor = inertial.needed("inertia")
    xx, xy, xz, yy, yz, zz = (tensor.number(entry) for entry in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    along_principal = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    placement = inertial.origin()
    rotation = placement[:3, :3]
    return Link(
        name, inertial.needed("mass").number("value"), placement[:3, 3], rotation @ along_principal @ rotation.T
    )


def _joint(element: Element, file: str) -> Joint:
    reader = Reader(element, _label(element), file)
    name, kind = reader.text("name"), _kind(reader)
    axis, dynamics, mimic = reader.child("axis"), reader.child("dynamics"), reader.child("mimic")
    return Joint(
        name,
        kind,
        parent=reader.needed("parent").text("link"),
        child=reader.needed("child").text("link"),
        placement=reader.origin(),
        axis=axis.vector("xyz", X_AXIS) if axis else np.array(X_AXIS),
        limits=_limits(reader, kind),
        damping=dynamics.number("damping", 0.0) if dynamics else 0.0,
        friction=dynamics.number("friction", 0.0) if dynamics else 0.0,
        mimic=Mimic(mimic.text("joint"), mimic.number("multiplier", 1.0), mimic.number("offset", 0.0))
        if mimic
        else None,
    )


def _kind(reader: Reader) -> JointKind:
    kind = reader.text("type")
    for known in KINDS:
        if kind == known:
            return known
    raise reader.error(f"type {kind!r} is not supported; supported types: {listed(KINDS)}")


def _limits(reader: Reader, kind: JointKind) -> Limits:
    """As in URDF: some kinds have no position limits, and of two bounds an unstated one is zero."""
    limit = reader.child("limit")
    if limit is None:
        return Limits()
    velocity, effort = limit.bound("velocity", np.inf), limit.bound("effort", np.inf)
    if kind in ("continuous", "planar", "floating") or not {"lower", "upper"} & limit.element.attributes.keys():
        return Limits(velocity=velocity, effort=effort)
    return Limits(limit.bound("lower", 0.0), limit.bound("upper", 0.0), velocity, effort)


def _warn(joints: Sequence[Joint], names: Collection[str], coupled: bool, place: str) -> None:
    """Warns of probable mistakes, once for the file.  joints: those that move; names: of all that can."""
    mimics = [joint.name for joint in joints if joint.mimic]
    if mimics and not coupled:
        option = "mimic='coupled' (--mimic coupled) ties them"
        text = f"mimic joints {listed(mimics)} are read as independent coordinates; {option}"
        lost = [joint.name for joint in joints if joint.mimic and joint.mimic.joint not in names]
        more = f", but the file has no movable leader for {listed(lost)}" if lost else ""
        warn(f"{text}{more} ({place})", MimicWarning)
    turning = {joint.name: joint.limits for joint in joints if joint.kind == "revolute"}
    warn_of_degrees(turning, "URDF angles are radians", place)
