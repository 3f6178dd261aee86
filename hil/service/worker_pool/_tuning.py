"""What a sequence of runs would ask of its bench, predicted before anybody consents."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hil.app.autotune.autotune import proposed_envelope
from hil.app.requests import AutotuneRequest
from hil.core.channels import CHANNELS


def envelope(sequence: str, model: str, bench: str) -> dict[str, Any]:
    """Fields of `EnvelopeData` but the bench's name.

    Raises:
        BadInputError: plans, model and bench cannot be used together.
    """
    found = proposed_envelope(AutotuneRequest(sequence=sequence, model=Path(model), bench=bench))
    return {
        "largest": dict(found.largest),
        "units": {name: CHANNELS[name].unit for name in found.largest},
        "runs": found.runs,
        "bench_time_s": found.bench_time_s,
        "words": found.in_words(),
    }
