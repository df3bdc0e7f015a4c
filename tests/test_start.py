"""How the command line starts: with what it needs, and with code that is there already."""

import subprocess
import sys
from pathlib import Path

import pytest

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
