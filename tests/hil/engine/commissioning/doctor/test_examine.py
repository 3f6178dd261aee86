"""A look at a bench: one that is well, and ones with something wrong."""

import datetime
import json

import pytest

from hil.core.errors import BadInputError, InterruptError
from hil.engine import StopRequest
from hil.engine.commissioning.doctor.examine import DoctorRequest, examine_bench
from sim_backend.bench import Fault
from sim_backend.can_interface import attached
from tests.benches_for_tests import sim_bench
from tests.drivers.pseudo_adapter import plugged_in

TODAY = datetime.date(2026, 11, 22)


def examined(bench=None, *, fault=None, listen_s=1.5):
    def break_it(share, text):
        if fault and share == 0:
            attached("test").fail(fault)

    return examine_bench(DoctorRequest(bench or sim_bench(), listen_s, TODAY, progress=break_it))


def told(found):
    return {(finding.severity, finding.where, finding.what) for finding in found.findings}


def test_a_bench_that_is_well():
    found = examined()
    assert (found.verdict, found.findings) == ("fine", [])
    assert {key: device.answers for key, device in found.devices.items()} == {"rmcu": True, "dyno": True}
    assert found.devices["rmcu"].facts["state"] == "off"
    assert found.devices["dyno"].facts["rear left: drive"] == "switch on disabled"
    rmcu = found.buses["rmcu"]
    assert rmcu.frames_s == pytest.approx(3000, rel=0.01)
    assert 0.33 < rmcu.load < 0.4  # 3 frames of 111 to 135 bits in each millisecond
    assert [clock.lost for clock in found.clocks] == [0, 0]
    assert json.loads(json.dumps(found.as_dict()))["verdict"] == "fine"


def test_nothing_is_written_to_any_device():
    seen = []

    def look(share, text):
        world = attached("test")
        seen.append(
            (world.rmcu._stored, [(n._node.nmt.state, dict(n._node.data_store)) for n in world.dynos])
        )

    request = DoctorRequest(sim_bench(), 0.5, TODAY, progress=look)
    examine_bench(request)
    stored, nodes = seen[-1]
    assert stored == {}
    assert {state for state, _ in nodes} == {"PRE-OPERATIONAL"}
    assert all(0x1016 not in store and 0x1005 not in store for _, store in nodes)


def test_an_rmcu_that_is_missing_leaves_the_rest_looked_at():
    found = examined(fault=Fault.RMCU_SILENT)
    assert found.verdict == "faults"
    assert ("fault", "RMCU (bus 'rmcu')", "has stopped sending its status (frames 0x110 and 0x111)") in told(
        found
    )
    assert found.devices["dyno"].answers


def test_an_rmcu_that_hears_nothing():
    found = examined(fault=Fault.RMCU_DEAF)
    what = "sends its status, but does not answer when a parameter is read"
    assert ("fault", "RMCU (bus 'rmcu')", what) in told(found)


def test_a_dyno_that_is_missing():
    found = examined(fault=Fault.DYNO_SILENT)
    assert ("fault", "bus 'dyno'", "rear left (node 3) is missing") in told(found)
    assert found.devices["dyno"].answers  # the other one does


def with_slcan(*paths):
    names = ("rmcu", "dyno")
    buses = {
        name: sim_bench()
        .buses[name]
        .model_copy(update={"interface": "slcan", "channel": path, "options": {"sleep_after_open": 0}})
        for name, path in zip(names, paths, strict=True)
    }
    return sim_bench(buses=buses, simulation=None)


def test_a_bus_without_a_frame_and_one_with_errors():
    with plugged_in() as rmcu, plugged_in() as dyno:

        def speak(share, text):
            if share == 0:
                dyno.say("sp000130", "e2ab")

        found = examine_bench(DoctorRequest(with_slcan(rmcu.path, dyno.path), 0.2, TODAY, progress=speak))
    said = {(finding.where, finding.what) for finding in found.findings}
    assert found.verdict == "not_there"
    assert ("bus 'rmcu'", "no frame received; the bench file says 1000000 bit/s") in said
    assert any(where == "bus 'dyno'" and "error-passive" in what for where, what in said)
    assert any(where == "bus 'dyno'" and "error frames" in what for where, what in said)


def test_a_bus_that_cannot_be_opened_does_not_hide_the_other(tmp_path):
    with plugged_in() as rmcu:
        # The path of a pseudo-terminal that was closed is given to the next that anybody opens.
        bench = with_slcan(rmcu.path, str(tmp_path / "unplugged"))
        found = examine_bench(DoctorRequest(bench, 0.2, TODAY))
    assert [found.buses[name].opened for name in ("rmcu", "dyno")] == [True, False]
    assert any(f.where.startswith("bus 'dyno'") and "cannot be opened" in f.what for f in found.findings)
    assert found.verdict == "not_there"


def test_a_senseless_time_is_refused():
    with pytest.raises(BadInputError, match="--for is 0"):
        examine_bench(DoctorRequest(sim_bench(), 0.0))


def test_it_can_be_stopped():
    stop = StopRequest()
    stop.ask()
    with pytest.raises(InterruptError):
        examine_bench(DoctorRequest(sim_bench(), stop=stop))
