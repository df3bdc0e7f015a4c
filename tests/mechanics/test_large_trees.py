"""Large robots run as loops over their bodies: the same results, and no cost that grows with the square of size."""

import os
import subprocess
import sys
import threading
import time
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio
import pytest

import cutpoint
from cutpoint import Robot, derivatives
from cutpoint.errors import InputError
from cutpoint.functions.compiled import machine_of
from cutpoint.kernels.programs.compiled import program_ir
from cutpoint.kernels.programs.plan import plan
from cutpoint.model import Drive, Joint, Link, Mechanism
from cutpoint.model.build import build
from cutpoint.model.drive import Rotor
from cutpoint.rolled import RECIPES, RolledFunction
from cutpoint.rolled import rolled as suited_to
from cutpoint.rolled.bodies import columns_of
from cutpoint.rolled.passes import one_by_one, side_by_side
from large_robots import assert_close, chain, longest
from random_trees import random_tree
from robot_library import load

DYNAMICS = ("inverse_dynamics", "forward_dynamics")
RIGID = ("inverse_dynamics", "bias_forces", "gravity_forces", "forward_dynamics", "mass_matrix")
BACKENDS = ("llvm", "numpy")
EPS = np.finfo(float).eps


def states(robot: Robot, *shape: int, seed: int = 0) -> np.ndarray:
    """q, v and a (or tau)."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (3, *shape, robot.nv))


@cache
def rolled(robot: Robot, name: str, backend: str) -> RolledFunction:
    """A function as loops, whatever the robot's size."""
    return RolledFunction(name, robot.machine, backend)


def in_steps_of_1_m(size: int) -> Mechanism:
    """A planar chain whose joints are placed alike, so that code needs no number to know where they are."""
    step = np.eye(4)
    step[0, 3] = 1.0
    links = [Link("world"), *(Link(f"link{k}", 1.0 + k, (0.5, 0.0, 0.0), np.eye(3)) for k in range(size))]
    ends = [link.name for link in links]
    joints = [Joint(f"joint{k}", "continuous", ends[k], ends[k + 1], step) for k in range(size)]
    return build("steps", links, joints)


TREES = {
    "one body": chain(1),
    "tree of 20": random_tree(1, 20),
    "chain of 20": chain(20),
    "steps of 1 m": in_steps_of_1_m(6),
    "slides alone": chain(6, ("prismatic",)),
    "screws and turns": chain(20, ("helical", "revolute", "prismatic")),
}


@pytest.mark.parametrize("tree", TREES)
@pytest.mark.parametrize("backend", BACKENDS)
def test_loops_give_what_straight_line_code_gives(tree: str, backend: str) -> None:
    robot = Robot(TREES[tree], backend="numpy")  # it never loops
    for name in DYNAMICS:
        given = states(robot, 19)  # whole packs of lanes and some that are left
        given[:, 1] = 0.0  # at rest
        assert_close(rolled(robot, name, backend)(*given), getattr(robot, name)(*given))
        for k in (0, 18):
            single = rolled(robot, name, backend)(*given[:, k])
            np.testing.assert_array_equal(single, rolled(robot, name, backend)(*given)[k])


def with_rotors(mechanism: Mechanism, every: int) -> dict[str, Drive]:
    """Heavy rotors with full coupling, some of them behind springs, and some without."""
    full = Drive(ratio=100.0, rotor=Rotor(2e-4, coupling="full"))
    reduced = Drive(ratio=50.0, rotor=Rotor(1e-4, coupling="reduced"))
    return {body.joint.name: full if k % every else reduced for k, body in enumerate(mechanism.bodies)}


@pytest.mark.parametrize("every", [1, 2, 10**9])
@pytest.mark.parametrize("tree", ["tree of 20", "chain of 20"])
def test_loops_feel_rotors(tree: str, every: int) -> None:
    robot = Robot(TREES[tree], with_rotors(TREES[tree], every), backend="numpy")
    bare = Robot(TREES[tree], backend="numpy")
    for name in DYNAMICS:
        given, function = states(robot), RolledFunction(name, robot.machine, "llvm")
        assert_close(function(*given), getattr(robot, name)(*given))
        assert np.abs(function(*given) - rolled(bare, name, "llvm")(*given)).max() > 1e-3


@pytest.mark.parametrize("tree", TREES)
@pytest.mark.parametrize("backend", BACKENDS)
def test_mass_matrices_of_pairs_are_those_of_straight_line_code(tree: str, backend: str) -> None:
    for drives in ({}, with_rotors(TREES[tree], 2) if tree != "screws and turns" else {}):  # no drive turns a screw
        robot = Robot(TREES[tree], drives, backend="numpy")
        q = states(robot, 2)[0]
        found = RolledFunction("mass_matrix", robot.machine, backend)(q)
        assert_close(found, robot.mass_matrix(q))
        np.testing.assert_array_equal(RolledFunction("mass_matrix", robot.machine, backend)(q[1]), found[1])


def model_of(mechanism: Mechanism) -> pinocchio.Model:
    """The same chain for Pinocchio."""
    model = pinocchio.Model()
    for body in mechanism.bodies:
        kind = getattr(pinocchio, "JointModelR" + "XYZ"[int(np.argmax(body.joint.axis))])()
        joint = model.addJoint(body.parent + 1, kind, pinocchio.SE3(body.placement), body.joint.name)
        inertia = pinocchio.Inertia(body.mass, body.com, body.inertia)
        model.appendBodyToJoint(joint, inertia, pinocchio.SE3.Identity())
    return model


def test_a_chain_of_192_moves_as_pinocchio_says() -> None:
    robot = Robot(chain(192))
    model = model_of(robot.mechanism)
    data = model.createData()
    for seed in range(3):
        q, v, a = states(robot, seed=seed)
        assert_close(robot.inverse_dynamics(q, v, a), pinocchio.rnea(model, data, q, v, a))
        assert_close(robot.forward_dynamics(q, v, a), pinocchio.aba(model, data, q, v, a))
        M = np.triu(pinocchio.crba(model, data, q))
        assert_close(robot.mass_matrix(q), M + np.triu(M, 1).T)
        assert_close(robot.gravity_forces(q), pinocchio.computeGeneralizedGravity(model, data, q))
        assert_close(robot.bias_forces(q, v), pinocchio.nonLinearEffects(model, data, q, v))


@pytest.mark.parametrize("name", RIGID)
def test_large_robots_loop_and_small_ones_do_not(name: str) -> None:
    most = longest(name)
    assert suited_to(name, machine_of(chain(most), {}), "llvm") is None
    robot = Robot(chain(most + 1))
    given = dict(zip(("q", "v", "a"), states(robot), strict=True)) | {"tau": np.ones(most + 1)}
    getattr(robot, name)(*(given[x] for x in RECIPES[name].inputs))
    with pytest.raises(InputError, match=rf"{name}: with {most + 1} bodies it runs as loops over them"):
        robot.kernel(name)


def test_robots_of_many_short_chains_loop_later() -> None:
    machine = load("tiago_dual.urdf").machine  # of 101 bodies, up to 17 in a chain
    assert suited_to("forward_dynamics", machine, "llvm") is None
    assert suited_to("mass_matrix", machine, "llvm") is not None
    assert suited_to("mass_matrix", load("talos_full_v2.urdf").machine, "llvm") is None
    assert suited_to("forward_dynamics", machine_of(random_tree(1, 300), {}), "llvm") is not None


def test_code_is_as_long_for_ten_bodies_as_for_a_thousand() -> None:
    """The same text, so that the second one is found on disk."""
    both = (one_by_one, side_by_side)
    for name, arrangements in {**dict.fromkeys(DYNAMICS, both), "mass_matrix": (one_by_one,)}.items():
        texts = []
        for size in (10, 1000):
            columns = columns_of(machine_of(chain(size), {}).system)
            built = [arranged(RECIPES[name].steps(columns), columns, 8) for arranged in arrangements]
            texts.append([program_ir(plan(x.body, x.regions)) for x in built])
        assert texts[0] == texts[1]


TEXT = """
from cutpoint.functions.compiled import machine_of
from cutpoint.kernels.programs.compiled import program_ir
from cutpoint.kernels.programs.plan import plan
from cutpoint.rolled import RECIPES
from cutpoint.rolled.bodies import columns_of
from cutpoint.rolled.passes import one_by_one
from large_robots import chain

columns = columns_of(machine_of(chain(10), {}).system)
for name in ("inverse_dynamics", "forward_dynamics", "mass_matrix"):
    built = one_by_one(RECIPES[name].steps(columns), columns, 8)
    print(program_ir(plan(built.body, built.regions)))
"""


def test_code_is_the_same_text_in_every_process() -> None:
    """So that it is found on disk, in whatever order a process has its sets."""
    given = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", TEXT]
    texts = [subprocess.check_output(command, env={**given, "PYTHONHASHSEED": seed}) for seed in ("1", "2")]
    assert texts[0] == texts[1] != b""


def test_ten_thousand_joints_work_in_seconds(tmp_path: Path) -> None:
    """From URDF text to torques and back to accelerations; a budget that code of quadratic cost cannot keep."""
    size = 10_000
    text = ['<robot name="long"><link name="link0"/>']
    inertia = '<mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.012" iyz="0" izz="0.009"/>'
    for k in range(size):
        text.append(f'<link name="link{k + 1}"><inertial>{inertia}</inertial></link>')
        ends = f'<parent link="link{k}"/><child link="link{k + 1}"/><axis xyz="{k % 2} {1 - k % 2} 0"/>'
        place = '<origin xyz="0 0 0.001" rpy="0 0 0.1"/>'
        text.append(f'<joint name="joint{k}" type="continuous">{place}{ends}</joint>')
    (tmp_path / "long.urdf").write_text("".join(text) + "</robot>")
    start = time.process_time()
    robot = cutpoint.load(tmp_path / "long.urdf")
    q, v, a = 0.01 * states(robot)
    tau = robot.inverse_dynamics(q, v, a)
    found = robot.forward_dynamics(q, v, tau)
    assert time.process_time() - start < 60
    assert_close(robot.inverse_dynamics(q, v, found), tau, 1e-9)
    # hanging straight down from its end, it needs no torque
    still = np.zeros(size)
    assert np.abs(robot.gravity_forces(still)).max() < 1e-6 * 9.81 * size


def test_batches_broadcast_as_kernels_do() -> None:
    robot, small = Robot(chain(100)), Robot(chain(100), backend="numpy")
    q, v, a = states(robot, 50)
    for given in ((q, v, a), (q[:1], v, a[0]), (q.reshape(5, 10, 100), v[:10], a[3]), (q[:0], v[:0], a[:0])):
        ours, theirs = robot.inverse_dynamics(*given), small.inverse_dynamics(*given)
        assert ours.shape == theirs.shape
        if ours.size:
            assert_close(ours, theirs)
    lists = robot.inverse_dynamics(q[0].tolist(), v[0], a[0].astype(np.float32))
    assert_close(lists, small.inverse_dynamics(q[0], v[0], a[0].astype(np.float32)))


@pytest.mark.parametrize("name", DYNAMICS)
@pytest.mark.parametrize("count", [0, 1, 7, 8, 21])
def test_batches_in_any_layout_are_their_configurations_bit_by_bit(name: str, count: int) -> None:
    robot = Robot(TREES["chain of 20"], backend="numpy")
    q, v, x = states(robot, count)
    function = rolled(robot, name, "llvm")
    alone = [function(*one) for one in zip(q, v, x, strict=True)]
    np.testing.assert_array_equal(function(q, v, x), np.reshape(alone, (count, robot.nv)))
    np.testing.assert_array_equal(function(*(np.asfortranarray(one) for one in (q, v, x))), function(q, v, x))
    np.testing.assert_array_equal(function(q[::-1], v[::-1], x[::-1]), function(q, v, x)[::-1])
    shared = states(robot)[1]
    np.testing.assert_array_equal(function(q, shared, x), function(q, np.tile(shared, (count, 1)), x))
    np.testing.assert_array_equal(function(q[None], v, x), function(q, v, x)[None])


def test_wrong_input_is_explained() -> None:
    robot = Robot(chain(100))
    q, v, a = states(robot)
    with pytest.raises(InputError, match=r"inverse_dynamics: v has shape \(99,\): its last axis must be 100"):
        robot.inverse_dynamics(q, v[:99], a)
    with pytest.raises(InputError, match=r"inverse_dynamics: a has shape \(1,\): its last axis must be 100"):
        robot.inverse_dynamics(q, v, a[:1])
    with pytest.raises(InputError, match=r"forward_dynamics: tau\[3\] is nan: every number must be finite"):
        robot.forward_dynamics(q, v, np.where(np.arange(100) == 3, np.nan, a))
    rows = states(robot, 20)
    rows[1, 17, 4] = -1e16
    with pytest.raises(InputError, match=r"inverse_dynamics: v\[17, 4\] is -1e\+16"):
        robot.inverse_dynamics(*rows)
    with pytest.raises(InputError, match="leading axes do not broadcast"):
        robot.inverse_dynamics(np.zeros((2, 100)), np.zeros((3, 100)), a)


def test_results_are_the_caller_s_own() -> None:
    robot = Robot(chain(100))
    q, v, a = states(robot)
    first = robot.inverse_dynamics(q, v, a)
    kept = first.copy()
    robot.inverse_dynamics(v, q, a)
    np.testing.assert_array_equal(first, kept)


def test_threads_do_not_meet() -> None:
    robot = Robot(chain(100))
    q, v, a = states(robot, 16)
    expected, wrong = robot.inverse_dynamics(q, v, a), []

    def work(k: int) -> None:
        for _ in range(200):
            single, batch = robot.inverse_dynamics(q[k], v[k], a[k]), robot.inverse_dynamics(q, v, a)
            if not (np.array_equal(single, expected[k]) and np.array_equal(batch, expected)):
                wrong.append(k)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_tree_too_large_for_straight_line_code_says_what_loops_do_not_take() -> None:
    mechanism = chain(1001, ("revolute",) * 7 + ("spherical",))
    robot = Robot(mechanism)
    with pytest.raises(
        InputError, match=r"1001 bodies are too many .* loops do not support the joint of 'link7', of kind"
    ):
        robot.inverse_dynamics(np.zeros(robot.nq), np.zeros(robot.nv), np.zeros(robot.nv))
    q, v, a = states(Robot(chain(1001)))
    with pytest.raises(InputError, match="loops do not support external wrenches"):
        Robot(chain(1001)).inverse_dynamics(q, v, a, external={"link5": np.ones(6)})


def test_torques_and_accelerations_undo_each_other() -> None:
    robot = Robot(random_tree(5, 150))
    q, v, a = states(robot)
    tau = robot.inverse_dynamics(q, v, a)
    back = robot.inverse_dynamics(q, v, robot.forward_dynamics(q, v, tau))
    # backward stable: the torques of what was found are the torques given
    assert_close(back, tau, 150 * 100 * EPS)


@pytest.mark.parametrize("far", [1e3, 1e6])
def test_where_a_large_robot_is_mounted_makes_no_difference(far: float) -> None:
    robot, mount = Robot(chain(60)), np.eye(4)
    mount[:3, 3] = far
    q = states(robot)[0]
    for name in ("mass_matrix", "forward_dynamics"):
        given = (q,) if name == "mass_matrix" else (q, q, q)
        assert_close(getattr(robot.with_base(mount), name)(*given), getattr(robot, name)(*given), 1e-11)


def test_how_far_trees_stand_from_each_other_makes_no_difference() -> None:
    near, far = (Robot(two_trees(distance)) for distance in (1.0, 1e6))
    q, v, a = states(near)
    assert_close(far.mass_matrix(q), near.mass_matrix(q), 1e-13)
    found = [derivatives.inverse_dynamics(robot, q, v, a) for robot in (far, near)]
    for ours, theirs in zip(*found, strict=True):
        assert_close(ours, theirs, 1e-13)


def two_trees(distance: float) -> Mechanism:
    """Two chains of 40 joints."""
    links, joints = [Link("world")], []
    for name, far in (("left", 0.0), ("right", distance)):
        own = chain(40)
        mount = np.array(own.bodies[0].placement)
        mount[0, 3] += far
        for k, body in enumerate(own.bodies):
            links.append(Link(f"{name}{k}", body.mass, body.com, body.inertia))
            parent, place = (f"{name}{k - 1}", body.placement) if k else ("world", mount)
            joints.append(Joint(f"{name} {k}", "revolute", parent, f"{name}{k}", place, body.joint.axis))
    return build("two trees", links, joints)
