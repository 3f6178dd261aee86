"""From logs to a recording, judged if a plan says by what."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hil.core.can_logs import CanLog, Stamps, read_can_log
from hil.core.errors import BadInputError
from hil.core.files import replacing, sha256_of
from hil.core.recording import AS_NAMED, REPLAY, ColumnMap, Recording, RecordingWriter, read_as_written
from hil.core.result import RunResult, Segment, verdict_of
from hil.core.runtime.clock import utc
from hil.core.runtime.versions import versions
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.bus_tally import known_identifiers
from hil.engine.replay._bench import BenchDecoder
from hil.engine.replay._channels import Frames, chosen_buses, merged
from hil.engine.replay._clocks import shifted
from hil.engine.replay._counts import FrameCounts, counted
from hil.engine.replay._dbc import DbcDecoder
from hil.engine.replay._segments import Segments, segments_from
from hil.engine.run.recorder import Recorder
from hil.engine.run.run_files import hashes
from test_plans import Plan, judge, not_checked

_NO_SEGMENTS = "the times of the plan's segments in the log are not known, so no criterion is evaluated"
_NO_PLAN = "no criterion is evaluated: metrics need the segments of a plan, and no plan was given"


@dataclass(frozen=True)
class ReplayRequest:
    """Logs, and what their frames mean: a bench file, or a DBC by channel ('': for all).

    Attributes:
        buses: by bus of the bench file, the log's channel.
        segments: where the plan's segments lie: a recording of the run, or JSON.
        stamps: what it means that stamps of a log go back.
        columns: which signals of a DBC are which channels.
        shifts_s: by file name of a log, seconds to be added to its clock.
    """

    logs: Sequence[Path]
    bench: BenchFile | None = None
    dbcs: Mapping[str, Path] = field(default_factory=dict)
    buses: Mapping[str, str] = field(default_factory=dict)
    plan: Plan | None = None
    segments: Path | None = None
    operator: str = ""
    stamps: Stamps = ""
    columns: ColumnMap = AS_NAMED
    shifts_s: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Replayed:
    """What became of it; `remarks` are what a reader must know, a sentence each."""

    result: RunResult | None
    remarks: tuple[str, ...]
    counts: FrameCounts
    samples: int
    channels: tuple[str, ...]
    columns: Mapping[str, Any]


def replay(request: ReplayRequest, path: Path, show: Callable[[str], None] = lambda text: None) -> Replayed:
    """Write the recording that the logs give, whole or not at all.

    Raises:
        BadInputError: a log, a DBC, a bench file or segments that cannot be used, or that do not go together.
        BenchError: the disk is full.
    """
    began = time.perf_counter()
    logs = []
    for log in request.logs:
        show(f"reading {log.name}")
        logs.append(read_can_log(log, request.stamps))
    segments = _segments(request)
    frames = merged(logs, request.shifts_s)
    logs = shifted(logs, request.shifts_s)
    show("decoding")
    decoder, remarks = _decoder(request, frames)
    with replacing(path) as temporary:
        written = _write(decoder, temporary, frames.began_ns or 0)
        remarks += [f"{log.path.name}: {remark}" for log in logs for remark in log.remarks]
        remarks += frames.remarks
        blocks = [(block, decoder.keys_of(*where)) for where, block in frames.channels.items()]
        counts = counted(logs, blocks, decoder.short)
        remarks += counts.in_words()
        if isinstance(decoder, DbcDecoder):
            remarks += decoder.about_unknown(counts.unknown)
        if frames.began_ns is None:
            remarks.append("the log has no date")
        found = segments.on(written.row_0_ns) if segments else ()
        remarks += decoder.remarks if request.plan else [*decoder.remarks, _NO_PLAN]
        result = _judged(request, written.recording, found, time.perf_counter() - began)
        if result is not None and frames.began_ns is not None:
            result = result.model_copy(update={"started_at": utc(written.row_0_ns)})
        _describe(written, request, decoder, logs, frames, remarks, result, counts)
    channels = tuple(written.recording.channels)
    columns = {name: json.loads(text) for name, text in getattr(decoder, "understood", {}).items()}
    return Replayed(result, tuple(remarks), counts, len(written.recording.time_s), channels, columns)


def _segments(request: ReplayRequest) -> Segments | None:
    if request.plan is None:
        if request.segments is not None:
            raise BadInputError("--segments goes with --plan", fix="give the plan to evaluate with --plan")
        return None
    if request.segments is not None:
        return segments_from(request.segments)
    own = [log for log in request.logs if log.suffix.lower() == ".mcap"]
    return segments_from(own[0]) if own else None


def _decoder(request: ReplayRequest, frames: Frames) -> tuple[BenchDecoder | DbcDecoder, list[str]]:
    bench = request.bench
    if bench is None:
        return DbcDecoder(frames, request.dbcs, request.columns), []
    known = {bus: known_identifiers(bench, bus) for bus in bench.buses}
    names = {bus: {bus, str(table.channel)} for bus, table in bench.buses.items()}
    chosen, lines, channels = chosen_buses(frames, known, names, request.buses)
    return BenchDecoder(bench, chosen, channels), lines


@dataclass(frozen=True)
class _Written:
    """A recording that is not closed yet; `row_0_ns`: when its first row was, ns since 1970."""

    writer: RecordingWriter
    recording: Recording
    row_0_ns: int
    time: Mapping[str, str]


def _write(decoder: BenchDecoder | DbcDecoder, path: Path, began_ns: int) -> _Written:
    written = decoder.write(path, began_ns)
    if isinstance(written, Recorder):
        recording, writer, table = written.finish_rows(), written.writer, written.time_base()
    else:
        written.flush()
        writer, recording = written, Recording(read_as_written(path).channels, path)
        table = {
            "time_s": "stamps of the log",
            "raw_frames": "stamps of the log",
            "row_0_at": utc(began_ns + round(writer.row_0_s * 1e9)),
            "bench_clock_0_at": utc(began_ns),
            "bench_clock_at_row_0_s": f"{writer.row_0_s:.6f}",
            "bench_clock_s_per_time_s": "1.0000000",
        }
    if not len(recording.time_s):
        raise BadInputError(
            "the log is too short: it has no complete sample",
            where=path.name,
            fix="give a longer log",
        )
    row_0_s = float(table.get("bench_clock_at_row_0_s", writer.row_0_s))
    return _Written(writer, recording, began_ns + round(row_0_s * 1e9), table)


def _judged(
    request: ReplayRequest, recording: Recording, segments: tuple[Segment, ...], took_s: float
) -> RunResult | None:
    plan = request.plan
    if plan is None:
        return None
    inside = tuple(_inside(segment, recording) for segment in segments)
    criteria = judge(plan, recording, inside)
    reason = "" if segments else f"{_NO_SEGMENTS}\ngive them with --segments"
    length_s = float(recording.time_s[-1] - recording.time_s[0])
    return RunResult(
        verdict=verdict_of(criteria, stopped=reason != ""),
        plan=plan.name,
        bench=request.bench.name if request.bench else "",
        real_time_factor=round(length_s / max(took_s, 1e-3), 1),
        bench_time_s=round(length_s, 3),
        safe_state="not_needed",
        variables=plan.values,
        criteria=criteria,
        segments=inside,
        not_checked=not_checked(plan, recording, inside),
        reason=reason,
    )


def _inside(segment: Segment, recording: Recording) -> Segment:
    """A segment of which the log has not all is not complete."""
    first_s, last_s = float(recording.time_s[0]), float(recording.time_s[-1])
    whole = first_s - 0.01 <= segment.start_s and segment.end_s <= last_s + 0.01
    return segment if whole else segment.model_copy(update={"complete": False})


def _describe(
    written: _Written,
    request: ReplayRequest,
    decoder: BenchDecoder | DbcDecoder,
    logs: Sequence[CanLog],
    frames: Frames,
    remarks: Sequence[str],
    result: RunResult | None,
    counts: FrameCounts,
) -> None:
    """What the recording carries beside its samples; closes it."""
    writer, bench, plan = written.writer, request.bench, request.plan
    last_s = float(written.recording.time_s[-1])
    for remark in remarks:
        writer.add_event(last_s, "replay", remark)
    attachments = dict(decoder.attachments)
    if plan is not None and result is not None:
        attachments["plan.yaml"] = plan.text.encode()
        attachments["run.json"] = result.model_dump_json(indent=1).encode()
    for name, content in attachments.items():
        writer.attach(name, content)
    names = ", ".join(log.path.name for log in logs)
    started = {"started_at": utc(written.row_0_ns)} if frames.began_ns is not None else {}
    writer.describe(
        "run",
        {
            **({"plan": plan.name} if plan else {}),
            "title": f"{plan.title or plan.name}, replayed from {names}" if plan else f"Replay of {names}",
            "bench": (bench.title or bench.name) if bench else "",
            "operator": request.operator,
            **started,
        },
    )
    writer.describe(
        REPLAY, {log.path.name: f"SHA-256 {sha256_of(log.path)}, {log.count} frames" for log in logs}
    )
    if isinstance(decoder, DbcDecoder):
        writer.describe("units", decoder.units)
        if decoder.understood:
            writer.describe("columns", decoder.understood)
    if bench is not None:
        writer.describe("dut", bench.dut)
        writer.describe("report", bench.report.model_dump())
        writer.describe("calibration", {name: date.isoformat() for name, date in bench.calibration.items()})
    writer.describe("frames", {name: str(count) for name, count in counts.as_json().items()})
    writer.describe("versions", versions())
    writer.describe("time", written.time)
    writer.describe("hashes", hashes(attachments))
    writer.close()
