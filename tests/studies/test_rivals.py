"""Newton-Euler and Lagrange, independent of the package's mechanics, agree with each other and with Pinocchio."""

import dataclasses
from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from cutpoint.errors import ModelError
from cutpoint.model.mechanism import Body, Joint, Mechanism, Mimic
from cutpoint.robots import xia2019_mechanism
from cutpoint.studies.paper import lagrange, newton_euler
from cutpoint.studies.paper.chain import Chain, chain_of


def random_pose(rng):
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = Q * np.sign(np.linalg.det(Q)), rng.normal(size=3)
    return pose


def random_inertia(rng):
    """Of a cloud of ten point masses, so that it is one that a body can have."""
    points = rng.normal(size=(10, 3))
    return np.sum(points**2) * np.eye(3) - points.T @ points


def random_tree(seed: int, n: int = 7) -> Chain:
    rng = np.random.default_rng(seed)
    axes = rng.normal(size=(n, 3))
    return Chain(
        parents=tuple(int(rng.integers(-1, i)) for i in range(n)),
        placements=np.array([random_pose(rng) for _ in range(n)]),
        axes=axes / np.linalg.norm(axes, axis=1, keepdims=True),
        kinds=tuple("prismatic" if i % 3 == 1 else "revolute" for i in range(n)),
        masses=rng.uniform(0.5, 3, n),
        coms=rng.normal(size=(n, 3)),
        inertias=np.array([random_inertia(rng) for _ in range(n)]),
        gravity=np.array([1.0, -2.0, -9.0]),
    )


@cache
def robots() -> dict[str, Chain]:
    trees = {f"tree {seed}": random_tree(seed) for seed in range(3)}
    return {"seed's arm": chain_of(xia2019_mechanism()), **trees}


def pinocchio_torques(chain: Chain, q, v, a):
    """Joint torques by Pinocchio's own recursion."""
    model = pin.Model()
    model.gravity.linear = chain.gravity
    for i, parent in enumerate(chain.parents):
        kinds = {"revolute": pin.JointModelRevoluteUnaligned, "prismatic": pin.JointModelPrismaticUnaligned}
        joint = model.addJoint(parent + 1, kinds[chain.kinds[i]](chain.axes[i]), pin.SE3(chain.placements[i]), str(i))
        inertia = pin.Inertia(chain.masses[i], chain.coms[i], chain.inertias[i])
        model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    order = [model.joints[model.getJointId(str(i))].idx_v for i in range(len(chain.parents))]
    placed = [np.empty(model.nv) for _ in range(3)]
    for target, source in zip(placed, (q, v, a), strict=True):
        target[order] = source
    return pin.rnea(model, model.createData(), *placed)[order]


def states(chain: Chain):
    n = len(chain.parents)
    random = np.random.default_rng(5).uniform(-3, 3, (3, 20, n))
    return np.concatenate([np.zeros((3, 1, n)), np.full((3, 1, n), 1e-9), random], axis=1)


@pytest.mark.parametrize("name", robots())
def test_newton_euler_and_lagrange_give_the_same_torques(name):
    chain = robots()[name]
    q, v, a = states(chain)
    ours = newton_euler.torques(chain, q, v, a)
    np.testing.assert_allclose(ours, lagrange.torques(chain, q, v, a), rtol=1e-12, atol=1e-12 * np.abs(ours).max())


@pytest.mark.parametrize("formulation", [newton_euler, lagrange])
@pytest.mark.parametrize("name", robots())
def test_both_give_the_torques_of_pinocchio(name, formulation):
    chain = robots()[name]
    q, v, a = states(chain)
    theirs = np.array([pinocchio_torques(chain, *state) for state in zip(q, v, a, strict=True)])
    ours = formulation.torques(chain, q, v, a)
    np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12 * np.abs(theirs).max())


@pytest.mark.parametrize("formulation", [newton_euler, lagrange])
def test_samples_do_not_see_one_another(formulation):
    chain = robots()["tree 0"]
    q, v, a = states(chain)
    batch = formulation.torques(chain, q.reshape(2, 11, -1), v.reshape(2, 11, -1), a.reshape(2, 11, -1))
    single = formulation.torques(chain, q[13], v[13], a[13])
    np.testing.assert_allclose(batch[1, 2], single, rtol=1e-14, atol=1e-13)


def test_mass_matrix_is_symmetric_and_positive_definite():
    chain = robots()["tree 1"]
    M = lagrange.mass_matrix(chain, states(chain)[0])
    np.testing.assert_allclose(M, np.swapaxes(M, -1, -2), atol=1e-12)
    assert np.linalg.eigvalsh(M).min() > 0


def mechanism_with(kind="revolute", mimic=None) -> Mechanism:
    joint = Joint("lift", kind, "base", "carriage", mimic=mimic)
    body = Body("carriage", joint, -1, np.eye(4), 2.0, np.zeros(3), np.eye(3))
    return Mechanism("lift", (body,), {})


def test_a_floating_base_is_refused_by_name():
    with pytest.raises(ModelError, match="joint 'lift': a floating joint"):
        chain_of(mechanism_with("floating"))


def test_a_joint_that_follows_another_is_refused_only_when_coupled():
    mechanism = mechanism_with(mimic=Mimic("other"))
    assert chain_of(mechanism).kinds == ("revolute",)
    with pytest.raises(ModelError, match="joint 'lift' follows 'other'"):
        chain_of(dataclasses.replace(mechanism, coupled=True))
