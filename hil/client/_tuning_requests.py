"""Tunings of controllers, on a model and by sequences of runs on a simulated bench."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import TypeVar

from hil.api_schemas.study import STUDY_OVER, StudyData
from hil.api_schemas.tuning import (
    AutotuningData,
    AutotuningPlanned,
    AutotuningWanted,
    EnvelopeData,
    TuningData,
    TuningWanted,
)
from hil.client._requests import Requests

T = TypeVar("T", TuningData, AutotuningData)
_ENVELOPE_WITHIN_S = 300.0
_LOOK_S = 0.5


class TuningRequests(Requests):
    """Tunings; each is a study, which `cancel_study` ends and `remove_study` removes."""

    def tune(self, wanted: TuningWanted) -> StudyData:
        """Have a plan's controller tuned on a model; `tuning` tells how it goes."""
        return self._one(StudyData, "POST", "/tunings", wanted)

    def tuning(self, study: int) -> TuningData:
        """A tuning: how far it is, then the front of controllers and what was chosen."""
        return self._one(TuningData, "GET", f"/tunings/{study}")

    def tuning_progress(self, study: int) -> Iterator[TuningData]:
        """The tuning every half second, until it is over; the last time with what was chosen."""
        return _until_over(lambda: self.tuning(study))

    def plan_autotuning(self, wanted: AutotuningPlanned) -> EnvelopeData:
        """What a sequence would ask of its bench at most, predicted; nothing moves."""
        path = "/autotunings/envelopes"
        return self._one(EnvelopeData, "POST", path, wanted, within_s=_ENVELOPE_WITHIN_S)

    def autotune(self, wanted: AutotuningWanted) -> StudyData:
        """Begin a sequence within the envelope consented to; `autotuning` tells how it goes."""
        return self._one(StudyData, "POST", "/autotunings", wanted)

    def autotuning(self, study: int) -> AutotuningData:
        """A sequence: every decision by now with its reason, and what it came to."""
        return self._one(AutotuningData, "GET", f"/autotunings/{study}")

    def autotuning_progress(self, study: int) -> Iterator[AutotuningData]:
        """The sequence every half second, until it is over; the last time with what it came to."""
        return _until_over(lambda: self.autotuning(study))


def _until_over(look: Callable[[], T]) -> Iterator[T]:
    while True:
        found = look()
        yield found
        if found.study.state in STUDY_OVER:
            return
        time.sleep(_LOOK_S)
