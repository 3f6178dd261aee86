"""Settings of all tests."""

import os
import tempfile

from hypothesis import HealthCheck, settings

# What outlives a process is not to outlive the tests, nor to meet what others keep.
_STATE = tempfile.TemporaryDirectory(prefix="hil-state-")
os.environ["HIL_STATE"] = _STATE.name

settings.register_profile(
    "project", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("project")
