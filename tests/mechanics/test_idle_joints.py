"""Joints that can move while nothing with inertia does: what divides by inertia names them, all else goes on."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import cutpoint
from cutpoint import Drive, LinearSpring, ModelError, Robot, Rotor, simulate
from cutpoint.control import tune
from cutpoint.model import Body, Joint, Link, Mechanism
from cutpoint.model.build import build
from cutpoint.model.pose import pose, roll_pitch_yaw
from robot_library import BACKENDS

TILTED = np.array([1.0, 2.0, 2.0]) / 3


def point_on_its_axis() -> Mechanism:
    """Rounding puts it a little beside."""
    shift = pose(roll_pitch_yaw(np.array([0.3, 0.2, 0.1])), np.ones(3))
    links = [Link("base"), Link("point", 2.0, 0.3 * TILTED)]
    return build("point", links, [Joint("spin", "continuous", "base", "point", shift, TILTED)])


def turns(*axes: np.ndarray, tip: Link) -> Mechanism:
    """Joints turn0, turn1, ... about axes through one point; all links but the last are without mass."""
    names = [f"link{k}" for k in range(len(axes))] + [tip.name]
    joints = [Joint(f"turn{k}", "revolute", names[k], names[k + 1], axis=axis) for k, axis in enumerate(axes)]
    return build("turns", [*map(Link, names[:-1]), tip], joints)


X, _, Z = np.eye(3)
STONE = Link("stone", 1.0, np.array([0.1, 0.2, 0.3]), 0.01 * np.eye(3))

IDLE = {
    "a point on a tilted axis": (point_on_its_axis(), r"joint 'spin' can move"),
    "a massless link between parallel axes": (
        turns(TILTED, TILTED, tip=STONE),
        r"joints 'turn0', 'turn1' can move against each other",
    ),
    "a floating point": (
        build("point", [Link("world"), Link("point", 1.0)], [Joint("free", "floating", "world", "point")]),
        r"joint 'free' can move",
    ),
}

DIVIDING = {
    "forward_dynamics": lambda r, q, z, u: r.forward_dynamics(q, z, z),
    "elastic_forward_dynamics": lambda r, q, z, u: r.elastic_forward_dynamics(q, z, u, u, u),
    "linearize": lambda r, q, z, u: r.linearize(q),
    "modes": lambda r, q, z, u: r.modes(q),
    "derivatives of forward_dynamics": lambda r, q, z, u: cutpoint.derivatives.forward_dynamics(r, q, z, z),
    "derivatives of elastic_forward_dynamics": lambda r, q, z, u: cutpoint.derivatives.elastic_forward_dynamics(
        r, q, z, u, u, u
    ),
}


@pytest.mark.parametrize("call", DIVIDING)
@pytest.mark.parametrize("name", IDLE)
def test_what_divides_by_inertia_names_the_joint_that_moves_none(name, call):
    mechanism, message = IDLE[name]
    idle = Robot(mechanism, backend="numpy")
    q, z, u = idle.neutral(), np.zeros(idle.nv), np.zeros(len(idle.joints))
    with pytest.raises(ModelError, match=f"{message} without moving any inertia.*rotor.*lock"):
        DIVIDING[call](idle, q, z, u)
    assert np.isfinite(idle.inverse_dynamics(q, z + 1.0, z + 1.0)).all()


def test_tuning_names_the_joint_that_moves_no_inertia():
    with pytest.raises(ModelError, match=r"joint 'spin' can move without moving any inertia"):
        tune(Robot(point_on_its_axis(), backend="numpy"), 2.0)


def test_a_rotor_is_not_more_than_the_link_that_is_said_to_hold_it():
    """Its carrier's inertia holds it unless the drive says otherwise: of the rest less than nothing would be left."""
    bodies = [
        Body(f"b{k}", Joint(f"j{k}", "revolute", "", f"b{k}"), k - 1, np.eye(4), 0.1, np.zeros(3), 0.02 * np.eye(3))
        for k in range(2)
    ]
    held = Drive(2.0, Rotor(0.5, coupling="full"), LinearSpring(1e4))
    beside = replace(held, rotor=Rotor(0.5, in_link_inertia=False, transverse=0.5, coupling="full"))
    arms = [Robot(Mechanism("two", tuple(bodies), {}), {"j1": drive}) for drive in (held, beside)]
    for call in (lambda arm: simulate(arm, duration=0.01), lambda arm: arm.modes(np.zeros(2))):
        with pytest.raises(ModelError, match=r"'j0' can move with no inertia .* in_link_inertia: false"):
            call(arms[0])
        call(arms[1])


def test_a_rotor_that_spins_freely_is_all_that_its_carrier_has():
    """It is no part of the carrier's inertia, so of that nothing is missing: there is none."""
    rotor = Rotor(1e-4, in_link_inertia=False, mass=0.1, transverse=1e-4, coupling="full")
    arm = Robot(turns(Z, Z, tip=STONE), {"turn1": Drive(50.0, rotor, LinearSpring(1e4))}, backend="numpy")
    with pytest.raises(ModelError, match=r"'turn1' can move against each other with no inertia .* beside rotors"):
        arm.elastic_forward_dynamics(np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2))


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_rotor_is_inertia_enough(backend):
    geared = Robot(point_on_its_axis(), {"spin": Drive(10.0, Rotor(1e-4))}, backend=backend)
    np.testing.assert_allclose(geared.forward_dynamics([0.0], [0.0], [0.5]), [50.0], rtol=1e-12)


def test_axes_that_only_happen_to_fall_together_are_no_defect():
    """A wrist whose middle joint is bent: its massless links are carried along with what has inertia."""
    wrist = Robot(turns(Z, X, Z, tip=STONE), backend="numpy")
    q, v, tau = np.array([0.3, 0.8, -0.4]), np.array([1.0, -2.0, 0.5]), np.array([0.2, 0.1, -0.3])
    a = wrist.forward_dynamics(q, v, tau)
    np.testing.assert_allclose(wrist.inverse_dynamics(q, v, a), tau, rtol=0, atol=1e-12)


def test_a_joint_with_next_to_no_inertia_is_no_defect():
    grain = Link("grain", 1e-12, np.array([1e-6, 0.0, 0.0]), 1e-24 * np.eye(3))
    spin = Joint("spin", "continuous", "base", "grain")
    robot = Robot(build("grain", [Link("base"), grain], [spin]), backend="numpy")
    np.testing.assert_allclose(robot.forward_dynamics([0.0], [0.0], [2e-24]), [1.0], rtol=1e-12)


@pytest.mark.parametrize("tip", ["point", "stone"])
def test_a_joint_of_a_large_robot_that_moves_nothing_is_named(tip):
    links = [Link("base"), *(replace(STONE, name=f"stone{k}") for k in range(249))]
    links.append(Link("tip", 1.0, 0.2 * Z) if tip == "point" else replace(STONE, name="tip"))
    pairs = pairwise(links)
    joints = [Joint(f"turn{k}", "continuous", a.name, b.name, axis=(X, Z)[k % 2]) for k, (a, b) in enumerate(pairs)]
    robot, still = Robot(build("chain", links, joints)), np.zeros(250)
    if tip == "point":
        with pytest.raises(ModelError, match=r"joint 'turn249' can move without moving any inertia"):
            robot.forward_dynamics(still, still, still)
    else:
        assert np.isfinite(robot.forward_dynamics(still, still, still)).all()
