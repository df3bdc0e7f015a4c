"""A hundred random trees over all kinds of joints, floating ones anywhere, against Pinocchio, and laws of motion."""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from cutpoint.mechanics.bodies.joints import Floating, Helical, Planar, Prismatic, Revolute, Spherical
from cutpoint.model import Joint, Limits, Link
from cutpoint.model.build import build
from random_trees import EVERY_KIND, placement, tree_of_every_kind
from robot_library import Array, Robot, assert_close, derivative
from twins import Twin, pinocchio_of, se3

TREES = range(100)
COMPILED = (3, 21, 46, 77)
"""Trees that are also compiled."""

CASES = [(seed, "numpy") for seed in TREES] + [(seed, "llvm") for seed in COMPILED]
every_tree = pytest.mark.parametrize(("seed", "backend"), CASES)


@cache
def twin_of(seed: int, backend: str) -> Twin:
    mechanism = tree_of_every_kind(seed)
    return Twin(Robot(mechanism, backend=backend), pinocchio_of(mechanism))  # pyright: ignore[reportArgumentType]


def states(ours: Robot, seed: int) -> tuple[Array, Array, Array]:
    """At rest and unmoved, nearly so, at random, and fast."""
    rng = np.random.default_rng(seed)
    q, v, a = ours.random(rng, 5), *rng.uniform(-3.0, 3.0, (2, 5, ours.nv))
    q[0], v[0], a[0] = ours.neutral(), 0.0, 0.0
    q[1], v[1], a[1] = ours.integrate(ours.neutral(), v[1], 1e-9), 1e-9 * v[1], 1e-9 * a[1]
    v[-1] *= 30.0
    return q, v, a


def turning(ours: Robot) -> Array:
    """Which speeds turn something."""
    axes = [axis for segment in ours.machine.system.segments for axis in segment.joint.axes]
    return np.array([any(axis[3:]) for axis in axes])


def other_quaternions(ours: Robot, q: Array) -> Array:
    """The same configuration: every turn has two quaternions, of opposite sign."""
    found = q.copy()
    for segment in ours.machine.system.segments:
        if isinstance(segment.joint, (Spherical, Floating)):
            found[:, segment.q.stop - 4 : segment.q.stop] *= -1.0
    return found


def test_the_trees_have_every_kind_of_joint_everywhere() -> None:
    trees = [tree_of_every_kind(seed) for seed in TREES]
    segments = [segment for seed in TREES for segment in twin_of(seed, "numpy").robot.machine.system.segments]
    for kind in (Revolute, Prismatic, Helical, Planar, Spherical, Floating):
        assert sum(isinstance(s.joint, kind) for s in segments) > 30
        assert sum(isinstance(s.joint, kind) and s.parent >= 0 for s in segments) > 15
    assert sum(body.joint.name.endswith("_2") for tree in trees for body in tree.bodies) > 30


@every_tree
def test_dynamics_are_pinocchios(seed: int, backend: str) -> None:
    twin = twin_of(seed, backend)
    q, v, a = s = states(twin.robot, seed)
    tau, accelerations, M = twin.robot.inverse_dynamics(*s), twin.robot.forward_dynamics(*s), twin.robot.mass_matrix(q)
    for k in range(len(q)):
        assert_close(tau[k], twin.inverse_dynamics(q[k], v[k], a[k]))
        assert_close(accelerations[k], twin.forward_dynamics(q[k], v[k], a[k]))
        assert_close(M[k], twin.mass_matrix(q[k]))


@every_tree
def test_jacobians_energies_and_momentum_are_pinocchios(seed: int, backend: str) -> None:
    twin = twin_of(seed, backend)
    ours, (q, v, _) = twin.robot, states(twin.robot, seed)
    frame = ours.mechanism.bodies[-1].name
    for way in ("local", "world", "local_world_aligned"):
        for q_k, J in zip(q, ours.jacobian(q, frame, way), strict=True):
            assert_close(J, twin.jacobian(q_k, frame, way), 1e-12)
    weight = sum(body.mass for body in ours.mechanism.bodies) * 10.0
    kinetic, potential = ours.kinetic_energy(q, v), ours.potential_energy(q)
    for k in range(len(q)):
        assert_close(kinetic[k], twin.kinetic_energy(q[k], v[k]))
        assert_close(potential[k], twin.potential_energy(q[k]), 1e-12, scale=weight)
        assert_close(ours.frame_pose(q[k], frame), twin.frame_pose(q[k], frame), 1e-12)
        assert_close(ours.momentum(q[k], v[k]), twin.momentum(q[k], v[k]))


@every_tree
def test_wrenches_act_as_pinocchios_external_forces(seed: int, backend: str) -> None:
    twin = twin_of(seed, backend)
    ours, (q, v, a) = twin.robot, states(twin.robot, seed)
    wrenches = {body.name: np.arange(6.0) - 2.0 for body in ours.mechanism.bodies[1::2]}
    forces = twin.external(wrenches)
    tau, accelerations = ours.inverse_dynamics(q, v, a, wrenches), ours.forward_dynamics(q, v, a, wrenches)
    for k in range(len(q)):
        assert_close(tau[k], twin.inverse_dynamics(q[k], v[k], a[k], forces))
        assert_close(accelerations[k], twin.forward_dynamics(q[k], v[k], a[k], forces))


@pytest.mark.parametrize("seed", TREES)
def test_every_form_of_the_equations_says_the_same(seed: int) -> None:
    """M a + C v + g, and the regressor times the inertial parameters, are the inverse dynamics."""
    ours = twin_of(seed, "numpy").robot
    q, v, a = s = states(ours, seed)
    tau = ours.inverse_dynamics(*s)
    assert_close(ours.regressor(*s) @ ours.inertial_parameters, tau)
    of_speeds = (ours.mass_matrix(q) @ a[..., None] + ours.coriolis_matrix(q, v) @ v[..., None])[..., 0]
    assert_close(of_speeds + ours.gravity_forces(q), tau)


@every_tree
def test_configurations_are_integrated_and_compared_as_pinocchio_does(seed: int, backend: str) -> None:
    """Steps turn by less than half a turn, so that the way back is the way there.

    Pinocchio's planar joint loses as many digits as the angle is smaller than 1: no slow turn is slower than 5e-5.
    """
    twin = twin_of(seed, backend)
    ours, (q, v, _) = twin.robot, states(twin.robot, seed)
    far = 1.5 * v / np.abs(v).max(axis=-1, keepdims=True).clip(1e-3)
    for step in (far, np.where(turning(ours), np.copysign(5e-5, far), far), 1e-6 * v, 0.0 * v):
        moved = ours.integrate(q, step, 1.0)
        assert_close(ours.integrate(q, 4.0 * step, 0.25), moved, 1e-14)
        back = ours.difference(q, moved)
        assert_close(back, step, 1e-12, scale=1.0)
        assert_close(back[:, turning(ours)], step[:, turning(ours)], 1e-10, scale=2e-5)
        assert_close(ours.difference(q, other_quaternions(ours, moved)), back, 1e-15, scale=1.0)
        for k in range(len(q)):
            theirs, change = twin.theirs(q[k], step[k])
            expected = pin.integrate(twin.model, theirs, change)
            found = twin.coordinates(moved[k])
            assert_close(pin.difference(twin.model, expected, found), np.zeros(ours.nv), scale=1.0)
            assert_close(back[k], twin.ours(pin.difference(twin.model, theirs, expected)), 1e-10, scale=1.0)


@every_tree
def test_power_is_the_rate_of_energy(seed: int, backend: str) -> None:
    """Along the motion: what joint torques do goes into kinetic and potential energy, and nowhere else."""
    ours = twin_of(seed, backend).robot
    q, v, a = states(ours, seed)
    v[-1] /= 30.0  # eighth-order differences follow slow turns to the last digits

    def energy(h: float) -> Array:
        there = ours.integrate(q, v, h)
        return ours.kinetic_energy(there, v + h * a) + ours.potential_energy(there)

    work = np.sum(ours.inverse_dynamics(q, v, a) * v, axis=-1)
    assert_close(derivative(energy), work, 1e-10, scale=np.abs(energy(0.0)).max())


@every_tree
def test_rates_of_coordinates_are_those_of_integration(seed: int, backend: str) -> None:
    ours = twin_of(seed, backend).robot
    q, v, _ = states(ours, seed)
    v[-1] /= 30.0
    rates = derivative(lambda h: ours.integrate(q, v, h))
    assert_close(ours.coordinate_rates(q, v), rates, 1e-11, scale=np.abs(v).max())


@pytest.mark.parametrize("seed", TREES)
def test_neutral_is_pinocchios_and_random_is_proper(seed: int) -> None:
    twin = twin_of(seed, "numpy")
    np.testing.assert_array_equal(twin.coordinates(twin.robot.neutral()), pin.neutral(twin.model))
    q = twin.robot.random(seed, (2, 3))
    assert q.shape == (2, 3, twin.robot.nq)
    for q_k in q.reshape(6, -1):
        assert pin.isNormalized(twin.model, twin.coordinates(q_k), 1e-12)
    assert np.array_equal(q, twin.robot.random(seed, (2, 3)))


def test_a_random_configuration_keeps_to_limits() -> None:
    rng = np.random.default_rng(0)
    links = [Link("base", 1.0), Link("screw", 1.0, rng.normal(size=3), np.eye(3))]
    joint = Joint("thread", "helical", "base", "screw", pitch=0.1, limits=Limits(0.2, 0.3))
    q = Robot(build("screw", links, [joint]), backend="numpy").random(rng, 100)
    assert 0.2 <= q.min() < 0.21 and 0.29 < q.max() <= 0.3


def test_a_universal_joint_is_pinocchios() -> None:
    """Pinocchio has it as one joint with two coordinates; here it is two joints and a link without mass."""
    rng = np.random.default_rng(1)
    tensor, com, at = np.diag([0.2, 0.3, 0.4]), rng.normal(size=3), placement(rng)
    joint = Joint("u", "universal", "base", "arm", at, np.array([2.0, 0.0, 0.0]), second_axis=np.array([0.0, 3.0, 4.0]))
    ours = Robot(build("u", [Link("base"), Link("arm", 2.0, com, tensor)], [joint]), backend="numpy")
    theirs = pin.Model()
    theirs.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.6, 0.8])), se3(at), "u")
    theirs.appendBodyToJoint(1, pin.Inertia(2.0, com, tensor), pin.SE3.Identity())
    data = theirs.createData()
    assert ours.joints == ("u_1", "u_2")
    for q, v, a in rng.normal(0.0, 2.0, (5, 3, 2)):
        assert_close(ours.inverse_dynamics(q, v, a), pin.rnea(theirs, data, q, v, a))
        assert_close(ours.forward_dynamics(q, v, a), pin.aba(theirs, data, q, v, a))
        assert_close(ours.jacobian(q, "arm"), pin.computeJointJacobian(theirs, data, q, 1), 1e-13)


@pytest.mark.parametrize("kind", [kind for kind in EVERY_KIND if kind != "floating"])
def test_what_is_not_driven_is_a_joint_subsystem_too(kind: str) -> None:
    numbers = {"pitch": 0.1, "second_axis": np.array([1.0, 0.0, 0.0])}
    joint = Joint("j", kind, "base", "arm", **numbers)  # pyright: ignore[reportArgumentType]
    ours = Robot(build("r", [Link("base"), Link("arm", 1.0, inertia=np.eye(3))], [joint]), backend="numpy")
    names = [subsystem.name for subsystem in ours.subsystems]
    assert names == (["j_1", "j_cross", "j_2", "arm"] if kind == "universal" else ["j", "arm"])
    assert ours.power_flows(ours.neutral(), np.zeros(ours.nv), np.zeros(ours.nv)).shape == (len(ours.cuts),)
