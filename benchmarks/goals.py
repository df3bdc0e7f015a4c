"""Goals of each row against a peer, and results: the first table of docs/benchmarks.md."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from tables import NONE, Row, ratio, share, table

ROBOTS = ("UR10", "Panda")
PINOCCHIO, CASADI, MUJOCO = "Pinocchio", "CasADi", "MuJoCo"

WANTED: dict[tuple[str, str, str], tuple[float, float]] = {
    ("inverse dynamics", "single", PINOCCHIO): (10, 8), ("inverse dynamics", "lanes", PINOCCHIO): (75, 50),
    ("inverse dynamics", "rows", PINOCCHIO): (45, 30), ("inverse dynamics", "single", CASADI): (1.3, 1.3),
    ("inverse dynamics", "lanes", CASADI): (8, 8), ("inverse dynamics", "rows", CASADI): (5, 5),
    ("forward dynamics", "single", PINOCCHIO): (12, 7), ("forward dynamics", "lanes", PINOCCHIO): (65, 40),
    ("forward dynamics", "single", CASADI): (1.3, 1.05), ("forward dynamics", "lanes", CASADI): (6.5, 5.5),
    ("mass matrix", "single", PINOCCHIO): (4.5, 3.2), ("mass matrix", "lanes", PINOCCHIO): (15, 10),
    ("mass matrix", "single", CASADI): (1, 1),
    ("Jacobian", "single", PINOCCHIO): (4.5, 3.2), ("Jacobian", "lanes", PINOCCHIO): (15, 10),
    ("Jacobian", "single", CASADI): (1, 1),
    ("derivatives", "single", PINOCCHIO): (6, 4.5), ("derivatives", "lanes", PINOCCHIO): (25, 15),
    ("derivatives", "single", CASADI): (1.2, 1.2),
    ("regressor", "single", PINOCCHIO): (6, 5), ("regressor", "single", CASADI): (1.1, 1.1),
    ("elastic inverse dynamics", "single", PINOCCHIO): (12, 8),
    ("elastic inverse dynamics", "single", CASADI): (2, 1.6), ("elastic inverse dynamics", "lanes", CASADI): (10, 7),
}  # fmt: skip
"""Speedups by task, way of calling and peer, on either robot.  single: one call, without Python."""

SLIMMER = "16c16c5d"
"""The commit since which forward dynamics as loops keeps less of each body.  The next one also runs the simulations of
the paper's arm once before each is timed, and has chains of 2,000."""

_HEAD = """## Goals and results

{kept}

Ratios are of the minimum times, UR10 / Panda; CasADi is its code from the robot as the file describes it.  The sections
below show the times of the first processor; the notes below this table explain where the time goes for goals that were
missed.

"""

WHERE = """
* Inverse and forward dynamics, beside Pinocchio: the library in the wheel takes {wheel} times as long as the fastest
  of its builds here, which is the one that counts.
* Lanes: Intel's processors do additions in the same two units as multiply-adds; AMD's have two more units for
  additions, which in Zen 4 take half of a vector of 512 bits at a time.
* Zen 3: vectors hold half as many numbers, and there are half as many registers: in lanes inverse dynamics loads 1.2
  vectors an operation, elastic inverse dynamics puts a number aside for every third one.
* Inverse dynamics, lanes, on Zen 4: nearly every cycle starts a multiply-add (see their share); only fewer of them
  would take less time.
* Regressor: its matrices are stored number by number; rows of {regressor} numbers saturate the memory's stores before
  the arithmetic is done.
* Elastic inverse dynamics, one call: each number comes with two derivatives; much of what must be kept between the
  outward and inward recursions is moved from registers to memory and back.
* Chains: each body waits for the one before it.  Rotating a vector takes three operations one after another; forward
  dynamics processes inertias of 27 numbers three at a time, in some 190 operations per joint, a quarter of which only
  move numbers between registers, and the path from joint to joint is a quadratic form, a division and two more
  operations.  Chains of 10,000: what is kept of their bodies takes 3.2 MB in inverse dynamics, 5 MB in forward
  dynamics, which exceeds 2 MB of Intel's near caches; the far ones feed one core more slowly than AMD's.  Up to commit
  91cb0b79 it was 3.5 and 6 MB, up to {slimmer} 9.5 MB in forward dynamics; runs up to that one have no chain of 2,000.
* One call from Python, general: NumPy checks types, shapes and strides of each argument for the gufunc; the shortcut
  for plain arrays does not.
* Closed loop: steps are {steps} times as fast as CasADi's, and there are fewer of them; checks, arrays of
  references and the log are the rest.
* The paper's arm: what counts is the smallest number of steps with which all 384 scores are right to 1e-4 rad.  One
  step per period is off by 0.86e-4; in runs of commits before 9c151f6 it was by up to 1.01e-4, so that two are counted.
  Up to commit {slimmer} the first call was timed after others had emptied the caches, which makes a single run up to
  twice as long.
* Share of the memory's: where inverse dynamics in lanes takes longer than copying, arithmetic is the bottleneck.
* Share of the multiply-adds: additions and products without a partner count as one of the two operations that a core
  can do.
"""


class Goal(NamedTuple):
    what: str
    wanted: tuple[float, ...]
    reached: tuple[float | None, ...]
    as_share: bool = False

    @property
    def is_kept(self) -> bool:
        pairs = [(x, y) for x, y in zip(self.wanted, self.reached, strict=True) if y is not None]
        return bool(pairs) and all(y >= x for x, y in pairs)


def goals(results: dict[str, Any], others: Sequence[dict[str, Any]]) -> str:
    """Goals of this run, beside results on other processors."""
    machines = [x["machine"] for x in (results, *others)]
    runs = [_goals(x) for x in (results, *others)]
    rows = [
        Row((same[0].what,), [_shown(same[0], same[0].wanted), *(cell for goal in same for cell in _cells(goal))])
        for same in zip(*runs, strict=True)
    ]
    told = [
        f"* {sum(goal.is_kept for goal in run)} of {len(run)} goals: {of['processor']}, commit {of['commit']}"
        for of, run in zip(machines, runs, strict=True)
    ]
    head = _HEAD.format(kept="\n".join(told))
    steps = [x["a step"].get(CASADI, 0) / x["a step"]["cutpoint"] for x in results["closed loop"]]
    regressor = [f"{x['bytes out'] // 8}" for x in results["tasks"] if x["task"] == "regressor"]
    where = WHERE.format(steps=" and ".join(f"{x:.1f}" for x in steps), regressor=" and ".join(regressor),
                         wheel=_wheel(results["tasks"]), slimmer=SLIMMER)  # fmt: skip
    titles = [cell for of in machines for cell in (of["processor"], "kept")]
    return head + table(" | ".join(["goal", "wanted", *titles]), rows) + where


def _wheel(tasks: Sequence[dict[str, Any]]) -> str:
    """Of Pinocchio's own library, how many times as long as its quickest build takes."""
    builds = [x["times"].get(PINOCCHIO, {}).get("builds", {}) for x in tasks]
    found = [each["wheel"] / min(each.values()) for each in builds if "wheel" in each]
    return f"{min(found):.1f} to {max(found):.1f}" if found else NONE


def _goals(results: dict[str, Any]) -> list[Goal]:
    return [*_functions(results), *_chains(results), *_python(results), *_loops(results), *_limits(results)]


def _cells(goal: Goal) -> tuple[str, str]:
    return _shown(goal, goal.reached), "yes" if goal.is_kept else "no"


def _functions(results: dict[str, Any]) -> Iterator[Goal]:
    times = {(x["task"], x["robot"]): x["times"] for x in results["tasks"]}
    times |= {("elastic inverse dynamics", x["robot"]): x["times"] for x in results["elastic"]}
    for (task, way, peer), wanted in WANTED.items():
        reached = tuple(_ratio(times[task, robot], peer, way) for robot in ROBOTS)
        names = {"single": "one call", "lanes": "lanes", "rows": "rows"}
        yield Goal(f"{task}, {names[way]}, beside {peer}", wanted, reached)


def _chains(results: dict[str, Any]) -> Iterator[Goal]:
    for row in results["chains"]["long"]:
        reached = _ratio(row["times"], PINOCCHIO, "single")
        yield Goal(f"chain of 192, {row['task']}, beside {PINOCCHIO}", (5,), (reached,))
    of_a_joint = {x["joints"]: [x["times"][f"{f}_dynamics, single"]["least"] for f in ("inverse", "forward")]
                  for x in results["chains"]["joints"]}  # fmt: skip
    for most, longer in ((2000, 1.1), (10_000, 1.3)):
        worst = [max(times) for times in zip(*(x for n, x in of_a_joint.items() if 192 < n <= most), strict=True)]
        reached = tuple(short / long for short, long in zip(of_a_joint[192], worst, strict=True))
        told = f"chains up to {most:,}, speed per joint beside that of 192, inverse and forward dynamics"
        yield Goal(told, (1 / longer, 1 / longer), reached, as_share=True)


def _python(results: dict[str, Any]) -> Iterator[Goal]:
    times = {(x["task"], x["robot"]): x["times"] for x in results["from Python"]}
    for way, wanted, told in (("kernel", 3, "one call from Python"), ("general", 1 / 1.2, "the same, general path")):
        reached = tuple(_ratio(times["inverse dynamics", robot], PINOCCHIO, way) for robot in ROBOTS)
        yield Goal(f"{told}, beside {PINOCCHIO}'s", (wanted, wanted), reached)


def _loops(results: dict[str, Any]) -> Iterator[Goal]:
    speeds = {x["robot"]: x["speed"] for x in results["closed loop"]}
    for peer, wanted in ((CASADI, (1.7, 1.7)), (MUJOCO, (30, 20))):
        reached = tuple(
            speeds[robot]["cutpoint"]["best"] / speeds[robot][peer]["best"] if peer in speeds[robot] else None
            for robot in ROBOTS
        )
        yield Goal(f"closed loop without friction, beside {peer}", wanted, reached)
    true = [x for x in results["own arm"] if x["score_error"] < 1e-4]
    best = [max((x[way] for x in true), default=None) for way in ("alone", "many")]
    yield Goal("the paper's arm to 1e-4 rad, simulated seconds a second, alone and many", (550, 2500), tuple(best))


def _limits(results: dict[str, Any]) -> Iterator[Goal]:
    rows = {x["robot"]: x for x in results["tasks"] if x["task"] == "inverse dynamics"}
    peak = results["limits"]["flops"]
    flops = [rows[robot]["flops"] / (1e-9 * rows[robot]["times"]["lanes"]["least"]) / peak for robot in ROBOTS]
    yield Goal("share of the multiply-adds, inverse dynamics in lanes", (0.55, 0.55), tuple(flops), as_share=True)
    copies = {x["robot"]: x["bytes"] / x["seconds"]["lanes"] for x in results["from memory"]}
    reached = tuple(copies[robot] / results["limits"]["copy"] for robot in ROBOTS)
    yield Goal("share of the memory's, a million configurations", (0.7, 0.7), reached, as_share=True)
    stores = {x["robot"]: x for x in results["tasks"] if x["task"] == "regressor"}
    found = [
        stores[robot]["bytes out"] / (1e-9 * stores[robot]["times"]["lanes"]["least"]) / results["limits"]["store"]
        for robot in ROBOTS
    ]
    yield Goal("share of the stores, regressor in lanes", (0.7, 0.7), tuple(found), as_share=True)


def _ratio(times: Mapping[str, Any], peer: str, ours: str) -> float | None:
    return times[peer]["least"] / times[ours]["least"] if peer in times and ours in times else None


def _shown(goal: Goal, numbers: tuple[float | None, ...]) -> str:
    return " / ".join(NONE if x is None else share(x) if goal.as_share else ratio(x) for x in numbers)
