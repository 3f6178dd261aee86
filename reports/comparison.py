"""The report of a comparison: criteria side by side, responses overlaid at the step, spectra in the band."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from hil.analysis.comparison import ComparedRun, Comparison, CriterionRow, difference
from hil.core.conventions import COMFORT_BAND_HZ
from hil.core.result import Segment
from reports import quantities, style
from reports.figure import Band, Figure, Trace
from reports.labels import Label, channel_label, channel_unit, criterion_title
from reports.members import controller_name
from reports.parts import Page, Part, Table, page_html, page_pdf
from reports.spectrum import DESCRIPTION, amplitude_spectrum, stretch_in_words
from reports.step_figures import SPECTRUM_WINDOW_S
from reports.stretch import cut, line

_ROLES = ("gain", "phase", "third", "fourth", "fifth", "reference")
_FIRST_SECONDS = 2.0
_ROWS = 12  # of the first screen
_SPECTRUM_TO_HZ = 30.0
_SLOW_HZ = 2.0  # what is left of the run-up below this does not set the scale
_MARKS = {"fail": " ✗", "undecided": " ?", "error": " !", "not_judged": " –"}


def comparison_html(found: Comparison) -> str:
    """The page: one file with interactive figures."""
    return page_html(_page(found))


def comparison_pdf(found: Comparison) -> bytes:
    """The same on paper: PDF/A-2a and PDF/UA-1."""
    return page_pdf(_page(found))


def lead(found: Comparison) -> str:
    """How far each run is from the first, in one sentence."""
    first, *others = found.runs
    told = [
        f"{run.name} {quantities.share(distance)}"
        for run, distance in zip(others, found.distances[1:], strict=True)
        if distance is not None
    ]
    if not told:
        return f"No criterion has a value in every run; the reference is {first.name}."
    return f"Mean distance of the criteria from {first.name}: {', '.join(told)}."


def value_text(row: CriterionRow, run: int) -> str:
    """Value of a criterion in a run, how far it is from the first run's, and a mark where it failed."""
    value, relative = row.values[run], row.relative[run]
    text = quantities.number(value, significant=4)
    if run and relative is not None:
        text += f" ({quantities.share(relative, signed=True)})"
    return text + _MARKS.get(row.verdicts[run], "")


def _page(found: Comparison) -> Page:
    plan = found.runs[0].result.plan
    return Page(
        kind="Runs of one plan side by side",
        title=f"{plan}: {len(found.runs)} runs",
        headline=f"Reference run: {found.runs[0].name}",
        tone="quiet",
        lead=lead(found),
        notes=found.notes,
        parts=tuple(_parts(found)),
        first=_first(found),
    )


def _first(found: Comparison) -> Part | None:
    """The criteria that differ most from the first run's, and the response of the first of them."""
    names = tuple(run.name for run in found.runs)
    ranked = sorted(found.criteria, key=_difference_rank)
    if not ranked:
        return None
    rows = tuple(
        (
            criterion_title(row.id),
            *(value_text(row, run) for run in range(len(names))),
            quantities.unit("" if row.unit == "1" else row.unit),
            _limit(row.limit),
        )
        for row in ranked[:_ROWS]
    )
    table = Table(("criterion", *names, "unit", "limit"), rows, 1, 1 + len(names))
    segments = {segment.id: segment for segment in found.runs[0].result.segments}
    drawn = segments.get(ranked[0].id.partition(".")[0])
    figures = overlay(found.runs, drawn)[:1] if drawn else ()
    text = f"Largest difference from {names[0]} first."
    wide = tuple(replace(figure, wide=True) for figure in figures)
    return Part("summary", "Criteria by difference", text, (table,), figures=wide)


def _difference_rank(row: CriterionRow) -> tuple[bool, float]:
    """The plan's own criteria first, each by its largest difference."""
    return not row.absolute, -max((abs(one or 0.0) for one in row.relative), default=0.0)


def _limit(text: str) -> str:
    """'≥ -10 ≤ 10' as '−10 to 10'."""
    both = re.fullmatch(r"≥ (\S+) ≤ (\S+)", text)
    joined = f"{both[1]} to {both[2]}" if both else text
    return re.sub(r"(?<!\S)-(?=\d)", quantities.MINUS, joined)


def _parts(found: Comparison) -> list[Part]:
    names = tuple(run.name for run in found.runs)
    parts = [
        Part("runs", "Runs", "", (_runs(found),)),
        Part(
            "criteria",
            "Criteria",
            f"In brackets: difference from {names[0]}. ✗ beyond its limit, ! not to be computed, "
            "– not judged; a dash alone: no value, such as a response that did not settle.",
            (_criteria(found, names),) if found.criteria else (),
        ),
        Part(
            "responses",
            "Distance of the responses",
            f"Rms of the difference from {names[0]} over the rms of {names[0]} around its mean, the whole "
            "segment, aligned at the step.",
            (_responses(found, names),),
        ),
    ]
    parts += [_segment_part(found, segment) for segment in found.runs[0].result.segments]
    return [part for part in parts if part.tables or part.figures or part.text]


def _runs(found: Comparison) -> Table:
    rows = []
    for run, distance in zip(found.runs, found.distances, strict=True):
        about = run.recording.metadata.get("run", {})
        simulated = about.get("simulated", "").lower() == "true"
        share = quantities.share(distance)
        rows.append(
            (
                run.name,
                run.result.bench,
                "simulated" if simulated else "measured",
                about.get("started_at", "")[:19].replace("T", " "),
                run.result.verdict,
                share,
            )
        )
    return Table(("run", "bench", "kind", "started", "verdict", "mean distance"), tuple(rows), 5)


def _criteria(found: Comparison, names: tuple[str, ...]) -> Table:
    rows = [
        (
            criterion_title(row.id),
            *(value_text(row, run) for run in range(len(names))),
            quantities.unit("" if row.unit == "1" else row.unit),
            _limit(row.limit),
        )
        for row in found.criteria
    ]
    return Table(("criterion", *names, "unit", "limit"), tuple(rows), 1, 1 + len(names))


def _responses(found: Comparison, names: tuple[str, ...]) -> Table:
    rows = [
        (
            row.segment,
            channel_label(row.channel).text,
            *(quantities.share(gap) for gap in row.gaps),
        )
        for row in found.responses
    ]
    return Table(("segment", "channel", *names), tuple(rows), 2)


def _segment_part(found: Comparison, segment: Segment) -> Part:
    speed = quantities.nominal(segment.initial_speed_km_h, "km/h")
    loaded = {
        other.controller for run in found.runs for other in run.result.segments if other.id == segment.id
    }
    same = len(loaded) == 1 and segment.controller
    name = controller_name(segment.controller) if same else segment.kind.capitalize()
    return Part(segment.id, f"{name}, {speed} ({segment.id})", "", figures=overlay(found.runs, segment))


def overlay(runs: tuple[ComparedRun, ...], segment: Segment) -> tuple[Figure, ...]:
    """A segment of every run: its first seconds, differences and spectra of a step, else the whole of it."""
    figures: list[Figure | None] = []
    if segment.kind == "step":
        figures = [
            _response(runs, segment.id, "shaft_torque_nm", "first", until_s=_FIRST_SECONDS),
            _difference(runs, segment.id, "shaft_torque_nm"),
            _response(runs, segment.id, "motor_speed_rad_s", "first", until_s=_FIRST_SECONDS),
            _spectrum(runs, segment.id, "motor_speed_rad_s"),
        ]
    else:
        figures = [_response(runs, segment.id, "shaft_torque_nm", "whole")]
    return tuple(figure for figure in figures if figure is not None)


def _of(run: ComparedRun, segment: str) -> Segment | None:
    return next((s for s in run.result.segments if s.id == segment), None)


def _role(index: int) -> tuple[str, str]:
    """Colour and dash of a run: one colour each, dashes once they have all been used."""
    return _ROLES[index % len(_ROLES)], style.DASHES[(index // len(_ROLES)) % len(style.DASHES)]


def _response(
    runs: tuple[ComparedRun, ...], segment: str, channel: str, suffix: str, until_s: float = np.inf
) -> Figure | None:
    """One channel of every run over the time from its own step."""
    traces = []
    for index, run in enumerate(runs):
        own = _of(run, segment)
        if own is None:
            continue
        role, dash = _role(index)
        start = max(own.start_s, own.step_s - 0.1) if np.isfinite(until_s) else own.start_s
        end = min(own.end_s, own.step_s + until_s)
        trace = line(
            run.recording,
            channel,
            Label(run.name),
            role,
            start_s=start,
            end_s=end,
            zero_s=own.step_s,
            dash=dash,
        )
        traces += [trace] if trace else []
    if not traces:
        return None
    label = channel_label(channel)
    tail = f", first {_FIRST_SECONDS:g}{quantities.THIN}s" if np.isfinite(until_s) else ""
    return Figure(
        f"{segment}-{channel}-{suffix}",
        Label(label.text, label.symbol, tail),
        "Time from the step",
        "s",
        label,
        channel_unit(channel),
        tuple(traces),
    )


def _difference(runs: tuple[ComparedRun, ...], segment: str, channel: str) -> Figure | None:
    """One channel of every further run minus the first one's; the smallest difference is drawn on top."""
    traces = []
    for index, run in enumerate(runs[1:], 1):
        found = difference(runs[0], run, segment, channel)
        if found is not None and np.isfinite(found[1]).any():
            traces.append(Trace(Label(run.name), *found, *_role(index)))
    if not traces:
        return None
    traces.sort(key=lambda trace: -float(np.nanstd(trace.y)))
    label = channel_label(channel)
    return Figure(
        f"{segment}-{channel}-difference",
        Label(label.text, label.symbol, f", difference from {runs[0].name}"),
        "Time from the step",
        "s",
        Label("Difference of", label.symbol),
        channel_unit(channel),
        tuple(traces),
    )


def _spectrum(runs: tuple[ComparedRun, ...], segment: str, channel: str) -> Figure | None:
    """Amplitude spectrum in the window of the band energy, of every run."""
    traces, lengths = [], []
    for index, run in enumerate(runs):
        own = _of(run, segment)
        if own is None:
            continue
        start, end = (own.step_s + offset for offset in SPECTRUM_WINDOW_S)
        found = cut(run.recording, channel, start, min(end, own.end_s))
        spectrum = amplitude_spectrum(*found) if found else None
        if spectrum is None:
            continue
        shown = spectrum.frequency_hz <= 2 * _SPECTRUM_TO_HZ
        lengths.append(own.end_s - own.step_s)
        role, dash = _role(index)
        x, y = spectrum.frequency_hz[shown], spectrum.amplitude[shown]
        traces.append(Trace(Label(run.name), x, y, role, dash))
    if not traces:
        return None
    scale = max(float(t.y[t.x >= _SLOW_HZ].max(initial=0.0)) for t in traces)
    label, band = channel_label(channel), COMFORT_BAND_HZ
    return Figure(
        f"{segment}-{channel}-spectrum",
        Label("Spectrum of motor speed", label.symbol),
        "Frequency",
        "Hz",
        Label("Amplitude of", label.symbol),
        channel_unit(channel),
        tuple(traces),
        bands=(Band(*band, f"{band[0]:g}{quantities.DASH}{band[1]:g}{quantities.THIN}Hz"),),
        x_range=(0.0, _SPECTRUM_TO_HZ),
        y_range=(0.0, 1.2 * scale) if scale > 0 else None,
        caption=f"{DESCRIPTION}, Hann window, {stretch_in_words(SPECTRUM_WINDOW_S, lengths)}.",
    )
