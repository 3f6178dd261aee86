"""What is said of a run whose service or agent was killed."""

from __future__ import annotations

import datetime
import os
from pathlib import Path

from hil.execution.benches import Bench
from hil.execution.run_execution import end_of_left


def test_it_ended_when_something_was_last_written(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    for name, at_s in (("run.lock", 1000.0), ("recording.mcap", 5000.5), ("parts/log.txt", 4000.0)):
        path = tmp_path / name
        path.write_bytes(b"x")
        os.utime(path, (at_s, at_s))
    end = end_of_left(tmp_path, "service", None)
    assert end.state == "interrupted"
    assert end.reason == "the service ended during the run; data measured before that is kept"
    assert end.at == datetime.datetime.fromtimestamp(5000.5, datetime.UTC)


def test_of_one_that_left_nothing_no_moment_is_known(tmp_path: Path) -> None:
    end = end_of_left(tmp_path / "none", "agent", Bench("sim"))
    assert (end.at, end.result) == (None, None)
    assert end.dut == Bench("sim").dut != ""
    assert "before the recording started" in end.reason
