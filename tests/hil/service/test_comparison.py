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
    assert (found.plan_summary, found.plan_more) == (found.differences, 0)
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


def test_a_run_of_a_changed_copy_is_compared_and_what_differs_is_named(
    service: Served, two: tuple[int, int]
) -> None:
    text = service.get("/plans/short/text").decode().replace("name: short", "name: copied")
    text = text.replace("to_nm: $torque_nm", "to_nm: 120")
    service.give(
        "copied",
        text.replace(
            "metric: peak_shaft_torque, upper: 400, unit: N m", "metric: jerk, upper: 99, unit: m/s³"
        ),
    )
    copied = service.queue("copied")
    service.over(copied)
    found = Client(service.url).comparison(two[0], copied)
    told = {one.name: (one.first, one.other, one.unit) for one in found.differences}
    assert told["segment s (step): to_nm"] == ("100 ($torque_nm)", "120", "N m")
    assert [one.id for one in found.segments] == ["s"]
    by_id = {one.id: one for one in found.criteria}
    assert by_id["s.peak_shaft_torque"].values[1] is None
    assert by_id["s.peak_shaft_torque"].verdicts == ("pass", None)
    assert by_id["s.jerk"].verdicts[0] is None
    assert None not in by_id["s.arrival"].values


def test_the_best_run_is_the_one_farthest_from_its_limits_of_the_same_plan_first(
    service: Served, two: tuple[int, int]
) -> None:
    """A copy that is farther from its limits counts only for runs whose own plan has none that passed."""
    text = service.get("/plans/short/text").decode().replace("name: short", "name: gentle")
    service.give("gentle", text.replace("to_nm: $torque_nm", "to_nm: 60"))
    gentle = service.queue("gentle")
    assert service.over(gentle)["verdict"] == "pass"
    best = Client(service.url).best_run(two[1])
    assert best.run is not None
    assert (best.run.id, best.criterion) == (two[0], "s.peak_shaft_torque")
    peak = Client(service.url).comparison(two[0], gentle).criteria[0].values[0]
    assert best.margin == pytest.approx((400 - peak) / 400)  # type: ignore[operator]
    best = Client(service.url).best_run(gentle)
    assert best.run is not None
    assert best.run.id == gentle
    with pytest.raises(RefusedError, match="there is no run"):
        Client(service.url).best_run(99999)


def _step_s(service: Served, run: int) -> float:
    result = service.ask("GET", f"/api/v1/runs/{run}/files/result.json")
    return float(result["segments"][0]["step_s"])
