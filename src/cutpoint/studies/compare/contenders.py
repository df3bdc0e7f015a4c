"""The compared laws: each with a name, its requirements, and a constructor from model, gains and period."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

from cutpoint.control import (
    PD,
    PID,
    VDC,
    AdaptiveVDC,
    ComputedTorque,
    DisturbanceObserver,
    ElasticComputedTorque,
    Feedforward,
    FullStateFeedback,
    GravityCompensation,
    Robust,
    SlotineLi,
    SuperTwisting,
)
from cutpoint.control.tuning.design import Design
from cutpoint.control.tuning.recipes import RECIPES

OURS = ("vdc", "vdc_filter", "adaptive", "natural")
"""Keys of the laws that are virtual decomposition control."""

RATE, NATURAL_RATE, WHOLE_RATE = 30.0, 5.0, 10.0
"""Adaptation rates, 1/J: AdaptiveVDC by projection, bodies and joints alike; its bodies by the natural update;
Slotine-Li.  Chosen once, on the paper's arm, in the middle of what was tried: 10 to 100, 3 to 10, 1 to 30."""


class Contender(NamedTuple):
    """key: in results.  needs: sides of encoders; its model, and what else it asks for.  make: the law for these gains.

    smooth: what of it is differenced for its stiffness.
    """

    key: str
    name: str
    needs: str
    make: Callable[[Design], Any]
    smooth: Callable[[Any], Any] = lambda law: law


def _tuned(law: Any, **options: Any) -> Callable[[Design], Any]:
    return lambda w: RECIPES[law](w, **options)


def _pd(w: Design) -> PD:
    return RECIPES[PD](w)


def _forward(w: Design) -> Any:
    return _pd(w) + Feedforward(w.robot, "elastic")


def _without_jumps(law: SuperTwisting) -> SuperTwisting:
    return replace(law, root_gain=0.0, twist=0.0)


MOTOR, BOTH = "motor", "both"
"""Sides on which a law needs encoders."""

CONTENDERS: tuple[Contender, ...] = (
    Contender("pd", "PD", MOTOR, _pd),
    Contender("pid", "PID", MOTOR, _tuned(PID)),
    Contender(
        "gravity", "PD + gravity", f"{MOTOR}; masses", lambda w: _pd(w) + GravityCompensation(w.robot, side="motor")
    ),
    Contender("feedforward", "PD + feedforward", f"{MOTOR}; elastic", _forward),
    Contender("computed", "computed torque", f"{MOTOR}; rigid", _tuned(ComputedTorque)),
    Contender("slotine", "Slotine-Li", f"{MOTOR}; rigid, learns", _tuned(SlotineLi, rate=WHOLE_RATE)),
    Contender("robust", "robust", f"{MOTOR}; rigid, bound", _tuned(Robust)),
    Contender(
        "twisting", "super-twisting", f"{MOTOR}; rigid, bound", _tuned(SuperTwisting),
        _without_jumps,
    ),
    Contender(
        "observer", "observer on feedforward", f"{MOTOR}; elastic",
        lambda w: DisturbanceObserver(w.robot, _forward(w), w.omega * w.inertia),
    ),
    Contender("full_state", "full state feedback", f"{BOTH}; elastic", _tuned(FullStateFeedback)),
    Contender("linearised", "elastic computed torque", f"{BOTH}; elastic", _tuned(ElasticComputedTorque)),
    Contender("vdc", "VDC (model)", f"{BOTH}; elastic", _tuned(VDC)),
    Contender("vdc_filter", "VDC (filter)", f"{BOTH}; elastic", _tuned(VDC, derivatives="filter")),
    Contender(
        "adaptive", "adaptive VDC (projection)", f"{BOTH}; elastic, learns",
        _tuned(AdaptiveVDC, body_rate=RATE, joint_rate=RATE),
    ),
    Contender(
        "natural", "adaptive VDC (natural)", f"{BOTH}; elastic, learns",
        _tuned(AdaptiveVDC, update="natural", body_rate=NATURAL_RATE, joint_rate=RATE),
    ),
)  # fmt: skip
