"""Gains from bandwidth and damping, at a pose, checked on the sampled plant."""

from collections.abc import Callable, Iterable
from functools import partial
from inspect import signature
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutpoint.control.adaptive_vdc import AdaptiveVDC
from cutpoint.control.computed_torque import ComputedTorque
from cutpoint.control.elastic_computed_torque import ElasticComputedTorque
from cutpoint.control.full_state_feedback import FullStateFeedback
from cutpoint.control.gains import motor_limits
from cutpoint.control.learning_rates import STROKE, SWING, body_rate, joint_rate
from cutpoint.control.model_law import check_all_driven
from cutpoint.control.pd import PD
from cutpoint.control.pid import PID
from cutpoint.control.robust import Robust
from cutpoint.control.sampled_loop import SampledPole, slowest_pole
from cutpoint.control.sensors import Sensors
from cutpoint.control.slotine_li import SlotineLi
from cutpoint.control.super_twisting import SuperTwisting
from cutpoint.control.vdc import VDC
from cutpoint.door import check_kind, checked_array, positive
from cutpoint.errors import InputError, unknown_name
from cutpoint.model.drive import Drive
from cutpoint.model.limits import limits_in_force
from cutpoint.robot import Robot, check_robot

Array = NDArray[np.float64]


INTEGRAL = 0.25
"""Of the natural frequency of PID's pair of poles: where its third pole lies."""

STOPPED = 1.0
"""Nepers a second: what grows more slowly is stopped by friction, which the linear plant lacks."""


CREEPING = 0.05
"""Hz: what would swing more slowly does not swing."""

SHORTER = 4
"""Times that a control period is shortened to see whether that would help."""

OTHERS = (0.7, 0.5, 0.35, 0.25, 0.18, 0.12, 1.4, 2.0)
"""Of the bandwidth: others that are looked at to see whether they would hold."""

CHANGES = {"width": "wider", "rate": "lower", "body_rate": "lower", "joint_rate": "lower", "shaping": "nearer to 1"}
"""What may help of what only some laws have."""

LIGHT = 0.05
"""Of a link's inertia at its joint: few rotors have less, with their motors."""


class Wanted(NamedTuple):
    """Inputs of gain design: the robot; its pose q; inertia of links and of elastic drives' rotors at each joint,
    kg m2; gravity torques, N m; bandwidth omega, rad/s; damping ratio; control period, s."""

    robot: Robot
    q: Array
    link: Array
    rotor: Array
    weight: Array
    omega: float
    damping: float
    period: float

    @property
    def whole(self) -> Array:
        return self.link + self.rotor

    @property
    def stiffness(self) -> Array:
        return self.whole * self.omega**2


def _pd(w: Wanted, **options: Any) -> PD:
    return PD(w.stiffness, 2 * w.damping * w.omega * w.whole, **options)


def _pid(w: Wanted, **options: Any) -> PID:
    """Poles of (s^2 + 2 zeta u s + u^2) (s + INTEGRAL u), with u below omega such that kp equals that of PD."""
    u = w.omega / np.sqrt(1 + 2 * w.damping * INTEGRAL)
    ki, kd = INTEGRAL * u**3 * w.whole, (2 * w.damping + INTEGRAL) * u * w.whole
    return PID(w.stiffness, ki, kd, **{"limit": motor_limits(w.robot), **options})


def _vdc(w: Wanted, law: Any, **options: Any) -> Any:
    """A spring gain above the position gain, by more if a filter differentiates, so that link speed feedback damps."""
    filtered = law is AdaptiveVDC or options.get("derivatives") == "filter"
    motor = np.where(w.rotor > 0, 2 * w.omega * w.rotor, 0.0)
    return law(w.robot, w.omega, w.omega * w.link, motor, (8 if filtered else 4) * w.omega, **options)


def _adaptive_vdc(w: Wanted, **options: Any) -> AdaptiveVDC:
    rates = {
        "body_rate": body_rate(w.robot, w.q, w.whole, w.omega, natural=options.get("update") == "natural"),
        "joint_rate": joint_rate(w.robot, w.q, w.whole, w.omega, 8 * w.omega),
    }
    return _vdc(w, AdaptiveVDC, **{**rates, **options})


def _slotine_li(w: Wanted, **options: Any) -> SlotineLi:
    rate = body_rate(w.robot, w.q, w.whole, w.omega)
    return SlotineLi(w.robot, w.omega, w.omega * w.whole, **{"rate": rate, **options})


def _robust(w: Wanted, **options: Any) -> Robust:
    """Within its width the bounded term adds the damping bound / width, here at most the speed gain."""
    bound, speed_gain = options.get("bound", _missed(w)), w.omega * w.whole
    width = np.maximum(0.05, bound / speed_gain)
    return Robust(w.robot, w.omega, speed_gain, **{"bound": bound, "width": width, **options})


def _full_state(w: Wanted, **options: Any) -> FullStateFeedback:
    """Damping for the reduced inertia, which the same stiffness accelerates faster."""
    left = w.link + np.where(w.rotor > 0.0, options.get("shaping", 0.5), 1.0) * w.rotor
    damping = 2 * w.damping * w.omega * np.sqrt(w.whole * left)
    return FullStateFeedback(w.robot, w.stiffness, damping, **{"lead": w.period, **options})


RECIPES: dict[Any, Callable[..., Any]] = {
    PD: _pd,
    PID: _pid,
    ComputedTorque: lambda w, **o: ComputedTorque(w.robot, w.omega**2, 2 * w.damping * w.omega, **o),
    ElasticComputedTorque: lambda w, **o: ElasticComputedTorque(w.robot, 2 * w.omega, **o),
    FullStateFeedback: _full_state,
    VDC: lambda w, **o: _vdc(w, VDC, **o),
    AdaptiveVDC: _adaptive_vdc,
    SlotineLi: _slotine_li,
    Robust: _robust,
    SuperTwisting: lambda w, **o: SuperTwisting(
        w.robot, w.omega, w.omega * w.whole, **{"root_gain": _missed(w), "twist": w.omega * _missed(w), **o}
    ),
}


def tune(
    robot: Robot,
    bandwidth: float,
    law: Any = PD,
    *,
    damping: float = 0.7,
    q: ArrayLike | None = None,
    control_period: float = 1e-3,
    sensors: Sensors | None = None,
    **options: Any,
) -> Any:
    """A law that gives each joint, taken alone, this bandwidth (Hz); a second-order response for PD.

    Gains come from the inertia of links and rotors at q (neutral if not given).  damping: ratio, for PD, PID,
    ComputedTorque and FullStateFeedback, each joint alone; coupling between an arm's joints reduces it.
    FullStateFeedback is as stiff as PD; shaping the inertia makes it faster by sqrt(whole / reduced inertia).  Laws
    with v_r = v_d + Lambda (q_d - q) are critically damped, with Lambda = 2 pi bandwidth; adaptation rates leave them
    a damping of 0.5, see `control.learning_rates`.  ElasticComputedTorque has four equal poles at twice that, for
    undamped springs and in the limit of short periods.  options go to the law.
    sensors: their delay and differenced speeds count in the stability check, not in the gains; perfect if not given.

    Raises:
        InputError: the gains are unstable at q: the linear plant with all its springs and motors, sampled every
            control_period (s), has a growing pole; the message names the joint, its frequency and remedies.  A law
            that is discontinuous at rest is not tested.  Or a joint, such as a floating base, has no motor.
    """
    names = [x.__name__ for x in RECIPES]
    check_robot("tune", robot)
    check_kind("tune", "law", law, type, "a law's class, such as cutpoint.control.PD")
    bandwidth = positive("tune", "bandwidth", bandwidth, "Hz")
    damping, period = positive("tune", "damping", damping), positive("tune", "control_period", control_period, "s")
    if law not in RECIPES:
        raise unknown_name("law that can be tuned", law.__name__, names)
    check_all_driven("tune", robot)
    pose = robot.neutral() if q is None else checked_array("tune", "q", q, robot.nq)
    if pose.ndim != 1:
        raise InputError(f"tune: q has shape {pose.shape}, it must be one pose, ({robot.nq},)", q=q)

    def made(hertz: float) -> Any:
        return _made(law, wanted(robot, pose, 2 * np.pi * hertz, damping, period), options)

    found = made(bandwidth)
    if law is not SuperTwisting:
        others = ((share * bandwidth, partial(made, share * bandwidth)) for share in OTHERS)
        check_holds(robot, found, pose, period, sensors, others)
    return found


def _made(law: Any, w: Wanted, options: dict[str, Any]) -> Any:
    known = [*signature(law).parameters]
    for name in options:
        if name not in known:
            raise unknown_name(f"option of {law.__name__}", name, known)
    try:
        return RECIPES[law](w, **options)
    except TypeError as error:
        twice = [name for name in options if f"multiple values for argument {name!r}" in str(error)]
        if not twice:
            raise
        raise InputError(f"tune: {twice[0]} of {law.__name__} is what tune finds; leave it out", **options) from None


def check_holds(
    robot: Robot,
    law: Any,
    q: Array,
    period: float,
    sensors: Sensors | None = None,
    others: Iterable[tuple[float, Callable[[], Any]]] = (),
) -> None:
    """Raises InputError if the law cannot hold the robot at q when it acts every period (s): see `slowest_pole`.

    If all drives have friction, poles that grow more slowly than STOPPED are left to it.
    others: bandwidths, Hz, and a function that makes a law of each, to search for a remedy.
    """
    worst = slowest_pole(robot, law, q, period, sensors=sensors)
    if _is_held(robot, worst, period):
        return

    def would_hold(law: Any, period: float) -> bool:
        try:
            return _is_held(robot, slowest_pole(robot, law, q, period, sensors=sensors), period)
        except InputError:  # the period is shorter than a motor's delay
            return False

    growth = np.log(worst.size) / period
    moves = f"swing at {worst.frequency:.1f} Hz" if worst.frequency > CREEPING else "run away"
    what = f"{worst.joint!r} would {moves} and grow by {growth:.3g} nepers a second"
    better = next((f"{hertz:.3g} Hz" for hertz, make in others if would_hold(make(), period)), "")
    remedies = [f"a bandwidth of {better} holds" if better else "ask for another bandwidth"]
    if would_hold(law, period / SHORTER):
        remedies.append(f"a control_period of {period / SHORTER:.3g} s holds")
    if any(drive.is_elastic and not drive.damping for drive in robot.drives.values()):
        remedies.append("give the springs damping")
    remedies += [f"make {name}= {change}" for name, change in CHANGES.items() if hasattr(law, name)]
    remedies += _light_rotor(robot, q, worst.joint)
    told = "; ".join([f"{type(law).__name__} does not hold at this pose: {what}", *remedies])
    raise InputError(told, joint=worst.joint, pole=worst)


def _light_rotor(robot: Robot, q: Array, joint: str) -> list[str]:
    """A remedy if the joint's rotor inertia is nearly zero, like that of a gear without its motor."""
    k = robot.joints.index(joint)
    found = wanted(robot, q, 1.0, 1.0, 1.0)
    if not 0 < found.rotor[k] < LIGHT * found.link[k]:
        return []
    felt = f"{joint!r} has a rotor of {found.rotor[k]:.2g} kg m2 at the joint, under {found.link[k]:.2g} of the link"
    return [f"{felt}: a catalogue gear's is without its motor, whose inertia belongs into it"]


def _is_held(robot: Robot, pole: SampledPole, period: float) -> bool:
    """Whether the pole decays, or grows so slowly that friction stops it."""
    rubs = all(drive.link_friction or drive.motor_friction for drive in robot.drives.values())
    return pole.size <= 1 + 1e-9 or np.log(pole.size) / period <= STOPPED * rubs


def wanted(robot: Robot, q: Array, omega: float, damping: float, period: float) -> Wanted:
    """Inputs of gain design: omega, rad/s; damping, a ratio; period, s."""
    driven = robot.machine.drives
    M, weight = robot.mass_matrix(q), robot.gravity_forces(q)
    link = np.array([M[d.v, d.v] for d in driven])
    rotor = np.array([d.drive.reflected_inertia if d.drive.is_elastic else 0.0 for d in driven])
    return Wanted(robot, q, link, rotor, np.array([weight[d.v] for d in driven]), omega, damping, period)


def _missed(w: Wanted) -> Array:
    """Assumed model error, N m: a tenth of the gravity torque of joints of a kind, and half of the friction."""
    sliding = w.robot.mechanism.sliding
    slides = np.array([name in sliding for name in w.robot.drives], bool)
    weight: Array = np.zeros(len(w.whole))
    for kind in (slides, ~slides):
        weight[kind] = np.abs(w.weight[kind]).max(initial=0.0) * w.whole[kind] / w.whole[kind].max(initial=1e-12)
    fastest = [limits.velocity for limits in limits_in_force(w.robot.mechanism, w.robot.drives).values()]
    speeds = np.minimum(w.omega * np.where(slides, STROKE, SWING), fastest)
    friction = [_friction(drive, v) for drive, v in zip(w.robot.drives.values(), speeds, strict=True)]
    return 0.1 * weight + 0.5 * np.array(friction) + 1e-3


def _friction(drive: Drive, speed: float) -> float:
    """Friction on both sides, N m at the joint."""
    laws = [law for law in (drive.link_friction, drive.motor_friction) if law is not None]
    return sum(abs(float(law.torque(speed))) for law in laws)
