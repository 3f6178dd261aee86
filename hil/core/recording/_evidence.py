"""What a recording carries beside its samples: the result of its run, and one JSON text that exports keep.

Of a file that was cut off the result is as much as the file still says.
"""

from __future__ import annotations

import base64
import contextlib
import hashlib
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hil.core.channels import unit_of
from hil.core.errors import BadInputError
from hil.core.files import open_regular
from hil.core.files.toml_file import FORMAT
from hil.core.recording._table import Event, Recording
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

#: Prefix of the metadata tables that say of an attachment where its file lay, and its SHA-256 there.
SOURCE = "source/"


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


#: Name of the text where a format has named places: an attachment of MDF4, a key of Parquet's metadata.
EVIDENCE = "hil_recording.json"
#: Beyond it a text is not read: plans, models and results are small.
LARGEST_BYTES = 1 << 26
_FORMAT = "hil recording"


class _Event(BaseModel):
    time_s: float = Field(allow_inf_nan=False)
    kind: str
    text: str


class _Attachment(BaseModel):
    """A file: its text, or where it is none its bytes in base 64."""

    sha256: str
    text: str | None = None
    base64: str | None = None

    def content(self) -> bytes | None:
        """The file; None if it is not what its hash says."""
        content = (self.text or "").encode() if self.base64 is None else base64.b64decode(self.base64)
        return content if hashlib.sha256(content).hexdigest() == self.sha256 else None


class _Evidence(BaseModel):
    model_config = ConfigDict(extra="ignore")

    format: Literal["hil recording"] = "hil recording"
    version: int = FORMAT
    source: str = Field("", description="file that was exported")
    samples: int
    first_time_s: float
    last_time_s: float
    table_sha256: str = Field("", description="of the file that it stands beside")
    units: dict[str, str] = {}
    metadata: dict[str, dict[str, str]] = {}
    attachments: dict[str, _Attachment] = {}
    events: list[_Event] = []
    damage: list[str] = []


def sidecar(path: Path) -> Path:
    """The file beside a CSV that says what it is a recording of."""
    return path.with_name(f"{path.name}.json")


def remove_sidecar(path: Path) -> None:
    """Remove the file beside a CSV that an earlier export wrote: it would speak of other samples."""
    beside = sidecar(path)
    with contextlib.suppress(OSError, BadInputError):
        with open_regular(beside) as file:
            is_ours = _FORMAT.encode() in file.read(200)
        if is_ours:
            beside.unlink()


def has_evidence(recording: Recording) -> bool:
    """Whether there is anything to keep beside the samples."""
    return bool(recording.metadata or recording.attachments or recording.events or recording.damage)


def evidence_of(recording: Recording, table_sha256: str = "") -> str:
    """Units, tables, files, events and damage of a recording, as JSON."""
    found = _Evidence(
        source=recording.source.name,
        samples=recording.samples,
        first_time_s=recording.first_s if recording.samples else 0.0,
        last_time_s=recording.last_s if recording.samples else 0.0,
        table_sha256=table_sha256,
        units={name: unit_of(name) for name in recording.channels if unit_of(name)},
        metadata=recording.metadata,
        attachments={name: _attached(content) for name, content in recording.attachments.items()},
        events=[_Event(time_s=e.time_s, kind=e.kind, text=e.text) for e in recording.events],
        damage=recording.damage,
    )
    return found.model_dump_json(indent=1, exclude_none=True) + "\n"


def take_evidence(recording: Recording, text: str | bytes, where: str, table_sha256: str = "") -> None:
    """Give a recording what `evidence_of` wrote of it; what does not fit is left out, and listed in `damage`.

    Args:
        where: name of the place the text comes from.
        table_sha256: of the table as it is now, to be held against that it was written with.
    """
    try:
        found = _Evidence.model_validate_json(text)
        contents = {name: attachment.content() for name, attachment in found.attachments.items()}
    except (ValidationError, ValueError):
        recording.damage.append(f"{where} is damaged: run and segments are not known")
        return
    if not _is_of(found, recording):
        recording.damage.append(
            f"{where} was written for another table ({found.samples} samples from {found.first_time_s:.6g} s "
            f"to {found.last_time_s:.6g} s): run and segments were left out"
        )
        return
    if found.table_sha256 and found.table_sha256 != table_sha256:
        recording.damage.append("the samples were changed after they had been exported: their hash differs")
    recording.metadata.update(found.metadata)
    recording.events += [Event(event.time_s, event.kind, event.text) for event in found.events]
    recording.damage += found.damage
    for name, content in contents.items():
        if content is None:
            recording.damage.append(f"the attachment '{name}' is not as it was written, and was left out")
        else:
            recording.attachments[name] = content


def _attached(content: bytes) -> _Attachment:
    sha256 = hashlib.sha256(content).hexdigest()
    try:
        return _Attachment(sha256=sha256, text=content.decode("utf-8"))
    except UnicodeDecodeError:
        return _Attachment(sha256=sha256, base64=base64.b64encode(content).decode("ascii"))


def _is_of(found: _Evidence, recording: Recording) -> bool:
    time_s = recording.channels.get("time_s")
    if time_s is None or len(time_s) != found.samples:
        return False
    ends = (float(time_s[0]), float(time_s[-1])) if len(time_s) else (0.0, 0.0)
    return abs(ends[0] - found.first_time_s) < 1e-6 and abs(ends[1] - found.last_time_s) < 1e-6
