"""Robots with quaternions, of which a zero one is refused, and robots in which nothing moves."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cutpoint import InputError, Robot, derivatives
from cutpoint.model import Joint, Link
from cutpoint.model.build import build
from large_robots import based
from robot_library import BACKENDS, Array

BALL = Link("ball", 2.0, np.array([0.0, 0.0, 0.1]), 0.1 * np.eye(3))


def ball(backend: str) -> Robot:
    """Two spherical joints, one behind a slide."""
    joints = [Joint("slide", "prismatic", "base", "sledge"), Joint("socket", "spherical", "sledge", "ball")]
    joints.append(Joint("second", "spherical", "ball", "ball2"))
    second = Link("ball2", 1.0, np.array([0.1, 0.0, 0.0]), 0.1 * np.eye(3))
    return Robot(build("ball", [Link("base"), Link("sledge", 1.0), BALL, second], joints), backend=backend)


def floating(bodies: int, backend: str) -> Robot:
    return Robot(based("floating", bodies, branching=False), backend=backend)


Call = Callable[[Robot, Array, Array], Any]
CALLS: dict[str, Call] = {
    "inverse_dynamics": lambda r, q, v: r.inverse_dynamics(q, v, v),
    "forward_dynamics": lambda r, q, v: r.forward_dynamics(q, v, v),
    "mass_matrix": lambda r, q, v: r.mass_matrix(q),
    "frame_acceleration": lambda r, q, v: r.frame_acceleration(q, v, v, r.frames[-1]),
    "frame_pose": lambda r, q, v: r.frame_pose(q, r.frames[-1]),
    "potential_energy": lambda r, q, v: r.potential_energy(q),
    "integrate": lambda r, q, v: r.integrate(q, v, 0.1),
    "difference": lambda r, q, v: r.difference(q, r.neutral()),
    "linearize": lambda r, q, v: r.linearize(q),
    "inverse_dynamics_derivatives": lambda r, q, v: derivatives.inverse_dynamics(r, q, v, v),
}  # fmt: skip


def refusal(name: str, joint: str, where: str = "") -> str:
    return rf"^{name}: the quaternion of joint '{joint}' is zero in q{where}; start from robot.neutral\(\)$"


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", CALLS)
def test_a_zero_quaternion_is_refused(name: str, backend: str) -> None:
    for ours, joint, own in ((floating(1, backend), "base", slice(3, 7)), (ball(backend), "second", slice(5, 9))):
        q, v = ours.neutral(), np.zeros(ours.nv)
        CALLS[name](ours, q, v)
        for zero in (0.0, -0.0, 1e-60, -1e-200):
            q[own] = zero
            with pytest.raises(InputError, match=refusal(name, joint)) as caught:
                CALLS[name](ours, q, v)
            assert caught.value.evidence["joint"] == joint
            with pytest.raises(InputError, match=refusal(name, joint)):
                CALLS[name](ours, q.tolist(), v)


@pytest.mark.parametrize("name", ["inverse_dynamics", "mass_matrix", "potential_energy"])
@pytest.mark.parametrize("bodies", [1, 70])
def test_in_a_batch_the_place_of_a_zero_quaternion_is_told(name: str, bodies: int) -> None:
    ours = floating(bodies, "llvm")
    q = np.broadcast_to(ours.neutral(), (3, 20, ours.nq)).copy()
    q[:, 1, 3:7] = [1.0, 0.0, 0.0, 0.0]
    CALLS[name](ours, q, np.zeros(ours.nv))
    q[2, 11, 3:7] = 0.0
    with pytest.raises(InputError, match=refusal(name, "base", r"\[2, 11\]")):
        CALLS[name](ours, q, np.zeros(ours.nv))


LARGE = [("inverse_dynamics", 70), ("integrate", 300), ("inverse_dynamics_derivatives", 30), ("linearize", 30)]


@pytest.mark.parametrize(("name", "bodies"), LARGE)
def test_a_zero_quaternion_of_a_large_robot_is_refused(name: str, bodies: int) -> None:
    ours = floating(bodies, "llvm")
    with pytest.raises(InputError, match=refusal(name, "base")):
        CALLS[name](ours, np.zeros(ours.nq), np.zeros(ours.nv))


def test_the_other_configuration_of_a_difference_is_looked_at_too() -> None:
    ours = floating(1, "llvm")
    with pytest.raises(InputError, match="'base' is zero in q_next"):
        ours.difference(ours.neutral(), np.zeros(ours.nq))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("length", [1e-40, 1e-3, 1e10])
def test_a_quaternion_may_have_any_other_length(length: float, backend: str) -> None:
    for ours, places in ((floating(1, backend), [slice(3, 7)]), (ball(backend), [slice(1, 5), slice(5, 9)])):
        q, v = ours.random(0), np.linspace(-1.0, 1.0, ours.nv)
        for turn in (q, ours.neutral()):
            scaled = turn.copy()
            for own in places:
                scaled[own] *= length
            for name in sorted({*CALLS} - {"linearize", "inverse_dynamics_derivatives"}):
                expected = CALLS[name](ours, turn, v)
                np.testing.assert_allclose(CALLS[name](ours, scaled, v), expected, rtol=1e-11, atol=1e-11)
            mine, other = (derivatives.inverse_dynamics(ours, x, v, v).d_q for x in (turn, scaled))
            np.testing.assert_allclose(mine, other, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("quaternion", np.eye(4))
def test_half_turns_are_no_zero_quaternions(quaternion: Array) -> None:
    ours = floating(1, "llvm")
    q = ours.neutral()
    q[3:7] = quaternion
    assert np.isfinite(ours.inverse_dynamics(q, np.zeros(ours.nv), np.zeros(ours.nv))).all()


# nothing moves


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("batch", [(), (3,), (2, 3)])
def test_matrices_of_a_robot_in_which_nothing_moves_have_no_rows_and_no_columns(
    batch: tuple[int, ...], backend: str
) -> None:
    links = [Link("base", 1.0, np.zeros(3), np.eye(3)), BALL]
    still = Robot(build("still", links, [Joint("weld", "fixed", "base", "ball")]), backend=backend)
    x = np.zeros((*batch, 0))
    square = [still.mass_matrix(x), still.coriolis_matrix(x, x), still.velocity_map(x), still.regressor(x, x, x)]
    square += [*still.drive_regressor(x, x, x, x, x)]
    square += [*derivatives.inverse_dynamics(still, x, x, x), *derivatives.forward_dynamics(still, x, x, x)]
    square += [*derivatives.elastic_inverse_dynamics(still, x, x, x, x, x)[:5]]
    square += [*derivatives.elastic_forward_dynamics(still, x, x, x, x, x)]
    assert {M.shape for M in square} == {(*batch, 0, 0)}
    for expressed_in in ("local", "world", "local_world_aligned"):
        assert still.jacobian(x, "ball", expressed_in).shape == (*batch, 6, 0)
        assert still.frame_acceleration(x, x, x, "ball", expressed_in).shape == (*batch, 6)
    assert still.inverse_dynamics(x, x, x).shape == (*batch, 0)
    assert still.frame_pose(x, "ball").shape == (*batch, 4, 4)
    assert still.momentum(x, x).shape == (*batch, 6)
