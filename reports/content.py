"""Everything a report says, formatted once, so that screen and paper cannot differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hil.core.channels import TIME
from hil.core.recording import Recording
from hil.core.result import RunResult
from reports import labels, provenance
from reports.bench_state import identification_facts, zero_facts
from reports.criteria import CriteriaTable, CriterionRow, count_by_verdict, criteria_table
from reports.figure import Section
from reports.guards import hold_facts, limit_facts
from reports.labels import channel_label, channel_unit
from reports.provenance import ControllerTable, Fact, StoredFile
from reports.sections import sections
from reports.summary import Summary, summary

_HEADLINE = {"pass": "Passed", "fail": "Failed", "error": "Error", "unjudged": "Executed, nothing judged"}
_SAFE_STATE = {
    "confirmed": "The bench confirmed its safe state after the run.",
    "not_needed": "No safe state was needed.",
    "not_confirmed": "The bench did not confirm its safe state after the run. Treat it as live: "
    "isolate it before anyone goes near.",
}


@dataclass(frozen=True)
class Banner:
    """The verdict: `tone` is pass, fail, error, unjudged (executed, no criterion) or none (no plan).

    `alarm` is '' unless the bench may not be safe.
    """

    tone: str
    headline: str
    sentences: tuple[str, ...]
    alarm: str


@dataclass(frozen=True)
class EventRow:
    """Something that happened, with its time in seconds."""

    time: str
    kind: str
    text: str


@dataclass(frozen=True)
class SegmentRow:
    """One segment; times in seconds of the recording."""

    id: str
    kind: str
    controller: str
    speed: str
    start: str
    step: str
    end: str


@dataclass(frozen=True)
class ChannelRow:
    """Statistics of one channel over the whole recording."""

    name: str
    meaning: str
    unit: str
    lowest: str
    mean: str
    highest: str
    deviation: str
    missing: str


@dataclass(frozen=True)
class Content:
    """A report without a form. `mark` names the recording at the foot of every page."""

    title: str
    simulated: bool
    identity: str
    banner: Banner
    summary: Summary | None
    run: tuple[Fact, ...]
    dut: tuple[Fact, ...]
    laboratory: tuple[Fact, ...]
    versions: tuple[Fact, ...]
    calibration: tuple[Fact, ...]
    identification: tuple[Fact, ...]
    zeros: tuple[Fact, ...]
    limits: tuple[Fact, ...]
    holds: tuple[Fact, ...]
    files: tuple[StoredFile, ...]
    source: str
    sha256: str
    samples_sha256: str
    mark: str
    criteria: CriteriaTable | None
    warnings: tuple[str, ...]
    damage: tuple[str, ...]
    controllers: ControllerTable | None
    segments: tuple[SegmentRow, ...]
    channels: tuple[ChannelRow, ...]
    events: tuple[EventRow, ...]
    notes: tuple[str, ...]
    sections: tuple[Section, ...]
    started_at: str

    @property
    def unmet(self) -> tuple[CriterionRow, ...]:
        """Criteria that failed or could not be computed; those not judged are reported by segment."""
        groups = self.criteria.groups if self.criteria else ()
        return tuple(r for group in groups for r in group.rows if r.unmet and r.verdict != "not_judged")


def content(recording: Recording, result: RunResult | None) -> Content:
    """Gather what the recording and the result say; what they lack is left empty."""
    run = recording.metadata.get("run", {})
    sha256 = provenance.recording_hash(recording)
    plan = result.plan if result else ""
    title = run.get("title") or plan or recording.source.stem
    started = run.get("started_at", "")
    calibration, files = provenance.calibration_facts(recording, result), provenance.stored_files(recording)
    identification = identification_facts(recording, result)
    zeros = zero_facts(result)
    criteria = criteria_table(result) if result and result.criteria else None
    marks = (plan or recording.source.name, started, f"SHA-256 {sha256[:12]}" if sha256 else "")
    return Content(
        title=title,
        simulated=provenance.simulated(recording),
        identity=provenance.identity(recording, result),
        banner=_banner(result),
        summary=summary(recording, result, criteria) if result and criteria else None,
        run=provenance.run_facts(recording, result),
        dut=provenance.dut_facts(recording),
        laboratory=provenance.laboratory_facts(recording, result),
        versions=provenance.table(recording, "versions"),
        calibration=calibration,
        identification=identification,
        zeros=zeros,
        limits=limit_facts(result),
        holds=hold_facts(result),
        files=files,
        warnings=(
            *_warnings(calibration, (*identification, *zeros), files),
            *(f"Not checked: {text}." for text in (result.not_checked if result else ())),
        ),
        damage=tuple(recording.damage),
        source=recording.source.name,
        sha256=sha256,
        samples_sha256=recording.samples_sha256,
        mark=" · ".join(part for part in marks if part),
        criteria=criteria,
        controllers=provenance.controller_table(recording),
        segments=_segments(result),
        channels=() if result else tuple(_channel(recording, n) for n in recording.channels if n != TIME),
        events=tuple(
            EventRow(labels.number(e.time_s, 3), e.kind.replace("_", " "), e.text) for e in recording.events
        ),
        notes=tuple(recording.notes),
        sections=tuple(sections(recording, result)),
        started_at=started,
    )


def _banner(result: RunResult | None) -> Banner:
    if result is None:
        sentence = "The recording comes without a test plan or a result, so nothing is judged."
        return Banner("none", "Recording, not judged", (sentence,), "")
    unsafe = result.safe_state == "not_confirmed"
    verdict = "error" if unsafe else result.verdict  # a run that may have left the bench live did not pass
    judged = any(one.has_limit and one.source == "plan" for one in result.criteria)
    tone = "unjudged" if verdict == "done" or (verdict == "pass" and not judged) else verdict
    sentences = [*_as_sentences(result.reason), *_counts(result)]
    if not unsafe:
        sentences.append(_SAFE_STATE[result.safe_state])
    alarm = _SAFE_STATE["not_confirmed"] if unsafe else ""
    return Banner(tone, _HEADLINE[tone], tuple(sentences), alarm)


def _counts(result: RunResult) -> list[str]:
    """What became of the criteria, in sentences."""
    sentences = []
    for source, name in (("plan", "criteria"), ("device", "device checks")):
        demanding = [one for one in result.criteria if one.has_limit and one.source == source]
        passed = sum(one.verdict == "pass" for one in demanding)
        failed = sum(one.failed for one in demanding)
        if source == "device" and failed:
            sentences.append(f"{failed} of {len(demanding)} {name} failed.")
        elif demanding:
            sentences.append(f"{passed} of {len(demanding)} {name} passed.")
    sentences = sentences or ["The plan has no criterion with a limit, so nothing is judged."]
    counts = count_by_verdict(result.criteria)
    failed = sum(criterion.verdict == "fail" for criterion in result.criteria)
    unsettled = counts["did_not_settle"]
    facts = {
        f"{failed} failed.": failed,
        f"{counts['undecided']} undecided.": counts["undecided"],
        f"{counts['not_judged']} not judged: {_why_not_judged(result)}.": counts["not_judged"],
        f"{counts['error']} could not be computed.": counts["error"],
        f"{counts['informational']} informational.": counts["informational"],
        f"{unsettled} {'response' if unsettled == 1 else 'responses'} did not settle.": unsettled,
    }
    return [*sentences, *(sentence for sentence, count in facts.items() if count)]


def _why_not_judged(result: RunResult) -> str:
    """Each reason once, in the plan's order."""
    reasons = dict.fromkeys(c.reason for c in result.criteria if c.verdict == "not_judged")
    return ", ".join(reasons)


def _as_sentences(text: str) -> list[str]:
    """Lines of a message, each with a capital and a full stop."""
    return [labels.as_sentence(line.strip()) for line in text.splitlines() if line.strip()]


def _warnings(
    calibration: tuple[Fact, ...], state: tuple[Fact, ...], files: tuple[StoredFile, ...]
) -> tuple[str, ...]:
    """What a signer must know before the numbers."""
    expired = [
        f"{fact.name}: calibration valid until {fact.value}." for fact in calibration if fact.state == "bad"
    ]
    others = [f"{fact.name}: {fact.value}." for fact in state if fact.state == "bad"]
    return (
        *expired,
        *others,
        *(f"{file.name}: its hash {file.check}." for file in files if file.state == "bad"),
    )


def _segments(result: RunResult | None) -> tuple[SegmentRow, ...]:
    return tuple(
        SegmentRow(
            id=segment.id,
            kind=segment.kind,
            controller=segment.controller or labels.DASH,
            speed=labels.nominal(segment.initial_speed_km_h),
            start=labels.number(segment.start_s, 3),
            step=labels.number(segment.step_s, 3) if segment.kind == "step" else labels.DASH,
            end=labels.number(segment.end_s, 3),
        )
        for segment in (result.segments if result else ())
    )


def _channel(recording: Recording, name: str) -> ChannelRow:
    values = recording[name]
    finite = values[np.isfinite(values)]
    low, mean, high, deviation = (
        (float(finite.min()), float(finite.mean()), float(finite.max()), float(finite.std()))
        if finite.size
        else (np.nan,) * 4
    )
    decimals = labels.decimals_for(low, high)
    missing = 100.0 * (1 - finite.size / len(values)) if len(values) else 0.0
    label = channel_label(name)
    return ChannelRow(
        name=name,
        meaning="" if label.text == name else label.text,
        unit=labels.unit(channel_unit(name, recording.metadata.get("units"))),
        lowest=labels.number(low, decimals),
        mean=labels.number(mean, decimals),
        highest=labels.number(high, decimals),
        deviation=labels.number(deviation),
        missing=labels.quantity(missing, "%", significant=2) if missing else labels.DASH,
    )
