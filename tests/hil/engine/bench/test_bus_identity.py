"""What two tables of bench files have in common that mean one port, and what tells two ports apart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from hil.engine.bench import bus_settings
from hil.engine.bench.bench_tables import Bus
from hil.engine.bench.bus_settings import identity_of, may_be_same


def of(interface: str, channel: str | int, **options: Any) -> str:
    table = {"interface": interface, "channel": channel, "bit_rate": 500_000, "options": options}
    return identity_of(Bus.model_validate(table))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (of("socketcan", "can0"), of("socketcan", "can0", receive_own_messages=True, local_loopback=False)),
        (of("slcan", "/dev/ttyACM7"), of("slcan", "/dev/ttyACM7@2000000", sleep_after_open=1)),
        (of("slcan", "/dev/ttyACM7"), of("robotell", "/dev/../dev/ttyACM7")),
        (of("slcan", "com3"), of("slcan", "COM3")),
        (
            of("socketcand", "can0", host="localhost", port=29536),
            of("socketcand", "can0", port=29536, host="127.0.0.1", tcp_tune=True),
        ),
        (of("socketcand", "can0", host="::1", port=1), of("socketcand", "can0", host="127.0.0.1", port="1")),
        (of("hil-udp", "localhost:47110"), of("hil-udp", "127.0.0.1:47110")),
        (of("vector", 0, serial=100), of("vector", 0, serial=100, app_name="x")),
        (of("kvaser", 1), of("kvaser", "1", accept_virtual=False)),
    ],
)
def test_one_port(one: str, other: str) -> None:
    assert one == other


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (of("socketcan", "can0"), of("socketcan", "can1")),
        (of("socketcan", "can1"), of("socketcan", "can10")),
        (of("slcan", "/dev/ttyACM7"), of("slcan", "/dev/ttyACM8")),
        (of("socketcand", "can0", host="a", port=1), of("socketcand", "can0", host="b", port=1)),
        (of("socketcand", "can0", host="a", port=1), of("socketcand", "can0", host="a", port=2)),
        (of("hil-udp", "127.0.0.1:1"), of("hil-udp", "127.0.0.1:2")),
        (of("vector", 0, serial=100), of("vector", 0, serial=101)),
    ],
)
def test_two_ports(one: str, other: str) -> None:
    assert not may_be_same(one, other)


def test_a_table_that_does_not_say_which_adapter_may_mean_any() -> None:
    assert may_be_same(of("vector", 0), of("vector", 0, serial=100))
    assert may_be_same(of("ixxat", 0, unique_hardware_id="HW1"), of("ixxat", 0))


def test_a_bus_within_the_process_is_nobody_elses() -> None:
    assert of("hil-sim", "sim/rmcu") == of("virtual", 0) == ""


def test_an_adapter_that_comes_back_as_another_tty_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bus_settings, "_BY_ID", tmp_path / "by-id")
    (tmp_path / "by-id").mkdir()
    link = tmp_path / "by-id/usb-CANable_1234"
    found = []
    for name in ("ttyACM0", "ttyACM1"):
        (tmp_path / name).touch()
        link.unlink(missing_ok=True)
        link.symlink_to(tmp_path / name)
        found += [of("slcan", str(tmp_path / name)), of("slcan", str(link))]
    assert len(set(found)) == 1
