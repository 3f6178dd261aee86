"""Opening adapters: every interface without its driver is one message; they are given what the file says."""

from __future__ import annotations

import socket
from typing import Any, ClassVar

import can
import pytest

from drivers import BusHealth, CanSettings, Wire, open_can
from drivers.bus_health import frame
from drivers.can_adapter import enlarged
from hil.core.errors import BenchError
from tests.clocks import SteppedClock
from tests.drivers.pseudo_adapter import warnings_in

OURS = {"hil-sim"}
ALWAYS_THERE = {"virtual", "udp_multicast"}  # the latter is never opened: it sends beyond this machine
ELSEWHERE = sorted(can.VALID_INTERFACES - OURS - ALWAYS_THERE)
NEED_SOFTWARE = {
    "canalystii", "cantact", "etas", "gs_usb", "iscan", "ixxat", "kvaser", "neousys", "neovi", "nican",
    "nixnet", "pcan", "systec", "usb2can", "vector",
}  # fmt: skip


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # destructors of half a bus
@pytest.mark.parametrize("interface", [name for name in ELSEWHERE if not name.startswith("hil-")])
def test_an_interface_without_its_driver_is_told_in_one_message(interface):
    port = socket.create_server(("127.0.0.1", 0))
    address = {"host": "127.0.0.1", "port": port.getsockname()[1]}
    port.close()  # no one listens there now
    options = address if interface == "socketcand" else {}
    channel: Any = 0 if interface in ("kvaser", "ixxat", "cantact", "canalystii") else "none7"
    with pytest.raises(BenchError) as caught:
        open_can(CanSettings("rmcu", interface, channel, 500_000, options=options))
    assert caught.value.exit_code == 3
    assert caught.value.where == f"bus 'rmcu' ({interface} {channel})"
    assert caught.value.fix
    assert "\n" not in caught.value.what
    if interface in NEED_SOFTWARE:
        assert "its driver is not installed" in caught.value.what
        assert caught.value.fix.startswith("install ")


class Given(can.BusABC):
    """Remembers what it was made with, and gives the messages that it is told to."""

    arguments: dict[str, Any]
    messages: list[can.Message]
    opened: ClassVar[list[can.BusABC]] = []

    def __init__(self, channel=None, **kwargs):
        Given.arguments = {"channel": channel, **kwargs}
        self.messages = []
        super().__init__(channel)
        Given.opened.append(self)

    def send(self, msg, timeout=None):
        raise can.CanOperationError("Failed to transmit: No buffer space available", 105)

    def _recv_internal(self, timeout):
        return (self.messages.pop(0) if self.messages else None), True


@pytest.fixture
def given(monkeypatch):
    for name in ("kvaser", "nixnet", "pcan", "gs_usb"):
        monkeypatch.setitem(can.interfaces.BACKENDS, name, (__name__, "Given"))
    yield
    while Given.opened:
        Given.opened.pop().shutdown()  # else python-can complains of it in the middle of another test


def test_channels_rates_and_timing_reach_the_adapter_as_they_are(given, monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / ".canrc").write_text("[default]\nreceive_own_messages = True\n")
    timing = can.BitTimingFd.from_sample_point(80_000_000, 500_000, 80.0, 2_000_000, 80.0)
    settings = CanSettings("a", "kvaser", 1, 500_000, True, 2_000_000, timing, {"accept_virtual": True})
    open_can(settings).shutdown()
    assert Given.arguments == {
        "channel": 1, "bitrate": 500_000, "fd": True, "data_bitrate": 2_000_000, "timing": timing,
        "accept_virtual": True,
    }  # fmt: skip
    open_can(CanSettings("a", "nixnet", "CAN1", 500_000, True, 2_000_000)).shutdown()
    assert Given.arguments["fd_bitrate"] == 2_000_000


def wire_of(interface):
    bus: Any = open_can(CanSettings("a", interface, 0, 500_000))
    return bus, Wire(
        "a", bus, SteppedClock(virtual=False), epoch_offset_s=1e9, health=BusHealth("a", interface, bus)
    )


def test_stamps_of_an_adapters_own_clock_begin_with_the_first_frame(given):
    bus, wire = wire_of("gs_usb")
    bus.messages = [can.Message(timestamp=5.0 + 0.001 * k, arbitration_id=k) for k in range(3)]
    assert wire.drain()["time_s"] == pytest.approx([0.0, 0.001, 0.002])
    bus, wire = wire_of("kvaser")
    bus.messages = [can.Message(timestamp=1e9 + 0.25 + k, arbitration_id=k) for k in range(3)]
    assert wire.drain()["time_s"] == pytest.approx([0.25, 1.25, 2.25])
    wire.close()


def test_a_full_transmit_queue_is_told_in_plain_words(given):
    _, wire = wire_of("kvaser")
    with pytest.raises(BenchError, match="sending failed: the transmit queue is full"):
        wire.send(0x100, b"")


@pytest.mark.parametrize(
    ("status", "said"), [(0x10, "bus-off"), (0x40000, "error-passive"), (0x80, "queue is full"), (0x8, None)]
)
def test_pcan_is_asked_for_its_state(given, status, said):
    bus, wire = wire_of("pcan")
    bus.status = lambda: status
    if said is None:
        wire.check()
        return
    with pytest.raises(BenchError, match=said):
        wire.check()
    wire.check()


def test_error_frames_of_adapters_that_say_no_more_are_counted_and_end_nothing(given, caplog):
    bus, wire = wire_of("kvaser")
    bus.messages = [frame(0.0, 0x40, 0) for _ in range(100)]
    wire.drain()
    wire.check()
    assert warnings_in(caplog) == ["bus 'a': 1 error frames so far", "bus 'a': 100 error frames so far"]


def test_a_receive_buffer_is_raised_and_what_was_granted_is_told():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as port:
        before = port.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        granted = enlarged(port, 4 * before)
        assert granted == port.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        assert granted > before


def test_only_the_bench_file_says_where_socketcand_is():
    with pytest.raises(BenchError, match="no socketcand answers at 127.0.0.1:1 "):
        open_can(CanSettings("a", "socketcand", "can0", 500_000, options={"host": "127.0.0.1", "port": 1}))
