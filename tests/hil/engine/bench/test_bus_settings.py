"""Tables of buses: what each make of adapter takes, and what is refused with its key."""

from __future__ import annotations

from typing import Any

import can
import pytest
from can.interfaces.kvaser import canlib as kvaser

from hil.core.errors import BadInputError
from hil.engine.bench.bench_file import bench_from_dict, load_bench
from hil.engine.bench.bench_tables import Bus
from hil.engine.bench.bus_settings import adapter_mistakes, can_settings, listens_only

SEGMENTS = {"tseg1": 63, "tseg2": 16, "sjw": 16}
DATA_SEGMENTS = {"data_tseg1": 15, "data_tseg2": 4, "data_sjw": 4}
CLASSIC = {"tseg1": 13, "tseg2": 2, "sjw": 1}
ONE_PHASE = {"f_clock": 80_000_000, "sample_point": 80.0}
BOTH_PHASES = {**ONE_PHASE, "data_sample_point": 75.0}
FD = {"fd": True, "data_bit_rate": 2_000_000}


def bus(interface: str, channel: str | int, **changes: Any) -> Bus:
    table = {"interface": interface, "channel": channel, "bit_rate": 500_000, **changes}
    return Bus.model_validate(table)


@pytest.mark.parametrize(
    "table",
    [
        bus("socketcan", "can0"),
        bus("socketcan", "can0", fd=True),
        bus("slcan", "/dev/ttyACM0", timing={"f_clock": 8_000_000, "sample_point": 87.5}),
        bus("slcan", "/dev/ttyACM0", **FD, timing={"f_clock": 80_000_000, **SEGMENTS, **DATA_SEGMENTS}),
        bus("pcan", "PCAN_USBBUS1"),
        bus("pcan", "PCAN_USBBUS1", **FD,
            timing=BOTH_PHASES),
        bus("kvaser", 0, **FD),
        bus("kvaser", 0, timing={"f_clock": 16_000_000, **CLASSIC}),
        bus("vector", 0, options={"app_name": "hil"}),
        bus("socketcand", "can0", options={"host": "127.0.0.1", "port": 29536}),
        bus("somebody-elses", 3, **FD, timing=BOTH_PHASES),
    ],
)  # fmt: skip
def test_what_adapters_take(table: Bus) -> None:
    assert list(adapter_mistakes("rmcu", table)) == []
    assert can_settings("rmcu", table).channel == table.channel


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (bus("kvaser", "0"), "buses.b.channel = '0': 'kvaser' counts its channels; write channel = 0"),
        (bus("kvaser", "usb"), "write channel = 0"),
        (bus("socketcan", 0),
         "buses.b.channel = 0: 'socketcan' knows channels by name; write channel = \"can0\""),
        (bus("slcan", 0), 'write channel = "/dev/ttyACM0"'),
        (bus("socketcan", "can0", timing={"f_clock": 8_000_000, "sample_point": 80.0}),
         "buses.b.timing: 'socketcan' takes no bit timing; Linux sets it: ip link set can0 type can"),
        (bus("socketcan", "can0", **FD), "data_bit_rate = 2000000: 'socketcan' takes none; Linux sets it"),
        (bus("gs_usb", 0, fd=True), "buses.b.fd: 'gs_usb' does no CAN FD"),
        (bus("kvaser", 0, data_bit_rate=2_000_000), "without CAN FD; add fd = true"),
        (bus("pcan", "PCAN_USBBUS1", **FD), "buses.b.fd: 'pcan' needs the timing of both phases"),
        (bus("kvaser", 0, **FD, timing=ONE_PHASE), "is without a data phase"),
        (bus("kvaser", 0, fd=True, timing=BOTH_PHASES),
         "the data phase has no rate; add data_bit_rate"),
        (bus("kvaser", 0, timing={"f_clock": 80_000_000, **SEGMENTS, **DATA_SEGMENTS}),
         "has a data phase; add fd"),
        (bus("kvaser", 0, timing={"f_clock": 1_000_001, "sample_point": 80.0}), "buses.b.timing: "),
        (bus("socketcand", "can0", options={"host": "x"}), "buses.b.options.port: is missing"),
    ],
)  # fmt: skip
def test_what_adapters_do_not_take_is_told_with_key_and_suggestion(table: Bus, said: str) -> None:
    assert any(said in mistake for mistake in adapter_mistakes("b", table))


def test_timing_is_what_python_can_makes_of_it() -> None:
    table = bus("kvaser", 0, timing={"f_clock": 16_000_000, **CLASSIC})
    timing = can_settings("b", table).timing
    assert isinstance(timing, can.BitTiming)
    assert (timing.bitrate, timing.tseg1, timing.tseg2, timing.sjw) == (500_000, 13, 2, 1)
    table = bus("vector", 0, **FD, timing={"f_clock": 80_000_000, **SEGMENTS, **DATA_SEGMENTS})
    fd = can_settings("b", table).timing
    assert isinstance(fd, can.BitTimingFd)
    assert (fd.nom_bitrate, fd.data_bitrate, fd.data_tseg2) == (500_000, 2_000_000, 4)


#: Of python-can's documentation: the argument that keeps an adapter from acknowledging what it hears.
SILENT: dict[str, dict[str, Any]] = {
    "kvaser": {"driver_mode": kvaser.DRIVER_MODE_SILENT},
    "nixnet": {"listen_only": True},
    "pcan": {"state": can.BusState.PASSIVE},
    "seeedstudio": {"operation_mode": "silent"},
    "slcan": {"listen_only": True},
    "systec": {"state": can.BusState.PASSIVE},
    "vector": {"listen_only": True},
}


@pytest.mark.parametrize("interface", [*SILENT, "socketcan", "gs_usb"])
def test_an_adapter_that_can_is_told_not_even_to_acknowledge(interface: str) -> None:
    table = bus(interface, "c", options={"own": 1})
    silent = SILENT.get(interface, {})
    assert listens_only(table) is bool(silent)
    assert can_settings("b", table, listen_only=True).options == {"own": 1, **silent}
    assert can_settings("b", table).options == {"own": 1}


REAL = load_bench("rear_axle_socketcan")
CHANNEL = 'channel = "can0"'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("channel = true", "line 8: buses.rmcu.channel = True: is not a channel"),
        ("channel = 1.5", "line 8: buses.rmcu.channel = 1.5: is not a channel"),
        ('channel = ""', "line 8: buses.rmcu.channel = '': is not a channel"),
        ("channel = 256", "line 8: buses.rmcu.channel = 256: is not a channel; channels are numbered"),
        (f"{CHANNEL}\ntiming = {{ f_clock = 8000000 }}", "line 9: buses.rmcu.timing: is empty"),
        (f"{CHANNEL}\ntiming = {{ f_clock = 8000000, tseg1 = 5 }}", "give tseg1, tseg2 and sjw together"),
    ],
)  # fmt: skip
def test_a_table_that_is_wrong_is_told_with_its_line(text: str, said: str) -> None:
    import tomllib

    changed = REAL.text.replace(CHANNEL, text, 1)
    with pytest.raises(BadInputError) as caught:
        bench_from_dict(tomllib.loads(changed), changed, REAL.source)
    assert said in str(caught.value)
