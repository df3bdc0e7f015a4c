"""The lean model, reframed and regrouped, against the untouched one: the same functions, in fewer operations."""

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
import pytest

from cutpoint import Drive, LinearSpring, Robot, Rotor, definitions
from cutpoint.functions.compiled import Machine, machine_of
from cutpoint.kernels import graph_of
from cutpoint.mechanics.assembly import placements
from cutpoint.mechanics.assembly.assembly import lean_framing
from cutpoint.mechanics.assembly.regrouping import UNMOVED
from cutpoint.mechanics.bodies.pseudo_inertia import pseudo_inertia_of
from cutpoint.mechanics.elastic_inverse import Options
from cutpoint.model import Joint, Link, Mechanism
from cutpoint.model.build import build
from cutpoint.model.mechanism import WORLD
from random_trees import placement, random_tree, tree_of_every_kind
from robot_library import Array, assert_close, load, mixed_drives, robot

ARMS: dict[str, Callable[[], Robot]] = {
    "xia2019": lambda: robot("xia2019"),
    "ur5": lambda: load("ur5_robot.urdf"),
    "ur10": lambda: load("ur10_robot.urdf"),
    "panda": lambda: load("panda.urdf"),
    "panda_arm": lambda: load("panda.urdf", lock=dict.fromkeys(["panda_finger_joint1", "panda_finger_joint2"], 0.0)),
    "panda_coupled": lambda: load("panda.urdf", mimic="coupled"),
    "kinova": lambda: load("kinova.urdf"),
    "talos": lambda: load("talos_reduced.urdf", floating_base=True),
}
TREES = range(100)

FULL = Rotor(2e-5, in_link_inertia=False, mass=0.3, transverse=1e-5, position=0.05, coupling="full")
"""A rotor that no link holds yet, and that its carrier turns along."""

FUNCTIONS: dict[str, tuple[Callable[..., Any], str]] = {
    "inverse_dynamics": (definitions.inverse_dynamics, "q v a"),
    "forward_dynamics": (definitions.forward_dynamics, "q v tau"),
    "bias_forces": (definitions.bias_forces, "q v"),
    "gravity_forces": (definitions.gravity_forces, "q"),
    "coriolis_matrix": (definitions.coriolis_matrix, "q v"),
    "mass_matrix": (definitions.mass_matrix, "q"),
    "kinetic_energy": (definitions.kinetic_energy, "q v"),
    "potential_energy": (definitions.potential_energy, "q"),
}
PUSHED = ("inverse_dynamics", "forward_dynamics")
"""Functions that take wrenches on the robot."""

ELASTIC: dict[str, tuple[Callable[..., Any], str]] = {
    "elastic_inverse_dynamics": (
        partial(definitions.elastic_inverse_dynamics, options=Options(quasi_rigid=True)), "q v a jerk snap",
    ),
    "elastic_forward_dynamics": (definitions.elastic_forward_dynamics, "q v theta theta_dot motor_torque"),
    "static_deflection": (definitions.static_deflection, "q"),
}  # fmt: skip

MOST_OPERATIONS = {
    "xia2019": (271, 493, 126, 1517), "ur5": (288, 522, 151, 288), "ur10": (288, 522, 151, 288),
    "panda": (682, 1341, 532, 700), "kinova": (582, 1275, 572, 582),
}  # fmt: skip
"""Of inverse dynamics, forward dynamics, mass matrix and elastic inverse dynamics, elementary functions as one."""


@cache
def arm(name: str) -> Robot:
    return ARMS[name]()


@cache
def untouched(name: str) -> Machine:
    """As the file states it: nothing is taken for 0, 1 or -1."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(placements, "NEGLIGIBLE", 0.0)
        return machine_of(arm(name).mechanism, arm(name).drives)


def lean(ours: Robot) -> Machine:
    return machine_of(ours.mechanism, ours.drives, lean_framing(ours.mechanism))


def states(ours: Robot, seed: int = 0) -> dict[str, Array]:
    """Seven states, (n, 7) each: unmoved at rest, hardly moved, random, fast."""
    rng, driven = np.random.default_rng(seed), len(ours.drives)
    names = {name: ours.nv for name in ("v", "a", "tau", "jerk", "snap")}
    names |= dict.fromkeys(("theta", "theta_dot", "motor_torque"), driven)
    given = {name: rng.uniform(-2.0, 2.0, (size, 7)) for name, size in names.items()}
    for x in given.values():
        x[:, 0], x[:, 1] = 0.0, 1e-9 * x[:, 1]
    given["v"][:, -1] *= 30.0
    q = ours.random(rng, 7)
    q[0], q[1] = ours.neutral(), ours.integrate(ours.neutral(), given["v"][:, 1], 1.0)
    given["theta"] = 1e-2 * given["theta"] + q.T[[d.q for d in ours.machine.drives]]
    return {"q": q.T, **given}


def values(function: Callable[..., Any], machine: Machine, given: dict[str, Array], inputs: str) -> Array:
    """(entries, states)"""
    found = flat(function(machine, **{name: [*given[name]] for name in inputs.split()}))
    return np.array([np.broadcast_to(x, given["q"].shape[1:]) for x in found], float)


def flat(nest: Any) -> list[Any]:
    return [x for part in nest for x in flat(part)] if isinstance(nest, (list, tuple)) else [nest]


def operations(function: Callable[..., Any], machine: Machine, given: dict[str, Array], inputs: str) -> int:
    graph = graph_of(lambda **x: function(machine, **x), **{name: len(given[name]) for name in inputs.split()})
    return sum(graph.operations.values())


def assert_same(ours: Machine, theirs: Machine, given: dict[str, Array], functions: dict[str, Any]) -> None:
    """To 1e-11 of the largest value in any state of the same kind."""
    for function, inputs in functions.values():
        expected = values(function, theirs, given, inputs)
        for slow in (slice(0, -1), slice(-1, None)):
            assert_close(values(function, ours, given, inputs)[:, slow], expected[:, slow], 1e-11, scale=1.0)


def assert_no_longer(ours: Machine, theirs: Machine, given: dict[str, Array], functions: dict[str, Any]) -> None:
    """Within one in a hundred: the weightless cross of a universal joint gets an inertia that it did not have."""
    for name, (function, inputs) in functions.items():
        before, after = (operations(function, machine, given, inputs) for machine in (theirs, ours))
        assert after <= 1.01 * before, f"{name}: {before} operations became {after}"


@pytest.mark.parametrize("name", ARMS)
def test_every_function_of_an_arm_stays_the_same_in_no_more_operations(name: str) -> None:
    ours = arm(name)
    assert_same(lean(ours), untouched(name), states(ours), FUNCTIONS)
    assert_no_longer(lean(ours), ours.machine, states(ours), FUNCTIONS)


@pytest.mark.parametrize("name", ["xia2019", "ur10", "panda", "kinova"])
def test_so_does_every_function_of_an_arm_whose_joints_bend(name: str) -> None:
    ours = arm(name).with_drives(mixed_drives(arm(name)))
    assert_same(lean(ours), ours.machine, states(ours), ELASTIC)
    assert_no_longer(lean(ours), ours.machine, states(ours), ELASTIC)


@pytest.mark.parametrize("seed", TREES)
def test_every_function_of_a_tree_stays_the_same_in_no_more_operations(seed: int) -> None:
    ours = Robot(tree_of_every_kind(seed))
    assert_same(lean(ours), ours.machine, states(ours), FUNCTIONS)
    assert_no_longer(lean(ours), ours.machine, states(ours), FUNCTIONS)


@pytest.mark.parametrize("stiffness", [None, 4e3])
@pytest.mark.parametrize("seed", range(8))
def test_rotors_that_no_link_holds_stay_where_they_are(seed: int, stiffness: float | None) -> None:
    bare = Robot(random_tree(seed, 6, floating=seed % 2 == 0))
    spring = LinearSpring(stiffness) if stiffness else None
    ours = bare.with_drives({name: Drive(40.0, FULL, compliance=spring) for name in bare.joints})
    assert_same(lean(ours), ours.machine, states(ours), FUNCTIONS | ELASTIC)


@pytest.mark.parametrize("seed", range(6))
def test_followers_stay_on_their_leaders(seed: int) -> None:
    ours = Robot(random_tree(seed, 7, mimic=True))
    assert_same(lean(ours), ours.machine, states(ours), FUNCTIONS)
    assert_no_longer(lean(ours), ours.machine, states(ours), FUNCTIONS)


@pytest.mark.parametrize("seed", range(8))
def test_wrenches_on_the_robot_act_where_they_did(seed: int) -> None:
    assert_wrenches_act(Robot(tree_of_every_kind(seed)), seed)


@pytest.mark.parametrize("name", ["xia2019", "ur10", "panda_arm"])
def test_wrenches_on_an_arm_act_in_its_unit_of_length(name: str) -> None:
    assert lean(arm(name)).system.length != 1
    assert_wrenches_act(arm(name), 0)


def assert_wrenches_act(ours: Robot, seed: int) -> None:
    rng = np.random.default_rng(seed)
    wrenches: dict[str, Any] = {frame: [*rng.normal(0.0, 10.0, 6)] for frame in ours.frames}
    functions = {name: (partial(FUNCTIONS[name][0], **wrenches), FUNCTIONS[name][1]) for name in PUSHED}
    assert_same(lean(ours), ours.machine, states(ours), functions)


@pytest.mark.parametrize(("name", "length", "count"), [("ur10", 0.612, 1), ("panda_arm", 0.0825, 2)])
def test_the_length_that_is_there_most_often_is_one(name: str, length: float, count: int) -> None:
    system = lean(arm(name)).system
    ones = [x for body in system.segments for x in body.placement.position if isinstance(x, int) and abs(x) == 1]
    assert len(ones) == count
    assert_close(system.length, length, 1e-12)


@pytest.mark.parametrize("lengths", [(0.0, 0.0), (0.3, 1e-9), (1e-9, 1e-9)])
def test_a_unit_of_length_is_no_rounding(lengths: tuple[float, float]) -> None:
    """Offsets that only files' digits have left are no unit, unless there is nothing else."""
    joints = [Joint(f"joint{k}", "revolute", f"link{k}", f"link{k + 1}", placement=placements.shift([0.0, x, 0.0]))
              for k, x in enumerate((0.0, *lengths, lengths[1]))]  # fmt: skip
    links = [Link(f"link{k}", 1.0, np.full(3, 0.1), 0.02 * np.eye(3)) for k in range(5)]
    ours = Robot(build("short", links, joints))
    longest = max(np.abs(T[:3, 3]).max() for T in lean_framing(ours.mechanism).placements[1:])
    assert longest <= 1e3 * lean(ours).system.length
    assert_same(lean(ours), ours.machine, states(ours), FUNCTIONS)


def test_robots_with_a_joint_that_slides_keep_the_metre() -> None:
    assert lean(Robot(nearly_parallel(0.1, "prismatic"))).system.length == 1


@pytest.mark.parametrize("name", MOST_OPERATIONS)
def test_operations_have_not_grown(name: str) -> None:
    names = ("inverse_dynamics", "forward_dynamics", "mass_matrix", "elastic_inverse_dynamics")
    functions, ours = FUNCTIONS | ELASTIC, arm(name)
    found = [operations(functions[key][0], lean(ours), states(ours), functions[key][1]) for key in names]
    assert all(n <= most for n, most in zip(found, MOST_OPERATIONS[name], strict=True)), found


@pytest.mark.parametrize("tilt", [10.0**-k for k in range(1, 16)])
@pytest.mark.parametrize("kind", ["revolute", "prismatic", "helical"])
def test_axes_that_are_all_but_parallel_cost_no_digits(tilt: float, kind: Any) -> None:
    """Their common normals may be anywhere; and a tilt is kept unless it is rounding."""
    ours = Robot(nearly_parallel(tilt, kind))
    assert_same(lean(ours), ours.machine, states(ours), FUNCTIONS)


def nearly_parallel(tilt: float, kind: Any) -> Mechanism:
    """Four bodies, each axis tilted against the one before."""
    rng = np.random.default_rng(0)
    links, joints = [Link("link0")], []
    for k in range(4):
        placement = placements.shift(rng.normal(0.0, 0.3, 3))
        placement[1:3, 1:3] = [[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]]
        links.append(Link(f"link{k + 1}", 1.0 + k, rng.normal(0.0, 0.1, 3), np.diag([0.02, 0.03, 0.04])))
        pitch = 0.1 if kind == "helical" and k % 2 else 0.0
        own = kind if k % 2 else "revolute"
        joints.append(Joint(f"joint{k}", own, f"link{k}", f"link{k + 1}", placement=placement, pitch=pitch))
    return build("tilted", links, joints, gravity=np.array([1.0, 2.0, -9.0]))


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("name", ["ur10", "kinova", "panda"])
def test_accelerations_under_a_heavy_or_light_hand_give_back_their_torques(name: str, scale: float) -> None:
    """Forward dynamics eliminates joints as well from regrouped bodies, whose masses may vanish, as from real ones.

    Held against torques of inertia, and against the hand's weight at a metre.
    """
    bare = arm(name)
    ours = bare.with_payload(scale, [0.0, 0.0, 0.1], 1e-8 * scale * np.eye(3), bare.mechanism.bodies[-1].name)
    given, machine = states(ours), lean(ours)
    a = values(definitions.forward_dynamics, machine, given, "q v tau")
    back = values(definitions.inverse_dynamics, ours.machine, {**given, "a": a}, "q v a")
    pushed = np.abs(values(definitions.mass_matrix, ours.machine, given, "q").reshape(ours.nv, ours.nv, -1))
    size = np.einsum("jkn,kn->jn", pushed, np.abs(a)).max(axis=0)
    assert np.all(np.abs(back - given["tau"]).max(axis=0) <= 1e-11 * (size + 1.0 + 9.81 * scale))


@pytest.mark.parametrize("seed", TREES[::5])
def test_regrouping_keeps_momentum_and_leaves_nothing_that_the_joint_cannot_tell(seed: int) -> None:
    ours, framing = Robot(tree_of_every_kind(seed)), lean_framing(tree_of_every_kind(seed))
    world, given = framing.world[:3, :3], states(ours)
    found, expected = (values(definitions.momentum, m, given, "q v") for m in (lean(ours), ours.machine))
    turned = np.concatenate([world @ found[:3], world @ found[3:]])
    assert_close(turned, expected, 1e-11)
    for body, inertia in zip(ours.mechanism.bodies, framing.inertias, strict=True):
        P = np.array(pseudo_inertia_of(inertia), float)
        if body.parent != WORLD:
            assert not np.any(P[np.ix_(UNMOVED[body.joint.kind], UNMOVED[body.joint.kind])])


@pytest.mark.parametrize("name", ARMS)
def test_no_number_of_a_placement_moves_farther_than_rounding_is_said_to_reach(name: str) -> None:
    for raw, ours in zip(untouched(name).system.segments, arm(name).machine.system.segments, strict=True):
        rows = [[*x.placement.rotation, x.placement.position] for x in (raw, ours)]
        for theirs, found in zip(*rows, strict=True):
            assert_close([*found], [*theirs], 1e-13, scale=1.0)


def test_an_angle_that_a_file_rounded_is_kept_beside_the_coordinate() -> None:
    """UR10's file has 1.57079632679 for a quarter turn: 4.9e-12 off, which would cost 1e-11 of the torques."""
    zeros = np.abs(lean_framing(arm("ur10").mechanism).zeros)
    assert np.count_nonzero(zeros) == 2
    assert_close(zeros[zeros > 0.0], np.full(2, np.pi / 2 - 1.57079632679), 1e-3)


def test_an_arm_in_the_papers_frames_needs_no_angles() -> None:
    assert not np.any(lean_framing(arm("xia2019").mechanism).zeros)


@pytest.mark.parametrize("name", ["ur10", "panda"])
def test_the_user_never_sees_it(name: str) -> None:
    """Compiled functions of joints run on the lean machine and agree with the untouched one."""
    ours, given = arm(name), states(arm(name))
    q, v, a = (given[x].T for x in ("q", "v", "a"))
    expected = values(definitions.inverse_dynamics, untouched(name), given, "q v a").T
    assert_close(ours.inverse_dynamics(q, v, a), expected, 1e-11)
    lean_count = operations(definitions.inverse_dynamics, lean(ours), given, "q v a")
    assert sum(ours.kernel("inverse_dynamics").operations.values()) == lean_count


@pytest.mark.parametrize("far", [1e2, 3e4, 1e6])
@pytest.mark.parametrize("seed", range(6))
def test_where_a_robot_is_mounted_makes_no_difference(seed: int, far: float) -> None:
    """A tilted first axis meets the world's far away, where a frame would lose all digits."""
    rng = np.random.default_rng(seed)
    ours = arm("xia2019") if seed == 0 else Robot(random_tree(seed, 1 + seed))
    turn = placement(rng)
    mounted = turn.copy()
    mounted[:3, 3] = far * rng.uniform(-1.0, 1.0, 3)
    turn[:3, 3] = 0.0
    here, there = (lean(ours.with_base(T)) for T in (turn, mounted))
    for name in ("inverse_dynamics", "forward_dynamics", "mass_matrix", "kinetic_energy"):
        function, inputs = FUNCTIONS[name]
        expected = values(function, here, states(ours), inputs)
        assert_close(values(function, there, states(ours), inputs), expected, 1e-11, scale=1.0)
