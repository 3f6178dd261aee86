"""A run whose bench is stopped while its process begins is over: a reset starts nothing by itself."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.hil.service.served import SHORT, RefusedError, Served, served

pytestmark = pytest.mark.slow


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as one:
        one.give("short", SHORT)
        yield one


def test_a_run_that_is_stopped_before_its_process_is_there_does_not_start_after_the_reset(
    service: Served,
) -> None:
    run = service.queue()
    service.until(run, lambda found: found["state"] == "running")
    service.post("/benches/sim/emergency-stop")  # its process takes longer than this to begin
    with pytest.raises(RefusedError, match="a run is still being ended"):
        service.post("/benches/sim/reset")
    over = service.over(run)
    assert over["state"] == "ended"
    assert over["reason"].startswith("stopped before it began: ")
    assert "recording.mcap" not in over["files"]
    service.post("/benches/sim/reset")
    next_one = service.over(service.queue())
    assert next_one["verdict"] == "pass"
    assert service.get(f"/runs/{run}")["reason"] == over["reason"]
