"""An emergency stop that is latched is the first thing to know about a bench."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.engine.bench.bench_tables import BenchFile, Bus
from hil.engine.commissioning.doctor.examination import findings_of_stops
from hil.engine.stop.emergency_stop import latch, reset
from tests.benches_for_tests import SIM


def served_bench() -> BenchFile:
    """One that other processes can reach."""
    bus = {"interface": "hil-udp", "channel": "127.0.0.1:9", "bit_rate": 1_000_000}
    changed: BenchFile = SIM.model_copy(
        update={"buses": {"rmcu": Bus.model_validate(bus)}, "simulation": None}
    )
    return changed


def test_it_is_a_fault_until_it_is_reset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HIL_STATE", str(tmp_path))
    bench = served_bench()
    assert list(findings_of_stops(bench)) == []
    latch(bench, by="the operator", why="smoke", run=tmp_path)
    (finding,) = findings_of_stops(bench)
    assert (finding.severity, "by the operator: smoke" in finding.what) == ("fault", True)
    assert "hil bench reset" in finding.fix
    reset(bench, "A. Tester")
    assert list(findings_of_stops(bench)) == []
