"""Large robots whose joints bend run as loops too: the same results as straight-line code."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from cutpoint import Robot
from cutpoint.errors import InputError
from cutpoint.kernels.programs.compiled import program_ir
from cutpoint.kernels.programs.plan import plan
from cutpoint.mechanics.drives.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.drives.friction import Coulomb, Stribeck
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.elastic_forward import ElasticAccelerations
from cutpoint.mechanics.elastic_inverse import ElasticTorques
from cutpoint.model import Drive, Mechanism
from cutpoint.model.drive import Harmonic, Rotor
from cutpoint.rolled import RECIPES, RolledFunction, rolled
from cutpoint.rolled.bodies import columns_of
from cutpoint.rolled.passes import one_by_one, side_by_side
from large_robots import assert_close, chain
from random_trees import random_tree

INVERSE, FORWARD = "elastic_inverse_dynamics", "elastic_forward_dynamics"
BACKENDS = ("llvm", "numpy")
EPS = np.finfo(float).eps
TREES = {"one body": random_tree(3, 1), "tree of 11": random_tree(4, 11), "tree of 20": random_tree(5, 20)}


def linear(rng: np.random.Generator) -> Drive:
    return Drive(rng.uniform(50.0, 160.0), Rotor(rng.uniform(1e-4, 2e-4)), LinearSpring(rng.uniform(1e4, 3e4)))


def full_of_laws(rng: np.random.Generator) -> Drive:
    """Everything but memory: its numbers differ from joint to joint, its laws do not."""
    rubs = {"link_friction": Coulomb(rng.uniform(0.5, 1.0), 0.3, 0.02)}
    rubs |= {"motor_friction": Stribeck(1.0, rng.uniform(1.5, 2.0), 0.4, 0.1, 0.01, per_load=0.05)}
    spring = Flexspline(rng.uniform(8e3, 9e3), rng.uniform(1e-3, 2e-3))
    error = KinematicError((Harmonic(2, rng.uniform(1e-5, 1e-4), rng.uniform(0.0, 6.0)),))
    return replace(linear(rng), compliance=spring, damping=rng.uniform(1.0, 5.0), kinematic_error=error, **rubs)


KINDS = {"springs": linear, "all laws": full_of_laws}


@cache
def robot(tree: str, kind: str, backend: str = "numpy") -> Robot:
    """With NumPy it never loops."""
    rng = np.random.default_rng(0)
    return Robot(TREES[tree], drives_of(TREES[tree], kind, rng), backend=backend)


def drives_of(mechanism: Mechanism, kind: str, rng: np.random.Generator) -> dict[str, Drive]:
    return {body.joint.name: KINDS[kind](rng) for body in mechanism.bodies}


def given_to(name: str, robot: Robot, *shape: int) -> np.ndarray:
    """Rates of a motion, or a state near rest of the springs with torques."""
    given = np.random.default_rng(1).uniform(-1.0, 1.0, (5, *shape, robot.nv))
    if name == FORWARD:
        given[2] = given[0] + 1e-3 * given[2]
    return given


def looping(robot: Robot, name: str, backend: str = "llvm", record: type[Any] | None = None) -> RolledFunction:
    """A function as loops, whatever the robot's size."""
    return RolledFunction(name, robot.machine, backend, record)


@pytest.mark.parametrize("name", [INVERSE, FORWARD])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tree", TREES)
def test_elastic_loops_give_what_straight_line_code_gives(tree: str, kind: str, name: str) -> None:
    ours = robot(tree, kind)
    given = given_to(name, ours, 11)  # a whole pack of lanes and some that are left
    given[1:, 1] *= 0.0 if name == INVERSE else 1.0  # at rest
    expected = getattr(ours, name)(*given)
    for backend in BACKENDS:
        found = looping(ours, name, backend, type(expected))(*given)
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())
        single = looping(ours, name, backend, type(expected))(*given[:, 10])
        np.testing.assert_array_equal(single, [x[10] for x in found])


def test_accelerations_of_a_large_elastic_robot_are_those_of_its_motor_torques() -> None:
    ours = Robot(mechanism := random_tree(6, 150), drives_of(mechanism, "springs", np.random.default_rng(2)))
    motion = 0.1 * given_to(INVERSE, ours)
    u = looping(ours, INVERSE, record=ElasticTorques)(*motion)
    function = looping(ours, FORWARD, record=ElasticAccelerations)
    found = function(*motion[:2], u.theta, u.theta_dot, u.motor_torque)
    again = looping(ours, INVERSE, record=ElasticTorques)(*motion[:2], found.a, *motion[3:])
    # a deflection is a small difference of angles: its rounding, times the stiffness, is a torque on link and rotor
    rounding = EPS * (3e4 * np.abs(u.theta).max() + 150 * np.abs(u.joint_torque).max())
    np.testing.assert_allclose(again.joint_torque, u.joint_torque, rtol=0, atol=100 * rounding)
    lightest = min(drive.reflected_inertia for drive in ours.drives.values())
    np.testing.assert_allclose(found.theta_ddot, u.theta_ddot, rtol=0, atol=100 * rounding / lightest)


def test_loops_are_for_large_robots_and_what_they_were_asked_for() -> None:
    mechanism = random_tree(7, 150)
    machine = Robot(mechanism, drives_of(mechanism, "springs", np.random.default_rng(0))).machine
    plain = (INVERSE, False, False, True)
    assert rolled(plain, machine, "llvm") and rolled(FORWARD, machine, "llvm")
    assert rolled(plain, machine, "numpy") is None
    for variant in ((INVERSE, False, False, False), (FORWARD, "strains")):
        assert rolled(variant, machine, "llvm") is None
    assert rolled(plain, robot("tree of 20", "springs").machine, "llvm") is None


RIGID = Drive(80.0, Rotor(1e-4))
BUILDS: dict[str, Callable[[int, Drive], Drive | None]] = {
    "rigid ones": lambda k, drive: RIGID if k % 3 else drive,
    "rigid ones with full coupling": lambda k, drive: (
        replace(RIGID, rotor=Rotor(1e-4, coupling="full")) if k % 2 else drive
    ),
    "two laws": lambda k, drive: replace(drive, compliance=Flexspline(8e3, 1e-3)) if k % 2 else drive,
    "joints without one": lambda k, drive: drive if k % 3 else None,
    "all of it": lambda k, drive: (None, RIGID, drive, replace(drive, compliance=Flexspline(8e3, 1e-3)))[k % 4],
}


def mixed(mechanism: Mechanism, case: str) -> dict[str, Drive]:
    """Drives of several structures."""
    drives = enumerate(drives_of(mechanism, "springs", np.random.default_rng(0)).items())
    built = {name: BUILDS[case](k, drive) for k, (name, drive) in drives}
    return {name: drive for name, drive in built.items() if drive}


@pytest.mark.parametrize(("case", "backend"), [("all of it", "llvm"), *((case, "numpy") for case in BUILDS)])
def test_loops_take_drives_of_several_structures(case: str, backend: str) -> None:
    mechanism = random_tree(4, 11)
    ours = Robot(mechanism, mixed(mechanism, case), backend="numpy")
    q = ours.random(1, (9,))
    assert_close(looping(ours, "static_deflection", backend)(q), ours.static_deflection(q))
    for name in (INVERSE, FORWARD):
        rng, sizes = (
            np.random.default_rng(1),
            [ours.nv] * 5 if name == INVERSE else [ours.nv] * 2 + [len(ours.drives)] * 3,
        )
        given = [rng.uniform(-1.0, 1.0, (9, n)) * (1.0 if k < 2 else 1e-3) for k, n in enumerate(sizes)]
        expected = getattr(ours, name)(*given)
        function = looping(ours, name, backend, type(expected))
        for found, other, single in zip(function(*given), expected, function(*(x[8] for x in given)), strict=True):
            np.testing.assert_allclose(found, other, rtol=0, atol=1e-12 * np.abs(other).max())
            np.testing.assert_array_equal(single, found[8])


@pytest.mark.parametrize("name", [INVERSE, FORWARD, "static_deflection"])
def test_code_for_mixed_drives_is_as_long_for_sixteen_bodies_as_for_a_thousand(name: str) -> None:
    texts = []
    for size in (16, 1024):
        machine = Robot(mechanism := chain(size), mixed(mechanism, "all of it")).machine
        columns = columns_of(machine.system, machine.drives)
        built = [arrange(RECIPES[name].steps(columns), columns, 8) for arrange in (one_by_one, side_by_side)]
        texts.append([program_ir(plan(x.body, x.regions)) for x in built])
    assert texts[0] == texts[1]


def coupled(mechanism: Mechanism, every: int = 2) -> Robot:
    """Heavy rotors with full coupling, one of so many behind a spring."""
    full = Drive(80.0, Rotor(1e-4, coupling="full"), LinearSpring(2e4))
    drives = {
        body.joint.name: full if k % every == 0 else replace(full, compliance=None)
        for k, body in enumerate(mechanism.bodies)
        if body.joint.kind != "floating"
    }
    return Robot(mechanism, drives, backend="numpy")


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("floating", [False, True])
def test_loops_feel_rotors_behind_springs(floating: bool, backend: str) -> None:
    mechanism = random_tree(4, 11, floating=floating)
    plain, full = coupled(mechanism), coupled(mechanism, every=1)
    for ours in (plain, full):
        n = len(ours.drives)
        rng = np.random.default_rng(1)
        q, (v, a, jerk, snap) = ours.random(2, (9,)), rng.uniform(-1.0, 1.0, (4, 9, ours.nv))
        theta, theta_dot, torque = q[:, -n:] + 1e-3 * rng.normal(size=(9, n)), *rng.normal(size=(2, 9, n))
        asked = {FORWARD: (q, v, theta, theta_dot, torque), (INVERSE, False, True, True): (q, v, a, jerk, snap)}
        for key, given in asked.items():
            options = {} if key == FORWARD else {"quasi_rigid": True}
            expected = getattr(ours, key if key == FORWARD else INVERSE)(*given, **options)
            function = RolledFunction(key, ours.machine, backend, type(expected))
            for found, other, single in zip(function(*given), expected, function(*(x[8] for x in given)), strict=True):
                np.testing.assert_allclose(found, other, rtol=0, atol=1e-12 * np.abs(other).max())
                np.testing.assert_array_equal(single, found[8])


def test_loops_let_friction_s_rates_through_springs() -> None:
    ours = robot("tree of 11", "all laws")
    given = given_to(INVERSE, ours, 11)
    expected = ours.elastic_inverse_dynamics(*given, friction_rates=True)
    found = RolledFunction((INVERSE, True, False, True), ours.machine, "llvm", ElasticTorques)(*given)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())


def test_a_robot_that_nothing_takes_is_told_why() -> None:
    machine = coupled(random_tree(9, 1001)).machine
    with pytest.raises(
        InputError, match=r"1001 bodies .* loops do not support rotors with full coupling behind springs"
    ):
        rolled((INVERSE, False, False, True), machine, "llvm")
    with pytest.raises(InputError, match=r"loops do not support strains"):
        rolled((INVERSE, True, False, False), machine, "llvm")
    errors = [KinematicError((Harmonic(order, 1e-5, 0.0),)) for order in range(1, 7)]
    kinds = {f"joint{k}": replace(linear(np.random.default_rng(k)), kinematic_error=x) for k, x in enumerate(errors)}
    machine = Robot(random_tree(9, 1001), kinds).machine
    with pytest.raises(InputError, match=r"loops do not support drives of 7 structures, more than 6"):
        rolled(FORWARD, machine, "llvm")


def test_wrong_input_of_elastic_loops_is_explained() -> None:
    function, given = looping(robot("tree of 11", "springs"), INVERSE), np.ones((5, 11))
    given[3, 4] = np.nan
    with pytest.raises(InputError, match=r"elastic_inverse_dynamics: jerk\[4\] is nan: every number must be finite"):
        function(*given)
    with pytest.raises(InputError, match=r"elastic_inverse_dynamics: snap has shape \(10,\): its last axis must be 11"):
        function(*np.ones((4, 11)), np.ones(10))


def test_a_large_robot_without_drives_has_nothing_to_tell_of_motors() -> None:
    robot = Robot(chain(60, ("helical",)))
    q, v, a, jerk, snap = np.random.default_rng(0).uniform(-1.0, 1.0, (5, robot.nv))
    found = robot.elastic_inverse_dynamics(q, v, a, jerk, snap)
    assert found.motor_torque.shape == (0,)
    assert_close(found.joint_torque, robot.inverse_dynamics(q, v, a), 1e-10)
    assert_close(robot.elastic_forward_dynamics(q, v, [], [], []).a, robot.forward_dynamics(q, v, np.zeros(60)), 1e-8)
