"""What a recording says of the run that made it: its result, or as much of it as a cut file still tells."""

from __future__ import annotations

from hil.core.errors import BadInputError
from hil.core.recording._table import Recording
from hil.core.result import AcceptedExpiry, RunResult, Segment

#: Attachment with the run's result, written when the run has ended.
RUN = "run.json"
#: Prefix of the metadata tables that hold the run's segments, written as each begins and as it ends.
SEGMENT = "segment/"
#: Prefix of the attachments that say what the devices' frames mean: DBC, EDS and the like.
DEVICE = "device/"
#: Metadata table of a recording that was decoded from logs of other tools: it may lack the axle's channels.
REPLAY = "replay"
#: Metadata table with the vehicle and road load that a panel confirmed.
VEHICLE = "vehicle"
#: Metadata table with who answered for sensors whose calibration had run out.
ACCEPTED_EXPIRY = "accepted expired calibration"


def run_of(recording: Recording) -> RunResult | None:
    """The stored result; of a recording that was cut off, the segments as far as they were recorded.

    None for a recording that another tool made.

    Raises:
        BadInputError: what is stored cannot be understood.
    """
    try:
        if RUN in recording.attachments:
            return RunResult.model_validate_json(recording.attachments[RUN])
        if "plan.yaml" not in recording.attachments or "run" not in recording.metadata:
            return None
        return _as_far_as_recorded(recording)
    except (ValueError, KeyError) as error:
        raise BadInputError(
            "its data of the run (run.json) are damaged",
            where=str(recording.source),
            fix="use another copy",
        ) from error


def accepted_expiry_of(recording: Recording) -> AcceptedExpiry | None:
    """Who answered for sensors whose calibration had run out before the run, if any had.

    Raises:
        ValueError: what is stored cannot be understood.
    """
    table = recording.metadata.get(ACCEPTED_EXPIRY)
    return AcceptedExpiry.model_validate_json(table["json"]) if table else None


def _as_far_as_recorded(recording: Recording) -> RunResult:
    run = recording.metadata["run"]
    last_s = recording.last_s if recording.samples else 0.0
    tables = [table for name, table in recording.metadata.items() if name.startswith(SEGMENT)]
    segments = [Segment.model_validate_json(table["json"]) for table in tables]
    return RunResult(
        verdict="error",
        plan=run.get("plan", "?"),
        bench=run.get("bench", "?"),
        started_at=run.get("started_at", ""),
        real_time_factor=0.0,
        bench_time_s=last_s,
        safe_state="not_confirmed",
        segments=tuple(_cut(segment, last_s) for segment in segments if segment.start_s < last_s),
        accepted_expired=accepted_expiry_of(recording),
        reason="the recording was cut off before the run had ended; its safe state is not known",
    )


def _cut(segment: Segment, last_s: float) -> Segment:
    """A segment ends with the recording; one that had not ended was not recorded whole."""
    if segment.complete and segment.end_s <= last_s + 0.01:
        return segment
    return segment.model_copy(update={"end_s": min(segment.end_s, last_s), "complete": False})
