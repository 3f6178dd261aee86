"""A bench with a device missing starts, says so, and refuses only the plans that need it."""

from types import SimpleNamespace

import pytest

from drivers import DeviceTable
from hil.core.errors import BadInputError, BenchError
from hil.engine import RunRequest, run_plan
from hil.engine.bench.bench import open_bench, refuse_needs
from hil.engine.bench.ranges import ChannelLimit
from hil.engine.run.preflight import channels_of
from sim_backend.rcs import DynoNode
from tests.benches_for_tests import SIM, plan, sim_bench

PLAN = plan("[{wait: {duration_s: 0.1}}]")


class Unplugged(DeviceTable):
    """A device whose port is not there."""

    kind: str = "unplugged"

    def open(self, name, connections):
        raise BenchError("cannot be opened: no such port", where=f"device '{name}'")


def bench(**changes):
    return sim_bench(devices={"oil": Unplugged()}, **changes)


def test_a_run_that_does_not_need_it_goes_on_and_says_so(tmp_path):
    outcome = run_plan(RunRequest(PLAN, bench(), tmp_path))
    assert outcome.error is None
    assert outcome.result.safe_state == "confirmed"
    assert outcome.result.missing == ("oil is missing: device 'oil': cannot be opened: no such port",)


def test_what_limits_it_cannot_be_watched():
    limits = SIM.limits.model_copy(update={"channels": {"oil_temperature_k": ChannelLimit(above=363.0)}})
    with pytest.raises(BadInputError) as caught, open_bench(bench(limits=limits)):
        pass
    assert caught.value.what == "limits.channels.oil_temperature_k: no device provides this channel"
    assert "devices.oil is missing" in caught.value.fix


def test_a_plan_that_needs_its_channels_is_refused():
    with open_bench(bench()) as opened:
        refuse_needs(opened, ["motor_speed_rad_s", "shaft_torque_nm"])
        with pytest.raises(BenchError, match="the plan needs oil_temperature_k") as caught:
            refuse_needs(opened, ["oil_temperature_k"])
    assert "devices.oil is missing" in caught.value.fix


def test_a_plan_needs_what_its_criteria_are_computed_from():
    metrics = (SimpleNamespace(channel="shaft_torque_nm"), SimpleNamespace(), SimpleNamespace(channel="x"))
    criteria = [SimpleNamespace(metric=metric) for metric in metrics]
    assert channels_of(SimpleNamespace(criteria=criteria)) == ["shaft_torque_nm", "x"]  # type: ignore[arg-type]


def without_power(monkeypatch, *missing):
    """Nodes of the simulated bench of which nothing is heard from the beginning."""
    made = DynoNode.__init__

    def make(self, node_id, eds, send, row):
        made(self, node_id, eds, (lambda frame_id, data: None) if node_id in missing else send, row)

    monkeypatch.setattr(DynoNode, "__init__", make)


def test_an_idle_dyno_that_is_missing_keeps_nobody_from_anything(tmp_path, monkeypatch):
    without_power(monkeypatch, SIM.dyno.idle["front left"])
    outcome = run_plan(RunRequest(PLAN, sim_bench(), tmp_path))
    assert outcome.error is None
    assert outcome.result.missing == ("dynos: front left (node 1) is missing",)


def test_a_rear_dyno_is_needed(tmp_path, monkeypatch):
    without_power(monkeypatch, SIM.dyno.rear_left)
    outcome = run_plan(RunRequest(PLAN, sim_bench(), tmp_path))
    assert outcome.error is not None
    assert "no heartbeat from rear left (node 3)" in outcome.error.what
    assert outcome.result.safe_state == "not_needed"
