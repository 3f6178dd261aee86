"""A mistake in a bench file is told with its line."""

from __future__ import annotations

import tomllib

import pytest

from hil.core.errors import BadInputError
from hil.core.errors.mistakes import line_of
from hil.engine.bench.bench_file import bench_from_dict, load_bench
from tests.benches_for_tests import SIM

TEXT = """# a bench
name = "x"

[buses.rmcu]   # the first
interface = "hil-sim"
channel="x/rmcu"
[ buses . "my bus" ]
"interface" = 'virtual'
dotted.key = 1
[dyno]
idle = { "front left" = 1 }
"""


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("name", 2),
        ("buses.rmcu", 4),
        ("buses.rmcu.interface", 5),
        ("buses.rmcu.channel", 6),
        ("buses.rmcu.bit_rate", 4),
        ("buses.my bus.interface", 8),
        ("buses.my bus.dotted.key", 9),
        ("dyno.idle.front left", 11),
        ("limits", None),
    ],
)
def test_the_line_is_that_of_the_key_or_of_what_is_around_it(key: str, line: int | None) -> None:
    assert line_of(TEXT, key) == line


def refused(text: str) -> str:
    with pytest.raises(BadInputError) as caught:
        bench_from_dict(tomllib.loads(text), text, SIM.source)
    return str(caught.value)


def test_simulated_and_real_buses_in_one_file_are_told_with_file_line_key_and_what_to_do() -> None:
    mixed = SIM.text.replace('"hil-sim"', '"socketcan"', 1)
    assert refused(mixed).startswith(
        f"{SIM.source}, line 7: buses.rmcu.interface = 'socketcan': hardware with [simulation]; "
        "leave [simulation] out, or make it 'hil-sim'"
    )
    real = load_bench("rear_axle_socketcan").text
    assert (
        "line 7: buses.rmcu.interface = 'hil-sim': a simulated bus without [simulation]; "
        "add [simulation] with a model"
    ) in refused(real.replace('"socketcan"', '"hil-sim"', 1))
    with_simulation = real + '\n[simulation]\nmodel = "three_inertia.toml"\n'
    told = refused(with_simulation)
    assert "line 7: buses.rmcu.interface = 'socketcan': hardware with [simulation]" in told
    assert "line 12: buses.dyno.interface = 'socketcan': hardware with [simulation]" in told
