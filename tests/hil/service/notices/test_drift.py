"""A drift is a notice once, with the run that breaks the rule."""

from __future__ import annotations

import datetime

from hil.api_schemas.api import RunData, TrendPoint
from hil.service.notices._notice import of_drifts
from hil.service.trends import trends

_NOW = datetime.datetime(2026, 11, 28, tzinfo=datetime.UTC)
_SCATTER = (0.0, 1.0, -1.0, 0.5, -0.5, 1.0, -1.0, 0.0, 0.5, -0.5)


def _run(number: int) -> RunData:
    return RunData(
        id=number, plan="p", title="Plan", bench="rig", state="ended", values={}, priority=0,
        requested_by="a", queued_at=_NOW, ended_at=_NOW, verdict="pass",
    )  # fmt: skip


def _drifts(values: list[float]) -> list[str]:
    points = [
        (
            "s.peak",
            TrendPoint(run=n, ended_at=_NOW, dut="d", value=v, unit="N m", upper=400.0, verdict="pass"),
        )
        for n, v in enumerate(values, start=1)
    ]
    return [one.data["rule"] for one in of_drifts(_run(len(values)), trends(points), "http://there")]


def test_scatter_is_no_drift_and_a_rise_is_one_once() -> None:
    steady = [240.0 + 2.0 * one for one in _SCATTER]
    assert _drifts(steady) == []
    rising = [*steady, *(238.0 + 0.6 * n for n in range(6))]
    assert "nelson_3" in _drifts(rising)
    assert "nelson_3" not in _drifts([*rising, 242.0])


def test_a_value_far_off_is_a_notice_though_it_passes() -> None:
    steady = [240.0 + 2.0 * one for one in _SCATTER] * 2
    [rule, *_] = _drifts([*steady, 260.0])
    assert rule == "nelson_1"
