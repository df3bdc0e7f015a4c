"""CasADi's side: its SX functions as C, compiled by gcc, each called in a plain loop.

Twice: on the robot as its file has it, and with the frames and base parameters that cutpoint finds, which CasADi cannot
find by itself.
"""

from collections.abc import Callable

import casadi as ca
import codegen
import numpy as np
import symbolic
import symbolic_models
import symbolic_tasks
from cases import TASKS, Case, Entry
from symbolic_models import SX, Chain

import cutpoint

Model = Callable[[SX], Chain]
"""A robot at an arbitrary q."""

NOT_LEAN = ("Jacobian", "regressor")
"""Tasks on single bodies or frames, for which others' frames and parameters cannot be used."""


def filed(robot: cutpoint.Robot) -> Model:
    return lambda q: symbolic_models.as_filed(robot.mechanism, q)


def lean(robot: cutpoint.Robot) -> Model:
    system = robot.machine_with(robot.drive_parameters, lean=True).system
    return lambda q: symbolic_models.as_framed(system, q)


def entries(case: Case, task: str, inputs: list[np.ndarray]) -> dict[str, Entry]:
    models = {"CasADi": filed(case.robot), "CasADi, lean": lean(case.robot)}
    if task in NOT_LEAN:
        del models["CasADi, lean"]
    return {name: entry(function(case, model, task), case.shape(task), inputs) for name, model in models.items()}


def entry(function: ca.Function, shape: tuple[int, ...], inputs: list[np.ndarray]) -> Entry:
    call, out = codegen.compiled(function), np.empty((len(inputs[0]), *shape))
    return Entry(lambda: call(*inputs, out=out), call(*inputs, out=out).copy())


def function(given: Case, model: Model, task: str) -> ca.Function:
    """A row's results of a row's inputs."""
    symbols = [SX.sym(name, given.robot.nv) for name in TASKS[task]]
    q, *rates = symbols
    match task:
        case "inverse dynamics":
            found = [symbolic.inverse_dynamics(model(q), *rates)]
        case "forward dynamics":
            found = [symbolic.forward_dynamics(model(q), *rates)]
        case "mass matrix":
            found = [symbolic.mass_matrix(model(q))]
        case "Jacobian":
            found = [symbolic_tasks.jacobian(model(q), flange_of(given))]
        case "derivatives":
            found = symbolic_tasks.derivatives(symbolic.inverse_dynamics(model(q), *rates), q, *rates)
        case "forward derivatives":
            found = symbolic_tasks.derivatives(symbolic.forward_dynamics(model(q), *rates), q, *rates)
        case _:
            p = SX.sym("p", 10 * given.robot.nv)
            found = [symbolic_tasks.regressor(symbolic_models.with_parameters(model(q), p), *rates, p)]
    return codegen.function(symbols, *found)


def flange_of(given: Case) -> np.ndarray:
    """(4, 4) in the last body's frame."""
    return given.robot.mechanism.frames[given.flange].placement
