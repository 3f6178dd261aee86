"""Runs: wanted, watched, steered, compared, and what they leave."""

from __future__ import annotations

import time
import urllib.parse
from collections.abc import Iterator, Mapping
from pathlib import Path

from hil.api_schemas.api import (
    OVER,
    Answer,
    ForecastData,
    ForecastWanted,
    RunChange,
    RunData,
    RunWanted,
    TrendData,
)
from hil.api_schemas.comparison import BestRunData, ComparisonData, TracesData
from hil.api_schemas.notes import NoteData, NoteWanted, RunNotes
from hil.api_schemas.run_list import FoundRuns, RunsWanted
from hil.client._requests import Requests, part

_FORECAST_WITHIN_S = 300.0
_LOOK_S = 0.5


class RunRequests(Requests):
    """Runs: wanted, watched, steered, compared, and what they leave."""

    def forecast(self, plan: str, bench: str, values: Mapping[str, float] | None = None) -> ForecastData:
        """Duration, peaks and criteria as predicted."""
        wanted = ForecastWanted(plan=plan, bench=bench, values=dict(values or {}))
        return self._one(ForecastData, "POST", "/forecasts", wanted, within_s=_FORECAST_WITHIN_S)

    def runs(self, bench: str | None = None, most: int = 50) -> list[RunData]:
        """Runs, newest first."""
        query = {"most": str(most)} | ({"bench": bench} if bench else {})
        return self._several(RunData, f"/runs?{urllib.parse.urlencode(query)}")

    def find_runs(self, wanted: RunsWanted) -> FoundRuns:
        """A page of all runs that pass the filters, sorted by the service."""
        chosen = wanted.model_dump(mode="json", exclude_defaults=True)
        query = urllib.parse.urlencode(chosen, doseq=True)
        return self._one(FoundRuns, "GET", f"/run-list?{query}")

    def trends(self, bench: str, plan: str, like: int | None = None) -> list[TrendData]:
        """Each criterion of a plan on a bench over its newest runs with the values of the last, or `like`."""
        query = {"bench": bench, "plan": plan} | ({} if like is None else {"like": str(like)})
        return self._several(TrendData, f"/trends?{urllib.parse.urlencode(query)}")

    def run(self, run: int) -> RunData:
        """A run."""
        return self._one(RunData, "GET", f"/runs/{run}")

    def notes(self, run: int) -> RunNotes:
        """Notes and tags that people have added to a run."""
        return self._one(RunNotes, "GET", f"/runs/{run}/notes")

    def add_note(self, run: int, text: str) -> NoteData:
        """Add a note to a run."""
        return self._one(NoteData, "POST", f"/runs/{run}/notes", NoteWanted(text=text))

    def tag(self, run: int, tag: str) -> None:
        """Have a run found by a tag."""
        self._done("PUT", f"/runs/{run}/tags/{part(tag)}")

    def queue(self, wanted: RunWanted) -> RunData:
        """Queue a run; with a key, a repeated request queues no second."""
        return self._one(RunData, "POST", "/runs", wanted)

    def set_priority(self, run: int, priority: int) -> RunData:
        """Change the place of a run in its queue."""
        return self._one(RunData, "PATCH", f"/runs/{run}", RunChange(priority=priority))

    def approve(self, run: int) -> RunData:
        """Approve a run of a hazardous plan that somebody else wants."""
        return self._one(RunData, "POST", f"/runs/{run}/approve")

    def pause(self, run: int) -> RunData:
        """Hold a run at its next safe point."""
        return self._one(RunData, "POST", f"/runs/{run}/pause")

    def resume(self, run: int) -> RunData:
        """Let a run go on that is held."""
        return self._one(RunData, "POST", f"/runs/{run}/resume")

    def answer(self, run: int, text: str) -> RunData:
        """Answer the operator's prompt of a run."""
        return self._one(RunData, "POST", f"/runs/{run}/answer", Answer(text=text))

    def abort(self, run: int) -> RunData:
        """End a run that is under way with its end steps, or cancel one that waits."""
        return self._one(RunData, "POST", f"/runs/{run}/abort")

    def progress(self, run: int) -> Iterator[RunData]:
        """The run every half second, until it is over; the last time as it ended."""
        while True:
            found = self.run(run)
            yield found
            if found.state in OVER:
                return
            time.sleep(_LOOK_S)

    def comparison(self, first: int, other: int) -> ComparisonData:
        """Two runs side by side; they may be of two plans."""
        query = f"first={first}&other={other}"
        return self._one(ComparisonData, "GET", f"/comparisons?{query}", within_s=_FORECAST_WITHIN_S)

    def best_run(self, run: int) -> BestRunData:
        """The best of the runs that passed the same criteria as this one."""
        return self._one(BestRunData, "GET", f"/comparisons/best?run={run}")

    def traces(
        self,
        first: int,
        other: int,
        segment: str,
        channel: str,
        *,
        within_s: tuple[float, float] | None = None,
        most: int = 600,
    ) -> TracesData:
        """A channel of a segment of two runs, in `most` buckets; `within_s` of the step, or the whole."""
        asked: dict[str, object] = {"first": first, "other": other, "segment": segment, "channel": channel}
        asked |= {"most": most}
        if within_s is not None:
            asked |= {"start_s": within_s[0], "end_s": within_s[1]}
        query = urllib.parse.urlencode(asked)
        return self._one(TracesData, "GET", f"/comparisons/traces?{query}", within_s=_FORECAST_WITHIN_S)

    def download(self, run: int, name: str, path: Path) -> None:
        """Write a file of a run, whole or not at all.

        Raises:
            BadInputError: the place cannot be written.
        """
        self._download(f"/runs/{run}/files/{part(name)}", path)
