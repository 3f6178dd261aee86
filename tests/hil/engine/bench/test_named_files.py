"""Which files a bench file names: of every device and of the simulation, wherever they are said to lie."""

from __future__ import annotations

import tomllib

import pytest

from hil.engine.bench.bench_file import shipped, shipped_benches
from hil.engine.bench.named_files import named_files


def test_files_of_devices_and_the_model_are_named_as_they_stand() -> None:
    text = shipped("sim_whole.toml").read_text("utf-8").replace('"rmcu.dbc"', '"../../etc/x.dbc"')
    found = dict(named_files(tomllib.loads(text)))
    assert found["rmcu.dbc"] == "../../etc/x.dbc"
    assert found["dyno.eds"] == "rcs_dyno.eds"
    assert found["devices.ram.symbols"] == "rmcu.a2l"
    assert found["simulation.model"].endswith(".toml")


@pytest.mark.parametrize("name", shipped_benches())
def test_every_shipped_file_that_a_shipped_bench_speaks_of_is_named(name: str) -> None:
    text = shipped(f"{name}.toml").read_text("utf-8")
    data = tomllib.loads(text)
    beside = [
        path.name for path in shipped("sim.toml").parent.iterdir() if path.suffix in (".dbc", ".eds", ".a2l")
    ]
    named = {value for _, value in named_files(data)}
    assert {file for file in beside if f'"{file}"' in text} <= named


def test_what_is_no_bench_file_names_nothing() -> None:
    for data in ({}, {"rmcu": 3}, {"devices": {"x": 1}}, {"simulation": "x"}, {"simulation": {"model": 4}}):
        assert list(named_files(data)) == []
