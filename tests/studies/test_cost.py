"""Rivals through one emitter: they agree, and their operations grow as their sources say.  Nothing here is timed."""

import json
from importlib.metadata import PackageNotFoundError

import numpy as np
import pinocchio as pin
import pytest

from cutpoint.errors import CutpointError, InputError
from cutpoint.kernels import compile, graph_of
from cutpoint.mechanics.elastic_forward import elastic_forward_dynamics
from cutpoint.mechanics.elastic_inverse import elastic_inverse_dynamics
from cutpoint.reporting.folder import write
from cutpoint.reporting.html import Heading
from cutpoint.studies.cost import run
from cutpoint.studies.cost.chains import random_machine
from cutpoint.studies.cost.contenders import CONTENDERS, Contender, arithmetic
from cutpoint.studies.cost.growth import exponent, polynomial
from cutpoint.studies.cost.measure import check_agreement, measured

VD, NE, JETS, EXPLICIT, CHRISTOFFEL, LAGRANGE = CONTENDERS
RIGID = [c for c in CONTENDERS if not c.elastic]


def kernel(contender: Contender, n: int):
    inputs = dict.fromkeys(contender.motion, n)
    return compile(contender.on(random_machine(n)), name=contender.key, backend="numpy", **inputs)


def motions(n: int):
    """Positions and their derivatives (5, 22, n): zero, tiny, random."""
    random = np.random.default_rng(n).uniform(-3, 3, (5, 20, n))
    return np.concatenate([np.zeros((5, 1, n)), np.full((5, 1, n), 1e-9), random], axis=1)


def pinocchio_torques(n: int, q, v, a):
    system = random_machine(n).system
    model = pin.Model()
    model.gravity.linear = np.array([*system.gravity])
    for i, body in enumerate(system.segments):
        R, p = np.array([[*row] for row in body.placement.rotation], float), np.array([*body.placement.position], float)
        joint = model.addJoint(i, pin.JointModelRZ(), pin.SE3(R, p), str(i))
        com = np.array([*body.inertia.first_moment]) / body.inertia.mass
        about_origin = np.array([[*row] for row in body.inertia.rotational])
        about_com = about_origin - body.inertia.mass * (com @ com * np.eye(3) - np.outer(com, com))
        model.appendBodyToJoint(joint, pin.Inertia(body.inertia.mass, com, about_com), pin.SE3.Identity())
    return np.array([pin.rnea(model, model.createData(), *state) for state in zip(q, v, a, strict=True)])


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_rigid_contenders_give_the_torques_of_pinocchio(n):
    q, v, a, *_ = motions(n)
    expected = pinocchio_torques(n, q, v, a)
    for contender in RIGID:
        np.testing.assert_allclose(kernel(contender, n)(q, v, a), expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6])
def test_both_elastic_contenders_give_the_same_motor_torques(n):
    by_jets, explicit = (kernel(c, n)(*motions(n)) for c in (JETS, EXPLICIT))
    np.testing.assert_allclose(explicit, by_jets, rtol=0, atol=1e-10 * np.abs(by_jets).max())


def test_the_explicit_elastic_contenders_motor_torques_make_the_motion():
    m = random_machine(3)
    states = motions(3)
    for state, torque in zip(np.moveaxis(states, 1, 0), kernel(EXPLICIT, 3)(*states), strict=True):
        u = elastic_inverse_dynamics(m.system, m.drives, *(x.tolist() for x in state))
        moved = elastic_forward_dynamics(
            m.system, m.drives, state[0].tolist(), state[1].tolist(), u.theta, u.theta_dot, torque.tolist()
        )
        np.testing.assert_allclose(moved.a, state[2], rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(moved.theta_ddot, u.theta_ddot, rtol=1e-8, atol=1e-8)


def counts(contender: Contender, sizes) -> dict[int, int]:
    graphs = {n: graph_of(contender.on(random_machine(n)), **dict.fromkeys(contender.motion, n)) for n in sizes}
    return {n: arithmetic(graph) for n, graph in graphs.items()}


@pytest.mark.parametrize("contender", [VD, NE, JETS, EXPLICIT], ids=lambda c: c.key)
def test_each_further_joint_costs_a_recursion_the_same(contender):
    steps = np.diff([*counts(contender, range(3, 13)).values()])
    assert np.ptp(steps) <= 0.03 * steps.mean()
    assert len(polynomial(counts(contender, range(2, 13)))) - 1 == 1


@pytest.mark.parametrize(
    ("contender", "degree", "sizes"), [(CHRISTOFFEL, 3, range(2, 15)), (LAGRANGE, 4, range(2, 11))]
)
def test_lagrangian_contenders_cost_the_power_that_their_sources_say(contender, degree, sizes):
    found = counts(contender, sizes)
    assert len(polynomial(found)) - 1 == degree
    assert degree - 1 < exponent(found) < degree


def test_virtual_decomposition_and_newton_euler_cost_about_the_same():
    ours, theirs = (counts(c, [24])[24] for c in (VD, NE))
    assert 0.8 < ours / theirs < 1.25


def test_growth_is_that_of_the_power_where_it_is_one():
    quadratic = {n: 3 * n**2 for n in range(1, 12)}
    assert exponent(quadratic) == pytest.approx(2)
    np.testing.assert_allclose(polynomial(quadratic), [3, 0, 0], atol=1e-9)
    assert exponent({1: 1, 2: 4, 4: 16}) is None
    assert polynomial({n: n**4 for n in (1, 2, 3, 4)}) is None


def test_a_contender_that_disagrees_is_named_and_not_timed():
    kernels = {VD: kernel(VD, 2), NE: compile(lambda q, v, a: [q[0] + v[0], a[1]], backend="numpy", q=2, v=2, a=2)}
    with pytest.raises(CutpointError, match=r"Newton-Euler .* 2 joints differ .* nothing was timed"):
        check_agreement(kernels, np.ones((5, 1, 2)))


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cost")
    run(folder, largest=6, progress=False)
    return folder


def test_the_report_holds_every_contender_and_its_numbers(output):
    results = json.loads((output / "cost.json").read_text(encoding="utf-8"))
    assert results["contenders"].keys() == {c.key for c in CONTENDERS}
    for found in results["contenders"].values():
        assert found["batched"].keys() == found["single"].keys() == {"1", "2", "3", "4", "6"}
        assert all(0 < t["least"] <= t["median"] for t in found["batched"].values())
    text = (output / "index.html").read_text(encoding="utf-8")
    assert (output / "figures" / "figure_c1.png").read_bytes().startswith(b"\x89PNG")
    vd, ne = (results["contenders"][key]["operations"]["6"] for key in ("vd", "ne"))
    assert f"takes {vd / ne:.2f} of Newton-Euler" in text
    # christoffel's counts to six joints are told by a square, although its power is the third
    assert len(results["contenders"]["christoffel"]["polynomial"]) == 3 and "With few joints a lower degree" in text
    assert "more than 5 s to compile, or when the study has taken 90 s; six joints are always timed" in text


def test_what_would_take_too_long_to_compile_is_counted_and_not_timed(monkeypatch):
    monkeypatch.setattr("cutpoint.studies.cost.measure.COMPILE_LIMIT", 0.0)
    cost = measured([6, 8], lambda _: None)[VD.key]
    assert [*cost.operations] == [6, 8] and [*cost.batched] == [6]


def test_it_goes_to_the_joints_that_are_asked_for_and_no_farther(tmp_path, monkeypatch):
    asked = []

    def begin(sizes, _):
        asked.append(sizes)
        raise InterruptedError("it began")

    monkeypatch.setattr("cutpoint.studies.cost.study.measured", begin)
    for largest in (6, 7, 64):
        with pytest.raises(InterruptedError, match="it began"):
            run(tmp_path, largest=largest, progress=False)
    assert [sizes[-3:] for sizes in asked] == [[3, 4, 6], [4, 6, 7], [32, 48, 64]]
    for largest, told in (
        (65, "must be at most 64, the largest size of the contenders"),
        (5, "whole number, at least 6"),
    ):
        with pytest.raises(InputError, match=f"cost: largest {largest} .*{told}"):
            run(tmp_path, largest=largest, progress=False)


def test_an_output_that_is_a_file_is_refused_before_anything_is_measured(tmp_path):
    (tmp_path / "cost").write_text("mine")
    with pytest.raises(InputError, match="cost' is not a folder"):
        run(tmp_path / "cost", progress=False)


def test_a_report_of_its_own_may_be_written_over_and_anothers_not(output, tmp_path, monkeypatch):
    def begin(*_):
        raise InterruptedError("it began")

    monkeypatch.setattr("cutpoint.studies.cost.study.measured", begin)
    with pytest.raises(InterruptedError, match="it began"):
        run(output, progress=False)
    for name in ("index.html", "cost.json"):
        other = tmp_path / name.replace(".", "_")
        other.mkdir()
        (other / name).write_text('{"study": "paper", "versions": {"cutpoint": "0.1.0"}}')
        with pytest.raises(InputError, match=f"holds {name} that this study did not write; name another folder"):
            run(other, progress=False)


def test_a_report_tells_versions_of_what_is_installed(tmp_path, monkeypatch):
    def version(name: str) -> str:
        if name == "llvmlite":
            raise PackageNotFoundError(name)
        return "1.0"

    monkeypatch.setattr("cutpoint.reporting.folder.version", version)
    found = write(tmp_path, Heading("a study", "cutpoint cost", ()), [], {}, "cost.json", "cost")
    assert [*found["versions"]] == ["cutpoint", "Python", "numpy", "scipy", "matplotlib"]
