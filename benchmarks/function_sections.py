"""Sections of docs/benchmarks.md on a robot's functions, from their parts of the results."""

from collections.abc import Sequence

from tables import Row, cells, ratio, share, table, times_as_quick

KDL = "Orocos KDL"
PEERS = ("Pinocchio", "MuJoCo", KDL, "CasADi", "CasADi, lean")

_RATIO = "quickest peer / cutpoint"

_ONE_CALL = """## One call, without Python

One row after another in a loop of machine code or C: cutpoint's machine code; the C that it exports, compiled by gcc.
Jacobian: of the flange, along the world's axes.  Derivatives: of inverse dynamics with respect to q, v and a; forward
derivatives: of forward dynamics with respect to q, v and torques.  Regressor: of joint torques.

"""

_KDL = """
## Beside Orocos KDL

The same calls, its time / cutpoint's, from the runs where it was installed.

"""

_BATCH = """
## Many in one call

As many configurations as fit in 1 MB, inputs and outputs together.  Rows are NumPy arrays of rows; lanes are blocks
that the caller keeps in that layout.  Shares are for lanes: of the multiply-adds that one core can do, where sines and
cosines count as the operations that they are made of, and of what it can store.

"""

_ELASTIC = """## Elastic inverse dynamics

Motor torques for a motion with four derivatives, linear springs, reduced rotor coupling; cutpoint reads the drives'
parameters as an input, CasADi has them compiled in as constants.  No peer offers this directly.  For Pinocchio,
torque'' is computed by finite differences along the motion, the cheapest ones that keep motor torques to
{accuracy}; CasADi differentiates the same recursion as above.

"""

_PARAMETERS = """## Inertial parameters as inputs

Inverse dynamics with all ten parameters of each body as an input, in the bodies' own frames, compared with the kernel
that has them compiled in as constants ("folded"), with frames and parameters chosen where they cost least.

"""

_JAX = """## In JAX

`kernel.to_jax()` under `jit` and `vmap`, on the CPU, from JAX arrays to JAX arrays, compared with rows of NumPy arrays.

"""

_MEMORY = """## A million configurations

Inverse dynamics, from and to memory; the share is the time for copying as many bytes, divided by the time taken.

"""


def functions(results: dict, others: Sequence[dict]) -> str:
    tasks = results["tasks"]
    head = f"robot | task | cutpoint | its C, gcc | Pinocchio C++ | MuJoCo C | CasADi | CasADi, lean | {_RATIO}"
    one = table(head, [_one_call(task) for task in tasks])
    head = "robot | task | rows | lanes | Pinocchio C++ | CasADi | quickest peer / rows | / lanes | of peak | of stores"
    many = table(head, [_batch(task, results["limits"]) for task in tasks])
    return _ONE_CALL + one + _beside_kdl([results, *others]) + _BATCH + many


def _one_call(task: dict) -> Row:
    reached = times_as_quick(task["times"], "single", PEERS)
    shown = cells(task["times"], ("single", "C99", "Pinocchio", "MuJoCo", "CasADi", "CasADi, lean"))
    return Row((task["robot"], task["task"]), [*shown, ratio(reached)])


def _beside_kdl(runs: Sequence[dict]) -> str:
    """Empty where none had it."""
    found = [x for x in runs if KDL in x["machine"]["versions"]]
    if not found:
        return ""
    rows = [
        Row((same[0]["robot"], same[0]["task"]), [ratio(times_as_quick(x["times"], "single", (KDL,))) for x in same])
        for same in zip(*(x["tasks"] for x in found), strict=True)
        if KDL in same[0]["times"]
    ]
    head = ["robot | task", *(f"{x['machine']['processor']}, version {x['machine']['versions'][KDL]}" for x in found)]
    return _KDL + table(" | ".join(head), rows)


def _batch(task: dict, limits: dict) -> Row:
    times = task["times"]
    shown = cells(times, ("rows", "lanes", "Pinocchio"))
    casadi = cells(times, [min((x for x in times if "CasADi" in x), key=lambda x: times[x]["least"], default="CasADi")])
    reached = {kind: times_as_quick(times, kind, PEERS) for kind in ("rows", "lanes")}
    seconds = 1e-9 * times["lanes"]["least"]
    shares = [share(task["flops"] / seconds / limits["flops"]), share(task["bytes out"] / seconds / limits["store"])]
    ratios = [ratio(x) for x in reached.values()]
    return Row((task["robot"], task["task"]), [*shown, *casadi, *ratios, *shares])


def elastic(rows: list[dict]) -> str:
    head = f"robot | cutpoint | its C, gcc | rows | lanes | Pinocchio C++ | CasADi | CasADi, lean | {_RATIO}"
    names, found, ways = ("single", "C99", "rows", "lanes", "Pinocchio", "CasADi", "CasADi, lean"), [], []
    for row in rows:
        reached = times_as_quick(row["times"], "single", PEERS)
        found.append(Row((row["robot"],), [*cells(row["times"], names), ratio(reached)]))
        ways += [f"{row['robot']}: {row['times']['Pinocchio']['build']}"] if "Pinocchio" in row["times"] else []
    told = f"\nPinocchio on {'; on '.join(ways)}.\n" if ways else ""
    return _ELASTIC.format(accuracy=f"{rows[0]['allowed']:.0e} of the largest") + table(head, found) + told


def parameters(rows: list[dict]) -> str:
    head, found = "robot | parameters | cutpoint | its C, gcc | rows | lanes", []
    for row in rows:
        for kind in ("folded", "inputs"):
            names = [f"{kind}, {way}" for way in ("single", "C99", "rows", "lanes")]
            found.append(Row((row["robot"], kind), cells(row["times"], names)))
    return _PARAMETERS + table(head, found)


def from_memory(rows: list[dict], limits: dict) -> str:
    found = []
    for row in rows:
        least = row["bytes"] / limits["copy"]
        shares = {kind: least / x for kind, x in row["seconds"].items()}
        shown = [f"{1e3 * row['seconds'][kind]:.1f}" for kind in shares]
        told = [row["robot"], f"{row['bytes'] / 1e6:.0f}", f"{1e3 * least:.1f}"]
        found.append(Row(told[:1], [*told[1:], *shown, *map(share, shares.values())]))
    head = "robot | MB | copying, ms | rows, ms | lanes, ms | rows: share | lanes: share"
    return _MEMORY + table(head, found)


def in_jax(rows: list[dict]) -> str:
    found = []
    for row in rows:
        times = row["times"]
        longer = times["JAX"]["least"] / times["rows"]["least"]
        found.append(Row((row["robot"], row["task"]), [*cells(times, ("rows", "JAX")), f"{longer:.2f}"]))
    return _JAX + table("robot | task | rows | JAX | JAX / rows", found)
