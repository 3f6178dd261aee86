"""Settings of all tests."""

import os
import signal
import tempfile
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

from tests.gate import gating, is_long

# What outlives a process is not to outlive the tests, nor to meet what others keep.
_STATE = tempfile.TemporaryDirectory(prefix="hil-state-")
os.environ["HIL_STATE"] = _STATE.name


@pytest.hookimpl(tryfirst=True)  # before pytest deselects by marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what is slow by its measured seconds, and of the slow ones what runs at night."""
    slow = []
    for item in items:
        if item.get_closest_marker("hunt"):
            continue
        if item.get_closest_marker("slow"):
            slow.append(item)
        elif is_long(item.nodeid, prepared=_shares(item)):
            item.add_marker(pytest.mark.slow)
            slow.append(item)
    chosen = gating(item.nodeid for item in slow)
    for item in slow:
        if item.nodeid not in chosen:
            item.add_marker(pytest.mark.nightly)
    items.sort(key=lambda item: "can_vm" not in item.nodeid)  # it takes as long as all others: first


def _shares(item: pytest.Item) -> bool:
    """Whether a test uses what its module prepares once."""
    by_name = getattr(item, "_fixtureinfo", None)
    fixtures = by_name.name2fixturedefs.values() if by_name else ()
    shared = (one for each in fixtures for one in each if one.scope in ("module", "session"))
    return any(one.func.__module__.startswith("tests.") for one in shared)


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
