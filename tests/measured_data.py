"""Measurements of real machines, which lie beside the repository and are no part of it."""

from pathlib import Path

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"

TESTS = ("test_measured_machines.py", "test_measured_drives.py", "test_estimation_measured.py")
"""What needs them: not collected where they are not there, and told so."""
