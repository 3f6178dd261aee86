"""Opening a bench: buses and devices in order, closed again whatever happens, channels that go together."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import can
import pytest

from drivers import SampleQueue, Stream
from hil.core.errors import BadInputError, BenchError
from hil.core.model import load_model
from hil.engine.bench.bench import open_bench
from hil.engine.bench.bench_channels import refuse_channels
from hil.engine.bench.ranges import ChannelLimit
from sim_backend.can_interface import attached
from tests.benches_for_tests import SIM, running, sim_bench
from tests.hil.engine.run.test_safety import Valve


def test_a_bench_has_its_devices_in_the_order_in_which_they_come_up() -> None:
    with open_bench(sim_bench("order")) as bench:
        bench.further["valve"] = valve = Valve()
        assert bench.devices == [bench.rmcu, bench.dyno, valve]
        assert bench.simulated is True
        assert bench.streams[0].channels[0] in ("motor_torque_ref_nm", "motor_speed_rad_s")
        assert len(bench.streams) == sum(len(source.streams) for source in bench.sources)
        attached("order")
    with pytest.raises(KeyError):
        attached("order")


def test_a_model_of_the_command_takes_the_bench_files_place() -> None:
    model = load_model(SIM.simulation.model).with_parameters(vehicle_inertia=250.0)
    with open_bench(sim_bench("model"), model=model) as bench:
        assert bench.model is model
    without = SIM.model_copy(update={"simulation": None})
    with (
        pytest.raises(BadInputError, match="--model goes with a simulated bench only"),
        open_bench(without, model=model),
    ):
        pass


def test_a_bus_that_cannot_be_opened_closes_those_that_were() -> None:
    buses = SIM.buses | {
        "dyno": SIM.buses["dyno"].model_copy(update={"interface": "socketcan", "channel": "none7"})
    }
    file = sim_bench("half").model_copy(update={"buses": sim_bench("half").buses | {"dyno": buses["dyno"]}})
    with pytest.raises(BenchError, match="cannot be opened") as caught, open_bench(file):
        pass
    assert caught.value.where == "bus 'dyno' (socketcan none7)"
    with pytest.raises(KeyError):
        attached("half")
    with can.Bus(interface="virtual", channel="half/rmcu"):
        pass


class Meter(Valve):
    """A device that measures channels of its own."""

    def __init__(self, *channels: str) -> None:
        super().__init__()
        stream = Stream("readings", "device 'oil'", channels, ("K",) * len(channels), 0.1)
        self.sources = (SampleQueue(stream),)


@pytest.mark.parametrize(
    ("channels", "said"),
    [
        (("oil temperature",), "cannot be called 'oil temperature'"),
        (("öl_k",), "cannot be called"),
        (("time_s",), "'time_s' is also given by the time base"),
        (("motor_speed_rad_s",), "'motor_speed_rad_s' is also given by bus 'rmcu'"),
        (("oil_k", "oil_k"), "'oil_k' is also given by device 'oil'"),
    ],
)
def test_channels_that_no_recording_can_hold_are_refused(channels: tuple[str, ...], said: str) -> None:
    with running("channels") as bench:
        bench.further["oil"] = Meter(*channels)
        with pytest.raises(BadInputError, match=said) as caught:
            refuse_channels(bench.file, bench.streams, bench.missing)
        assert caught.value.where == "device 'oil'"


def test_a_limit_needs_a_device_that_gives_its_channel() -> None:
    limits = SIM.limits.model_copy(update={"channels": {"oil_k": ChannelLimit(above=400.0)}})
    with running("limited") as bench:
        bench.file = bench.file.model_copy(update={"limits": limits})
        with pytest.raises(
            BadInputError, match=r"limits.channels.oil_k: no device provides this channel"
        ) as caught:
            refuse_channels(bench.file, bench.streams, bench.missing)
        assert "motor_speed_rad_s" in caught.value.fix
        assert "time_s" not in caught.value.fix
        bench.further["oil"] = Meter("oil_k")
        refuse_channels(bench.file, bench.streams, bench.missing)


def test_only_devices_that_watch_the_host_are_told_that_it_lives(tmp_path: Path) -> None:
    class Watching(Valve):
        heartbeat_s: Any = 0.05
        beats = 0

        def beat(self) -> None:
            self.beats += 1

    with open_bench(sim_bench("beats")) as bench:
        bench.further["watching"] = watching = Watching()
        bench.further["deaf"] = Valve()
        bench.start_heartbeats()
        bench.loop.run_for(1.0)
        assert watching.beats == pytest.approx(20, abs=1)
