"""Identifications and diagnoses of runs.

One that was under way when the service ended is interrupted: it can be asked for again, no bench hangs on it.
"""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from hil.api_schemas.study import StudyData, StudyKind
from hil.app.requests import AutotuneRequest, DiagnoseRequest, IdentifyRequest, TuneRequest
from hil.app.worker.job_feedback import PROGRESS
from hil.core.errors import HilError
from hil.service.jobs.job_repository import kill_left
from hil.service.jobs.jobs import Jobs
from hil.service.jobs.shared_results import SharedResults
from hil.service.plain_words import in_plain_words

_LAST_WORDS_S = 20.0
_TUNED_WITHIN_S = 90.0  # an interrupted tuning writes its report, a run its end steps


StudyRequest = IdentifyRequest | DiagnoseRequest | TuneRequest | AutotuneRequest


@dataclass(frozen=True)
class StudyAsked:
    """What somebody wants studied: numbers of runs and of given recordings, held out ones among them."""

    kind: StudyKind
    runs: list[int]
    recordings: list[int]
    model: str
    by: str
    plan: str = ""
    bench: str = ""
    names: Mapping[str, str] = field(default_factory=dict)  # of its files as people know them, by path
    sequence: Path | None = None  # written for it alone: it goes with its end


class Studies(Jobs[StudyData]):
    """All of them, by number.

    Args:
        folder: where each has a folder of its own.
        shared: those of other services.
    """

    def __init__(self, folder: Path, shared: SharedResults[StudyData]) -> None:
        super().__init__(folder, "study.json", StudyData, shared, "study", "studies")
        self._sequences: dict[int, Path] = {}
        for study in self._records:
            if not self.is_over(study):
                kill_left(self._records.folder_of(study.id))
                self._end(study.id, "interrupted", "the service ended during the study; start it again")
        shutil.rmtree(self.sequences_folder(), ignore_errors=True)  # of studies that are over by now

    def of_kind(self, kind: StudyKind | None) -> list[StudyData]:
        """Newest first, also those of other services."""
        return [study for study in self.all() if kind in (None, study.kind)]

    def add(
        self,
        asked: StudyAsked,
        request: StudyRequest,
        within_s: float,
    ) -> StudyData:
        """Have one executed in its turn.

        Args:
            asked: what it is of, as it is shown.
            request: without the place for the results.
            within_s: how long it may take.

        Raises:
            BadInputError: too many wait already.
        """
        self._refuse_too_many()
        number = self._records.take_number()
        study = StudyData(
            id=number,
            kind=asked.kind,
            state="waiting",
            runs=asked.runs,
            recordings=asked.recordings,
            model=asked.model,
            plan=asked.plan,
            bench=asked.bench,
            requested_by=asked.by,
            asked_at=datetime.datetime.now(datetime.UTC),
        )
        self._records.keep(study)
        if asked.sequence is not None:
            self._sequences[number] = asked.sequence
        placed = replace(request, out=self.results(number).resolve())
        self._begin(number, self._execute(number, placed, within_s, asked.names))
        return study

    def sequences_folder(self) -> Path:
        """Where sequences of tunings are, each until its tuning is over."""
        return self._records.folder_of(0).parent / "sequences"

    def progress_of(self, number: int) -> dict[str, Any]:
        """What one of this service has reported while it works; {} where nothing is known."""
        with contextlib.suppress(OSError, ValueError):
            found: dict[str, Any] = json.loads((self._records.folder_of(number) / PROGRESS).read_bytes())
            return found
        return {}

    async def cancel(self, number: int) -> bool:
        """End one; what a diagnosis knows by then it writes down. False if it is over."""
        found = await super().cancel(number)
        study = self._records.get(number)
        if found and study is not None and not self.is_over(study):  # it had not started
            self._end(number, "cancelled", "cancelled")
        return found

    async def _execute(
        self, number: int, request: StudyRequest, within_s: float, names: Mapping[str, str]
    ) -> None:
        try:
            self._records.change(number, state="running")
            tunes = isinstance(request, TuneRequest | AutotuneRequest)
            last_words_s = _TUNED_WITHIN_S if tunes else _LAST_WORDS_S
            async with self._process(number, request, last_words_s) as process:
                code, reason = await asyncio.wait_for(process.over(), within_s)
            self._end(number, *(("ended", "") if code == 0 else ("failed", in_plain_words(reason, names))))
        except TimeoutError:
            self._end(number, "failed", f"took more than {within_s:g} s")
        except asyncio.CancelledError:
            self._end(number, "cancelled", "cancelled")
            raise
        except (HilError, OSError) as error:
            self._end(number, "failed", in_plain_words(str(error), names))

    def _progress(self, number: int) -> dict[str, Any]:
        del number
        return {}

    def _end(self, number: int, state: str, reason: str) -> None:
        sequence = self._sequences.pop(number, None)
        if sequence is not None:
            with contextlib.suppress(OSError):
                sequence.unlink(missing_ok=True)
        self._change(number, state=state, reason=reason)
