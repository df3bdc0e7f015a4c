"""How the tests run: random inputs are drawn anew on a developer's machine, and the same every time in CI."""

import os

from hypothesis import HealthCheck, settings

settings.register_profile("here", deadline=None, max_examples=50)
settings.register_profile(
    "ci", deadline=None, max_examples=50, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("ci" if os.environ.get("CI") else "here")
