"""Which imperfection of the simulated stand-in matters: each alone, on a plant that is otherwise its model."""

from collections.abc import Mapping

import numpy as np

from cutpoint.arrays import Array
from cutpoint.reporting.page import Table, row
from cutpoint.studies.paper.imperfections import ALL, Imperfections
from cutpoint.studies.paper.stand_in import StandIn

SEEDS = range(10)

NO_FAULT = "none: the plant is the model"
RINGING = "encoders and delay together"

CASES: dict[str, Imperfections] = {
    NO_FAULT: Imperfections(),
    "masses, centroids, moments of inertia": ALL.only("mass", "centroid", "moment"),
    "stiffness": ALL.only("stiffness"),
    "friction: how much": ALL.only("friction"),
    "friction: on which side": ALL.only("motor_share"),
    "rotor inertia": ALL.only("rotor"),
    "kinematic error": ALL.only("kinematic"),
    "drive damping": ALL.only("damping"),
    "encoders": ALL.only("counts", "encoder_noise"),
    "delay": ALL.only("delay"),
    "torque ripple": ALL.only("ripple"),
    RINGING: ALL.only("counts", "encoder_noise", "delay"),
}

Alone = Mapping[str, Array]
"""By case: medians over the seeds of RMS position errors (deg) and compensation errors (N m), (2, joints)."""


def run_alone(stand_in: StandIn) -> Alone:
    return {name: _medians(stand_in, sizes) for name, sizes in CASES.items()}


def _medians(stand_in: StandIn, sizes: Imperfections) -> Array:
    runs = (stand_in.run(sizes, seed) for seed in (SEEDS if sizes.is_random else SEEDS[:1]))
    return np.median([[run.position_rms, run.torque_rms] for run in runs], axis=0)


def table(alone: Alone) -> Table:
    columns = ("", *(f"joint {k}: RMS {unit}" for k in (1, 2) for unit in ("[deg]", "[N m]")))
    return Table(
        "Table A4",
        "Simulated stand-in for the experiment: RMS errors with each imperfection alone, median of "
        f"{len(SEEDS)} seeds.",
        columns,
        tuple(row(name, errors.T, 4) for name, errors in alone.items()),
    )


def largest(alone: Alone) -> dict[str, tuple[str, float]]:
    """By error and joint: the single imperfection that makes most of it, and how much."""
    names = [name for name in alone if name not in (NO_FAULT, RINGING)]
    found = {}
    for i, error in enumerate(("position", "torque")):
        for joint in range(2):
            name = max(names, key=lambda name: alone[name][i, joint])
            found[f"{error} of joint {joint + 1}"] = name, float(alone[name][i, joint])
    return found
