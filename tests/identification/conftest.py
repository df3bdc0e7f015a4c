"""Measurements of real machines, which lie beside the repository and are no part of it."""

import pytest
from measured import DATA

collect_ignore = [] if DATA.is_dir() else ["test_measured_machines.py"]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if collect_ignore:
        terminalreporter.write_line(f"{', '.join(collect_ignore)} needs the measured data in {DATA}")
