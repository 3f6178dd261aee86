"""Settings of all tests."""

import os
import signal
import tempfile
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

from tests.gate import gates

# What outlives a process is not to outlive the tests, nor to meet what others keep.
_STATE = tempfile.TemporaryDirectory(prefix="hil-state-")
os.environ["HIL_STATE"] = _STATE.name


@pytest.hookimpl(tryfirst=True)  # before pytest deselects by marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What is slow and does not gate runs at night."""
    for item in items:
        if item.get_closest_marker("slow") and not gates(item.nodeid):
            item.add_marker(pytest.mark.nightly)


settings.register_profile(
    "project", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("project")


@pytest.fixture
def heard_hangups() -> Iterator[None]:
    """SIGHUP as a shell gives it to a command: `nohup` and some CI start everything with it ignored."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)
