"""Mistakes of a plan that is being written: each on its line; a forecast of its text as it stands."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from hil.service.files.plan_checks import mistakes_of
from hil.service.worker_pool.plan_reading import read_given
from tests.hil.service.served import SHORT, RefusedError, Served, served
from tests.hil.service.test_access import tokens as tokens  # a service with people of every role


def mistakes(text: str, folder: Path) -> list[tuple[int | None, str]]:
    with pytest.raises(BadInputError) as refused:
        read_given("short", text, folder)
    return [(one.line, one.key) for one in mistakes_of(refused.value)]


def test_every_mistake_has_its_line_and_key(tmp_path: Path) -> None:
    text = SHORT.replace("variables:", "tile: x\nvariables:").replace(
        "hold_speed: {speed_km_h", "hold_speed: {kmh"
    )
    found = mistakes(text, tmp_path)
    assert found[0] == (3, "tile")
    assert {(8, "steps[2].hold_speed.kmh"), (8, "steps[2].hold_speed.speed_km_h")} <= set(found)


def test_what_is_no_yaml_has_the_line_where_it_stops(tmp_path: Path) -> None:
    assert mistakes("name: short\nsteps: [\n", tmp_path) == [(3, "")]


def test_another_name_is_on_no_line(tmp_path: Path) -> None:
    assert mistakes(SHORT.replace("name: short", "name: other"), tmp_path) == [(None, "")]


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("checks")
    with served(folder / "data", state=folder / "state") as service:
        yield service


@pytest.mark.slow
def test_a_text_is_checked_and_foreseen_and_nothing_is_kept(there: Served) -> None:
    found = there.post("/plan-checks", {"name": "short", "text": SHORT})
    assert (found["mistakes"], found["plan"]["name"]) == ([], "short")
    wrong = there.post("/plan-checks", {"name": "short", "text": SHORT.replace("upper: 400", "uper: 400")})
    assert [(one["line"], one["key"]) for one in wrong["mistakes"]] == [(12, "criteria[1].uper")]
    wanted = {"plan": "short", "bench": "sim", "text": SHORT, "values": {"torque_nm": 150}}
    forecast = there.post("/forecasts", wanted)
    assert forecast["fits"]
    assert forecast["criteria"][0]["id"] == "s.peak_shaft_torque"
    assert forecast["largest_requests_nm"] == {"driving_torque": 150.0}  # with the value as it was chosen
    with pytest.raises(RefusedError, match="torque_nm") as refused:
        there.post("/forecasts", {**wanted, "values": {"torque_nm": 900}})
    assert refused.value.status == 422
    assert "short" not in {plan["name"] for plan in there.get("/plans")}


@pytest.mark.slow
def test_an_operator_foresees_given_plans_only(tokens: tuple[Served, dict[str, str]]) -> None:
    service, secrets = tokens
    wanted = {"plan": "short", "bench": "sim", "text": SHORT}
    with pytest.raises(RefusedError, match="engineer is needed") as refused:
        service.ask("POST", "/api/v1/forecasts", wanted, token=secrets["operator"])
    assert refused.value.status == 403
