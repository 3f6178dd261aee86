"""A disk that keeps somebody waiting is seen."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from tests.process_faults.disk import DiskWatch


def test_a_disk_that_stands_still_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = os.fdatasync
    slow = iter([0.0, 0.3])

    def sync(descriptor: int) -> None:
        time.sleep(next(slow, 0.0))
        usual(descriptor)

    monkeypatch.setattr(os, "fdatasync", sync)
    watch = DiskWatch(tmp_path / "disk")
    until_s = time.monotonic() + 30.0
    while watch.longest_s < 0.3 and time.monotonic() < until_s:
        time.sleep(0.01)
    watch.close()
    assert watch.longest_s >= 0.3
    assert (tmp_path / "disk").stat().st_size >= 2 * 4096
