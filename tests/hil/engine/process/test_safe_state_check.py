"""Whether a bench is safe that no one holds any more: by listening alone."""

from __future__ import annotations

import threading
from pathlib import Path

from hil.engine import RunRequest, run_plan
from hil.engine.process.lost_process import complaints_of
from tests.benches_for_tests import SIM, plan
from tests.drivers.pseudo_adapter import plugged_in
from tests.hil.engine.commissioning.doctor.test_examine import with_slcan
from tests.hil.engine.run.test_wall_clock import bench_in_real_time


def test_a_bench_that_was_left_is_heard_and_one_without_power_is_not(tmp_path: Path) -> None:
    with bench_in_real_time("left") as (bench, unplugged, _):
        run_plan(RunRequest(plan("[{hold_speed: {speed_km_h: 1, duration_s: 0.1}}]"), bench, tmp_path))
        assert complaints_of(bench) == []
        unplugged.set()
        assert [text.partition(":")[0] for text in complaints_of(bench)] == ["RMCU", "dynos"]


def test_a_bus_that_cannot_be_opened_is_a_complaint_of_its_own() -> None:
    bus = SIM.buses["rmcu"].model_copy(update={"interface": "socketcan", "channel": "none9"})
    bench = SIM.model_copy(update={"buses": {"rmcu": bus, "dyno": bus}, "simulation": None})
    found = complaints_of(bench)
    assert [text.partition(":")[0] for text in found] == ["bus 'rmcu'", "bus 'dyno'", "rmcu", "dyno"]


def test_a_bus_that_fails_while_it_is_heard_is_named() -> None:
    with plugged_in() as rmcu, plugged_in() as dyno:
        bench = with_slcan(rmcu.path, dyno.path)
        threading.Timer(0.3, rmcu.unplug).start()
        found = complaints_of(bench)
    assert [text.partition(":")[0] for text in found] == ["bus 'rmcu'", "RMCU", "dynos"]
