"""What in a bench file contradicts itself: each mistake by key and value."""

from __future__ import annotations

from typing import Any

import pytest

from hil.engine.bench._bench_checks import contradictions, device_mistakes, file_mistakes, unprintable
from hil.engine.bench.bench_tables import BenchFile
from tests.benches_for_tests import SIM


def with_bus(name: str, **changes: Any) -> BenchFile:
    buses = SIM.buses | {name: SIM.buses["rmcu"].model_copy(update=changes)}
    return BenchFile.model_construct(**{**dict(SIM), "buses": buses})


def test_the_shipped_bench_has_none() -> None:
    assert contradictions(SIM) == []
    assert device_mistakes(SIM) == []


def test_control_characters_are_told_with_their_keys_and_a_dut_may_have_lines() -> None:
    data = {
        "name": "a\x1b[31m",
        "dut": {"note": "two\n\tlines", "serial": "\x07"},
        "vehicle": {"k\x00": 1.0, "colour": "two\nlines"},
    }
    told = unprintable(data)
    assert [text.partition(":")[0].partition(" = ")[0] for text in told] == [
        "name",
        "dut.serial",
        "vehicle.k\\x00",
        "vehicle.colour",
    ]
    assert all("\x1b" not in text and "\x00" not in text for text in told)


@pytest.mark.parametrize(
    ("bus", "changes", "said"),
    [
        ("third", {"channel": "sim/third"}, "buses.third: no device uses it"),
        ("dyno", {}, "is also buses.rmcu"),
        ("rmcu", {"interface": "sockatcan"}, "did you mean 'socketcan'?"),
        ("rmcu", {"interface": "zzzz"}, "python-can has no such interface; known: "),
        ("rmcu", {"interface": "socketcan"}, "hardware with [simulation]"),
        ("rmcu", {"channel": "elsewhere/rmcu"}, "with name = 'sim' this simulated bus is 'sim/rmcu'"),
        ("rmcu", {"options": {"fd": True}}, "buses.rmcu.options: the simulated bench takes none"),
        ("rmcu", {"options": {"bitrate": 1}}, "buses.rmcu.options.bitrate: must be set outside of options"),
    ],
)
def test_buses_that_contradict_the_rest(bus: str, changes: dict[str, Any], said: str) -> None:
    assert any(said in text for text in contradictions(with_bus(bus, **changes)))


def test_a_simulated_bus_needs_a_simulation_and_each_device_its_bus() -> None:
    without = SIM.model_copy(update={"simulation": None})
    assert sum("a simulated bus without [simulation]" in text for text in contradictions(without)) == 2
    lost = SIM.model_copy(update={"buses": {"rmcu": SIM.buses["rmcu"]}})
    assert contradictions(lost)[0] == "dyno.bus = 'dyno': bus 'dyno' is not under [buses]; known: rmcu"
    none = SIM.model_copy(update={"buses": {}})
    assert contradictions(none)[0].endswith("known: none")


def test_devices_on_one_simulated_bus_are_refused() -> None:
    dyno = SIM.dyno.model_copy(update={"bus": "rmcu"})
    one = SIM.model_copy(update={"dyno": dyno, "buses": {"rmcu": SIM.buses["rmcu"]}})
    told = [text for text in contradictions(one) if text.startswith("dyno.bus")]
    assert told == ["dyno.bus = 'rmcu': is also rmcu.bus; the simulated bench has a bus for each"]


def test_a_file_that_cannot_be_used_is_told_with_its_key_and_on_one_line(tmp_path: Any) -> None:
    (tmp_path / "broken.dbc").write_text("VERSION 1 2 3\nBO_ nothing\n")
    rmcu = SIM.rmcu.model_copy(update={"dbc": tmp_path / "broken.dbc"})
    (told,) = file_mistakes({"rmcu": rmcu, "dyno": SIM.dyno, "devices": {}}, None)
    assert told.startswith("rmcu.dbc = 'broken.dbc': ")
    assert "\n" not in told


def test_device_files_that_no_simulated_bench_can_be_made_of_are_told(tmp_path: Any) -> None:
    whole = SIM.rmcu.dbc.read_text("utf-8")
    (tmp_path / "other.dbc").write_text(whole.replace("RMCU_ParameterWrite", "RMCU_Unknown"))
    bench = SIM.model_copy(update={"rmcu": SIM.rmcu.model_copy(update={"dbc": tmp_path / "other.dbc"})})
    (told,) = device_mistakes(bench)
    assert told.startswith("for the simulated bench: ")
    assert "RMCU_ParameterWrite" in told
    assert str(tmp_path) not in told  # the key shows the file


@pytest.mark.parametrize(
    ("held", "said"),
    [
        ({"sigma": 3.0, "k_i_dfc": 0.005}, ""),
        (
            {"k_i_dcf": 0.005},
            "simulation.rmcu.k_i_dcf: the RMCU has no such parameter; did you mean 'k_i_dfc'? known: ",
        ),
        ({"torque_limit": 1e5}, "simulation.rmcu.torque_limit = 100000: the RMCU does not take this value"),
    ],
)
def test_parameters_that_the_simulated_rmcu_keeps_are_those_that_it_has(
    held: dict[str, float], said: str
) -> None:
    simulation = SIM.simulation.model_copy(update={"rmcu": held})
    told = device_mistakes(SIM.model_copy(update={"simulation": simulation}))
    assert len(told) == bool(said)
    assert all(mistake.startswith(said) for mistake in told)
