"""How the command line starts: with what it needs, and with code that is there already."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cutpoint
from cutpoint import derivatives

SOURCE = """
import sys
from llvmlite import binding
from cutpoint.cli import main
{patch}
sys.argv = ["cutpoint", "torque", "xia2019", "--q", "0,30,60,0,45,0", "--degrees"]
try:
    main()
finally:
    print(sorted({{"scipy", "matplotlib", "mujoco", "pandas", "sympy"}} & sys.modules.keys()), file=sys.stderr)
"""
REFUSES_TO_COMPILE = """
def refuse(*_): raise AssertionError("compiled")
binding.TargetMachine.emit_object = refuse
"""


def run(patch: str = "") -> tuple[str, str]:
    command = [sys.executable, "-W", "error", "-c", SOURCE.format(patch=patch)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def test_torques_take_no_slow_imports_and_no_second_compilation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CUTPOINT_CACHE", str(tmp_path))
    first, imported = run()
    assert "14.23" in first and imported == "[]\n"
    assert run(REFUSES_TO_COMPILE)[0] == first


SIMULATION = """
import sys, cutpoint
robot = cutpoint.robots.xia2019()
law = cutpoint.control.PD([500.0] * 6, [20.0] * 6, side="motor") + cutpoint.control.Feedforward(robot)
log = cutpoint.simulate(robot, law, cutpoint.trajectories.cycloid([0.1] * 6, 1.0), duration=0.01)
print(log["q"][-1].tolist(), sorted({"scipy", "matplotlib", "rich", "pandas"} & sys.modules.keys()))
"""


def test_simulations_take_no_slow_imports() -> None:
    done = subprocess.run([sys.executable, "-c", SIMULATION], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.endswith("] []\n")


WITHOUT_LLVMLITE = """
import sys
sys.modules["llvmlite"] = None  # as if it were not installed
import cutpoint
import cutpoint.export
from cutpoint import derivatives
robot = cutpoint.robots.xia2019()
print(robot.gravity_forces([0.1] * 6).tolist())
print(derivatives.forward_dynamics(robot, *[[0.1] * 6] * 3).d_tau[0].tolist())
"""


def test_all_of_the_package_runs_without_llvmlite() -> None:
    command = [sys.executable, "-W", "error", "-c", WITHOUT_LLVMLITE]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    robot, given = cutpoint.robots.xia2019(), np.full(6, 0.1)
    expected = [robot.gravity_forces(given), derivatives.forward_dynamics(robot, given, given, given).d_tau[0]]
    np.testing.assert_allclose([*map(json.loads, done.stdout.splitlines())], expected, rtol=1e-12, atol=1e-12)


def test_a_start_imports_llvmlite_only_where_code_is_made() -> None:
    source = "import sys, cutpoint; print('llvmlite' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout == "False\n"
