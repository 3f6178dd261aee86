"""What is wrong with a SocketCAN interface, and what to do about it."""

from drivers.linux_links import Link
from hil.engine.bench_tables import Bus
from hil.engine.doctor._buses import judged

BUS = Bus(interface="socketcan", channel="can0", bit_rate=1_000_000)
WELL = Link(up=True, state="ERROR-ACTIVE", bit_rate=1_000_000, transmit_errors=0, receive_errors=0)


def findings(**changes):
    return list(judged("rmcu", BUS, Link(**{**vars(WELL), **changes})))


def test_an_interface_that_is_well():
    assert findings() == []


def test_one_that_is_down():
    (finding,) = findings(up=False, state="STOPPED")
    assert finding.what == "the network interface is down"
    assert finding.fix == "'ip link set can0 up type can bitrate 1000000' brings it up"
    assert finding.where == "bus 'rmcu' (socketcan can0)"


def test_another_bit_rate():
    (finding,) = findings(bit_rate=500_000)
    assert finding.what == "the interface runs at 500000 bit/s, the bench file says 1000000"


def test_error_counters():
    passive = findings(state="ERROR-PASSIVE", transmit_errors=128)
    assert [f.severity for f in passive] == ["fault"]
    assert "ERROR-PASSIVE (error counters: transmit 128, receive 0)" in passive[0].what
    (few,) = findings(receive_errors=3)
    assert (few.severity, few.what) == ("hint", "error counters: transmit 0, receive 3")


def test_listening_only_and_dropped_frames():
    assert [f.severity for f in findings(listen_only=True, dropped=7)] == ["fault", "hint"]
