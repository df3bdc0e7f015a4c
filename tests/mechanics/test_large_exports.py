"""Functions that run as loops over bodies leave as loops in C, with the bits that machine code gives."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from c_builds import STRICT, CFunction, assert_same_bits, build, compilers, run
from cutpoint import Robot, derivatives
from cutpoint.derivatives import in_c
from cutpoint.errors import InputError
from cutpoint.export import export_function
from cutpoint.functions.compiled import compiled_of
from large_robots import assert_close, based, chain, star
from robot_library import load, mixed_drives, tree

CHAIN, TREE = Robot(chain(140, ("revolute", "prismatic", "helical"))), Robot(based("revolute", 140))
FLOATING, BRANCHING = Robot(based("floating", 140, branching=False)), Robot(based("floating", 140))
STAR = Robot(star(130))
TURNING = Robot(chain(70, ("revolute", "prismatic")))
DRIVEN, HELICAL = TURNING.with_drives(mixed_drives(TURNING)), CHAIN.with_drives(mixed_drives(CHAIN))

WORLD = {"expressed_in": "world"}
EVERYWHERE = (
    "inverse_dynamics", "forward_dynamics", "mass_matrix", "bias_forces", "gravity_forces", "regressor",
    "kinetic_energy", "potential_energy", "momentum", "inverse_dynamics_derivatives", "coriolis_matrix",
)  # fmt: skip
ELASTIC = (
    "elastic_inverse_dynamics", "elastic_forward_dynamics", "static_deflection", "elastic_inverse_dynamics_derivatives",
)  # fmt: skip
PAIRED = ("mass_matrix", "regressor", "inverse_dynamics_derivatives", "coriolis_matrix")
BRANCHED = ("inverse_dynamics", "forward_dynamics", "mass_matrix", "momentum", "inverse_dynamics_derivatives")
FLOATED = tuple(name for name in EVERYWHERE if name not in ("bias_forces", "gravity_forces", "regressor"))
CASES: dict[str, tuple[Robot, str, dict[str, Any]]] = {
    **{f"{name} of a chain": (CHAIN, name, {}) for name in EVERYWHERE},
    **{f"{name} of a tree": (TREE, name, {}) for name in BRANCHED},
    **{f"{name} where no body carries another": (STAR, name, {}) for name in PAIRED},
    **{f"{name}, floating": (FLOATING, name, {}) for name in FLOATED},
    **{f"{name}, floating and branching": (BRANCHING, name, {}) for name in ("mass_matrix", "regressor")},
    **{f"{name}, driven": (DRIVEN, name, {}) for name in ELASTIC},
    "quasi-rigid": (DRIVEN, "elastic_inverse_dynamics", {"quasi_rigid": True}),
    **{
        f"{name} of {which}": (robot, name, {"frame": "link139", **options})
        for which, robot in {"a chain": CHAIN, "a floating chain": FLOATING}.items()
        for name, options in {"frame_pose": {}, **dict.fromkeys(("jacobian", "frame_acceleration"), WORLD)}.items()
    },
}


@pytest.mark.parametrize("case", CASES)
def test_loops_leave_as_loops(case: str, tmp_path: Path) -> None:
    robot, function, options = CASES[case]
    export_function(robot, function, tmp_path, name="f", **options)
    assert "no globals, loops of fixed lengths, " in (tmp_path / "f.h").read_text()
    build(tmp_path, "f.c", "f_check.c", "-o", "check", compiler=compilers()[-1], flags=(*STRICT, "-O1"))
    code, said = run(tmp_path)
    assert code == 0 and re.fullmatch(r"f: 0 of [1-9]\d* numbers differ\n", said)


@pytest.mark.parametrize("compiler", compilers())
@pytest.mark.parametrize("flags", [("-O0",), ("-O3", "-march=native")], ids=" ".join)
def test_every_call_is_on_its_own(compiler: str, flags: tuple[str, ...], tmp_path: Path) -> None:
    export_function(CHAIN, "forward_dynamics", tmp_path)
    n, rng = CHAIN.nv, np.random.default_rng(0)
    CHAIN.forward_dynamics(*np.zeros((3, n)))
    loops = compiled_of(CHAIN).looping("forward_dynamics")
    assert loops is not None
    function = CFunction(tmp_path, "forward_dynamics", loops.to_c("a"), compiler, flags)
    for scale in (1.0, 0.0, 1e-300, 1e3):  # what one call leaves does not reach the next
        given = scale * rng.normal(size=(3, n))
        assert_same_bits(function(*given)[0], CHAIN.forward_dynamics(*given))


@pytest.mark.parametrize(
    ("which", "compiler"),
    [
        *(("humanoid", compiler) for compiler in compilers()),
        *((which, compilers()[-1]) for which in ("floating", "chain", "floating chain")),
    ],
)
def test_derivatives_of_accelerations_leave(which: str, compiler: str, tmp_path: Path) -> None:
    chains = {"chain": TURNING, "floating chain": Robot(based("floating", 60, branching=False))}
    robot = chains.get(which) or load("talos_reduced.urdf", floating_base=which == "floating")
    export_function(robot, "forward_dynamics_derivatives", tmp_path, name="f")
    build(tmp_path, "f.c", "f_check.c", "-o", "check", compiler=compiler, flags=(*STRICT, "-O1"))
    assert run(tmp_path) == (0, f"f: 0 of {2 * 3 * robot.nv**2} numbers differ\n")
    made = in_c.forward_dynamics(robot)
    assert made is not None
    function, rng = CFunction(tmp_path, "f", made[0], compiler), np.random.default_rng(0)
    for _ in range(3):
        given = robot.random(rng), *rng.normal(size=(2, robot.nv))
        for ours, theirs in zip(function(*given), derivatives.forward_dynamics(robot, *given), strict=True):
            assert_close(ours, theirs, 1e-11)  # which takes accelerations from code without loops


def test_the_same_robot_leaves_as_the_same_text(tmp_path: Path) -> None:
    one, other = (export_function(Robot(FLOATING.mechanism), "mass_matrix", tmp_path / k) for k in "ab")
    assert [path.read_text() for path in one] == [path.read_text() for path in other]


def test_an_output_may_be_an_inputs_memory(tmp_path: Path) -> None:
    export_function(CHAIN, "inverse_dynamics", tmp_path)
    build(tmp_path, "-shared", "-fPIC", "inverse_dynamics.c", "-o", "f.so")
    import ctypes

    call = ctypes.CDLL(str(tmp_path / "f.so")).inverse_dynamics
    given = np.random.default_rng(0).normal(size=(3, CHAIN.nv))
    expected = CHAIN.inverse_dynamics(*given)
    places = [ctypes.c_void_p(x.ctypes.data) for x in given]
    call(*places, places[1])
    assert_same_bits(given[1], expected)


def test_an_output_may_be_the_memory_of_an_input_that_a_later_step_reads(tmp_path: Path) -> None:
    export_function(TURNING, "forward_dynamics_derivatives", tmp_path)
    build(tmp_path, "-shared", "-fPIC", "forward_dynamics_derivatives.c", "-o", "f.so")
    import ctypes

    call = ctypes.CDLL(str(tmp_path / "f.so")).forward_dynamics_derivatives
    n, rng = TURNING.nv, np.random.default_rng(0)
    given, outputs = rng.normal(size=(3, n)), np.zeros((3, n * n))
    call(*(ctypes.c_void_p(x.ctypes.data) for x in (*given, *outputs)))
    for k in range(2):
        shared = np.zeros_like(outputs)
        shared[k, :n] = given[0]
        places = [shared[k], *given[1:], *shared]
        call(*(ctypes.c_void_p(x.ctypes.data) for x in places))
        assert_same_bits(shared, outputs)


def test_what_does_not_leave_says_so(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"with 140 bodies it runs as loops .* no kernel .*; loops are exported as C only"
    ):
        export_function(CHAIN, "inverse_dynamics", tmp_path, to="cuda")
    with pytest.raises(
        InputError, match=r"elastic_forward_dynamics_derivatives: with 70 bodies .* no kernel to inspect or to export"
    ):
        export_function(DRIVEN, "elastic_forward_dynamics_derivatives", tmp_path)
    with pytest.raises(InputError, match="loops are exported as C for robots with a drive in every joint, or in none"):
        export_function(HELICAL, "static_deflection", tmp_path)
    with pytest.raises(InputError, match=r"mass_matrix: in C it would take [\d,]+ bytes of stack, more than 4"):
        export_function(Robot(chain(750)), "mass_matrix", tmp_path)
    told = "inverse_dynamics: for 140 degrees of freedom it is exported as loops, which need double precision"
    with pytest.raises(InputError, match=told):
        export_function(CHAIN, "inverse_dynamics", tmp_path, precision="float32")
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("name", ["forward_dynamics", "inverse_dynamics"])
def test_derivatives_without_a_kernel_are_said_to_leave_where_they_do(name: str) -> None:
    robot = Robot(TURNING.mechanism)
    getattr(derivatives, name)(robot, *np.zeros((3, robot.nv)))
    with pytest.raises(InputError, match="has no kernel to inspect; loops are exported as C only"):
        robot.kernel(f"{name}_derivatives")


def test_small_robots_leave_without_loops(tmp_path: Path) -> None:
    export_function(tree(), "inverse_dynamics", tmp_path)
    assert "no globals, no loops: safe" in (tmp_path / "inverse_dynamics.h").read_text()
