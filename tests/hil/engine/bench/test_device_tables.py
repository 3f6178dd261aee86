"""Tables of devices are checked by the kind that they name; each mistake is told with its key."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from drivers import DynoTable, RmcuTable
from hil.core.errors.mistakes import mistakes_of
from hil.engine.bench.device_kinds import KINDS, descriptions_of, device_tables
from tests.benches_for_tests import SIM


def tables() -> dict[str, Any]:
    data = tomllib.loads(SIM.text)
    for key, file in (("rmcu", "dbc"), ("dyno", "eds")):
        data[key][file] = str(SIM.source.parent / data[key][file])
    return data


def test_kinds_have_defaults_and_can_be_named() -> None:
    assert {"rmcu-can", "rcs-canopen"} <= set(KINDS.names())
    data = tables()
    for _ in range(2):
        found, mistakes = device_tables(data)
        assert mistakes == []
        assert isinstance(found["rmcu"], RmcuTable)
        assert isinstance(found["dyno"], DynoTable)
        data["rmcu"]["kind"], data["dyno"]["kind"] = "rmcu-can", "rcs-canopen"


@pytest.mark.parametrize(
    ("key", "change", "said"),
    [
        ("rmcu", {"kind": 7}, "rmcu.kind = 7: is not a kind; known: "),
        ("rmcu", {"kind": ""}, "rmcu.kind = '': is not a kind; known: "),
        (
            "rmcu",
            {"kind": "rmcu-cam"},
            "rmcu.kind = 'rmcu-cam': no installed package provides it; did you mean",
        ),
        ("dyno", {"kind": "rmcu-can", "eds": None}, "dyno"),
        ("rmcu", {"colour": 1}, "rmcu.colour: unknown key"),
        ("rmcu", {"bus": 7}, "rmcu.bus = 7: "),
    ],
)
def test_a_mistake_is_told_and_the_table_stays(key: str, change: dict[str, Any], said: str) -> None:
    data = tables()
    data[key] |= change
    found, mistakes = device_tables(data)
    assert mistakes[0].startswith(said)
    assert found[key] == data[key]


def test_what_turns_no_wheels_is_no_dyno() -> None:
    data = tables()
    data["dyno"] = dict(data["rmcu"], kind="rmcu-can")
    _, mistakes = device_tables(data)
    assert mistakes == ["dyno.kind = 'rmcu-can': is not a dyno device; move it to [devices]"]


def test_further_devices_must_name_their_kind() -> None:
    data = tables() | {"devices": {"oil": {"port": "x"}, "pump": 3}}
    found, mistakes = device_tables(data)
    assert mistakes == [f"devices.oil.kind: is missing; known: {', '.join(KINDS.names())}"]
    assert found["devices"]["pump"] == 3  # refused with the whole file


class Inner(BaseModel, extra="forbid"):
    length_m: float


class Outer(BaseModel, extra="forbid"):
    rod: Inner
    tube: Inner


def test_pydantics_errors_become_key_value_and_what_would_be_right() -> None:
    with pytest.raises(ValidationError) as caught:
        Outer.model_validate({"rod": {"length_m": "long", "mass": 1}, "tube": {}})
    mistakes = mistakes_of(caught.value, Outer, "frame")
    assert mistakes[0].startswith("frame.rod.length_m = 'long': must be a number")
    assert mistakes[1:] == ["frame.rod.mass: unknown key", "frame.tube.length_m: is missing"]
    # of a table that was told of before, nothing is reported again
    assert (
        mistakes_of(caught.value, Outer, "", ["rod.length_m = 'long': no"])[-1] == "tube.length_m: is missing"
    )
    assert len(mistakes_of(caught.value, Outer, "", ["rod.length_m = 'long': no"])) == 2
    with pytest.raises(ValidationError) as again:
        Outer.model_validate({"rod": 3, "tube": {"length_m": {}}})
    assert mistakes_of(again.value, Outer)[1].startswith("tube.length_m = a table: ")


def test_the_largest_description_that_a_reader_takes_is_attached_too(tmp_path: Path) -> None:
    path = tmp_path / "engine.a2l"
    with path.open("wb") as file:
        file.truncate(70_000_000)  # holes: no room on the disk
    assert {name: len(content) for name, content in descriptions_of("ram", [path]).items()} == {
        "device/ram/engine.a2l": 70_000_000
    }
