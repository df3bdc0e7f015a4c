"""MuJoCo's side: from C, no more of its stages than a task needs; with two hinges a joint where joints bend."""

import ctypes
from functools import cache
from pathlib import Path

import compilers
import mujoco
import numpy as np
import pinocchio as pin
from cases import Case, Entry
from pinocchio_cpp import axis

FUNCTIONS = {
    "inverse dynamics": "inverse_dynamics", "forward dynamics": "forward_dynamics", "mass matrix": "mass_matrix",
    "Jacobian": "jacobian",
}  # fmt: skip
"""Of mujoco_c.c; there is no exact one for the other tasks."""


@cache
def built() -> ctypes.CDLL:
    package = Path(mujoco.__file__).parent
    (shared,) = package.glob("libmujoco.so*")
    text = Path(__file__).with_name("mujoco_c.c").read_text()
    flags, linked = [f"-I{package / 'include'}"], [str(shared), f"-Wl,-rpath,{package}"]
    return compilers.library(text, flags=flags, linked=linked)


def model_of(model: pin.Model, flange: str | None = None, elastic: tuple[float, float] | None = None) -> mujoco.MjModel:
    """The same robot.  flange: a frame that becomes a site.  elastic: stiffness, and reflected inertia of rotors."""
    spec = mujoco.MjSpec()
    spec.option.gravity = model.gravity.linear
    spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT
    spec.compiler.autolimits = spec.compiler.balanceinertia = False
    bodies = [spec.worldbody]
    for i in range(1, model.njoints):
        inertia = model.inertias[i]
        body = bodies[model.parents[i]].add_body(**_place(model.jointPlacements[i]), explicitinertial=True)
        body.mass, body.ipos = inertia.mass, inertia.lever
        I = inertia.inertia
        body.fullinertia = [I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]]
        for stated in _hinges(elastic):
            body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis(model.joints[i]), **stated)
        bodies.append(body)
    if flange:
        bodies[-1].add_site(name=flange, **_place(model.frames[model.getFrameId(flange)].placement))
    return spec.compile()


def _hinges(elastic: tuple[float, float] | None) -> list[dict]:
    """A joint's, from the motor to the link."""
    if elastic is None:
        return [{}]
    stiffness, inertia = elastic
    return [{"armature": inertia}, {"stiffness": [stiffness, 0.0, 0.0]}]


def _place(placement: pin.SE3) -> dict:
    q = pin.Quaternion(placement.rotation)
    return {"pos": placement.translation, "quat": [q.w, q.x, q.y, q.z]}


class Robot:
    """A model with its data, for C."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model, self.data = model, mujoco.MjData(model)

    def run(self, function: str, *arguments: object) -> None:
        """Of mujoco_c.c; arrays by their addresses, whole numbers as long, floats as double."""
        given = [_as_c(x) for x in (self.model._address, self.data._address)]
        getattr(built(), function)(*given, *map(_as_c, arguments))


def _as_c(x: object) -> object:
    if isinstance(x, np.ndarray):
        return ctypes.c_void_p(x.ctypes.data)
    return ctypes.c_double(x) if isinstance(x, float) else ctypes.c_void_p(x)


def entries(case: Case, task: str, inputs: list[np.ndarray]) -> dict[str, Entry]:
    function = FUNCTIONS.get(task)
    if function is None or not compilers.version("gcc"):
        return {}
    robot, count = Robot(model_of(case.model, case.flange)), len(inputs[0])
    out = np.empty((count, *case.shape(task)))
    robot.run(function, count, *inputs, out)
    return {"MuJoCo": Entry(lambda: robot.run(function, count, *inputs, None), out)}
