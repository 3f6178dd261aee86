"""What a view asks about a run of the real service: under way and afterwards, from near and from far."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import numpy as np
import pytest
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

from hil.core.files.signatures import sign_folder
from hil.core.recording import read_recording
from tests.hil.service.served import ASKING, SHORT, RefusedError, Served, served

pytestmark = pytest.mark.slow
TORQUE = "shaft_torque_nm"


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service whose run 1 has ended."""
    folder = tmp_path_factory.mktemp("views")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT)
        service.give("asking", ASKING)
        service.over(service.queue())
        yield service


def asked(there: Served, what: str, *channels: str, run: int = 1, **more: float) -> Any:
    query = [*(("channel", name) for name in channels), *more.items()]
    return there.get(f"/runs/{run}/{what}?{urlencode(query)}")


def recorded(there: Served) -> tuple[np.ndarray, np.ndarray]:
    recording = read_recording(there.data / "runs/000001/recording.mcap")
    return recording.time_s, recording[TORQUE]


def test_a_view_has_all_of_a_run_but_its_samples(there: Served) -> None:
    view = there.get("/runs/1/view")
    time, _ = recorded(there)
    assert (view["live"], view["first_s"], view["last_s"]) == (False, time[0], time[-1])
    assert view["channels"][TORQUE] == "N m"
    (segment,) = [mark for mark in view["marks"] if mark["kind"] == "segment"]
    assert segment["start_s"] < segment["step_s"] < segment["end_s"]
    assert ("arm", "drives enabled") in [(mark["name"], mark["text"]) for mark in view["marks"]]
    assert view["criteria"][0]["id"] == "s.peak_shaft_torque"
    assert any(line["channel"] == TORQUE and line["above"] for line in view["limits"])
    assert set(view["evidence"]["files"]) >= {"report.pdf", "junit.xml"}
    assert len(view["evidence"]["samples_sha256"]) == 64


def test_limits_are_those_that_the_run_was_watched_by(there: Served) -> None:
    limits = {line["channel"]: line["above"] for line in there.get("/runs/1/view")["limits"]}
    assert limits["shaft_torque_left_nm"] == 600.0
    assert limits[TORQUE] == 1200.0  # of both sides
    path = there.data / "runs/000001/result.json"
    result = json.loads(path.read_text())
    for one in result["limits"]:
        one["above"] /= 2  # as if the bench had had half of today's
    before = path.read_text()
    path.write_text(json.dumps(result))
    halved = {line["channel"]: line["above"] for line in there.get("/runs/1/view")["limits"]}
    path.write_text(before)
    assert halved == {channel: above / 2 for channel, above in limits.items()}


def test_who_signed_a_run_is_seen_and_a_broken_signature_is_no_ones(there: Served) -> None:
    folder, key = there.data / "runs/000001", Ed25519PrivateKey.generate()
    assert there.get("/runs/1/view")["evidence"]["signed_by"] == ""
    manifest, signature = sign_folder(folder, key, by="anna", at="2026-01-01T12:00:00Z")
    assert there.get("/runs/1/view")["evidence"]["signed_by"] == "anna"
    signature.write_bytes(bytes(64))
    assert there.get("/runs/1/view")["evidence"]["signed_by"] == ""
    manifest.unlink()
    signature.unlink()


def test_from_far_no_peak_is_lost(there: Served) -> None:
    _, torque = recorded(there)
    trace = asked(there, "traces", TORQUE, most=10)["channels"][TORQUE]
    assert len(trace["highest"]) <= 10
    assert max(trace["highest"]) == pytest.approx(torque.max(), rel=1e-5)
    assert min(trace["lowest"]) == pytest.approx(torque.min(), rel=1e-5)


def test_from_near_each_sample_is_seen_where_it_was_measured(there: Served) -> None:
    time, torque = recorded(there)
    found = asked(there, "traces", TORQUE, start_s=0.5, end_s=0.6, most=200)
    inside = (time >= 0.5 - 1e-9) & (time <= 0.6 + 1e-9)
    assert found["exact"]
    middles = found["start_s"] + (np.arange(inside.sum()) + 0.5) * found["width_s"]
    assert middles == pytest.approx(time[inside], abs=1e-6)
    assert found["channels"][TORQUE]["lowest"] == pytest.approx(torque[inside], rel=1e-5, abs=1e-9)


def test_a_spectrum_has_the_energy_of_its_stretch(there: Served) -> None:
    found = asked(there, "spectrum", TORQUE, start_s=0.3, end_s=1.5)
    assert found["step_hz"] == pytest.approx(1 / 1.2, rel=0.01)
    band = [density for at, density in enumerate(found["density"]) if 8.5 <= at * found["step_hz"] <= 19.5]
    assert 0.5 < found["band_energy"] / (sum(band) * found["step_hz"]) < 2.0


def test_samples_of_channels_are_of_the_same_moments(there: Served) -> None:
    time, torque = recorded(there)
    found = asked(there, "samples", TORQUE, "motor_speed_rad_s", most=100)
    assert found["every"] == -(-len(time) // 100)
    assert found["channels"][TORQUE] == pytest.approx(torque[:: found["every"]], rel=1e-5, abs=1e-9)
    assert len(found["channels"]["motor_speed_rad_s"]) == len(found["time_s"]) <= 100


@pytest.mark.parametrize("what", ["traces", "spectrum", "samples"])
def test_a_channel_that_is_not_there_is_refused_with_those_there_are(there: Served, what: str) -> None:
    with pytest.raises(RefusedError, match="has no channel 'nothing'") as refused:
        asked(there, what, "nothing")
    assert refused.value.status == 422
    assert TORQUE in refused.value.problem["fix"]


def test_what_was_kept_of_a_run_is_made_again_where_it_is_lost(tmp_path: Path) -> None:
    with served(tmp_path / "data", state=tmp_path / "state") as before:
        before.give("short", SHORT)
        before.over(before.queue())
        seen = asked(before, "traces", TORQUE, most=100)
    facts = tmp_path / "data/overviews/000001/envelope.json"
    assert facts.is_file()
    facts.write_text("{")
    with served(tmp_path / "data", state=tmp_path / "state") as after:
        assert asked(after, "traces", TORQUE, most=100) == seen


def test_a_run_under_way_is_seen_back_to_its_beginning(there: Served) -> None:
    run = there.queue("asking")
    there.until(run, lambda found: "cage" in found["message"])
    view = there.get(f"/runs/{run}/view")
    assert (view["live"], view["evidence"]) == (True, None)
    assert any(mark["name"] == "s" for mark in view["marks"])
    found = asked(there, "traces", TORQUE, run=run, most=50)
    assert found["start_s"] < 0.1
    assert max(one or 0.0 for one in found["channels"][TORQUE]["highest"]) > 50.0
    assert asked(there, "spectrum", TORQUE, run=run)["band_energy"] > 0.0
    there.post(f"/runs/{run}/answer", {"text": "yes"})
    there.over(run)


def test_a_run_that_recorded_nothing_is_refused(there: Served) -> None:
    there.post("/benches/sim/emergency-stop")
    run = there.queue()
    there.post(f"/runs/{run}/abort")
    with pytest.raises(RefusedError, match="nothing was recorded"):
        there.get(f"/runs/{run}/view")
    there.post("/benches/sim/reset")
