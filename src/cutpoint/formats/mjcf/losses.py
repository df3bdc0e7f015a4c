"""Parts of an MJCF file that a `Mechanism` cannot represent."""

from collections import Counter
from typing import Any

import numpy as np

from cutpoint.errors import listed
from cutpoint.formats.mjcf.model import BALL, FREE, names_of


def losses(model: Any, left_out: Counter[str]) -> list[str]:
    """Parts of a compiled model (mujoco.MjModel) that are lost, after the elements that were left out before."""
    found = ["<{}>{}{} ({})".format(*what.partition(" "), count) for what, count in sorted(left_out.items()) if count]
    colliding = int(np.count_nonzero((model.geom_contype != 0) | (model.geom_conaffinity != 0)))
    if colliding:
        found.append(f"contacts ({colliding} geoms)")
    if model.opt.density or model.opt.viscosity:
        found.append("fluid forces")
    named = names_of(model, "body")
    bodies = [named[b] for b in np.flatnonzero(model.body_gravcomp)]
    if bodies:
        found.append(f"gravcomp of bodies {listed(bodies)}")
    return found + _of_joints(model)


def _of_joints(model: Any) -> list[str]:
    """Springs, nonlinear laws, reversed ranges, and numbers of joints that no drive can move or limit."""
    undriven = np.isin(model.jnt_type, (FREE, BALL))
    by_dof = undriven[model.dof_jntid]
    lost = {
        "springs": (model.jnt_stiffness != 0.0) | _any(model, "jnt_stiffnesspoly"),
        "nonlinear damping": _joints_of(model, _any(model, "dof_dampingpoly")),
        "damping": _joints_of(model, by_dof & (model.dof_damping != 0.0)),
        "frictionloss": _joints_of(model, by_dof & (model.dof_frictionloss != 0.0)),
        "armature, in the mass matrix,": _joints_of(model, by_dof & (model.dof_armature != 0.0)),
        "range": undriven & (model.jnt_limited != 0),
        "reversed range, which MuJoCo takes for none,": _reversed_ranges(model),
        "asymmetric actuatorfrcrange (the smaller side counts, 0 as none)": _uneven_efforts(model),
    }
    names = names_of(model, "joint")
    named = {what: [names[j] for j in np.flatnonzero(which)] for what, which in lost.items()}
    return [f"{what} of joints {listed(joints)}" for what, joints in named.items() if joints]


def _reversed_ranges(model: Any) -> Any:
    """Joints without limits whose range runs downward: to MuJoCo it does not say that there are any."""
    return (model.jnt_limited == 0) & (model.jnt_range[:, 0] > model.jnt_range[:, 1])


def _uneven_efforts(model: Any) -> Any:
    """Joints whose actuators may exert more in one direction than in the other."""
    return (model.jnt_actfrclimited != 0) & (model.jnt_actfrcrange[:, 0] != -model.jnt_actfrcrange[:, 1])


def _any(model: Any, what: str) -> Any:
    """Rows with a nonzero entry, of an array that only later versions of MuJoCo have."""
    rows = getattr(model, what, None)
    return np.False_ if rows is None else np.any(rows != 0.0, axis=tuple(range(1, rows.ndim)))


def _joints_of(model: Any, dofs: Any) -> Any:
    """Joints with any of these degrees of freedom."""
    joints = np.zeros(model.njnt, bool)
    np.logical_or.at(joints, model.dof_jntid, np.broadcast_to(dofs, model.nv))
    return joints
