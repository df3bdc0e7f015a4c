"""Rotors with full coupling against Pinocchio trees in which every rotor is a body on a joint of its own."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from cutpoint import Drive, Flexspline, InputError, LinearSpring, Robot, Rotor
from cutpoint.model import Body, Joint, Mechanism
from cutpoint.simulation.steps.fastest import fastest_mode, posture
from robot_library import derivative

N = 4


def random_arm(seed: int, floating: bool = False) -> Mechanism:
    """A chain of revolute joints of any axis, on a floating base if wanted."""
    rng = np.random.default_rng(seed)
    bodies = []
    if floating:
        bodies.append(Body("base", Joint("root", "floating", "world", "base"), -1, np.eye(4), 4.0, *_mass(rng)))
    for k in range(N):
        axis = rng.normal(size=3)
        joint = Joint(f"j{k}", "revolute", "", f"b{k}", axis=axis / np.linalg.norm(axis))
        bodies.append(Body(f"b{k}", joint, len(bodies) - 1, _place(rng), rng.uniform(1, 3), *_mass(rng)))
    return Mechanism("arm", tuple(bodies), {})


def rotor_drives(seed: int, elastic: bool, in_link: bool = False) -> dict[str, Drive]:
    rng = np.random.default_rng(100 + seed)
    drives = {}
    for k in range(N):
        J = rng.uniform(1e-3, 3e-3)  # heavy, so that what it couples to shows
        rotor = Rotor(J, in_link, rng.uniform(0.2, 0.5), 0.7 * J, rng.uniform(-0.1, 0.1), coupling="full")
        spring = LinearSpring(rng.uniform(500, 900)) if elastic else None
        drives[f"j{k}"] = Drive(rng.choice([-1, 1]) * rng.uniform(5, 20), rotor, spring)
    return drives


def twin(mechanism: Mechanism, drives: dict[str, Drive]) -> tuple[pin.Model, list[int], list[int]]:
    """Pinocchio's tree: links, and rotors on joints of their own; first speed of each link joint and each rotor."""
    model, ids, links, rotors = pin.Model(), [], [], []
    for body in mechanism.bodies:
        place, carrier = pin.SE3(body.placement), ids[body.parent] if body.parent >= 0 else 0
        if body.joint.kind == "floating":
            kind = pin.JointModelFreeFlyer()
        else:
            kind = pin.JointModelRevoluteUnaligned(body.joint.axis)
            drive = drives[body.joint.name]
            rotors.append(
                model.addJoint(carrier, pin.JointModelRevoluteUnaligned(body.joint.axis), place, body.name + "r")
            )
            z, r = body.joint.axis, drive.rotor
            tensor = r.transverse * np.eye(3) + (r.inertia - r.transverse) * np.outer(z, z)
            if not r.in_link_inertia:
                model.appendBodyToJoint(rotors[-1], pin.Inertia(r.mass, r.position * z, tensor), pin.SE3.Identity())
        ids.append(model.addJoint(carrier, kind, place, body.name))
        model.appendBodyToJoint(ids[-1], pin.Inertia(body.mass, body.com, body.inertia), pin.SE3.Identity())
        if body.joint.kind != "floating":
            links.append(ids[-1])
    model.armature = np.zeros(model.nv)
    return model, [model.joints[i].idx_v for i in links], [model.joints[i].idx_v for i in rotors]


def _place(rng: np.random.Generator) -> np.ndarray:
    placement = np.eye(4)
    placement[:3, :3], placement[:3, 3] = pin.exp3(rng.normal(size=3)), rng.normal(size=3) * 0.3
    return placement


def _mass(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    A = rng.normal(size=(3, 3)) * 0.2
    return rng.normal(size=3) * 0.1, A @ A.T + 0.05 * np.eye(3)


def geared(model: pin.Model, links: list[int], rotors: list[int], ratios: np.ndarray) -> np.ndarray:
    """How all speeds of the twin follow from those of the base and the joints, rotors geared rigidly."""
    base = model.nv - 2 * N
    G = np.zeros((model.nv, base + N))
    G[:base, :base] = np.eye(base)
    for k in range(N):
        G[links[k], base + k], G[rotors[k], base + k] = 1, ratios[k]
    return G


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_rigidly_geared_rotors_are_bodies(seed: int, floating: bool) -> None:
    mechanism, drives = random_arm(seed, floating), rotor_drives(seed, elastic=False)
    ours, rng = Robot(mechanism, drives, backend="numpy"), np.random.default_rng(seed)
    model, links, rotors = twin(mechanism, drives)
    data = model.createData()
    G = geared(model, links, rotors, np.array([d.ratio for d in drives.values()]))
    q, v, a = ours.random(seed), rng.normal(size=ours.nv), rng.normal(size=ours.nv)
    q_twin = pin.neutral(model)
    q_twin[: 7 if floating else 0] = q[: 7 if floating else 0]
    for k in range(N):
        q_twin[links[k] + (1 if floating else 0)] = q[-N:][k]
    tau = G.T @ pin.rnea(model, data, q_twin, G @ v, G @ a)
    M = pin.crba(model, data, q_twin)
    M = G.T @ (np.triu(M) + np.triu(M, 1).T) @ G
    scale = np.abs(tau).max()
    np.testing.assert_allclose(ours.inverse_dynamics(q, v, a), tau, rtol=1e-10, atol=1e-10 * scale)
    np.testing.assert_allclose(ours.mass_matrix(q), M, rtol=1e-10, atol=1e-10 * np.abs(M).max())
    np.testing.assert_allclose(ours.forward_dynamics(q, v, tau), a, rtol=1e-9, atol=1e-9)
    assert ours.kinetic_energy(q, v) == pytest.approx(pin.computeKineticEnergy(model, data, q_twin, G @ v), rel=1e-10)
    if floating:  # of a rotor in a fixed base, only the links' momentum is ours
        pin.computeCentroidalMomentum(model, data, q_twin, G @ v)
        momentum = np.r_[data.hg.linear, data.hg.angular + np.cross(data.com[0], data.hg.linear)]
        np.testing.assert_allclose(ours.momentum(q, v), momentum, rtol=1e-10, atol=1e-10 * np.abs(momentum).max())


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_elastically_geared_rotors_are_bodies(seed: int, floating: bool) -> None:
    mechanism, drives = random_arm(seed, floating), rotor_drives(seed, elastic=True)
    ours, rng = Robot(mechanism, drives, backend="numpy"), np.random.default_rng(seed)
    model, links, rotors = twin(mechanism, drives)
    data = model.createData()
    ratio = np.array([d.ratio for d in drives.values()])
    K = np.array([d.compliance.stiffness for d in drives.values()])
    q, v, u = ours.random(seed), rng.normal(size=ours.nv), rng.normal(size=N) * 20
    theta, theta_dot = q[-N:] + rng.normal(size=N) * 1e-2, rng.normal(size=N)
    q_twin, v_twin, tau = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
    q_twin[: 7 if floating else 0], v_twin[: 6 if floating else 0] = (
        q[: 7 if floating else 0],
        v[: 6 if floating else 0],
    )
    shift = 1 if floating else 0
    for k in range(N):
        q_twin[links[k] + shift], q_twin[rotors[k] + shift] = q[-N:][k], ratio[k] * theta[k]
        v_twin[links[k]], v_twin[rotors[k]] = v[-N:][k], ratio[k] * theta_dot[k]
        spring = K[k] * (theta[k] - q[-N:][k])
        tau[links[k]], tau[rotors[k]] = spring, (u[k] - spring) / ratio[k]
    acceleration = pin.aba(model, data, q_twin, v_twin, tau)
    found = ours.elastic_forward_dynamics(q, v, theta, theta_dot, u)
    expected = np.r_[acceleration[: 6 if floating else 0], acceleration[links]]
    np.testing.assert_allclose(found.a, expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())
    np.testing.assert_allclose(
        found.theta_ddot, acceleration[rotors] / ratio, rtol=1e-9, atol=1e-9 * np.abs(acceleration).max()
    )
    energy = ours.kinetic_energy(q, v) + ours.elastic_energy(q, theta, theta_dot, v=v)
    wound = 0.5 * K @ (theta - q[-N:]) ** 2
    assert energy == pytest.approx(pin.computeKineticEnergy(model, data, q_twin, v_twin) + wound, rel=1e-10)
    if floating:
        pin.computeCentroidalMomentum(model, data, q_twin, v_twin)
        momentum = np.r_[data.hg.linear, data.hg.angular + np.cross(data.com[0], data.hg.linear)]
        scale = np.abs(momentum).max()
        np.testing.assert_allclose(ours.momentum(q, v, theta_dot), momentum, rtol=1e-10, atol=1e-10 * scale)


def motion(t: float, count: int) -> np.ndarray:
    """Position and its derivatives of a sum of sines, (count + 1, N)."""
    w, phase = np.array([1.1, 1.7, 0.9, 1.3]), np.array([0.3, 1.0, 2.0, -0.4])
    return np.array([0.5 * w**k * np.sin(w * t + phase + k * np.pi / 2) for k in range(count + 1)])


def test_exact_elastic_inverse_dynamics_takes_two_derivatives_more_for_each_rotor() -> None:
    ours = Robot(random_arm(0), rotor_drives(0, elastic=True))
    assert ours.derivatives_needed == 2 * (N + 1)
    with pytest.raises(InputError, match="6 more derivatives of the position are needed: 4 are given"):
        ours.elastic_inverse_dynamics(*motion(0.2, 4))
    reduced = {n: replace(d, rotor=replace(d.rotor, coupling="reduced")) for n, d in ours.drives.items()}
    assert ours.with_drives(reduced).derivatives_needed == 4


@pytest.mark.parametrize("flexspline", [False, True])
def test_elastic_inverse_then_forward_returns_the_motion_with_full_coupling(flexspline: bool) -> None:
    ours = Robot(random_arm(1), rotor_drives(1, elastic=True))
    if flexspline:
        ours = ours.with_drives({n: replace(d, compliance=Flexspline(700.0, 0.02)) for n, d in ours.drives.items()})
    x = motion(0.4, ours.derivatives_needed)
    u = ours.elastic_inverse_dynamics(*x)
    back = ours.elastic_forward_dynamics(x[0], x[1], u.theta, u.theta_dot, u.motor_torque)
    np.testing.assert_allclose(back.a, x[2], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(back.theta_ddot, u.theta_ddot, rtol=1e-9, atol=1e-9 * np.abs(u.theta_ddot).max())


def test_motor_rates_are_time_derivatives_of_motor_positions_with_full_coupling() -> None:
    ours, h = Robot(random_arm(2), rotor_drives(2, elastic=True)), 1e-3
    near = [ours.elastic_inverse_dynamics(*motion(0.4 + k * h, ours.derivatives_needed)) for k in (-2, -1, 0, 1, 2)]
    theta = np.array([u.theta for u in near])
    rate = (theta[0] - 8 * theta[1] + 8 * theta[3] - theta[4]) / (12 * h)
    np.testing.assert_allclose(near[2].theta_dot, rate, rtol=1e-8, atol=1e-8)


def test_the_quasi_rigid_form_is_close_and_not_exact() -> None:
    """The difference is what the drives' bending does to rotors that others carry: small against the torque."""
    ours = Robot(random_arm(3), rotor_drives(3, elastic=True))
    exact = ours.elastic_inverse_dynamics(*motion(0.4, ours.derivatives_needed)).motor_torque
    practical = ours.elastic_inverse_dynamics(*motion(0.4, 4), quasi_rigid=True).motor_torque
    off = np.abs(practical - exact).max() / np.abs(exact).max()
    assert 1e-9 < off < 1e-2


def test_a_spinning_rotor_on_a_tilting_base_pushes_as_a_gyroscope_does() -> None:
    """Base turning about x with omega, rotor spinning about z with h = J ratio v: the base bears omega x h along -y."""
    heavy = np.eye(3)
    base = Body(
        "base",
        Joint("tilt", "revolute", "", "base", axis=np.array([1.0, 0, 0])),
        -1,
        np.eye(4),
        1.0,
        np.zeros(3),
        heavy,
    )
    link = Body("link", Joint("spin", "revolute", "", "link"), 0, np.eye(4), 0.0, np.zeros(3), 1e-9 * heavy)
    yaw = Body(
        "yaw", Joint("yaw", "revolute", "", "yaw", axis=np.array([0, 1.0, 0])), -1, np.eye(4), 0.0, np.zeros(3), heavy
    )
    chain = Mechanism("top", (yaw, replace(base, parent=0), replace(link, parent=1)), {}, np.zeros(3))
    J, ratio, omega, speed = 2e-3, 50.0, 0.7, 3.0
    with_spin = Robot(chain, {"spin": Drive(ratio, Rotor(J, coupling="full"))})
    without = Robot(chain, {"spin": Drive(ratio, Rotor(J))})
    q, v, a = np.zeros(3), np.array([0, omega, speed]), np.zeros(3)
    bears = with_spin.inverse_dynamics(q, v, a) - without.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(bears, [-omega * J * ratio * speed, 0, 0], atol=1e-12)


def test_reactions_on_the_stator_sum_as_equation_11_says() -> None:
    """About one common axis the carrier bears (ratio - 1) tau_t + tau: the reducer's housing and the motor's stator."""
    heavy, ratio = np.eye(3), 30.0
    carrier = Body("carrier", Joint("first", "revolute", "", "carrier"), -1, np.eye(4), 1.0, np.zeros(3), heavy)
    link = Body("link", Joint("second", "revolute", "", "link"), 0, np.eye(4), 1.0, np.zeros(3), heavy)
    springs = {n: Drive(ratio, Rotor(2e-3, coupling="full"), LinearSpring(800.0)) for n in ("first", "second")}
    ours = Robot(Mechanism("stator", (carrier, link), {}), springs)
    rates = [np.array([0.0, x]) for x in (0.3, 0.8, -1.4, 3.0, 0.2, -0.6, 1.1)]
    u = ours.elastic_inverse_dynamics(*rates)
    tau_t = u.joint_torque[1] / ratio
    tau = u.motor_torque[1] / ratio
    assert u.joint_torque[0] == pytest.approx((ratio - 1) * tau_t + tau, rel=1e-12)


def test_momentum_is_conserved_with_spinning_rotors_on_a_floating_base() -> None:
    mechanism = replace(random_arm(5, floating=True), gravity=np.zeros(3))
    ours, rng = Robot(mechanism, rotor_drives(5, elastic=False), backend="numpy"), np.random.default_rng(5)
    q, v = ours.random(5), rng.normal(size=ours.nv)
    a = ours.forward_dynamics(q, v, np.r_[np.zeros(6), rng.normal(size=N) * 5])
    rate = derivative(lambda h: ours.momentum(ours.integrate(q, v, h), v + h * a))
    np.testing.assert_allclose(rate, 0, atol=1e-9 * np.abs(ours.momentum(q, v)).max())


def test_motor_power_is_the_rate_of_all_energy_with_spinning_rotors_behind_springs() -> None:
    mechanism = replace(random_arm(6, floating=True), gravity=np.zeros(3))
    ours, rng = Robot(mechanism, rotor_drives(6, elastic=True), backend="numpy"), np.random.default_rng(6)
    q, v, u = ours.random(6), rng.normal(size=ours.nv), rng.normal(size=N) * 20
    theta, theta_dot = q[-N:] + rng.normal(size=N) * 1e-2, rng.normal(size=N)
    a, theta_ddot = ours.elastic_forward_dynamics(q, v, theta, theta_dot, u)

    def later(h: float) -> tuple[np.ndarray, ...]:
        return ours.integrate(q, v, h), v + h * a, theta + h * theta_dot, theta_dot + h * theta_ddot

    def energy(h: float) -> np.ndarray:
        q, v, theta, theta_dot = later(h)
        return ours.kinetic_energy(q, v) + ours.elastic_energy(q, theta, theta_dot, v=v)

    def momentum(h: float) -> np.ndarray:
        q, v, _, theta_dot = later(h)
        return ours.momentum(q, v, theta_dot)

    assert derivative(energy) == pytest.approx(u @ theta_dot, rel=1e-9)
    np.testing.assert_allclose(derivative(momentum), 0, atol=1e-9 * np.abs(momentum(0.0)).max())


def test_energy_and_momentum_of_spinning_rotors_are_refused_without_the_speeds_they_take() -> None:
    ours, q = Robot(random_arm(0), rotor_drives(0, elastic=True)), np.zeros(N)
    with pytest.raises(InputError, match=r"elastic_energy: also give v=, the links' speeds: rotors with full coupling"):
        ours.elastic_energy(q, q, q)
    with pytest.raises(InputError, match=r"momentum: also give theta_dot=, the motors' speeds: rotors with full coup"):
        ours.momentum(q, q)


def test_speeds_that_no_rotor_needs_change_neither_energy_nor_momentum() -> None:
    drives = {n: replace(d, rotor=replace(d.rotor, coupling="reduced")) for n, d in rotor_drives(0, True).items()}
    ours, (q, v, theta, w) = Robot(random_arm(0), drives), np.random.default_rng(0).normal(size=(4, N))
    assert ours.elastic_energy(q, theta, w, v=v) == ours.elastic_energy(q, theta, w)
    np.testing.assert_array_equal(ours.momentum(q, v, w), ours.momentum(q, v))


@pytest.mark.parametrize("coupling", ["reduced", "full"])
@pytest.mark.parametrize("elastic", [False, True])
def test_inertial_parameters_hold_the_rotors_that_no_link_holds(coupling: str, elastic: bool) -> None:
    """What Y p lacks of the inverse dynamics is what rotors without mass, on links without mass, cost."""
    drives = {n: replace(d, rotor=replace(d.rotor, coupling=coupling)) for n, d in rotor_drives(7, elastic).items()}
    mechanism = random_arm(7)
    bare = [replace(body, mass=0.0, com=np.zeros(3), inertia=np.zeros((3, 3))) for body in mechanism.bodies]
    held = {n: replace(d, rotor=replace(d.rotor, in_link_inertia=True)) for n, d in drives.items()}
    ours, spins = Robot(mechanism, drives), Robot(replace(mechanism, bodies=tuple(bare)), held)
    q, v, a = np.random.default_rng(7).normal(size=(3, N))
    told = ours.regressor(q, v, a) @ ours.inertial_parameters
    tau = ours.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(told + spins.inverse_dynamics(q, v, a), tau, rtol=1e-12, atol=1e-12 * np.abs(tau).max())
    carried = sum(d.rotor.mass for d in [*drives.values()][1:])  # the world carries the first
    mass = ours.inertial_parameters[::10].sum()
    assert mass == pytest.approx(carried + sum(body.mass for body in mechanism.bodies), rel=1e-14)


@pytest.mark.parametrize(("seed", "floating"), [(0, False), (1, True)])
def test_the_fastest_mode_is_that_of_links_and_rotors_together(seed, floating):
    """As fast as the linear model's fastest pole, which comes by derivatives of the accelerations."""
    ours = Robot(random_arm(seed, floating), rotor_drives(seed, elastic=True)).with_gravity([0.0, 0.0, 0.0])
    q = ours.random(seed)
    poles = np.linalg.eigvals(ours.linearize(q).A)
    assert fastest_mode(ours, [posture(ours, q)]).rate == pytest.approx(np.abs(poles).max(), rel=1e-9)
