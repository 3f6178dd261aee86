"""A latched stop holds for every account and file of the bench; a simulated one is its process's own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from hil.core.errors import BenchError
from hil.engine.bench.bench_tables import BenchFile, Bus
from hil.engine.commissioning.doctor.examination import findings_of_stops
from hil.engine.stop import stop_places
from hil.engine.stop.emergency_stop import latch, refuse_latched, reset
from tests.benches_for_tests import SIM, sim_bench

RMCU, DYNO = {"channel": "127.0.0.1:47110"}, {"channel": "127.0.0.1:47111"}


@pytest.fixture(autouse=True)
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A machine with a place for all accounts, homes of two, and no say of HIL_STATE."""
    monkeypatch.delenv("HIL_STATE")
    monkeypatch.delenv("XDG_STATE_HOME", raising=False)
    monkeypatch.setattr(stop_places, "MACHINE_PLACES", (tmp_path / "var/lib/hil",))
    accounts = tmp_path / "passwd"
    lines = [f"{name}:x:1:1::{tmp_path / name}:/bin/sh" for name in ("anna", "bert")]
    accounts.write_text("\n".join([*lines, "broken line", ""]))
    monkeypatch.setattr(stop_places, "_ACCOUNTS", accounts)
    monkeypatch.setenv("HOME", str(tmp_path / "anna"))
    return tmp_path


def hardware(**tables: dict[str, Any]) -> BenchFile:
    tables = tables or {"rmcu": RMCU, "dyno": DYNO}
    buses = {
        name: Bus.model_validate({"interface": "hil-udp", "bit_rate": 1_000_000, **table})
        for name, table in tables.items()
    }
    changed: BenchFile = SIM.model_copy(update={"buses": buses, "simulation": None})
    return changed


def nobody_else_writes(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (machine / "file").touch()
    monkeypatch.setattr(stop_places, "MACHINE_PLACES", (machine / "file/hil",))


@pytest.mark.parametrize(
    "second",
    [
        {"rmcu": RMCU | {"options": {"receive_own_messages": True}}},
        {"wheels": {"channel": "localhost:47111"}, "rmcu": {"channel": "127.0.0.1:1"}},
        {"rmcu": RMCU | {"bit_rate": 500_000}},
    ],
)
def test_another_file_of_the_same_ports_is_refused(second: dict[str, Any], tmp_path: Path) -> None:
    latch(hardware(), by="x", why="smoke", run=tmp_path)
    with pytest.raises(BenchError, match="smoke"):
        refuse_latched(hardware(**second))
    refuse_latched(hardware(rmcu={"channel": "127.0.0.1:47112"}))


def test_another_account_is_refused_and_may_reset(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = latch(hardware(), by="anna", why="smoke", run=machine)
    for folder in (place.parent, place, place / "reset"):
        assert folder.stat().st_mode & 0o7777 == 0o1777
    monkeypatch.setenv("HOME", str(machine / "bert"))
    monkeypatch.setenv("XDG_STATE_HOME", str(machine / "elsewhere"))
    monkeypatch.setenv("HIL_STATE", str(machine / "named"))
    with pytest.raises(BenchError, match="by anna: smoke"):
        refuse_latched(hardware())

    def not_mine(path: Path, missing_ok: bool = False) -> None:
        raise PermissionError(1, "Operation not permitted", str(path))

    with monkeypatch.context() as patch:  # as in a sticky folder; this test may be root's
        patch.setattr(Path, "unlink", not_mine)
        (stop,) = reset(hardware(), "bert")
    assert (stop.by, stop.reset_by) == ("anna", "bert")
    assert list(place.glob("*.json"))
    refuse_latched(hardware())
    latch(hardware(), by="anna", why="smoke again", run=machine)
    with pytest.raises(BenchError, match="smoke again"):
        refuse_latched(hardware())


def test_where_nobody_else_finds_it_says_so_and_holds_for_who_can_see_it(
    machine: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    assert list(findings_of_stops(hardware())) == []
    nobody_else_writes(machine, monkeypatch)
    (finding,) = findings_of_stops(hardware())
    assert "other accounts of this machine may not see" in finding.what
    place = latch(hardware(), by="anna", why="smoke", run=machine)
    assert place == machine / "anna/.local/state/hil/emergency-stops"
    assert "other accounts" in caplog.text
    monkeypatch.setenv("HOME", str(machine / "bert"))
    with pytest.raises(BenchError, match="by anna: smoke"):
        refuse_latched(hardware())
    reset(hardware(), "bert")
    refuse_latched(hardware())


def test_a_stop_of_an_earlier_version_still_holds(machine: Path) -> None:
    place = machine / "anna/.local/state/hil/emergency-stops"
    place.mkdir(parents=True)
    (place / "old.json").write_text(
        '{"bench": "b", "buses": ["hil-udp 127.0.0.1:47110 receive_own_messages=True"], "by": "anna",'
        ' "why": "smoke", "at": "2026-01-01", "run": "x"}'
    )
    with pytest.raises(BenchError, match="smoke"):
        refuse_latched(hardware())
    refuse_latched(hardware(rmcu={"channel": "127.0.0.1:471"}))
    reset(hardware(), "anna")
    refuse_latched(hardware())


def test_what_cannot_be_read_keeps_every_bench_from_being_armed(machine: Path) -> None:
    place = machine / "var/lib/hil/emergency-stops"
    place.mkdir(parents=True)
    (place / "torn.json").write_text("{")
    with pytest.raises(BenchError, match="cannot be read"):
        refuse_latched(hardware())
    refuse_latched(sim_bench("no one else has it"))
    assert reset(hardware(), "A. Tester") == []
    refuse_latched(hardware())
    (place / "torn.json").write_text("{}")
    with pytest.raises(BenchError, match="cannot be read"):
        refuse_latched(hardware())


def test_a_simulated_bench_of_another_process_or_service_is_another_bench(machine: Path) -> None:
    bench = sim_bench("mine")
    latch(bench, by="x", why="y", run=machine)
    latch(SIM, by="x", why="y", run=machine, owner=machine / "service")
    with pytest.raises(BenchError, match="start again"):
        refuse_latched(bench)
    with pytest.raises(BenchError, match="--data"):
        refuse_latched(SIM, machine / "service")
    refuse_latched(SIM)
    refuse_latched(SIM, machine / "another")
    look = "from hil.engine import load_bench; from hil.engine.stop.emergency_stop import refuse_latched"
    code = f"{look}; refuse_latched(load_bench('sim'))"
    subprocess.run([sys.executable, "-c", code], check=True, env=dict(os.environ))
    (stop,) = reset(SIM, "A. Tester", machine / "service")
    assert stop.reset_by == "A. Tester"
    refuse_latched(SIM, machine / "service")
