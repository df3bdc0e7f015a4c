"""Two arms against MuJoCo, their bodies written into it one by one with principal axes of our own finding."""

from typing import Any

import mujoco
import numpy as np
import pytest

from cutpoint.model import WORLD, Mechanism
from robot_library import assert_close, robot, states

ROBOTS = ("ur10", "panda")


def mujoco_of(mechanism: Mechanism) -> Any:
    spec = mujoco.MjSpec()
    spec.option.gravity = mechanism.gravity
    spec.option.enableflags = mujoco.mjtEnableBit.mjENBL_ENERGY
    bodies: list[Any] = []
    for body in mechanism.bodies:
        carrier = spec.worldbody if body.parent == WORLD else bodies[body.parent]
        moments, axes = np.linalg.eigh(body.inertia)
        axes = axes * np.linalg.det(axes)
        own = carrier.add_body(name=body.name, pos=body.placement[:3, 3], quat=quaternion(body.placement[:3, :3]))
        own.explicitinertial, own.mass, own.ipos = True, body.mass, body.com
        own.inertia, own.iquat = moments, quaternion(axes)
        kind = mujoco.mjtJoint.mjJNT_SLIDE if body.joint.kind == "prismatic" else mujoco.mjtJoint.mjJNT_HINGE
        own.add_joint(name=body.joint.name, type=kind, axis=body.joint.axis)
        bodies.append(own)
    return spec.compile()


def quaternion(rotation: np.ndarray) -> np.ndarray:
    """(w, x, y, z)."""
    found = np.zeros(4)
    mujoco.mju_mat2Quat(found, np.ascontiguousarray(rotation).reshape(-1))
    return found


@pytest.fixture(params=ROBOTS)
def pair(request):
    """Our robot, MuJoCo's model, and a function that gives its data at a state."""
    ours = robot(request.param)
    model = mujoco_of(ours.mechanism)
    data = mujoco.MjData(model)

    def at(q, v):
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(model, data)
        return data

    return ours, model, at


def test_inverse_and_forward_dynamics(pair):
    ours, model, at = pair
    for q, v, a in zip(*states(ours), strict=True):
        data = at(q, v)
        data.qacc[:] = a
        mujoco.mj_inverse(model, data)
        assert_close(ours.inverse_dynamics(q, v, a), data.qfrc_inverse)
        data.qfrc_applied[:] = a
        assert_close(ours.forward_dynamics(q, v, a), at(q, v).qacc)
        data.qfrc_applied[:] = 0.0


def test_mass_matrix_and_energies(pair):
    ours, model, at = pair
    for q, v, _ in zip(*states(ours), strict=True):
        data, M = at(q, v), np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        assert_close(ours.mass_matrix(q), M)
        potential, kinetic = data.energy
        assert_close(ours.kinetic_energy(q, v), kinetic)
        assert_close(ours.potential_energy(q), potential, 1e-12, scale=100.0)


def test_jacobians_and_poses(pair):
    ours, model, at = pair
    for q, v, _ in zip(*states(ours), strict=True):
        data = at(q, v)
        for body in (ours.mechanism.bodies[2].name, ours.mechanism.bodies[-1].name):
            linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
            mujoco.mj_jacBody(model, data, linear, angular, model.body(body).id)
            assert_close(ours.jacobian(q, body, "local_world_aligned"), np.vstack([linear, angular]), 1e-12)
            assert_close(ours.frame_pose(q, body)[:3, 3], data.body(body).xpos, 1e-12)
