"""MJCF files to a `Mechanism`, compiled by the `mujoco` package.

Read: bodies with their inertias, joints with axes, positions, ranges, damping and friction, armature, gravity; sites,
which are frames here.
Coordinates are MuJoCo's but for quaternions, which are (x, y, z, w) here, and a free joint's linear velocity, which is
along the moving body's axes here.  Other effects in MuJoCo are listed in a warning.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from cutpoint.arrays import Array
from cutpoint.callers import warn
from cutpoint.door import check_kind, path_of
from cutpoint.errors import ModelError, listed
from cutpoint.formats.degrees import warn_of_degrees
from cutpoint.formats.mjcf.includes import include_files
from cutpoint.formats.mjcf.losses import losses
from cutpoint.formats.mjcf.meshes import MeshFile, mesh_files, read_meshes
from cutpoint.formats.mjcf.model import (
    BALL,
    FREE,
    HINGE,
    SLIDE,
    compiled,
    free,
    meshes_of_inertias,
    names_of,
    package,
)
from cutpoint.formats.mjcf.text import excerpt_of
from cutpoint.formats.not_carried_over import NotCarriedOver
from cutpoint.formats.plain_drive import drive_of
from cutpoint.formats.reading import read_bytes
from cutpoint.formats.safe_xml import Element, parse_xml
from cutpoint.model.build import build
from cutpoint.model.drive import Drive, Rotor
from cutpoint.model.mechanism import Joint, JointKind, Limits, Link, Mechanism
from cutpoint.model.places import Places
from cutpoint.model.pose import pose, rotation_about

MAXIMUM_BYTES = 16 * 2**20


class RenamedWarning(UserWarning):
    """Sites of a file have names that its bodies or joints have; their frames are named otherwise."""


class MjcfRobot(NamedTuple):
    """A mechanism, and drives for its hinges and slides: armature as a rotor at ratio 1, damping and friction."""

    mechanism: Mechanism
    drives: dict[str, Drive]


def load_mjcf(
    path: str | Path, *, gravity: ArrayLike | None = None, lock: Mapping[str, float] | None = None
) -> MjcfRobot:
    """The robot of an MJCF file, and of those that it includes from its own folder and below.

    It opens only meshes, from the same place, that define a body's inertia.

    gravity: acceleration of free fall in the world's frame, m/s2; None is the file's.
    lock: coordinates (rad or m) at which joints are held fixed, by name.
    Warns once, NotCarriedOver, of what has no counterpart here.  Several joints of a body become a chain of links
    without mass, named `<body>_after_<joint>`; bodies and joints without a name are `body_<n>` and `joint_<n>`.
    If the file uses such a name itself, underscores are appended.  A site with the name of a body or joint is the frame
    `<site>_site`, and a RenamedWarning says so.

    Raises:
        ModelError: the `mujoco` package is missing, what is wrong in the file or in gravity, or what cannot be locked.
    """
    path = path_of("load_mjcf", path)
    root = parse_xml(read_bytes(path, MAXIMUM_BYTES), str(path))
    include_files(root, path, MAXIMUM_BYTES)
    return _robot(root, str(path), gravity, lock, _meshes(root, path))


def parse_mjcf(
    content: str | bytes,
    place: str = "<string>",
    *,
    gravity: ArrayLike | None = None,
    lock: Mapping[str, float] | None = None,
) -> MjcfRobot:
    """The robot of an MJCF document in memory.

    content: its text, or a file's bytes.  No other file is opened: <include> is an error, and so is a body whose
    inertia would come from a mesh file.  place: its name in messages; a document that does not name its robot names it
    after this.  Options, warnings and errors are those of `load_mjcf`; content that is neither text nor bytes raises
    InputError.
    """
    check_kind("parse_mjcf", "content", content, (str, bytes), "the text of an MJCF file (load_mjcf reads files)")
    return _robot(parse_xml(content, place), place, gravity, lock, {})


def _meshes(root: Element, path: Path) -> dict[str, MeshFile]:
    """Meshes for inertias, from the file's own folder; most robots need none."""
    files = mesh_files(root)
    wanted = meshes_of_inertias(excerpt_of(root, str(path), {}).text, str(path)) if files else set[str]()
    return read_meshes([file for file in files if file.name in wanted], path)


def _robot(
    root: Element,
    place: str,
    gravity: ArrayLike | None,
    lock: Mapping[str, float] | None,
    meshes: Mapping[str, MeshFile],
) -> MjcfRobot:
    excerpt = excerpt_of(root, place, meshes)
    model, remarks = compiled(excerpt.text, place, meshes.values())
    tree = _tree(model)
    fall = _gravity(model, place) if gravity is None else gravity
    name = root.attributes.get("model") or Path(place).stem
    whole = build(name, tree.links, tree.joints, gravity=fall, lock=lock, place=Places(place))
    mechanism = replace(whole, frames={name: frame for name, frame in whole.frames.items() if name not in tree.unnamed})
    drives, lost = _drives(mechanism, tree.armature, place), losses(model, excerpt.left_out)
    turning = {joint.name: joint.limits for joint in tree.joints if joint.kind == "revolute"}
    warn_of_degrees(turning, "the file's compiler takes angles as radians", place)
    if lost:
        warn(NotCarriedOver(lost, place))
    if tree.renamed:
        warn(f"{_of_sites(tree.renamed)} ({place})", RenamedWarning)
    for words in remarks:
        warn(f"MuJoCo says about {place}: {words}")
    return MjcfRobot(mechanism, drives)


def _of_sites(renamed: Mapping[str, str]) -> str:
    """A sentence on the frames of sites, by the sites' names, which others have."""
    if len(renamed) == 1:
        return f"site {listed(renamed)} is the frame {listed(renamed.values())}, since a body or joint has that name"
    return f"sites {listed(renamed)} are the frames {listed(renamed.values())}, since bodies or joints have those names"


def _tree(model: Any) -> "_Tree":
    tree = _Tree(model)
    for body in range(1, model.nbody):
        tree.add_body(body)
    for site in range(model.nsite):
        tree.add_site(site)
    return tree


def _gravity(model: Any, place: str) -> Array:
    disabled = model.opt.disableflags & package(place).mjtDisableBit.mjDSBL_GRAVITY
    return np.zeros(3) if disabled else np.array(model.opt.gravity)


def _drives(mechanism: Mechanism, armature: Mapping[str, float], place: str) -> dict[str, Drive]:
    """Drives of all joints with armature, which MuJoCo states at the joint, so the ratio is 1."""
    for name, inertia in armature.items():
        if inertia < 0.0:
            complaint = f"joint {name!r}: armature {inertia:g} kg m2 must not be negative"
            raise ModelError(complaint, place=place, joint=name)
    joints = {body.joint.name: body.joint for body in mechanism.bodies}
    return {
        name: replace(drive_of(joints[name]), rotor=Rotor(inertia))
        for name, inertia in armature.items()
        if name in joints and inertia > 0.0
    }


@dataclass
class _Tree:
    """Links and joints as read from a compiled model; armature of hinges and slides by joint.

    Generated names avoid those of its bodies, joints and sites.
    unnamed: fixed joints that the file does not have.  renamed: frames of sites that share a name, by that name.
    """

    model: Any
    links: list[Link] = field(default_factory=lambda: [Link("world")])
    joints: list[Joint] = field(default_factory=list[Joint])
    armature: dict[str, float] = field(default_factory=dict[str, float])
    unnamed: set[str] = field(default_factory=set[str])
    renamed: dict[str, str] = field(default_factory=dict[str, str])

    def __post_init__(self) -> None:
        self.body_names, self.joint_names = (names_of(self.model, kind) for kind in ("body", "joint"))
        self.owners = {*self.joint_names, *self.body_names}
        self.taken = {*self.owners, *(self.model.site(s).name for s in range(self.model.nsite))}

    def add_body(self, b: int) -> None:
        """Adds a body, and the chain of joints to it from its parent."""
        model, name = self.model, self.body_names[b]
        carrier = self.body_names[model.body_parentid[b]]
        at = _placement(name, model.body_pos[b], model.body_quat[b])
        first, count = model.body_jntadr[b], model.body_jntnum[b]
        for j in range(first, first + count):
            anchor = model.jnt_pos[j] if model.jnt_type[j] in (HINGE, BALL) else np.zeros(3)
            is_body = j == first + count - 1 and not anchor.any()
            child = name if is_body else free(f"{name}_after_{self.joint_names[j]}", self.taken)
            self.joints.append(self.joint(j, carrier, child, at @ pose(np.eye(3), anchor)))
            if not is_body:
                self.links.append(Link(child))
            carrier, at = child, pose(np.eye(3), -anchor)
        if carrier != name:
            self.fix(name, carrier, at)
        axes = _placement(name, model.body_ipos[b], model.body_iquat[b])[:3, :3]
        inertia = axes @ np.diag(model.body_inertia[b]) @ axes.T
        self.links.append(Link(name, float(model.body_mass[b]), np.array(model.body_ipos[b]), inertia))

    def add_site(self, s: int) -> None:
        """Adds a frame for a site, if it has a name; a name that a body or joint has is followed by `_site`."""
        name = stated = self.model.site(s).name
        if not stated:
            return
        if stated in self.owners:
            name = self.renamed[stated] = free(f"{stated}_site", self.taken)
        at = _placement(name, self.model.site_pos[s], self.model.site_quat[s])
        self.fix(name, self.body_names[self.model.site_bodyid[s]], at)
        self.links.append(Link(name))

    def fix(self, name: str, carrier: str, at: Array) -> None:
        """A link rests on its carrier."""
        joint = free(f"{name}_fixed", self.taken)
        self.joints.append(Joint(joint, "fixed", carrier, name, at))
        self.unnamed.add(joint)

    def joint(self, j: int, parent: str, child: str, at: Array) -> Joint:
        """MuJoCo turns about an axis through `jnt_pos` by qpos less its reference; a free joint is placed by qpos."""
        model, name = self.model, self.joint_names[j]
        kind, axis, dof = model.jnt_type[j], np.array(model.jnt_axis[j]), model.jnt_dofadr[j]
        damping, friction = float(model.dof_damping[dof]), float(model.dof_frictionloss[dof])
        if kind == FREE:
            return Joint(name, "floating", parent, child, damping=damping, friction=friction)
        if kind == BALL:
            return Joint(name, "spherical", parent, child, at, damping=damping, friction=friction)
        self.armature[name] = float(model.dof_armature[dof])
        back = -float(model.qpos0[model.jnt_qposadr[j]])
        reference = pose(np.eye(3), back * axis) if kind == SLIDE else pose(rotation_about(axis, back), np.zeros(3))
        limited = bool(model.jnt_limited[j])
        own: JointKind = "prismatic" if kind == SLIDE else "revolute" if limited else "continuous"
        return Joint(name, own, parent, child, at @ reference, axis, _limits(model, j), damping, friction)


def _limits(model: Any, j: int) -> Limits:
    """Position limits, and the smaller of the efforts that actuators may exert in either direction."""
    lower, upper = map(float, model.jnt_range[j]) if model.jnt_limited[j] else (-np.inf, np.inf)
    effort = float(np.min(np.abs(model.jnt_actfrcrange[j]))) if model.jnt_actfrclimited[j] else np.inf
    return Limits(lower, upper, effort=effort)


def _placement(body: str, position: Array, quaternion: Array) -> Array:
    """(4, 4) of a position and a quaternion (w, x, y, z), which MuJoCo leaves zero where its length overflowed."""
    if not quaternion.any():
        raise ModelError(f"body {body!r}: its quat gives MuJoCo no direction; use one of length 1", body=body)
    w, x, y, z = quaternion
    return pose(Rotation.from_quat([x, y, z, w]).as_matrix(), np.array(position))
