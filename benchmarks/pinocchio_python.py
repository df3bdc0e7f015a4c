"""Pinocchio through its Python bindings: what all others must agree with, and the peer of calls from Python."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin
from cases import Case
from pinocchio_cpp import in_our_order

ROWS = 256
"""Of a batch, that are compared."""


def function(case: Case, task: str) -> Callable[..., np.ndarray | tuple[np.ndarray, ...]]:
    """One row of inputs to one row of results, which are Pinocchio's own memory."""
    model, data = case.model, case.data
    if task == "Jacobian":
        frame = model.getFrameId(case.flange)
        return lambda q: pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
    if task == "forward derivatives":
        return lambda *state: _forward_derivatives(model, data, *state)
    algorithm = {
        "inverse dynamics": pin.rnea, "forward dynamics": pin.aba, "mass matrix": pin.crba,
        "derivatives": pin.computeRNEADerivatives, "regressor": pin.computeJointTorqueRegressor,
    }[task]  # fmt: skip
    return lambda *state: algorithm(model, data, *state)


def _forward_derivatives(model: pin.Model, data: pin.Data, *state: np.ndarray) -> tuple[np.ndarray, ...]:
    pin.computeABADerivatives(model, data, *state)
    return data.ddq_dq, data.ddq_dv, data.Minv


def results(case: Case, task: str, inputs: list[np.ndarray]) -> np.ndarray:
    """Of the first ROWS."""
    call, found = function(case, task), []
    for state in zip(*(x[:ROWS] for x in inputs), strict=True):
        got = call(*state)
        found.append(np.stack(got) if isinstance(got, tuple) else got.copy())
    return in_our_order(np.array(found)) if task == "regressor" else _mirrored(np.array(found), task)


def _mirrored(found: np.ndarray, task: str) -> np.ndarray:
    """With the lower triangle of the mass matrix or its inverse, which Pinocchio leaves empty."""
    if "derivatives" in task:
        upper = np.triu(found[:, 2])
        found[:, 2] = upper + np.triu(upper, 1).swapaxes(1, 2)
    return found
