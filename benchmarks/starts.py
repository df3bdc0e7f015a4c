"""Start-up times: processes from launch to their first result, in turns.

python benchmarks/starts.py      prints its table alone
"""

import os
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from cases import robot_file
from run_sections import starts as table_of

from cutpoint.studies.cost.timing import Timing

ROUNDS = 15

NUMPY = "import numpy"
"""What all others are compared with."""

TORQUE = """
import sys
from cutpoint.cli import main
sys.argv = ["cutpoint", "torque", {file!r}, "--q", "0.1,0.2,0.3,0.4,0.5,0.6"]
main()
"""
CALL = """
import numpy as np, cutpoint
q = np.full(6, 0.1)
cutpoint.load({file!r}).inverse_dynamics(q, q, q)
"""
SIMULATION = """
import cutpoint
arm = cutpoint.robots.xia2019()
law = cutpoint.control.PD([2000.0] * 6, [60.0] * 6, side="motor") + cutpoint.control.Feedforward(arm)
cutpoint.simulate(arm, law, cutpoint.trajectories.cycloid([0.5] * 6, 2.0))
"""
PINOCCHIO = """
import numpy as np, pinocchio as pin
model, q = pin.buildModelFromUrdf({file!r}), np.full(6, 0.1)
pin.rnea(model, model.createData(), q, q, q)
"""
STARTS = {
    NUMPY: NUMPY, "cutpoint torque": TORQUE, "cutpoint, inverse dynamics": CALL,
    "cutpoint, simulation of 2 s": SIMULATION, "Pinocchio, inverse dynamics": PINOCCHIO,
}  # fmt: skip
"""Of a UR10 from its file, but for the simulation: that is the paper's arm under PD and feedforward."""


def starts() -> list[dict]:
    """Seconds of each: of the first start, which has code to make, and of those that find it, median and least."""
    file = robot_file("ur10_robot.urdf")
    programs = {name: source.format(file=file) for name, source in STARTS.items()}
    with TemporaryDirectory() as place:
        folder = Path(place)
        for source in programs.values():  # so that Python has its own code of all modules
            _seconds(source, folder, "warm")
        first = {name: _seconds(source, folder, f"of {k}") for k, (name, source) in enumerate(programs.items())}
        turns = [{name: _seconds(source, folder, "warm") for name, source in programs.items()} for _ in range(ROUNDS)]
    times = {name: [turn[name] for turn in turns] for name in programs}
    return [
        {"start": name, "first": first[name], **asdict(Timing(float(np.median(x)), min(x)))}
        for name, x in times.items()
    ]


def _seconds(source: str, folder: Path, cache: str) -> float:
    """Of a process; cache: the folder of machine code."""
    own = {"PYTHONPYCACHEPREFIX": str(folder / "python"), "CUTPOINT_CACHE": str(folder / cache)}
    environment = {k: x for k, x in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"} | own
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", source], env=environment, stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - start


if __name__ == "__main__":
    print(table_of([{"machine": {"processor": "this machine"}, "starts": starts()}]))
