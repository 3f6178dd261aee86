"""What is wrong with a bus, or with a SocketCAN interface, and what to do about it."""

from types import SimpleNamespace
from typing import Any

import pytest

from drivers.bus_health import Link
from hil.engine.bench.bench_tables import Bus
from hil.engine.commissioning.doctor._buses import findings_of_bus, judged
from hil.engine.commissioning.doctor.examination import BusFacts

BUS = Bus(interface="socketcan", channel="can0", bit_rate=1_000_000)
WELL = Link(up=True, state="ERROR-ACTIVE", bit_rate=1_000_000, transmit_errors=0, receive_errors=0)


def findings(**changes):
    return list(judged("rmcu", BUS, Link(**{**vars(WELL), **changes})))


def test_an_interface_that_is_well():
    assert findings() == []


def test_one_that_is_down():
    (finding,) = findings(up=False, state="STOPPED")
    assert finding.what == "the network interface is down"
    assert finding.fix == "bring it up with 'ip link set can0 up type can bitrate 1000000'"
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


def of_bus(
    frames: int = 100, errors: int = 0, remarks: tuple[str, ...] = (), *, expected: bool = True, **facts: Any
) -> list[tuple[str, str]]:
    heard: Any = SimpleNamespace(frames=frames, errors=errors)
    wire: Any = SimpleNamespace(remarks=remarks)
    bus = BusFacts("socketcan", "can0", 500_000, **facts)
    found = list(findings_of_bus("rmcu", bus, heard, wire, expected=expected))
    assert all(finding.where == "bus 'rmcu'" and finding.fix for finding in found)
    return [(finding.severity, finding.what) for finding in found]


@pytest.mark.parametrize(
    ("frames", "errors", "expected", "said"),
    [
        (100, 0, True, ""),
        (0, 0, False, ""),  # no one sends unasked
        (0, 0, True, "no frame received; the bench file says 500000 bit/s"),
        (0, 3, True, "no frame received but 3 error frames; the bench file says 500000 bit/s"),
        (0, 3, False, "no frame received but 3 error frames; the bench file says 500000 bit/s"),
        (100, 3, True, "3 error frames received"),
    ],
)
def test_a_bus_without_frames_or_with_errors_is_a_fault(
    frames: int, errors: int, expected: bool, said: str
) -> None:
    assert of_bus(frames, errors, expected=expected) == ([("fault", said)] if said else [])


def test_a_bus_is_busy_above_four_fifths_of_the_time() -> None:
    assert of_bus(load=0.8) == []
    assert of_bus(load=0.81) == [("hint", "bus load is 81%: frames are delayed")]


def test_eight_unknown_identifiers_are_shown_and_the_rest_counted() -> None:
    rates = {f"0x{number:03X}": 10.0 for number in range(1, 12)}
    eight = dict(list(rates.items())[:8])
    shown = ", ".join(f"{number} (10/s)" for number in eight)
    text = "frames of no device in the bench file: "
    assert of_bus(unknown=eight) == [("hint", text + shown)]
    assert of_bus(unknown=rates) == [("hint", f"{text}{shown} and 3 more")]
    assert of_bus(0, expected=False, unknown=rates) == []


def test_what_the_wire_remarks_is_told_but_for_errors_that_are_counted_already() -> None:
    remarks = ("12 error frames", "its stamps jump")
    assert of_bus(remarks=remarks) == [("hint", "its stamps jump")]
