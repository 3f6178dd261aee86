"""Identifications and diagnoses of runs: asked for, told, cancelled, and what a service that ends leaves."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from hil.api_schemas.api import RunWanted
from hil.api_schemas.study import STUDY_OVER, DiagnosisWanted, IdentificationWanted, StudyData
from hil.client import Client, RefusedError
from tests.hil.service.served import SHORT, Served, served

#: A chirp of some seconds: enough for a fit, not for a good one.
CHIRP = """
name: chirp
steps:
  - hold_speed: {speed_km_h: 20, duration_s: 0.5}
  - chirp:
      segment: c
      quantity: motor_torque
      from_hz: 0.5
      to_hz: 30
      duration_s: 12
      amplitude_nm: 20
      fade_s: 0.5
finally:
  - ramp_down: {duration_s: 1}
"""
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, int]]:
    folder = tmp_path_factory.mktemp("studies")
    with served(folder / "data", state=folder / "state") as service:
        service.give("chirp", CHIRP)
        run = service.queue("chirp")
        assert service.over(run)["state"] == "ended"
        yield service, run


def over(client: Client, study: StudyData, within_s: float = 240.0) -> StudyData:
    until_s = time.monotonic() + within_s
    while (found := client.study(study.id)).state not in STUDY_OVER:
        assert time.monotonic() < until_s, found
        time.sleep(0.2)
    return found


def test_a_model_is_identified_given_and_designed_for(there: tuple[Served, int]) -> None:
    service, run = there
    client = Client(service.url)
    study = over(client, client.identify(IdentificationWanted(runs=[run])))
    assert study.state == "ended", study.reason
    found = client.identification(study.id)
    assert {one.channel for one in found.outputs} >= {"motor_speed_rad_s", "shaft_torque_nm"}
    assert [one.order for one in found.orders if one.integrator] == [2, 3, 4, 5, 6, 7]
    assert sum(one.chosen for one in found.orders) == 1
    assert {one.model for one in found.orders if one.model} <= set(study.files)
    assert {one.model for one in found.chains} <= set(study.files)
    assert all(one.misfit.keys() == {o.channel for o in found.outputs} for one in found.orders if one.model)
    assert {len(found.frequency_hz)} == {len(one.coherence) for one in found.outputs}
    assert found.resonance_hz == pytest.approx(11.4, rel=0.05)
    ratio = next(one for one in found.parameters if one.name == "gear_ratio")
    assert ratio.lower is None or ratio.lower < ratio.value < ratio.upper  # type: ignore[operator]
    text = service.get(f"/studies/{study.id}/files/model.toml").decode()
    assert client.give_model("found", text).kind == "transfer_function"


def test_a_diagnosis_is_cancelled_and_leaves_the_next_its_turn(there: tuple[Served, int]) -> None:
    service, run = there
    client = Client(service.url)
    first = client.diagnose(DiagnosisWanted(model="three_inertia", runs=[run], at_most_min=5))
    second = client.identify(IdentificationWanted(runs=[run]))
    assert client.study(second.id).state == "waiting"
    assert client.cancel_study(first.id).state == "cancelled"
    assert over(client, second).state == "ended"
    with pytest.raises(RefusedError, match="is finished"):
        client.cancel_study(first.id)
    third = client.identify(IdentificationWanted(runs=[run]))
    with pytest.raises(RefusedError, match=rf"study {third.id} is (waiting|running)"):
        client.remove_study(third.id)
    over(client, third)
    client.remove_study(first.id)
    assert first.id not in {one.id for one in client.studies()}
    with pytest.raises(RefusedError, match="there is no study"):
        client.remove_study(first.id)
    assert {("local", "study cancelled"), ("local", "study removed")} <= {
        (one.who, one.action) for one in client.audit()
    }


def test_a_diagnosis_tells_map_gap_and_verdict(there: tuple[Served, int]) -> None:
    service, run = there
    client = Client(service.url)
    asked = DiagnosisWanted(model="three_inertia", runs=[run], at_most_min=0.2)
    study = over(client, client.diagnose(asked))
    assert study.state == "ended", study.reason
    found = client.diagnosis(study.id)
    assert found.verdict in ("named", "none", "unknown")
    assert len(found.map.recordings) == len(found.map.before) == len(found.map.after) >= 1
    assert len(found.map.before[0]) == len(found.map.channels) == 3
    assert len(found.map.before[0][0]) == len(found.map.bands_hz)
    assert set(found.gap) <= set(found.map.channels)


def test_what_cannot_be_studied_is_said(there: tuple[Served, int]) -> None:
    service, run = there
    client = Client(service.url)
    with pytest.raises(RefusedError, match="there is no run '99999'"):
        client.identify(IdentificationWanted(runs=[99999]))
    with pytest.raises(RefusedError, match="there is no model 'none'"):
        client.diagnose(DiagnosisWanted(model="none", runs=[run]))
    with pytest.raises(RefusedError, match="there is no study"):
        client.study(99999)
    study = over(client, client.identify(IdentificationWanted(runs=[run, run])))
    assert (study.state, "twice" in study.reason or "same" in study.reason) == ("failed", True), study.reason
    with pytest.raises(RefusedError, match="has no result"):
        client.identification(study.id)
    assert f"the recording of run {run}" in study.reason


def test_a_refusal_names_runs_and_no_places_of_the_machine(there: tuple[Served, int]) -> None:
    service, _ = there
    client = Client(service.url)
    service.give("short", SHORT)
    short = service.queue("short")
    assert service.over(short)["state"] == "ended"
    study = over(client, client.identify(IdentificationWanted(runs=[short])))
    assert study.state == "failed"
    assert f"the recording of run {short}" in study.reason
    assert str(service.data) not in study.reason
    assert "--segment" not in study.reason or "options with --" in study.reason


def test_a_service_that_is_killed_leaves_an_interrupted_study(tmp_path: Path) -> None:
    with served(tmp_path / "data", state=tmp_path / "state") as one:
        client = Client(one.url)
        one.give("chirp", CHIRP)
        mine = client.queue(RunWanted(plan="chirp", bench="sim"))
        *_, last = client.progress(mine.id)
        study = client.diagnose(DiagnosisWanted(model="three_inertia", runs=[last.id], at_most_min=5))
        while client.study(study.id).state != "running":
            time.sleep(0.1)
        one.process.kill()
        one.process.wait()
    kept = json.loads((tmp_path / f"data/studies/{study.id:06d}/study.json").read_text("utf-8"))
    assert kept["state"] == "running"
    left = int((tmp_path / f"data/studies/{study.id:06d}/process").read_text("utf-8"))
    assert Path(f"/proc/{left}").exists()
    with served(tmp_path / "data", state=tmp_path / "state") as one:
        found = Client(one.url).study(study.id)
        assert (found.state, found.runs) == ("interrupted", [last.id])
        until_s = time.monotonic() + 20.0
        while Path(f"/proc/{left}").exists() and "Z" not in _state_of(left):
            assert time.monotonic() < until_s, "the process of the killed service goes on"
            time.sleep(0.1)


def _state_of(process: int) -> str:
    """`Z` of one that has ended and that no one has asked for."""
    try:
        return Path(f"/proc/{process}/stat").read_text("utf-8").rpartition(")")[2].split()[0]
    except OSError:
        return "Z"
