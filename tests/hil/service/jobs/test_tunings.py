"""Tunings over the API: on a model, and by a sequence within the envelope that a person consented to."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hil.client import AutotuningPlanned, AutotuningWanted, Client, TuningWanted
from tests.hil.analysis.tuning.trials import PLAN
from tests.hil.service.served import RefusedError, Served, served

pytestmark = pytest.mark.slow
_OVER = ("ended", "failed", "cancelled", "interrupted")
_API = "/api/v1"


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("tunings")
    with served(folder / "data", state=folder / "state") as service:
        service.give("short", PLAN)
        yield service


def over(service: Served, study: int, within_s: float = 300.0) -> dict[str, Any]:
    until_s = time.monotonic() + within_s
    while (found := service.ask("GET", f"{_API}/studies/{study}"))["state"] not in _OVER:
        assert time.monotonic() < until_s, found
        time.sleep(0.3)
    assert isinstance(found, dict)
    return found


def _sequences(there: Served) -> list[Path]:
    return list((there.data / "studies" / "sequences").glob("*"))


def test_a_tuning_has_a_front_and_a_controller_that_is_given(there: Served) -> None:
    wanted = {"plan": "short", "model": "three_inertia", "bench": "sim", "starts": 0, "at_most_min": 0.2}
    asked = there.ask("POST", f"{_API}/tunings", wanted)
    assert (asked["kind"], asked["plan"], asked["bench"]) == ("tuning", "short", "sim")
    study = over(there, asked["id"])
    assert study["state"] == "ended", study["reason"]
    found = there.ask("GET", f"{_API}/tunings/{asked['id']}")
    assert found["worst_margin"] >= found["start_worst_margin"]
    assert found["progress"]["text"].startswith("tune short")
    assert all(len(one["figures"]) == len(found["figures"]) for one in found["front"])
    text = there.ask("GET", f"{_API}/studies/{asked['id']}/files/controller.toml")
    there.ask("PUT", f"{_API}/controllers/tuned", text.decode() if isinstance(text, bytes) else text)


def test_a_sequence_stays_in_the_envelope_that_was_consented_to(there: Served) -> None:
    planned = {"plan": "short", "model": "three_inertia", "bench": "sim", "rounds": 1, "runs": 1}
    envelope = there.ask("POST", f"{_API}/autotunings/envelopes", planned)
    assert envelope["runs"] == 3
    assert _sequences(there) == []  # a preview leaves none
    assert envelope["largest"]["motor_torque_nm"] > 0
    agreed = {
        "largest": {**envelope["largest"], "motor_torque_nm": 0.5},
        "bench_time_s": envelope["bench_time_s"],
        "confirm": "A. Name",
    }
    asked = there.ask("POST", f"{_API}/autotunings", {**planned, **agreed})
    study = over(there, asked["id"])
    assert study["state"] == "failed"
    assert "would leave the envelope" in study["reason"]
    assert _sequences(there) == []


def test_decisions_are_shown_as_they_fall_and_a_sequence_is_stopped(there: Served) -> None:
    planned = {"plan": "short", "model": "three_inertia", "bench": "sim", "rounds": 1, "runs": 1}
    envelope = there.ask("POST", f"{_API}/autotunings/envelopes", planned)
    agreed = {"largest": envelope["largest"], "bench_time_s": envelope["bench_time_s"], "confirm": "A. Name"}
    asked = there.ask("POST", f"{_API}/autotunings", {**planned, **agreed, "diagnose_min": 0.5})
    until_s = time.monotonic() + 300
    address = f"{_API}/autotunings/{asked['id']}"
    while len((found := there.ask("GET", address))["decisions"]) < 2:
        assert time.monotonic() < until_s, found
        time.sleep(0.2)
    assert [one["stage"] for one in found["decisions"][:2]] == ["consent", "identify"]
    there.ask("POST", f"{_API}/studies/{asked['id']}/cancel")
    assert over(there, asked["id"])["state"] in ("cancelled", "ended")
    assert _sequences(there) == []


def test_a_preview_that_is_refused_leaves_no_sequence(there: Served) -> None:
    planned = {"plan": "short", "model": "none", "bench": "sim", "rounds": 1, "runs": 1}
    with pytest.raises(RefusedError, match="there is no model 'none'"):
        there.ask("POST", f"{_API}/autotunings/envelopes", planned)
    assert _sequences(there) == []


def test_sequences_that_a_killed_service_left_go_with_its_next_start(tmp_path: Path) -> None:
    left = tmp_path / "data" / "studies" / "sequences" / "old.yaml"
    left.parent.mkdir(parents=True)
    left.write_text("name: autotune")
    with served(tmp_path / "data", state=tmp_path / "state"):
        assert not left.exists()


def test_what_cannot_be_tuned_is_refused(there: Served, tmp_path: Path) -> None:
    del tmp_path
    wanted = {"plan": "none", "model": "three_inertia", "bench": "sim"}
    with pytest.raises(RefusedError, match="there is no plan 'none'"):
        there.ask("POST", f"{_API}/tunings", wanted)
    with pytest.raises(RefusedError, match="422"):
        there.ask(
            "POST", f"{_API}/autotunings", {**wanted, "plan": "short", "largest": {}, "bench_time_s": 9}
        )


def test_a_client_tunes_follows_and_gets_the_controller(there: Served, tmp_path: Path) -> None:
    client = Client(there.url)
    wanted = TuningWanted(plan="short", model="three_inertia", bench="sim", starts=0, at_most_min=0.2)
    study = client.tune(wanted)
    *_, last = client.tuning_progress(study.id)
    assert last.study.state == "ended", last.study.reason
    assert last.worst_margin is not None
    assert last.start_worst_margin is not None
    assert last.worst_margin >= last.start_worst_margin
    assert last.parameters
    client.download_of_study(study.id, "controller.toml", tmp_path / "controller.toml")
    assert client.give_controller("by_client", (tmp_path / "controller.toml").read_text("utf-8")).name


def test_a_client_plans_begins_and_ends_a_sequence(there: Served) -> None:
    client = Client(there.url)
    planned = AutotuningPlanned(plan="short", model="three_inertia", bench="sim", rounds=1, runs=1)
    envelope = client.plan_autotuning(planned)
    assert envelope.bench == "sim"
    limits = {"largest": envelope.largest, "bench_time_s": envelope.bench_time_s}
    study = client.autotune(AutotuningWanted(**planned.model_dump(), **limits, confirm="A. Name"))
    followed = client.autotuning_progress(study.id)
    first = next(one for one in followed if one.decisions)
    assert first.decisions[0].stage == "consent"
    client.cancel_study(study.id)
    *_, last = client.autotuning_progress(study.id)
    assert last.study.state in ("cancelled", "ended")
    assert study.id in {one.id for one in client.studies()}
    client.remove_study(study.id)
