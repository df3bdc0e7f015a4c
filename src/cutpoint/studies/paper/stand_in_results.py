"""The simulated stand-in in numbers, for the JSON file."""

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from cutpoint.arrays import Array
from cutpoint.studies.paper.bench import PERIOD
from cutpoint.studies.paper.imperfections import ALL, ORDERS, UNITS
from cutpoint.studies.paper.imperfections_alone import SEEDS, Alone
from cutpoint.studies.paper.printed import DURATION_5, GOAL_5, TABLE_5_PEAK, TABLE_5_POSITION, TABLE_5_TORQUE
from cutpoint.studies.paper.stand_in import KD, KP, Run, StandIn

Results = dict[str, dict[str, object]]

_NAMED = {"simulated_stand_in": True, "units": {"position": "deg", "torque": "N m", "time": "s"}}


def measured(runs: Sequence[Run]) -> dict[str, Array]:
    """By run and joint, (runs, 2): degrees and N m."""
    return {
        "position_rms": np.array([run.position_rms for run in runs]),
        "position_peak": np.array([run.position_peak for run in runs]),
        "torque_rms": np.array([run.torque_rms for run in runs]),
    }


def pose_samples(time: Array) -> list[int]:
    """Indices of the start, the middle and the end."""
    return [0, len(time) // 2, len(time) - 1]


def results(stand_in: StandIn, runs: Sequence[Run], alone: Alone, shown: int) -> Results:
    """By table and figure; runs by their seeds 0, 1 ..., one of which the figures show."""
    run, samples = runs[shown], pose_samples(stand_in.time)
    found = {
        "table_5": _table_5(runs),
        "table_a4": {"seeds": [*SEEDS], "alone": {name: _pair(errors) for name, errors in alone.items()}},
        "figure_12": {"seed": shown, "time": stand_in.time[samples], "poses": np.rad2deg(run.q[samples])},
        "figure_13": {"seed": shown, "position_rms": run.position_rms, "position_peak": run.position_peak},
        "figure_14": {"seed": shown, "torque_rms": run.torque_rms, "control_peak": np.abs(run.control).max(axis=0)},
    }
    return {key: {**_NAMED, **values} for key, values in found.items()}


def _table_5(runs: Sequence[Run]) -> dict[str, object]:
    found = measured(runs)
    return {
        "settings": _settings(len(runs)),
        "paper": {
            "position_rms": TABLE_5_POSITION,
            "position_peak_at_most": TABLE_5_PEAK,
            "torque_rms": TABLE_5_TORQUE,
        },
        "by_seed": found,
        "median": {name: np.median(values, axis=0) for name, values in found.items()},
        "lowest": {name: values.min(axis=0) for name, values in found.items()},
        "highest": {name: values.max(axis=0) for name, values in found.items()},
    }


def _settings(seeds: int) -> dict[str, object]:
    return {
        "goal": np.rad2deg(GOAL_5).round(9), "duration": DURATION_5, "locked": "joints 3 to 6 at zero", "kp": KP,
        "kd": KD, "side": "motor", "control_period": PERIOD, "imperfections": asdict(ALL), "imperfection_units": UNITS,
        "ripple_orders": ORDERS, "seeds": [*range(seeds)],
    }  # fmt: skip


def _pair(errors: Array) -> dict[str, Array]:
    return {"position_rms": errors[0], "torque_rms": errors[1]}
