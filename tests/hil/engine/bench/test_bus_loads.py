"""The load of the buses: counted in a run, foretold by a forecast, the same within the events of a plan."""

import numpy as np
import pytest

from hil.core.can.frames import FRAME
from hil.engine import RunRequest, run_plan
from hil.engine.bench.bus_tally import BusLoads
from hil.engine.prediction.forecast import forecast
from tests.benches_for_tests import SIM, plan, sim_bench

STEPS = """
- hold_speed: {speed_km_h: 0, duration_s: 1}
- chirp: {segment: c, from_hz: 1, to_hz: 20, duration_s: 2, amplitude_nm: 5, quantity: motor_torque}
"""


def frames_at(*times_s):
    frames = np.zeros(len(times_s), FRAME)
    frames["time_s"], frames["length"] = times_s, 8  # 135 bits each, at most
    return frames


def test_mean_over_the_run_and_the_busiest_tenth_of_a_second():
    now_s = [5.0]
    loads = BusLoads({"a": 13_500, "b": 1_000_000}, lambda: now_s[0])
    now_s[0] = 6.0
    loads.take_frames("a", frames_at(5.01, 5.02))
    loads.take_frames("a", frames_at(5.99))
    for stamp_s in (np.nan, 1e300, -1.0):  # what an adapter may give: none is lost
        loads.take_frames("a", frames_at(stamp_s))
    a, b = loads.results()
    assert (a.mean, a.busiest) == (pytest.approx(6 * 0.01), pytest.approx(3 * 0.1))
    assert (b.bus, b.mean, b.busiest) == ("b", 0.0, 0.0)


def test_a_run_carries_what_its_forecast_says(tmp_path):
    chosen = plan(STEPS)
    foretold = forecast(chosen, SIM).bus_loads
    outcome = run_plan(RunRequest(chosen, sim_bench("loads"), tmp_path))
    counted = {load.bus: load for load in outcome.result.bus_loads}
    assert counted.keys() == foretold.keys()
    for name, load in counted.items():
        assert load.busiest == pytest.approx(foretold[name], abs=0.08)  # services and heartbeats beside
        assert load.mean < load.busiest


def test_a_bus_that_cannot_carry_its_frames_does_not_fit():
    slow = SIM.buses["rmcu"].model_copy(update={"bit_rate": 500_000})
    found = forecast(plan(STEPS), SIM.model_copy(update={"buses": {**SIM.buses, "rmcu": slow}}))
    assert found.bus_loads["rmcu"] > 1.0
    assert found.overloaded == ("rmcu",)
    assert not found.fits
