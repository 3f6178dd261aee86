"""The simulated bench on its wire: load, determinism, timing, the dynos' own safety."""

from typing import Any

import can
import numpy as np
import pytest

from drivers import TICK_S, Wire, read_rmcu
from hil.core.can.frames import crc8_many, longest_frame_s
from hil.core.errors import BadInputError
from hil.core.model import Model, load_model
from sim_backend.bench import Fault, SimulatedBench, SimulationSettings
from sim_backend.can_interface import SimulatedBus, attach, attached, detach
from tests.benches_for_tests import SIM, running, sim_bench


def frames_of(looks, duration=120):
    """All frames of a bench of its own while a host asks for torque, starts nodes and falls silent.

    `looks(k)`: whether somebody looks at the bench after sample k.
    """
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    rmcu = read_rmcu(SIM.rmcu.dbc).layouts["RMCU_Request"]
    payloads = rmcu.encode(Counter=np.arange(40) % 16, Mode=1, TorqueRequest=np.linspace(0, 20, 40))
    payloads |= rmcu.signals["Crc"].encode(crc8_many(rmcu.id, payloads))
    payloads[30] ^= np.uint64(1 << 20)  # damaged on the way
    seen: dict[str, list[Any]] = {"rmcu": [], "dyno": []}
    for k in range(duration):
        if k < len(payloads):
            world.put("rmcu", rmcu.id, int(payloads[k]).to_bytes(8, "little")[: rmcu.length])
        if k == 7:
            world.put("dyno", 0x000, bytes([1, 0]))  # NMT: start all nodes
        if k == 25:
            world.put("rmcu", read_rmcu(SIM.rmcu.dbc).layouts["RMCU_ParameterWrite"].id, bytes(8))
        if k == 100:
            world.fail(Fault.DYNO_SILENT)
        world.sleep_until((k + 1) * 0.001)
        if looks(k):
            for bus, frames in seen.items():
                frames.append(world.take(bus))
    mode = world.rmcu.mode
    return mode, {bus: np.concatenate([*frames, world.take(bus)]).tobytes() for bus, frames in seen.items()}


def test_what_nobody_looks_at_comes_to_pass_all_the_same():
    always = frames_of(lambda k: True)
    assert always[0] == 3  # requests stopped
    assert frames_of(lambda k: k % 10 == 4) == always
    assert frames_of(lambda k: False) == always


def test_every_bus_stays_below_70_percent_load():
    with running("load") as bench:
        seen: dict[str, list[Any]] = {wire.name: [] for wire in bench.loop.wires}
        bench.loop.on_block(lambda bus, block: seen[bus].append(block.copy()))
        bench.dyno.enable(10.0)
        payloads = bench.rmcu.requests("motor_torque", np.zeros(1000))
        start_s = bench.loop.clock.now_s()
        for payload in payloads:
            bench.rmcu.send(payload)
            bench.loop.step()
        bench.loop.drain()
        for bus, blocks in seen.items():
            frames = np.concatenate(blocks)
            frames = frames[frames["time_s"] >= start_s]
            rate = SIM.buses[bus].bit_rate
            busy_s = sum(longest_frame_s(int(length), rate) for length in frames["length"])
            assert 0.3 < busy_s / (bench.loop.clock.now_s() - start_s) < 0.7
            assert len(frames) > 3900


def drive(bench):
    """A second of torque; all frames as bytes."""
    seen = []
    bench.loop.on_block(lambda bus, block: seen.append((bus, block.tobytes())))
    bench.dyno.enable(10.0)
    bench.dyno.release_vehicle(0.0)
    for payload in bench.rmcu.requests("motor_torque", 10 * np.sin(np.arange(1000) * 0.01)):
        bench.rmcu.send(payload)
        bench.loop.step()
    return seen


@pytest.mark.parametrize("count", [1, 7, 10, 333])
def test_requests_handed_over_ahead_are_those_sent_one_each_tick(count: int) -> None:
    torque_nm = 10 * np.sin(np.arange(count) * 0.01)

    def frames_of(name: str, ahead: bool) -> list[tuple[str, bytes]]:
        seen = []
        with running(name) as bench:
            bench.loop.on_block(lambda bus, block: seen.append((bus, block.tobytes())))
            bench.dyno.enable(10.0)
            bench.loop.run_for(0.0037)  # in mid-stretch
            payloads, rmcu = bench.rmcu.requests("motor_torque", torque_nm), bench.rmcu
            ticks = bench.loop.each_tick(
                count,
                lambda k: rmcu.send(payloads[k]),
                lambda k, times_s: ahead and rmcu.send_ahead(payloads[k : k + len(times_s)], times_s),
            )
            assert list(ticks)[-1] == count
            for _ in range(100):  # past the RMCU's time-out
                bench.loop.step()
        return seen

    assert frames_of("ahead", True) == frames_of("each", False)


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others():
    with running("a") as bench:
        first = drive(bench)
    with running("b") as bench:
        second = drive(bench)
    other = SIM.simulation.model_copy(update={"seed": 2})
    with running("c", simulation=other) as bench:
        third = drive(bench)
    assert first == second
    assert first != third


class OneByOne(can.BusABC):
    """The simulated bus as any other python-can bus: without blocks."""

    def __init__(self, bus):
        self._inner = bus
        super().__init__(channel="one by one")

    def send(self, msg, timeout=None):
        self._inner.send(msg, timeout)

    def _recv_internal(self, timeout):
        return self._inner._recv_internal(timeout)

    def shutdown(self):
        super().shutdown()
        self._inner.shutdown()


def test_message_by_message_gives_the_same_frames_as_blocks():
    results = []
    for wrap in (lambda bus: bus, OneByOne):
        with running("wrapped"):
            world = attached("wrapped")
            bus = wrap(SimulatedBus("wrapped/dyno"))
            wire = Wire("dyno", bus, world)
            world.take("dyno")
            world.sleep_until(world.now_s() + 0.05)
            results.append(wire.drain())
            bus.shutdown()
    assert len(results[0]) > 200
    np.testing.assert_array_equal(results[0], results[1])


def test_python_can_opens_it_by_its_registered_name():
    with running("registered"), can.Bus(interface="hil-sim", channel="registered/dyno") as bus:
        message = bus.recv(0.1)
        assert message is not None
        with pytest.raises(can.CanInitializationError, match="nowhere"):
            can.Bus(interface="hil-sim", channel="nowhere/dyno")


def test_waiting_is_computing():
    with running("waiting") as bench:
        before = bench.loop.clock.now_s()
        bench.loop.run_for(1.0)
        assert bench.loop.clock.now_s() - before == pytest.approx(1.0, abs=TICK_S)


def test_dynos_go_safe_by_themselves_when_the_host_falls_silent():
    with running("silent") as bench:
        bench.dyno.enable(10.0)
        world = attached("silent")
        assert world.dynos[0].power.statusword & 0x6F == 0x27
        world.sleep_until(world.now_s() + 0.15)
        assert world.dynos[0].power.statusword & 0x6F == 0x27
        world.sleep_until(world.now_s() + 0.1)
        assert [node.power.statusword & 0x6F for node in world.dynos[:2]] == [0x08, 0x08]
        bench.loop.run_for(0.02)
        assert any("0x8130" in text for text in bench.dyno.troubles())


def test_the_rmcu_goes_safe_by_itself_when_requests_stop():
    with running("requests") as bench:
        world = attached("requests")
        for payload in bench.rmcu.requests("motor_torque", np.full(100, 20.0)):
            bench.rmcu.send(payload)
            bench.loop.step()
        assert bench.rmcu.torque_ref_nm == 20.0
        bench.loop.run_for(0.06)
        assert world.rmcu.mode == 3
        assert (bench.rmcu.state, bench.rmcu.fault, bench.rmcu.torque_ref_nm) == ("fault", "timeout", 0.0)


def test_faults_of_devices_show_on_the_wire():
    with running("faults") as bench:
        world = attached("faults")
        world.fail(Fault.RMCU_SILENT)
        bench.loop.run_for(0.2)
        assert not bench.rmcu.is_safe()
        world.fail(Fault.DYNO_SILENT)
        bench.loop.run_for(0.5)
        assert any("heartbeat lost" in text for text in bench.dyno.troubles())


def test_a_transfer_function_cannot_be_a_bench():
    with pytest.raises(BadInputError, match="transfer_function"):
        SimulatedBench(SimulationSettings(Model("transfer_function"), SIM.rmcu.dbc, SIM.dyno.eds))


def test_the_speed_loop_holds_what_it_is_told():
    with running("speed") as bench:
        bench.dyno.enable(20.0)
        bench.dyno.hold_speed(16.8)
        bench.loop.run_for(3.0)
        assert bench.dyno.wheel_speed_rad_s == pytest.approx(16.8, abs=0.3)
        bench.dyno.release_vehicle(16.8 * 0.33)
        bench.loop.run_for(1.0)
        assert bench.dyno.wheel_speed_rad_s == pytest.approx(16.8, abs=0.5)


def test_attached_benches_are_forgotten():
    world: Any = object()
    attach("gone", world)
    detach("gone")
    with pytest.raises(KeyError):
        attached("gone")
    assert sim_bench("x").name == "x"
