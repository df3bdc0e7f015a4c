"""Single calls of a robot's functions: the bits that the same numbers give in a batch, and the same errors."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas
import pytest

import cutpoint
from cutpoint import Drive, InputError, LinearSpring, Robot, Rotor
from cutpoint.scalars import map_leaves
from robot_library import robot, turned

RNG = np.random.default_rng(3)
ROBOTS = ("xia2019", "mixed_floating")

CALLS: dict[str, Callable[..., Any]] = {
    "inverse_dynamics": lambda r, q, v, a, th, w: r.inverse_dynamics(q, v, a),
    "inverse dynamics with a wrench": lambda r, q, v, a, th, w: r.inverse_dynamics(q, v, a, {r.frames[-1]: w}),
    "forward_dynamics": lambda r, q, v, a, th, w: r.forward_dynamics(q, v, a),
    "forward dynamics with a wrench": lambda r, q, v, a, th, w: r.forward_dynamics(q, v, a, {r.frames[-1]: w}),
    "mass_matrix": lambda r, q, v, a, th, w: r.mass_matrix(q),
    "bias_forces": lambda r, q, v, a, th, w: r.bias_forces(q, v),
    "gravity_forces": lambda r, q, v, a, th, w: r.gravity_forces(q),
    "coriolis_matrix": lambda r, q, v, a, th, w: r.coriolis_matrix(q, v),
    "regressor": lambda r, q, v, a, th, w: r.regressor(q, v, a),
    "jacobian": lambda r, q, v, a, th, w: r.jacobian(q, r.frames[-1], "world"),
    "frame_acceleration": lambda r, q, v, a, th, w: r.frame_acceleration(q, v, a, r.frames[-1]),
    "frame_pose": lambda r, q, v, a, th, w: r.frame_pose(q, r.frames[-1]),
    "velocity_map": lambda r, q, v, a, th, w: r.velocity_map(q),
    "kinetic_energy": lambda r, q, v, a, th, w: r.kinetic_energy(q, v),
    "potential_energy": lambda r, q, v, a, th, w: r.potential_energy(q),
    "momentum": lambda r, q, v, a, th, w: r.momentum(q, v),
    "power_flows": lambda r, q, v, a, th, w: r.power_flows(q, v, a),
    "integrate": lambda r, q, v, a, th, w: r.integrate(q, v, 1e-3),
    "difference": lambda r, q, v, a, th, w: r.difference(q, q + 0.1),
    "coordinate_rates": lambda r, q, v, a, th, w: r.coordinate_rates(q, v),
    "elastic_inverse_dynamics": lambda r, q, v, a, th, w: r.elastic_inverse_dynamics(q, v, a, v, a),
    "elastic inverse dynamics, quasi-rigid": lambda r, q, v, a, th, w: r.elastic_inverse_dynamics(
        q, v, a, v, a, friction_rates=True, quasi_rigid=True
    ),
    "elastic_forward_dynamics": lambda r, q, v, a, th, w: r.elastic_forward_dynamics(q, v, th, th, th),
    "elastic_energy": lambda r, q, v, a, th, w: r.elastic_energy(q, th, th),
    "drive_torque": lambda r, q, v, a, th, w: r.drive_torque(th, q),
    "static_deflection": lambda r, q, v, a, th, w: r.static_deflection(q),
    "friction_torques": lambda r, q, v, a, th, w: r.friction_torques(v),
}


def given(robot: Robot, count: int) -> list[np.ndarray]:
    """q, v, a, theta and a wrench for so many states."""
    sizes = (robot.nq, robot.nv, robot.nv, len(robot.drives), 6)
    q, *others = (RNG.uniform(-1, 1, (count, n)) for n in sizes)
    return [turned(robot, q), *others]


def row(result: Any, k: int) -> Any:
    return tuple(x[k] for x in result) if isinstance(result, tuple) else result[k]


def assert_same(found: Any, expected: Any) -> None:
    pairs = zip(found, expected, strict=True) if isinstance(found, tuple) else [(found, expected)]
    for x, y in pairs:
        assert (type(x), x.shape, x.tobytes()) == (type(y), y.shape, y.tobytes())


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_a_single_call_has_the_bits_of_a_batch(name: str, call: Callable[..., Any]) -> None:
    arm = robot(name)
    arguments = given(arm, 3)
    batch = call(arm, *arguments)
    for k in range(3):
        plain = call(arm, *(x[k].copy() for x in arguments))
        listed = call(arm, *(x[k] if i < 1 else x[k].tolist() for i, x in enumerate(arguments)))
        assert type(plain) is type(listed) and (not isinstance(batch, tuple) or type(plain) is type(batch))
        assert_same(plain, row(batch, k))
        assert_same(listed, row(batch, k))


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("x", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_not_finite_is_named_in_every_call(name: str, x: float) -> None:
    arm = robot(name)
    arm.integrate(*(a[0] for a in given(arm, 1)[:2]), 0.1)
    for k, key in enumerate(("q", "v")):
        for index in range((arm.nq, arm.nv)[k]):
            q, v = (a[0] for a in given(arm, 1)[:2])
            (q, v)[k][index] = x
            with pytest.raises(InputError, match=rf"integrate: {key}\[{index}\] is {x}: every number must be finite"):
                arm.integrate(q, v, 0.1)
    q, v = (a[0] for a in given(arm, 1)[:2])
    with pytest.raises(InputError, match=rf"integrate: dt is {x}: every number"):
        arm.integrate(q, v, x)


@pytest.mark.parametrize("x", [np.nan, np.inf, -1e16])
@pytest.mark.parametrize("place", [(0, 0), (255, 5), (256, 1), (699, 5)])
def test_a_number_out_of_bounds_is_named_wherever_it_is_in_a_long_batch(place: tuple[int, int], x: float) -> None:
    arm = robot("xia2019")
    q, v, a, *_ = given(arm, 700)
    arm.elastic_inverse_dynamics(q, v, a, v, a)
    a[place] = x
    where = rf"a\[{place[0]}, {place[1]}\]"
    with pytest.raises(InputError, match=f"inverse_dynamics: {where} is"):
        arm.inverse_dynamics(q, v, a)
    with pytest.raises(InputError, match=rf"elastic_inverse_dynamics: snap\[{place[0]}, {place[1]}\] is"):
        arm.elastic_inverse_dynamics(q, v, v, v, a)


def test_every_robot_reads_the_numbers_of_its_own_drives() -> None:
    arm = robot("xia2019")
    v = given(arm, 1)[1][0]
    before = arm.friction_torques(v)
    (joint, drive), *_ = arm.drives.items()
    still = arm.with_drives({joint: type(drive)()})
    assert still.friction_torques(v)[0] == 0 and arm.friction_torques(v).tobytes() == before.tobytes()
    assert before[0] != 0


def heavier(robot: Robot) -> Robot:
    """With 2 % more of every number of its drives."""
    return robot.with_drives(map_leaves(lambda x: 1.02 * x, dict(robot.drives)))


def coupled() -> Robot:
    """Whose links carry the rotors' mass, and feel those turn that drive rigidly."""
    arm, rotor = robot("xia2019"), Rotor(1e-5, in_link_inertia=False, mass=0.2, transverse=2e-5)
    kinds = [Drive(100.0, rotor, LinearSpring(8e3)), Drive(100.0, replace(rotor, coupling="full"))]
    return arm.with_drives({name: kinds[k % 2] for k, name in enumerate(arm.joints)})


@pytest.mark.parametrize("first", [*(robot(name) for name in ROBOTS), coupled()], ids=[*ROBOTS, "coupled"])
def test_robots_that_differ_in_numbers_share_kernels_and_no_results(first: Robot) -> None:
    second = heavier(first)
    alone = Robot(second.mechanism, second.drives)
    numbers = [x[0] for x in given(first, 1)]
    for call in CALLS.values():
        call(first, *numbers)
        assert_same(call(second, *numbers), call(alone, *numbers))
    for name in ("mass_matrix", "static_deflection", "elastic_forward_dynamics"):
        assert first.kernel(name) is second.kernel(name) is not alone.kernel(name)
    bare = first.with_drives({first.joints[0]: Drive()})
    assert bare.mass_matrix(numbers[0]) is not None and bare.kernel("mass_matrix") is not first.kernel("mass_matrix")


def test_variants_of_a_function_do_not_answer_for_each_other() -> None:
    arm = robot("xia2019")
    q = given(arm, 1)[0][0]
    frames = (arm.frames[-1], arm.frames[1])
    kinds = ("local", "world", "local_world_aligned")
    for _ in range(2):
        found = {arm.jacobian(q, frame, kind).tobytes() for frame in frames for kind in kinds}
        assert len(found) == 6


class Labelled:
    """As a series of pandas is: numbers that have names."""

    def __init__(self, names: Any) -> None:
        self.index = names

    def to_numpy(self) -> Any:
        return np.ones(6)

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self.to_numpy()


def test_numbers_with_names_are_refused_since_nothing_reads_these() -> None:
    arm = robot("xia2019")
    with pytest.raises(InputError, match=r"gravity_forces: q has labels \('joint6', .*\), which are not read: put"):
        arm.gravity_forces(Labelled([*reversed(arm.joints)]))
    with pytest.raises(InputError, match=r"q has labels .*which are not read"):
        arm.gravity_forces(Labelled([("q", joint) for joint in arm.joints]))
    for plain in ([*range(6)], [*np.linspace(0.0, 1.0, 6)], lambda value: 0):  # places, times; a method of that name
        assert np.array_equal(arm.gravity_forces(Labelled(plain)), arm.gravity_forces(np.ones(6)))


def test_tables_of_pandas_are_arrays_to_kernels() -> None:
    """pandas itself would apply a universal function to the transpose of a table."""
    kernel = cutpoint.compile(lambda q: [q[0] - q[1], 10 * q[1]], name="mixed", q=2)
    rows = np.array([[1.0, 2.0], [3.0, 5.0]])
    table = pandas.DataFrame(rows, columns=["q1", "q2"])
    for call in (kernel, kernel.general, kernel.float32):
        assert np.array_equal(call(table), kernel(rows)) and type(call(table)) is np.ndarray
        assert np.array_equal(call(pandas.Series(rows[1])), kernel(rows[1]))
    assert np.array_equal(kernel(pandas.DataFrame(np.repeat(rows, 25, axis=0))), kernel(np.repeat(rows, 25, axis=0)))
    with pytest.raises(InputError, match=r"mixed: q has shape \(3,\): its last axis must be 2"):
        kernel(pandas.Series([1.0, 2.0, 3.0]))


def test_numbers_that_are_masked_are_refused() -> None:
    arm = robot("xia2019")
    q = np.ma.array(np.ones((2, 6)), mask=False)
    assert np.array_equal(arm.gravity_forces(q), arm.gravity_forces(np.ones((2, 6))))
    q[1] = np.ma.masked
    with pytest.raises(InputError, match="gravity_forces: q has masked entries"):
        arm.gravity_forces(q)
