"""What `hil bench sim` serves: the file's bench, effects hidden in it, and the file that connects to it."""

from __future__ import annotations

import socket
import threading
import tomllib
from typing import Any

import pytest

from hil.core.errors import BadInputError, BenchError
from hil.core.model import load_model
from hil.engine.bench.bench import open_bench
from hil.engine.bench.bench_file import bench_from_dict, load_bench
from hil.engine.commissioning.sim_bench import Serving, SimBenchRequest, bench_text, serve, with_hidden
from hil.engine.stop.stopping import StopRequest
from tests.benches_for_tests import SIM

MODEL = load_model(SIM.simulation.model)
BUSES = {
    "rmcu": {"interface": "hil-udp", "channel": "127.0.0.1:47110", "bit_rate": 1_000_000},
    "dyno": {"interface": "hil-udp", "channel": "127.0.0.1:47111", "bit_rate": 1_000_000},
}


def loaded(text: str, tmp_path: Any) -> Any:
    return bench_from_dict(tomllib.loads(text), text, tmp_path / "bench.toml")


def test_effects_are_hidden_by_name_with_their_first_number_or_another() -> None:
    model = with_hidden(MODEL, {"backlash": "0.01", "backlash.restitution": "0.5", "viscous_drag": "0.02"})
    uses = {use.id: use.values for use in model.effects}
    assert uses["backlash"]["half_gap_rad"] == 0.01
    assert uses["backlash"]["restitution"] == 0.5
    assert uses["viscous_drag"]["coefficient_nms_rad"] == 0.02
    assert {use.id for use in MODEL.effects} < uses.keys()
    assert with_hidden(MODEL, {}) == MODEL


def test_an_effect_that_the_model_has_takes_another_number() -> None:
    (use,) = MODEL.effects
    (changed,) = with_hidden(MODEL, {f"{use.id}.amplitude_nm": "50"}).effects
    assert changed.values == {**use.values, "amplitude_nm": 50.0}
    sensed = with_hidden(MODEL, {"sensor_gain.channel": "motor_speed_rad_s", "sensor_gain.gain": "1.05"})
    assert sensed.effects[-1].values == {"channel": "motor_speed_rad_s", "gain": 1.05}


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("backlsh", "0.01", "there is no effect 'backlsh'"),
        ("", "1", "there is no effect ''"),
        ("backlash.gap", "0.01", "effect 'backlash' has no parameter 'gap'"),
        ("backlash", "big", "not a finite number"),
        ("backlash", "nan", "not a finite number"),
        ("backlash", "50", "out of range"),
    ],
)
def test_what_cannot_be_hidden_is_refused(name: str, value: str, said: str) -> None:
    with pytest.raises(BadInputError, match=said) as caught:
        with_hidden(MODEL, {name: value})
    assert "--hide" in caught.value.where


def test_the_bench_file_that_connects_is_the_same_bench_with_other_buses(tmp_path: Any) -> None:
    bench = loaded(bench_text(SIM, BUSES, 0.5), tmp_path)
    assert bench.simulation is None
    assert bench.time_scale == 0.5
    assert (bench.rmcu.dbc, bench.dyno.eds) == (SIM.rmcu.dbc, SIM.dyno.eds)
    assert (bench.limits, bench.vehicle, bench.dut) == (SIM.limits, SIM.vehicle, SIM.dut)
    assert bench.buses["dyno"].channel == "127.0.0.1:47111"
    assert "time_scale" not in bench_text(SIM, BUSES, 1.0)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"time_scale": 2.0}, "--time-scale is 2"),
        ({"time_scale": 0.0}, "--time-scale is 0"),
        ({"for_s": -1.0}, "--for is -1"),
        ({"for_s": float("nan")}, "--for is nan"),
        ({"port": 70000}, "--port is 70000"),
        ({"seed": -1}, "--seed is -1"),
        ({"bench": load_bench("rear_axle_socketcan")}, "it is a bench with hardware"),
    ],
)
def test_what_makes_no_sense_is_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(BadInputError, match=said):
        serve(SimBenchRequest(**{"bench": SIM, **changes}))


def test_a_port_that_is_taken_is_told() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        with pytest.raises(BenchError, match=f"port {port} cannot be taken") as caught:
            serve(SimBenchRequest(SIM, port=port, for_s=1.0))
        assert "--port" in caught.value.fix


def test_it_says_what_it_serves_and_ends_when_asked() -> None:
    told: list[Serving] = []
    request = SimBenchRequest(SIM, port=0, seed=7, hidden={"backlash": "0.01"}, time_scale=0.5)

    def ready(serving: Serving) -> None:
        told.append(serving)
        request.stop.ask()

    request.ready = ready
    served = serve(request)
    (serving,) = told
    assert serving.buses.keys() == {"rmcu", "dyno"}
    assert serving.hidden[0].startswith("backlash: half_gap_rad = 0.01")
    assert serving.left_out == ()
    assert served.pace.turns == 0
    assert served.frames == {"rmcu": (0, 0), "dyno": (0, 0)}


REAL = load_bench("rear_axle_socketcan")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time_scale = 0.2\n" + REAL.text, "buses.rmcu ('socketcan') may be hardware, which keeps real time"),
        ("time_scale = 0.2\n" + SIM.text, "the simulated bench computes its time; leave it out"),
        ("time_scale = 2.0\n" + SIM.text, "time_scale = 2.0: must be at most 1"),
    ],
)
def test_only_a_simulated_bench_in_another_process_runs_slower(text: str, said: str, tmp_path: Any) -> None:
    with pytest.raises(BadInputError) as caught:
        loaded(text.replace('"rmcu.dbc"', f'"{SIM.rmcu.dbc}"'), tmp_path)
    assert said in str(caught.value)


def test_a_bench_at_another_pace_is_refused(tmp_path: Any) -> None:
    ready, told = threading.Event(), []
    request = SimBenchRequest(SIM, port=0, time_scale=0.5)

    def tell(serving: Serving) -> None:
        told.append(serving.bench_file)
        ready.set()

    request.ready = tell
    thread = threading.Thread(target=serve, args=[request])
    thread.start()
    try:
        assert ready.wait(30)
        bench = loaded(told[0].replace("time_scale = 0.5", "time_scale = 1.0"), tmp_path)
        with (
            pytest.raises(BadInputError, match=r"runs at 0.5 of real time, the bench file says 1") as caught,
            open_bench(bench),
        ):
            pass
        assert caught.value.fix == "write time_scale = 0.5 at the top of the bench file"
    finally:
        request.stop.ask()
        thread.join()


def test_panel_and_memory_are_served_too(tmp_path: Any) -> None:
    given: list[Serving] = []
    stop = StopRequest()
    request = SimBenchRequest(load_bench("sim_whole"), port=0, ready=given.append, stop=stop)
    serving = threading.Thread(target=serve, args=(request,))
    serving.start()
    try:
        while not given:
            serving.join(0.05)
        file = loaded(given[0].bench_file, tmp_path)
        assert (given[0].left_out, list(given[0].buses)) == ((), ["rmcu", "dyno", "ram"])
        with open_bench(file) as bench:
            bench.loop.run_for(0.1)
            bench.start_heartbeats()
            bench.further["panel"].come_up()
            bench.further["ram"].come_up()
            bench.loop.run_for(0.3)
            troubles = [text for device in bench.further.values() for text in device.troubles()]
            assert troubles == []
            ((source,),) = [device.sources for device in bench.further.values() if device.sources]
            assert sum(len(samples.time_s) for samples in source.samples()) > 100
    finally:
        stop.times = 1
        serving.join()
