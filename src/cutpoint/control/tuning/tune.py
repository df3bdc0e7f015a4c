"""Gains from bandwidth and damping, at a pose, checked on the sampled plant."""

from functools import partial
from inspect import signature
from typing import Any, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.control.laws.model_law import OF_LAWS
from cutpoint.control.laws.pd import PD
from cutpoint.control.sensors import Sensors
from cutpoint.control.tuning.design import Design, design_of
from cutpoint.control.tuning.holding import check_holds
from cutpoint.control.tuning.recipes import RECIPES
from cutpoint.door import check_kind, positive
from cutpoint.errors import InputError, unknown_name
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_all_driven, checked_pose

L = TypeVar("L")

OTHERS = (0.7, 0.5, 0.35, 0.25, 0.18, 0.12, 1.4, 2.0)
"""Of the bandwidth: others that are looked at to see whether they would hold."""


@overload
def tune(
    robot: Robot,
    bandwidth: float,
    *,
    damping: float = 0.7,
    q: ArrayLike | None = None,
    control_period: float = 1e-3,
    sensors: Sensors | None = None,
    **options: Any,
) -> PD: ...


@overload
def tune(
    robot: Robot,
    bandwidth: float,
    law: type[L],
    *,
    damping: float = 0.7,
    q: ArrayLike | None = None,
    control_period: float = 1e-3,
    sensors: Sensors | None = None,
    **options: Any,
) -> L: ...


def tune(
    robot: Robot,
    bandwidth: float,
    law: type[Any] = PD,
    *,
    damping: float = 0.7,
    q: ArrayLike | None = None,
    control_period: float = 1e-3,
    sensors: Sensors | None = None,
    **options: Any,
) -> Any:
    """A law that gives each joint, taken alone, this bandwidth (Hz); a second-order response for PD.

    law: the class of a feedback law, such as `VDC`.  control_period: s.
    Gains come from the inertia of links and rotors at q (nq,), neutral if not given.  damping: ratio, for PD, PID,
    ComputedTorque and FullStateFeedback, each joint alone; coupling between an arm's joints reduces it.
    FullStateFeedback is as stiff as PD; shaping the inertia makes it faster by sqrt(whole / reduced inertia).  Laws
    with v_r = v_d + Lambda (q_d - q) are critically damped, with Lambda = 2 pi bandwidth; adaptation rates leave them
    a damping of 0.5, see `learning_rates`.  ElasticComputedTorque has two poles there, and two at the spring's
    resonance, or as near as the control period allows, for undamped springs.  options go to the law.
    sensors: their delay and differenced speeds count in the stability check, not in the gains; perfect if not given.
    The check is of small motions about q: across the play of `Backlash` a law may still swing.  Simulate it.

    Warns:
        FragileWarning: the law holds the robot at q, but a loop amplifies disturbances more than ten times: a torque
            that is 11 % larger, or a lag of 6 degrees, may make it unstable.
    Raises:
        InputError: an argument is wrong, such as a law without a recipe or an option that the law lacks.  Or the gains
            are unstable at q: the linear plant with all its springs and motors, sampled every
            control_period (s), has a pole that grows faster than dry friction stops; the message names the joint, its
            frequency and remedies.  `SuperTwisting` is not tested.  Or a joint, such as a floating base, has no motor.
    """
    check_all_driven("tune", robot, OF_LAWS)
    check_kind("tune", "law", law, type, "a law's class, such as cutpoint.control.PD")
    bandwidth = positive("tune", "bandwidth", bandwidth, "Hz")
    damping, period = positive("tune", "damping", damping), positive("tune", "control_period", control_period, "s")
    if law not in RECIPES:
        raise unknown_name("law that can be tuned", law.__name__, [x.__name__ for x in RECIPES])
    pose = robot.neutral() if q is None else checked_pose("tune", robot, q)

    def made(hertz: float) -> Any:
        return _made(law, design_of(robot, pose, 2 * np.pi * hertz, damping, period), options)

    found = made(bandwidth)
    if not found.jumps_at_rest:
        others = ((share * bandwidth, partial(made, share * bandwidth)) for share in OTHERS)
        check_holds(robot, found, pose, period, sensors, others)
    return found


def _made(law: Any, w: Design, options: dict[str, Any]) -> Any:
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
        raise InputError(f"tune: {twice[0]} of {law.__name__} is determined by tune; leave it out", **options) from None
