from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.recording import Event, Recording
from hil.core.result import CriterionResult, RunResult
from reports import write_reports
from tests.reports import synthetic

HOSTILE = '<script>alert(1)</script> $x$ *b* #panic("x") \\ 試験 \x07 &amp; _'


@pytest.fixture
def recording() -> Recording:
    return synthetic.recording()


@pytest.fixture
def result() -> RunResult:
    return synthetic.result()


@pytest.fixture(scope="session")
def acceptance(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Reports of a run that passed."""
    return write_reports(synthetic.recording(), synthetic.result(), tmp_path_factory.mktemp("acceptance"))


@pytest.fixture(scope="session")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Reports of a run that went wrong, with markup in every text that comes from a file."""
    recording, result = synthetic.recording(), synthetic.result()
    run = recording.metadata["run"] | {"title": HOSTILE, "operator": HOSTILE}
    recording.metadata |= {"run": run, "dut": {HOSTILE: HOSTILE}, "versions": {HOSTILE: HOSTILE}}
    recording.attachments[HOSTILE] = HOSTILE.encode()
    recording.events += [Event(96.0, HOSTILE, HOSTILE), Event(96.1, "broken", "half a pair \ud83d")]
    recording.notes.append(HOSTILE)
    recording.channels[HOSTILE] = recording.time_s
    failed = result.criteria[0].model_copy(update={"upper": 330.0, "verdict": "fail", "title": HOSTILE})
    broken = CriterionResult(
        id=HOSTILE, value=None, unit=HOSTILE, verdict="error", reason=HOSTILE, definition=HOSTILE
    )
    segments = [s.model_copy(update={"controller": s.controller + HOSTILE}) for s in result.segments]
    result = result.model_copy(
        update={
            "verdict": "fail",
            "safe_state": "not_confirmed",
            "plan": HOSTILE,
            "reason": HOSTILE,
            "criteria": (failed, broken, *result.criteria[1:]),
            "segments": tuple(segments),
        }
    )
    return write_reports(recording, result, tmp_path_factory.mktemp("hostile"))
