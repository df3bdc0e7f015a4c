"""The comparison as a report."""

from collections.abc import Sequence

import numpy as np

from cutpoint.arrays import Array
from cutpoint.reporting.page import Page, Picture, listed
from cutpoint.studies.compare import figures
from cutpoint.studies.compare.bench import FAST, USUAL, Bench, overtaxed
from cutpoint.studies.compare.contenders import NATURAL_RATE, RATE, WHOLE_RATE
from cutpoint.studies.compare.findings import findings
from cutpoint.studies.compare.results import Results
from cutpoint.studies.compare.scenarios import LINK_STEP, MOTOR_STEP, NOISE, SCENARIOS, TURN
from cutpoint.studies.compare.tables import error_tables, further_tables, numbers, refusals, tuning_table


def pages_of(bench: Bench, results: Results, seeds: int) -> list[Page]:
    return [_tuning(bench, results), _errors(bench, results, seeds), _further(results)]


def _tuning(bench: Bench, results: Results) -> Page:
    method = (
        f"Every law is tuned at home as `control.tune` has it, with damping 1, and its bandwidth sought at which its "
        f"stiffness is that of a PD of {bench.bandwidth:g} Hz: by how much a joint's own torque answers when its link "
        "and its motor are moved together, the law's memory standing still; in the geometric mean over the joints. "
        "Springs stay wound as they are in this, so what laws feed back of their torque does not count. "
        "Joints may differ from it, and damping may: Table K1 shows by how much. Torque limits are the robot's, the "
        f"same for all. Bodies and joints of adaptive VDC learn at {RATE:g}/J by projection, bodies at "
        f"{NATURAL_RATE:g}/J by the natural update, Slotine-Li at {WHOLE_RATE:g}/J. What of super-twisting jumps at "
        "rest has no stiffness and comes on top of its linear part, which is matched."
    )
    blocks = (method, tuning_table(results), *refusals(results))
    if results.nanoseconds:
        caption = (
            "A step of each law, one call from Python on one core, on a logarithmic axis; virtual decomposition in the "
            "other colour."
        )
        blocks = (*blocks, Picture("Figure K3", caption, figures.step_bars(results)))
    return Page("tuning", "Equal stiffness", blocks)


def _errors(bench: Bench, results: Results, seeds: int) -> Page:
    if not results.outcomes:
        return Page("errors", "Errors by law and scenario", ("No scenario was run.",), {"comparison": numbers(results)})
    stood = f"The robot is {bench.robot.name}. {_move(bench)} {_scenarios(results, seeds)}"
    if bench.robot.strain_names:
        stood += " The plant has hysteresis or bristles throughout; of the laws only the feedforward follows them."
    heat = (
        "Worst RMS error of the links, 10^{−3} degrees, by law and scenario; shaded by how many times the best of the "
        f"column, which is bold; {figures.WORST:g} times or a run that diverged (∞) is darkest. Virtual decomposition "
        "is named in the other colour; * marks laws that do not hold at equal stiffness and are not ranked."
    )
    bar = "The same errors of some scenarios as bars, on logarithmic axes."
    pictures = (
        Picture("Figure K1", heat, figures.heat_map(results)),
        Picture("Figure K2", bar, figures.bars(results)),
    )
    blocks = (stood, _sizes(bench), *findings(results), *pictures, *error_tables(results))
    return Page("errors", "Errors by law and scenario", blocks, {"comparison": numbers(results)})


def _further(results: Results) -> Page:
    words = (
        "The ideal torques are those of the elastic inverse dynamics of the plant along the reference; what a drive "
        "remembers, and waves that the model lacks, are not in them. What a motor's torque is off it is feedback, "
        "mistakes of the model, and chatter."
    )
    return Page("further", "Peaks and torques", (words, *further_tables(results)))


def _move(bench: Bench) -> str:
    way = f"from {listed(np.rad2deg(bench.home), 0)} to {listed(np.rad2deg(bench.goal), 0)} degrees"
    return (
        f"It moves {way} on a cycloid and back, {USUAL:g} s each way where nothing else is said, under a control "
        f"period of {1e3 * bench.control_period:g} ms. The rated payload is {bench.payload:g} kg at {bench.frame!r}."
    )


def _scenarios(results: Results, seeds: int) -> str:
    told = "; ".join(f"{s.name}: {s.what}" for s in SCENARIOS if s.key in results.outcomes)
    runs = "is 1 run" if seeds == 1 else f"are {seeds} runs, and the worst counts"
    return (
        f"Each scenario departs from the first in one thing. {told}. Gains stay as they are; what is wrong is the "
        f"model inside the law. Where chance has a part there {runs}. Errors are RMS over time and all joints together."
    )


def _sizes(bench: Bench) -> str:
    few = overtaxed(bench)
    small = f", and may not repeat what is needed at {', '.join(few)}" if few else ""
    return (
        f"Encoders have {TURN / LINK_STEP:.0f} steps a turn at the link and {TURN / MOTOR_STEP:.0f} at the motor, and "
        f"noise of {NOISE:g} rad, at the joint's side. Gears of the whole drives are of the catalogue{small}; "
        f"kinematic error, ripple and cogging stand at phases of chance. The fast move takes {FAST:g} s. "
        f"{_torque_limits(bench.robot.effort_limits)}."
    )


def _torque_limits(limits: Array) -> str:
    is_stated = np.isfinite(limits)
    if not is_stated.any():
        return "The robot states no limits of torques"
    return f"Torques are limited to {listed(limits, 0)} N m" if is_stated.all() else "Not all limits are stated"


def summary(results: Results, done: Sequence[int]) -> tuple[str, ...]:
    """What stands above the pages; done: how many pairs of law and scenario were run, of how many."""
    words = "All control laws of the package on one plant, at equal stiffness, each departure from the model alone."
    if results.complete:
        return (words,)
    return (words, f"INCOMPLETE: interrupted after {done[0]} of {done[1]} pairs of law and scenario.")
