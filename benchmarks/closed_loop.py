"""Elastic joints under control, without friction: simulated seconds per second, each with the steps that it needs.

All integrate the same plant by steps of fourth order and four stages: motors' PD at 1 kHz, held between samples.
"""

import ctypes
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import casadi as ca
import casadi_peer
import codegen
import compilers
import mujoco
import mujoco_peer
import numpy as np
from cases import ROBOTS, Case, case
from elastic import INERTIA, STIFFNESS, elastic

import cutpoint
from cutpoint.errors import SimulationError
from cutpoint.simulation.plant import State
from cutpoint.studies.cost.timing import Timing, in_turns
from cutpoint.trajectories import Trajectory

DURATION, PERIOD, KP, KD = 10.0, 1e-3, 4000.0, 200.0
"""s, s, N m/rad, N m s/rad."""

PERIODS = round(DURATION / PERIOD)

ACCURACY = 1e-4
"""rad: largest error of any link at any sample."""

SUBSTEPS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40, 64)
EXACT, AGREEMENT = 400, 1e-9
"""Steps per period that count as exact, and the largest difference of the contenders with these, rad."""

Simulation = Callable[[int], np.ndarray]
"""With so many steps a period, the links' q at each sample but the last, (periods, n)."""


@dataclass(frozen=True, eq=False)
class Sines(Trajectory):
    """0.5 rad of a sine in each joint, the faster the farther out; found at the samples, before anything is timed."""

    values: np.ndarray

    @classmethod
    def of(cls, joints: int) -> "Sines":
        w = 2 * np.pi * (0.3 + 0.1 * np.arange(joints))
        angle = (np.arange(PERIODS + 1) * PERIOD)[:, None] * w
        sine, cosine = 0.5 * np.sin(angle), 0.5 * np.cos(angle)
        return cls(DURATION, np.stack([w**k * (sine, cosine, -sine, -cosine)[k % 4] for k in range(5)]))

    @property
    def size(self) -> int:
        return self.values.shape[-1]

    def _inside(self, t: np.ndarray, order: int) -> np.ndarray:
        assert np.array_equal(t, np.arange(PERIODS + 1) * PERIOD), "these sines are known at the samples alone"
        return self.values[: order + 1]


def closed_loop() -> list[dict]:
    found = []
    for name in ROBOTS:
        print(f"{name}: closed loop", file=sys.stderr)
        found.append(measured(case(name)))
    return found


def measured(given: Case) -> dict:
    simulations = {"cutpoint": _ours(given), **_peers(given)}
    exact = {name: run(EXACT) for name, run in simulations.items()}
    apart = {name: float(np.abs(q - exact["cutpoint"]).max()) for name, q in exact.items()}
    if not max(apart.values()) < AGREEMENT:
        sys.exit(f"{given.name}, closed loop: {apart} rad apart, more than {AGREEMENT}; not timed")
    steps = {name: _needed(run, exact["cutpoint"]) for name, run in simulations.items()}
    times = in_turns({name: partial(run, steps[name]) for name, run in simulations.items()})
    more = in_turns({name: partial(run, 3 * steps[name]) for name, run in simulations.items()})
    a_step = {name: (more[name].least - x.least) / (2 * steps[name] * PERIODS) for name, x in times.items()}
    return {"robot": given.name, "apart": apart, "substeps": steps, "a step": a_step, "speed": _speeds(times)}


def _speeds(times: Mapping[str, Timing]) -> dict[str, dict[str, float]]:
    """Simulated seconds a second, from nanoseconds a run."""
    return {name: {"median": DURATION / (1e-9 * x.median), "best": DURATION / (1e-9 * x.least)}
            for name, x in times.items()}  # fmt: skip


def _needed(run: Simulation, exact: np.ndarray) -> int:
    """The fewest steps a period that are accurate enough."""
    for n in SUBSTEPS:
        with np.errstate(all="ignore"):
            off = np.abs(run(n) - exact).max()
        if off < ACCURACY:  # false for what has diverged, too
            return n
    return SUBSTEPS[-1]


def _ours(given: Case) -> Simulation:
    robot, n = elastic(given), given.robot.nv
    controller, trajectory = cutpoint.control.PD(np.full(n, KP), np.full(n, KD)), Sines.of(n)
    simulate = partial(cutpoint.simulate, robot, controller, trajectory, control_period=PERIOD,
                       initial=State(*np.zeros((4, n))), channels=("q",))  # fmt: skip

    def run(substeps: int) -> np.ndarray:
        try:
            log = simulate(substeps=substeps)
        except SimulationError:  # diverged: the steps are too long
            return np.full((PERIODS, n), np.nan)
        return log["q"][:-1]

    return run


def _peers(given: Case) -> dict[str, Simulation]:
    if not compilers.version("gcc"):
        return {}
    targets = np.concatenate([*Sines.of(given.robot.nv).values[:2, :PERIODS]], axis=1)
    models = {"CasADi": casadi_peer.filed(given.robot), "CasADi, lean": casadi_peer.lean(given.robot)}
    found: dict[str, Simulation] = {name: _casadi(given, model, targets) for name, model in models.items()}
    return {**found, "MuJoCo": _mujoco(given, targets)}


def _casadi(given: Case, model: casadi_peer.Model, targets: np.ndarray) -> Simulation:
    function, n = casadi_peer.function(given, model, "forward dynamics"), given.robot.nv
    text = codegen.source(function) + _sizes(function, n) + Path(__file__).with_name("closed_loop.c").read_text()
    loop = compilers.library(text, linked=("-lm",)).closed_loop
    numbers = [*map(ctypes.c_double, (PERIOD, STIFFNESS, INERTIA, KP, KD))]

    def run(substeps: int) -> np.ndarray:
        state, record = np.zeros(4 * n), np.empty((len(targets), n))
        arrays = [ctypes.c_void_p(x.ctypes.data) for x in (state, targets, record)]
        loop(ctypes.c_long(len(targets)), ctypes.c_long(substeps), *numbers, *arrays)
        return record

    return run


def _sizes(f: ca.Function, n: int) -> str:
    sizes = {"N": n, "SZ_ARG": f.sz_arg(), "SZ_RES": f.sz_res(), "SZ_IW": f.sz_iw() + 1, "SZ_W": f.sz_w() + 1}
    return "".join(f"\n#define {name} {size}" for name, size in sizes.items())


def _mujoco(given: Case, targets: np.ndarray) -> Simulation:
    model = mujoco_peer.model_of(given.model, elastic=(STIFFNESS, INERTIA))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4

    def run(substeps: int) -> np.ndarray:
        model.opt.timestep = PERIOD / substeps
        record = np.empty((len(targets), given.robot.nv))
        mujoco_peer.Robot(model).run("closed_loop", len(targets), substeps, KP, KD, targets, record)
        return record

    return run
