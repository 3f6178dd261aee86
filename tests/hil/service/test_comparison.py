"""Two runs side by side: criteria, what was given differently, and traces that lose no peak."""

from __future__ import annotations

import numpy as np
import pytest

from hil.client import Client, RefusedError
from hil.core.recording import read_recording
from tests.hil.service.served import Served

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def two(service: Served) -> tuple[int, int]:
    first = service.queue(values={"torque_nm": 100})
    other = service.queue(values={"torque_nm": 120})
    assert {service.over(first)["verdict"], service.over(other)["verdict"]} == {"pass"}
    return first, other


def test_criteria_stand_side_by_side_and_what_was_given_differently_is_named(
    service: Served, two: tuple[int, int]
) -> None:
    found = Client(service.url).comparison(*two)
    assert [(one.kind, one.name, one.first, one.other) for one in found.differences] == [
        ("plan", "variables.torque_nm.default", "100", "120")
    ]
    peak = found.criteria[0]
    assert peak.relative == pytest.approx(peak.values[1] / peak.values[0] - 1)  # type: ignore[operator]
    assert (peak.better, peak.source) == ("lower", "plan")
    assert {one.better for one in found.criteria if one.id == "s.arrival"} == {""}
    assert 0.1 < found.distance < 0.3  # type: ignore[operator]
    assert [one.id for one in found.segments] == ["s"]
    assert found.segments[0].start_s == pytest.approx(-0.2)


@pytest.mark.parametrize("most", [10, 77, 4000])
def test_no_peak_is_lost_in_however_few_buckets(service: Served, two: tuple[int, int], most: int) -> None:
    found = Client(service.url).traces(*two, "s", "shaft_torque_nm", most=most)
    for run, envelope in zip(two, found.runs, strict=True):
        recording = read_recording(service.data / f"runs/{run:06d}/recording.mcap")
        segment = service.get(f"/comparisons?first={two[0]}&other={two[1]}")["segments"][0]
        step_s = _step_s(service, run)
        time = recording.time_s - step_s
        inside = (time >= segment["start_s"]) & (time < segment["end_s"])
        values = recording["shaft_torque_nm"][inside]
        assert max(one for one in envelope.highest if one is not None) == pytest.approx(
            np.max(values), rel=1e-5
        )
        assert min(one for one in envelope.lowest if one is not None) == pytest.approx(
            np.min(values), rel=1e-5, abs=1e-5
        )
        assert len(envelope.highest) <= most


def test_what_cannot_be_compared_is_said_in_the_names_of_runs(service: Served, two: tuple[int, int]) -> None:
    client = Client(service.url)
    with pytest.raises(RefusedError, match="there is no run"):
        client.comparison(two[0], 99999)
    with pytest.raises(RefusedError, match="has no 'nothing' in a segment 's'"):
        client.traces(*two, "s", "nothing")
    with pytest.raises(RefusedError, match="no data were measured in this period"):
        client.traces(*two, "s", "shaft_torque_nm", within_s=(50.0, 60.0))
    text = service.get("/plans/short/text").decode().replace("name: short", "name: longer")
    service.give("longer", text.replace("duration_s: 0.2}\n  - step", "duration_s: 0.3}\n  - step"))
    longer = service.queue("longer")
    service.over(longer)
    with pytest.raises(RefusedError, match=f"run {longer}: ran a different plan from run {two[0]}"):
        client.comparison(two[0], longer)


def _step_s(service: Served, run: int) -> float:
    result = service.ask("GET", f"/api/v1/runs/{run}/files/result.json")
    return float(result["segments"][0]["step_s"])
