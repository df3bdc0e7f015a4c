"""Sections of docs/benchmarks.md on chains, calls from Python, simulation and latency."""

from collections.abc import Sequence

from tables import NONE, Row, cells, plain, ratio, table, times_as_quick

_CHAINS = """## Long chains

192 revolute joints, no parameter zero; cutpoint uses loops over bodies and is called from Python, that call included;
Pinocchio C++ runs in loops of its own.

"""

_JOINTS = """
Nanoseconds per joint, cutpoint from Python: one configuration per call, and 64.

"""

_LARGE = """## Large robots

Unitree's G1 (29 joints) and PAL's Talos (44), with fixed pelvis, from the package example-robot-data, and the chain of
192 above.  cutpoint is called from Python, that call and its checks included, and chooses by itself between code with
and without loops; Pinocchio C++ runs in loops of its own.  Derivatives: d inverse dynamics / d (q, v, a); forward: d
forward dynamics / d (q, v, tau).

"""

_PYTHON = """## One call from Python

`robot.inverse_dynamics(...)` and similar methods, which check their arguments; the kernel behind it,
`robot.kernel("inverse_dynamics").call`; the same for arrays of any shape, `.general`; Pinocchio's and MuJoCo's Python
bindings, for MuJoCo `mj_inverse` and `mj_forward`.  Over 256 random states, a new one in each call.

"""

_LOOP = """## Closed loop with elastic joints

Simulated seconds per second, medians, best in brackets: drives of 1e4 N m/rad with rotors of 1 kg m2 at the joint,
without friction, a PD on the motors at 1 kHz that tracks sines of 0.5 rad, with the longest steps that keep every link
within 1e-4 rad.  All contenders use fourth-order steps of four stages, the peers Runge-Kutta and cutpoint its own,
which preserve the phase of springs; with short steps their results are {apart:.0e} rad apart.  The sines are known
beforehand.  cutpoint runs in `simulate`, including its checks and its log of positions; CasADi's forward dynamics runs
in a loop of C, which logs positions; MuJoCo runs with two hinges per joint, in a loop of C.

"""

_OWN_ARM = """
The paper's arm with flexspline and friction, PD and elastic feedforward, simulated seconds per second by `simulate`,
and by `simulate_many` for runs that differ in friction and noise and keep only the RMS error.  With stick-slip two runs
drift apart whatever the integrator does, but their scores do not: the last column is the error of the worst score,
compared with 200 steps per period.

"""

_LAWS = """## One step of a control law

On the paper's arm, with flexspline and friction: machine code for one call, and for many in one call; elementary
functions count as one operation.  Many are blocks of lanes, each with parameters of its own.  The curves of springs and
friction take about half the time of a law that inverts them.

"""

_STEPS = """## One integration step of an arm with drives

The paper's six joints with drives of its catalogue sizes, first each effect alone on linear elastic drives, then all
together: a step of four stages of the closed loop, with links, motors and the internal states of the drives.  Times are
the difference between runs with many and with few steps per control period, so that the controller and the call cancel.
States: numbers in the state of the plant.

"""

_STARTS = """## Starting

Seconds from the start of a process to its first result, each in a process of its own, Python's own start included: for
the first start, which has to compile machine code; for later starts, which find it on disk; and how much longer later
starts take than importing NumPy, by the minimum of each.  `cutpoint torque`, inverse dynamics: of a UR10; simulation:
of the paper's arm under PD and feedforward.  Two thirds of the time of `cutpoint torque` beyond NumPy on Zen 3 were
imports of the packages that read the command line, print tables and generate code: typer, rich and llvmlite.

"""

_LATENCY = """## Exported C, call by call

`{function}` of the paper's arm as C99 by {compiler}:
{calls:.0e} calls, each timed individually, minus the time of reading the clock; allocations are counted by wrapping the
allocator, stack use by painting the stack.

"""


def chains(found: dict[str, list[dict]]) -> str:
    rows, peers = [], ("Pinocchio", "Pinocchio, Python")
    for row in found["long"]:
        reached = times_as_quick(row["times"], "single", peers)
        rows.append(Row((row["task"],), [*cells(row["times"], ("single", "rows", *peers)), ratio(reached)]))
    head = "task | one call | 64 in one call, each | Pinocchio C++ | Pinocchio, Python | quickest peer / one call"
    long, names = table(head, rows), ("inverse_dynamics", "forward_dynamics")
    kinds = [f"{name}, {kind}" for name in names for kind in ("single", "rows")]
    joints = [Row((str(x["joints"]),), cells(x["times"], kinds)) for x in found["joints"]]
    head = "joints | inverse dynamics, one | 64 | forward dynamics, one | 64"
    return _CHAINS + long + _JOINTS + table(head, joints)


def large_robots(found: list[dict]) -> str:
    rows, peers = [], ("Pinocchio", "Pinocchio, Python")
    for row in found:
        reached = times_as_quick(row["times"], "single", peers)
        shown = [*cells(row["times"], ("single", "rows", *peers)), ratio(reached)]
        rows.append(Row((row["robot"], row["task"]), shown))
    head = "robot | task | one call | 64 in one call, each | Pinocchio C++ | Pinocchio, Python"
    return _LARGE + table(f"{head} | quickest peer / one call", rows)


def python_calls(found: list[dict]) -> str:
    rows, names = [], ("cutpoint", "kernel", "general", "Pinocchio", "MuJoCo")
    for row in found:
        reached = times_as_quick(row["times"], "cutpoint", names[3:])
        rows.append(Row((row["robot"], row["task"]), [*cells(row["times"], names), ratio(reached)]))
    head = "robot | task | cutpoint | its kernel | general | Pinocchio | MuJoCo | quickest peer / cutpoint"
    return _PYTHON + table(head, rows)


def closed_loop(found: list[dict], own_arm: list[dict]) -> str:
    names, rows, steps = ("cutpoint", "CasADi", "CasADi, lean", "MuJoCo"), [], []
    for row in found:
        speeds, peers = row["speed"], [x for x in row["speed"] if x != "cutpoint"]
        best = max((speeds[x]["best"] for x in peers), default=None)
        reached = None if best is None else speeds["cutpoint"]["best"] / best
        shown = [f"{x['median']:.0f} ({x['best']:.0f})" if (x := speeds.get(name)) else NONE for name in names]
        rows.append(Row((row["robot"],), [*shown, ratio(reached)]))
        told = [plain(row["a step"][name]) if name in row["a step"] else NONE for name in names]
        steps.append(Row((row["robot"],), [", ".join(str(row["substeps"].get(x, NONE)) for x in names), *told]))
    head = "robot | cutpoint | CasADi | CasADi, lean | MuJoCo | cutpoint / quickest peer"
    speed = table(head, rows)
    head = "robot | steps a period of each | cutpoint, ns a step | CasADi | CasADi, lean | MuJoCo"
    alone = f"\nAn integration step alone:\n\n{table(head, steps)}"
    own = [Row((str(x["substeps"]),), [f"{x['alone']:.0f}", f"{x['many']:.0f}", f"{x['score_error']:.0e}"])
           for x in own_arm]  # fmt: skip
    arm = table("steps a period | one run | 64 runs at once | scores off by, rad", own)
    apart = max(x for row in found for x in row["apart"].values())
    return _LOOP.format(apart=apart) + speed + alone + _OWN_ARM + arm


def steps(found: list[dict]) -> str:
    """The first row is what the others are measured by."""
    first = found[0]["nanoseconds"]
    rows = [Row((x["effect"],), [f"{x['nanoseconds']:.0f}", f"{x['nanoseconds'] / first:.2f}", str(x["states"])])
            for x in found]  # fmt: skip
    return _STEPS + table("effect | ns a step | times linear elastic | states", rows)


def laws(found: list[dict]) -> str:
    rows = [
        Row((x["law"],), [str(x["operations"]), *cells(x, ("single", "lanes"))])
        for x in found
    ]  # fmt: skip
    return _LAWS + table("law | operations | one call, ns | many, ns each", rows)


def starts(runs: Sequence[dict]) -> str:
    """Of all runs that have them.  The first row is what the others are beyond."""
    rows = [
        Row(
            (run["machine"]["processor"], x["start"]),
            [
                f"{x['first']:.2f}",
                f"{x['median']:.2f} ({x['least']:.2f})",
                f"{x['least'] - run['starts'][0]['least']:.2f}",
            ],
        )
        for run in runs
        if "starts" in run
        for x in run["starts"]
    ]
    return _STARTS + table("processor | process | first start | later | beyond NumPy", rows) if rows else ""


def latency(found: dict | None) -> str:
    if found is None:
        return ""
    rows = [
        Row((x["beside"],), [*(f"{x[key]} ns" for key in ("p50", "p99.99", "max")), str(x["allocations"]),
                             f"{x['stack']} bytes"])
        for x in found["runs"]
    ]  # fmt: skip
    return _LATENCY.format(**found) + table("core beside | p50 | p99.99 | longest | allocations | stack", rows)
