"""MJCF text to MuJoCo's compiled model, by the `mujoco` package if it is installed; no file is opened.

Compiling resolves defaults, angles and orientations, and finds inertias from geoms.  Geoms whose shape is not given
(height fields, meshes that no inertia needs) are made massless; a body that needs one for its inertia is refused.
"""

import warnings
from collections.abc import Collection
from typing import Any

import numpy as np

from cutpoint.errors import ModelError, listed
from cutpoint.formats.mjcf.meshes import INERTIAL, MeshFile

FREE, BALL, SLIDE, HINGE = range(4)
"""Kinds of joints: MuJoCo's mjtJoint."""


def meshes_of_inertias(text: str, place: str) -> set[str]:
    """Names of the meshes that define inertias of moving bodies and whose points are not in the text.

    Raises as `compiled` does.
    """
    mujoco = package(place)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spec = _parsed(mujoco, text, place)
    return {geom.meshname for _, geom, counts in _without_shape(mujoco, spec) if counts and geom.meshname}


def compiled(text: str, place: str, meshes: Collection[MeshFile]) -> tuple[Any, list[str]]:
    """The mujoco.MjModel of a document, and MuJoCo's remarks on it; meshes: those that it names by their aliases.

    Raises ModelError: the package is missing, or it cannot compile the text.
    """
    mujoco = package(place)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        spec = _parsed(mujoco, text, place)
        spec.assets = {mesh.alias: mesh.content for mesh in meshes}
        _leave_out_shapes(mujoco, spec, place)
        fuses, spec.compiler.fusestatic = spec.compiler.fusestatic, False  # fused bodies would lose their names
        try:
            model = spec.compile()
        except Exception as problem:
            raise _refused(problem, place, meshes) from problem
    if fuses:
        _check_fusing_changes_no_number(mujoco, spec, model, place)
    _switch_off(mujoco, model)
    return model, [_in_a_line(each.message, meshes) for each in said]


def _check_fusing_changes_no_number(mujoco: Any, spec: Any, model: Any, place: str) -> None:
    """Raises ModelError if MuJoCo's numbers depend on whether bodies without joints become part of their carriers.

    `settotalmass` does not count the mass of those that become part of the world, and `align` moves the frame of a free
    body if all that it carries becomes part of it.
    """
    named, carriers = names_of(model, "body"), model.body_weldid
    fused = np.flatnonzero(carriers != np.arange(model.nbody))
    unscaled = [b for b in fused if carriers[b] == 0 and model.body_mass[b] > 0.0 and spec.compiler.settotalmass > 0.0]
    if unscaled:
        _refuse_fusing([named[b] for b in unscaled], "settotalmass would not count their mass", place)
    automatic = (mujoco.mjtAlignFree.mjALIGNFREE_FALSE, mujoco.mjtAlignFree.mjALIGNFREE_TRUE)[spec.compiler.alignfree]
    for joint in spec.joints:
        align = automatic if joint.align == mujoco.mjtAlignFree.mjALIGNFREE_AUTO else joint.align
        if model.jnt_type[joint.id] == FREE and align == mujoco.mjtAlignFree.mjALIGNFREE_TRUE:
            body = model.jnt_bodyid[joint.id]
            carried = [b for b in np.flatnonzero(model.body_rootid == body) if b != body]
            if carried and all(carriers[b] == body for b in carried):
                _refuse_fusing([named[b] for b in carried], f"align would move the frame of {named[body]!r}", place)


def _refuse_fusing(bodies: list[str], then: str, place: str) -> None:
    """Raises ModelError.  then: what MuJoCo would do once these bodies are part of their carriers."""
    remedy = "leave fusestatic out if that is not meant, else settotalmass and align, and state what they would give"
    complaint = f'with fusestatic="true" bodies {listed(bodies)} become part of what carries them, and {then}'
    raise ModelError(f"<compiler> {complaint}: {remedy}", place=place, bodies=bodies)


def names_of(model: Any, kind: str) -> list[str]:
    """Names of the bodies or joints of a compiled model: `joint_3` if the file gives none."""
    stated = [getattr(model, kind)(k).name for k in range(model.nbody if kind == "body" else model.njnt)]
    taken = set(stated)
    return [name or free(f"{kind}_{k}", taken) for k, name in enumerate(stated)]


def free(name: str, taken: set[str]) -> str:
    """The name, with underscores appended until it is unused; it then counts as used."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def package(place: str) -> Any:
    """The mujoco package."""
    try:
        import mujoco
    except ImportError as problem:
        complaint = 'an MJCF file needs the mujoco package, 3.3.1 or later: pip install "cutpoint[mjcf]"'
        raise ModelError(complaint, place=place) from problem
    return mujoco


def _parsed(mujoco: Any, text: str, place: str) -> Any:
    """The mujoco.MjSpec of a document."""
    try:
        return mujoco.MjSpec.from_string(text)
    except Exception as problem:  # the class that it raises depends on its version
        raise _refused(problem, place) from problem


def _without_shape(mujoco: Any, spec: Any) -> list[tuple[Any, Any, bool]]:
    """Geoms without shape data: the body of each, the geom, and whether a moving body's inertia depends on it."""
    present = {mesh.name for mesh in spec.meshes}
    shapeless = (mujoco.mjtGeom.mjGEOM_HFIELD, mujoco.mjtGeom.mjGEOM_SDF)

    found: list[tuple[Any, Any, bool]] = []
    waiting: list[tuple[Any, bool]] = [(spec.worldbody, False)]
    while waiting:
        body, moves = waiting.pop()
        moves = moves or bool(len(body.joints))
        for geom in body.geoms:
            if (geom.meshname and geom.meshname not in present) or geom.type in shapeless:
                found.append((body, geom, moves and _gives_inertia(mujoco, spec, body, geom)))
        # with `settotalmass` the mass of each scales all others
        waiting += [(child, moves or spec.compiler.settotalmass > 0.0) for child in reversed([*body.bodies])]
    return found


def _leave_out_shapes(mujoco: Any, spec: Any, place: str) -> None:
    """Replaces geoms without shape data by massless spheres."""
    for body, geom, gives_inertia in _without_shape(mujoco, spec):
        if gives_inertia:
            told = f"body {body.name!r}" if body.name else "a body without a name"
            complaint = "its inertia would come from a shape that is not in this file"
            line = f":{body.info.removeprefix('line ')}" if body.info else ""
            raise ModelError(f"{told}: {complaint}; give it {INERTIAL}", place=f"{place}{line}", body=body.name)
        geom.type, geom.meshname, geom.hfieldname = mujoco.mjtGeom.mjGEOM_SPHERE, "", ""
        geom.size, geom.mass = [1.0, 0.0, 0.0], 0.0


def _switch_off(mujoco: Any, model: Any) -> None:
    """Removes losses, springs and contacts that the file's <flag> disables."""
    damping, springs = ("dof_damping", "dof_dampingpoly"), ("jnt_stiffness", "jnt_stiffnesspoly")
    contacts = ("geom_contype", "geom_conaffinity")
    arrays = {
        "DAMPER": damping, "SPRING": springs, "FRICTIONLOSS": ("dof_frictionloss",), "CONTACT": contacts,
        "PASSIVE": (*damping, *springs), "CONSTRAINT": ("dof_frictionloss", *contacts),
    }  # fmt: skip
    for flag, names in arrays.items():  # not all versions of MuJoCo have all flags and arrays
        if model.opt.disableflags & getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}", 0):
            for name in names:
                getattr(model, name, np.zeros(0))[:] = 0


def _gives_inertia(mujoco: Any, spec: Any, body: Any, geom: Any) -> bool:
    """Whether MuJoCo's compiler would use a geom's mass, by `inertiafromgeom` and `inertiagrouprange`."""
    always = spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    never = spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    first, last = spec.compiler.inertiagrouprange
    weightless = geom.mass == 0.0 or (geom.mass != geom.mass and geom.density == 0.0)  # nan: not stated
    inferred = always or not (never or body.explicitinertial)
    return inferred and not weightless and first <= geom.group <= last


def _refused(problem: Exception, place: str, meshes: Collection[MeshFile] = ()) -> ModelError:
    return ModelError(f"MuJoCo cannot compile this file: {_in_a_line(problem, meshes)}", place=place)


def _in_a_line(said: Any, meshes: Collection[MeshFile]) -> str:
    """MuJoCo's message on one line, with the user's file names."""
    words = " ".join(str(said).split())
    for mesh in meshes:
        words = words.replace(f"'{mesh.alias}'", f"'{mesh.file}'")
    return words
