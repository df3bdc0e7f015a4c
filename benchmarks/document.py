"""docs/benchmarks.md from the results of a run."""

_INTRODUCTION = """# Benchmarks

<!-- Written by benchmarks/run.py: change that, and run `make bench`. -->

cutpoint beside Pinocchio and beside CasADi's generated C, on robots of the package example-robot-data, in one process
on one core, the contenders in turns; every result agrees to {worst:.0e} of the largest before anything is timed.
**Only the ratios within a row are claims**: absolute figures move with the machine, its clock and what else it does.
Times are medians, least in brackets, in nanoseconds; ratios are of the least, which other work disturbs least.

| | |
|-|-|
| processor | {processor}, core {core} |
| system | {system}, Python {versions[Python]} |
| commit | {commit} |
| versions | {packages} |
| compiler of CasADi's code | {gcc}, {flags} |
"""

_SINGLE = """
## One call from Python

`robot.inverse_dynamics(...)` and its like, which check what they are given; the kernel behind it,
`robot.kernel("inverse_dynamics").call`; Pinocchio's Python bindings.  Over 256 random states, a new one each call.

| robot | task | cutpoint | its kernel | Pinocchio | kernel / cutpoint | Pinocchio / cutpoint |
|-|-|-|-|-|-|-|
"""

_BATCHED = """
## One of {items} in one call

A cutpoint kernel on arrays; Pinocchio's `rneaInParallel` and `abaInParallel` on one thread (there is none for the mass
matrix); CasADi's SX functions, written for this purpose with the robot's zeros structural, as C in a plain loop, which
no Python call interrupts.

| robot | task | cutpoint | Pinocchio | CasADi and gcc | Pinocchio / cutpoint | CasADi / cutpoint |
|-|-|-|-|-|-|-|
"""

_STEPS = """
## One integration step of an arm with drives

The paper's six joints on drives of its catalogue sizes, each effect alone on linear elastic drives and then all at
once: a fourth-order Runge-Kutta step of the closed loop, links, motors and what drives remember.  From runs of many
steps a control period less runs of few, so that the controller and the call cancel.  States: numbers of the plant.

| effect | ns a step | times linear elastic | states |
|-|-|-|-|
"""


def document(results: dict) -> str:
    machine, tasks = results["machine"], results["tasks"]
    packages = ", ".join(f"{name} {number}" for name, number in machine["versions"].items() if name != "Python")
    worst = max(x for task in tasks for x in task["differences"].values())
    text = _INTRODUCTION.format(**{**machine, "flags": " ".join(machine["flags"])}, packages=packages, worst=worst)
    text += _SINGLE
    text += "".join(_row(task, "single", ("cutpoint", "kernel", "Pinocchio")) for task in tasks)
    text += _BATCHED.format(items=machine["items"])
    text += "".join(_row(task, "batched", ("kernel", "Pinocchio", "CasADi")) for task in tasks)
    return text + _STEPS + "".join(step_rows(results["steps"]))


def step_rows(steps: list[dict]) -> list[str]:
    """The first row is what the others are measured by."""
    cells = [(x["effect"], x["nanoseconds"], x["nanoseconds"] / steps[0]["nanoseconds"], x["states"]) for x in steps]
    return [f"| {effect} | {time:.0f} | {ratio:.2f} | {states} |\n" for effect, time, ratio, states in cells]


def _row(task: dict, kind: str, names: tuple[str, ...]) -> str:
    times = [task[kind].get(name) for name in names]
    cells = [f"{t['median']:.0f} ({t['least']:.0f})" if t else "–" for t in times]
    ratios = [f"{t['least'] / times[0]['least']:.2g}" if t else "–" for t in times[1:]]
    return "| " + " | ".join([task["robot"], task["task"], *cells, *ratios]) + " |\n"
