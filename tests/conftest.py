"""How the tests run: random inputs are drawn anew on a developer's machine and are the same in CI; none is skipped."""

import os

import pytest
from hypothesis import HealthCheck, settings

from measured_data import DATA, TESTS

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # each process of the tests has one core's share

settings.register_profile("here", deadline=None, max_examples=50)
settings.register_profile(
    "ci", deadline=None, max_examples=50, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("ci" if os.environ.get("CI") else "here")

_CODE = "CUTPOINT_CACHE"


def pytest_configure(config: pytest.Config) -> None:
    """Machine code is shared by the processes of a run, and kept from run to run in `.pytest_cache`: what a change does
    not reach is not compiled again.  Never the user's own is used; `--cache-clear` begins anew."""
    if not hasattr(config, "workerinput"):
        os.environ[_CODE] = str(config.rootpath / ".pytest_cache" / "d" / "cutpoint")


def skipped_tests(config: pytest.Config) -> int:
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    return len(reporter.stats.get("skipped", [])) if reporter else 0


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    terminalreporter.write_line(f"{skipped_tests(config)} skipped tests")
    if not DATA.is_dir():
        terminalreporter.write_line(f"not run, as they need the measured data in {DATA}: {', '.join(TESTS)}")


def pytest_sessionfinish(session: pytest.Session) -> None:
    if skipped_tests(session.config):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
