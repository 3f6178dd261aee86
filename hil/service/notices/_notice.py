"""A notice: what happened, in words, and as data."""

from __future__ import annotations

import datetime
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from hil.api_schemas.api import RunData, TrendData
from hil.service.control_chart import LENGTHS
from hil.service.notices._settings import Event

_SAFE = {"confirmed": "confirmed", "not_confirmed": "NOT CONFIRMED", "not_needed": "not needed"}


@dataclass(frozen=True)
class Notice:
    """What a recipient gets once; `id` is the same however often it is sent."""

    id: str
    events: tuple[Event, ...]
    bench: str
    subject: str
    text: str
    at: datetime.datetime
    data: dict[str, Any]

    def as_json(self) -> dict[str, Any]:
        """The body of a webhook."""
        return {
            "type": self.events[0],
            "timestamp": self.at.isoformat(),
            "data": {"bench": self.bench, "subject": self.subject, "text": self.text, **self.data},
        }


def of_run(run: RunData, address: str) -> Notice | None:
    """Of a run that has ended or waits for approval; None for any other, and one that a person cancelled."""
    data = {"run": run.model_dump(mode="json", exclude={"files"}), "url": _link(address, f"runs/{run.id}")}
    name = run.title or run.plan
    if run.state == "waiting_approval":
        subject = f"{run.bench}: run {run.id} of '{name}' waits for approval"
        text = f"{run.requested_by} asks for it. {run.hazard}"
        return _notice(f"run-{run.id}-approval", ("approval_asked",), run, subject, text, data)
    if run.state not in ("ended", "interrupted"):
        return None
    verdict = run.verdict or ("interrupted" if run.state == "interrupted" else "error")
    events: tuple[Event, ...] = ("run_ended",)
    if verdict not in ("pass", "done"):
        events = ("run_failed", *events)
    if "limit tripped" in run.reason:
        events = ("limit_tripped", *events)
    subject = f"{run.bench}: run {run.id} of '{name}' ended: {verdict.upper()}"
    safe = f"Safe state: {_SAFE[run.safe_state]}. " if run.safe_state else ""
    return _notice(f"run-{run.id}-ended", events, run, subject, f"{safe}{run.reason}", data)


def of_drifts(run: RunData, found: Iterable[TrendData], address: str) -> list[Notice]:
    """Of criteria whose values break a rule of control charts with this run; once for a stretch."""
    notices = []
    for trend in found:
        for signal in trend.signals:
            begins = len(signal.runs) == LENGTHS[signal.rule]
            if not (begins and signal.present and signal.runs[-1] == run.id):
                continue
            subject = f"{run.bench}: {trend.criterion} of '{run.title or run.plan}' drifts"
            text = f"{signal.text[0].upper()}{signal.text[1:]} (runs {', '.join(map(str, signal.runs))})."
            data = {
                "criterion": trend.criterion,
                "rule": signal.rule,
                "runs": signal.runs,
                "url": _link(
                    address, f"trends?bench={run.bench}&plan={run.plan}&criterion={trend.criterion}"
                ),
            }
            id_ = f"drift-{run.id}-{trend.criterion}-{signal.rule}"
            notices.append(_notice(id_, ("drift",), run, subject, text, data))
    return notices


def of_stop(bench: str, why: str, address: str) -> Notice:
    """Of an emergency stop that has just been latched."""
    at = _now()
    subject = f"{bench}: emergency stop"
    data = {"url": _link(address, f"benches/{bench}")}
    text = f"{why}. The bench stays stopped until somebody resets it."
    return Notice(f"stop-{bench}-{at.timestamp():.0f}", ("bench_stopped",), bench, subject, text, at, data)


def of_test(address: str) -> Notice:
    """One by which an administrator sees that notices arrive."""
    at = _now()
    text = "Nothing has happened. Notices of the bench service arrive here."
    return Notice(f"test-{at.timestamp():.0f}", ("test",), "", "Test of notices", text, at, {"url": address})


def _notice(
    id_: str, events: tuple[Event, ...], run: RunData, subject: str, text: str, data: dict[str, Any]
) -> Notice:
    at = run.ended_at or run.queued_at
    return Notice(id_, events, run.bench, subject, text.strip(), at, data)


def _link(address: str, path: str) -> str:
    return f"{address.rstrip('/')}/{path}" if address else ""


def _now() -> datetime.datetime:
    return datetime.datetime.now(datetime.UTC)
