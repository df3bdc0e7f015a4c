"""Table 4 with figures 10 and 11: PD on the motor's side, alone and with each rung of feedforward."""

import numpy as np

from cutpoint.control import Feedforward
from cutpoint.control.feedforward import RUNGS
from cutpoint.simulation import Log
from cutpoint.studies.paper.bench import KD, KP, PERIOD, Bench, pd
from cutpoint.studies.paper.loop_figures import by_rung, figure_10, figure_11, position_rms
from cutpoint.studies.paper.page import JOINTS, Page, Picture, Table, listed, row
from cutpoint.studies.paper.printed import TABLE_4_POSITION, TABLE_4_TORQUE

ALONE = "PD alone"
NAMES = {
    "gravity": "+ gravity",
    "rigid": "+ inertia, Coriolis (rigid)",
    "rotor": "+ rotors",
    "friction": "+ friction",
    "elastic": "+ elasticity",
}
WITHOUT_FRICTION = ("no friction: PD alone", "no friction: all rungs")


def page(bench: Bench) -> Page:
    logs = runs(bench)
    with_friction = {name: log for name, log in logs.items() if name not in WITHOUT_FRICTION}
    figures = (
        Picture("Figure 10", "Control torque and the feedforward in it, all rungs, at the joint's side.", figure_10(bench.elastic)),
        Picture("Figure 11", "What is left with all rungs: (a) position errors, (b) compensation errors, the part of the control torque "
                "that feedforward did not foresee.", figure_11(bench.elastic)),
        Picture("Figure A1", "Table 4 by rung; the paper's row, with unknown gains, at the right.", by_rung(with_friction)),
    )  # fmt: skip
    blocks = (*_setting(), *_tables(logs), *_readings(logs), *figures)
    return Page("table-4", "Closed loop: feedforward on the elastic arm", blocks, _results(logs, bench.elastic))


def runs(bench: Bench) -> dict[str, Log]:
    """Closed loops by row of the table."""
    robot, free = bench.robot, bench.frictionless
    logs = {ALONE: bench.pd_alone}
    for rung in RUNGS[:-1]:
        logs[NAMES[rung]] = bench.run(robot, pd() + Feedforward(robot, rung))
    logs[NAMES["elastic"]] = bench.elastic
    logs[WITHOUT_FRICTION[0]] = bench.run(free, pd())
    logs[WITHOUT_FRICTION[1]] = bench.run(free, pd() + Feedforward(free, "elastic"))
    return logs


def _setting() -> tuple[str, ...]:
    return (
        "Section IV.B drives the arm along (57) with the VD model as feedforward and PD control (58). The paper prints neither its gains, "
        "nor how it smoothed the friction, nor what plant it simulated. So its Table 4 cannot be reproduced; it is set beside one "
        f"stated loop: K_{{p}} = {listed(KP, 0)} N m/rad and K_{{d}} = {listed(KD, 0)} N m s/rad at the joint's side, on the motor's "
        f"encoder, every {1e3 * PERIOD:g} ms; every joint bends by law (2); the links bear the friction of Table 2, with sgn smoothed to "
        "tanh(velocity / 0.02 rad/s); motor friction is off, as the text says. None of this was fitted.",
        "Each rung of feedforward adds to the one before. The last makes the motor track q_{d} plus the drive's deflection; without "
        "it the motor tracks q_{d} itself. The compensation error is the feedback's share of the control torque.",
    )


def _tables(logs: dict[str, Log]) -> tuple[Table, ...]:
    columns = ("", *JOINTS)
    position = [row(name, position_rms(log), 4) for name, log in logs.items()]
    peak = [row(name, np.rad2deg(log.max("position_error")), 3) for name, log in logs.items()]
    torque = [row(name, log.rms("feedback_torque"), 4) for name, log in logs.items()]
    position.insert(0, row("the paper, Table 4", TABLE_4_POSITION, 4))
    peak.insert(0, ("the paper, fig. 11(a)", *["< 0.4"] * 6))
    torque.insert(0, row("the paper, Table 4", TABLE_4_TORQUE, 4))
    return (
        Table("Table 4a", "RMS position tracking errors, degrees.", columns, tuple(position), printed=(0,)),
        Table("Table 4b", "Peak position tracking errors, degrees.", columns, tuple(peak), printed=(0,)),
        Table("Table 4c", "RMS torque compensation errors, N m.", columns, tuple(torque), printed=(0,)),
    )


def _readings(logs: dict[str, Log]) -> tuple[str, ...]:
    alone, gravity, friction, elastic = (position_rms(logs[n]).max() for n in (ALONE, *(NAMES[r] for r in ("gravity", "friction", "elastic"))))
    return (
        f"Read down a column: gravity takes the worst joint from {alone:.3f}° to {gravity:.3f}°, inertia and rotors change little at this pace, "
        f"friction brings it to {friction:.3f}° and the motor's shifted reference to {elastic:.3f}°. Without friction the last rung leaves "
        f"{position_rms(logs[WITHOUT_FRICTION[1]]).max():.5f}°: what remains with friction is joints that stick and slip at start and stop, "
        "and the model itself leaves almost nothing. With friction on the link a single run depends on rounding at every slip, so these "
        "rows are to be compared by their size, not by their last digit.",
        "Beside the paper, joint by joint: " + " ".join(_beside(k, logs[NAMES["elastic"]]) for k in range(6)),
        "The printed torque error divided by the printed position error is the gain that the paper's loop would need if it were a plain "
        "spring; it differs from ours, and from joint to joint by two orders, which no stated setting explains.",
    )  # fmt: skip


def _beside(k: int, log: Log) -> str:
    """One sentence on one joint's difference."""
    position, torque = position_rms(log)[k], log.rms("feedback_torque")[k]
    implied = TABLE_4_TORQUE[k] / np.deg2rad(TABLE_4_POSITION[k])
    return (
        f"Joint {k + 1}: ours {position:.4f}° and {torque:.3f} N m, printed {TABLE_4_POSITION[k]:.4f}° and {TABLE_4_TORQUE[k]:.4f} N m, "
        f"{_times(position, TABLE_4_POSITION[k])} and {_times(torque, TABLE_4_TORQUE[k])}; the printed pair implies {implied:.0f} N m/rad "
        f"where ours has {KP[k]:.0f}."
    )


def _times(ours: float, printed: float) -> str:
    return f"{printed / ours:.1f} times smaller" if ours < printed else f"{ours / printed:.1f} times larger"


def _results(logs: dict[str, Log], elastic: Log) -> dict[str, dict[str, object]]:
    def measured(log: Log) -> dict[str, object]:
        return {
            "position_rms": position_rms(log),
            "position_peak": np.rad2deg(log.max("position_error")),
            "torque_rms": log.rms("feedback_torque"),
        }

    table = {
        "units": {"position": "deg", "torque": "N m"},
        "settings": {"kp": KP, "kd": KD, "side": "motor", "control_period": PERIOD, "friction": "Table 2, tanh(v / 0.02 rad/s)"},
        "paper": {"position_rms": TABLE_4_POSITION, "position_peak_below": 0.4, "torque_rms": TABLE_4_TORQUE},
        "ours": {name: measured(log) for name, log in logs.items()},
    }
    torques = {"unit": "N m", "control_peak": elastic.max("command_torque"), "feedforward_peak": elastic.max("feedforward_torque")}
    return {"table_4": table, "figure_10": torques, "figure_11": measured(elastic)}
