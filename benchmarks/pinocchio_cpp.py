"""Pinocchio's C++ headers, as its wheel brings them, compiled for this processor; Eigen's come with CasADi's wheel."""

import ctypes
import subprocess
import sys
from functools import cache
from importlib.metadata import files, version
from pathlib import Path

import compilers
import numpy as np
import pinocchio as pin
from cases import TASKS, Case, Entry

COMPILERS = {"gcc": ("g++", ("-fno-gnu-unique",)), "clang": ("clang++", ())}
"""By name: the command for C++, and flags; without unique symbols two builds can live in one process."""

STANDARD = ("-std=c++17", "-DNDEBUG")

DEFINED = (
    "PINOCCHIO_ENABLE_COMPATIBILITY_WITH_VERSION_3=0", "BOOST_MPL_LIMIT_LIST_SIZE=30",
    "BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "BOOST_FUSION_INVOKE_MAX_ARITY=12", "FUSION_MAX_VECTOR_SIZE=20",
)  # fmt: skip

FUNCTIONS = {
    "inverse dynamics": ("inverse_dynamics",), "forward dynamics": ("forward_dynamics", "forward_dynamics_local"),
    "mass matrix": ("mass_matrix", "mass_matrix_local"), "Jacobian": ("jacobian",), "derivatives": ("derivatives",),
    "forward derivatives": ("forward_derivatives",), "regressor": ("regressor",),
}  # fmt: skip
"""Of pinocchio_cpp.cpp; some tasks by either of two conventions."""

_AXES = {"RX": (1, 0, 0), "RY": (0, 1, 0), "RZ": (0, 0, 1)}


@cache
def built(name: str) -> ctypes.CDLL | None:
    """The library by this compiler; None where it is not installed, or not up to it: it needs 5 GB of memory."""
    command, own = COMPILERS[name]
    if not compilers.version(command):
        return None
    folders = [_folder("libpinocchio", "cmeel.prefix/include/"), _folder("casadi", "casadi/include/eigen3/")]
    flags = [*STANDARD, "-w", "-Wl,-Bsymbolic", *own, *(f"-D{x}" for x in DEFINED), *(f"-I{x}" for x in folders)]
    text = Path(__file__).with_name("pinocchio_cpp.cpp").read_text()
    note = f"Pinocchio {version('pin')}"
    try:
        found = compilers.library(text, compiler=command, suffix=".cpp", flags=flags, note=note)
    except subprocess.CalledProcessError as error:
        print(f"{command} gave up, which leaves its build out: {error}", file=sys.stderr)
        return None
    found.robot.restype = ctypes.c_void_p
    return found


def _folder(package: str, place: str) -> str:
    """A folder that a package is installed into."""
    file = next(x for x in files(package) or () if place in str(x))
    return str(file.locate()).partition(place)[0] + place


class Robot:
    """A model in a library of C++."""

    def __init__(self, built: ctypes.CDLL, model: pin.Model, flange: str | None = None) -> None:
        self._built, self._numbers, self.nv = built, numbers(model, flange), model.nv
        gravity = np.array(model.gravity.linear)
        self._robot = ctypes.c_void_p(built.robot(model.nv, _address(self._numbers), _address(gravity)))

    def __del__(self) -> None:
        self._built.forget(self._robot)

    def run(self, function: str, inputs: list[np.ndarray], out: np.ndarray | None, *more: object) -> None:
        """The function on rows; without out, results stay where Pinocchio has them."""
        arrays = [*map(_address, inputs), ctypes.c_void_p(None) if out is None else _address(out)]
        getattr(self._built, function)(self._robot, ctypes.c_long(len(inputs[0])), *arrays, *more)


def entries(case: Case, task: str, inputs: list[np.ndarray]) -> dict[str, Entry]:
    """A contender for each compiler and convention."""
    found = {}
    for name in COMPILERS:
        library = built(name)
        for function in FUNCTIONS[task] if library else ():
            robot, out = Robot(library, case.model, case.flange), np.empty((len(inputs[0]), *case.shape(task)))
            robot.run(function, inputs, out)
            results = in_our_order(out) if task == "regressor" else out
            found[f"{name}, {function}"] = Entry(lambda r=robot, f=function: r.run(f, inputs, None), results)
    return found


def wheel(case: Case, task: str, inputs: list[np.ndarray]) -> dict[str, Entry]:
    """The wheel's own library, many rows a call; it offers that for two tasks."""
    batch = {"inverse dynamics": pin.rneaInParallel, "forward dynamics": pin.abaInParallel}.get(task)
    if batch is None:
        return {}
    pool, columns = pin.ModelPool(case.model, 1), [np.asfortranarray(x.T) for x in inputs]
    out = np.asfortranarray(np.zeros_like(columns[0]))

    def call() -> None:
        batch(1, pool, *columns, out)

    call()
    return {"wheel": Entry(call, out.T.copy())}


def in_our_order(Y: np.ndarray) -> np.ndarray:
    """Regressors with the columns of Ixz and Iyy exchanged: Pinocchio has xx xy yy xz yz zz."""
    order = np.arange(Y.shape[-1]).reshape(-1, 10)[:, [0, 1, 2, 3, 4, 5, 7, 6, 8, 9]]
    return Y[..., order.ravel()]


def numbers(model: pin.Model, flange: str | None = None) -> np.ndarray:
    """What pinocchio_cpp.cpp makes a robot of: 29 numbers a joint, 12 for the flange."""
    rows = []
    for i in range(1, model.njoints):
        body, along = model.inertias[i], axis(model.joints[i])
        rows += [model.parents[i] - 1, *_pose(model.jointPlacements[i]), *along]
        rows += [body.mass, *body.lever, *body.inertia.ravel()]
    place = model.frames[model.getFrameId(flange)].placement if flange else pin.SE3.Identity()
    return np.array([*rows, *_pose(place)], dtype=np.float64)


def axis(joint: pin.JointModel) -> tuple[float, ...]:
    """Of a revolute joint, in its own frame."""
    known = _AXES.get(joint.shortname()[-2:])
    return known or tuple(joint.extract().axis)


def _pose(placement: pin.SE3) -> list[float]:
    return [*placement.rotation.ravel(), *placement.translation]


def _address(x: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(x.ctypes.data)


assert FUNCTIONS.keys() == TASKS.keys()
