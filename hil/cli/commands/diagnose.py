"""`hil diagnose`: why recordings and a model differ, the missing effect, and the better model."""

from __future__ import annotations

from pathlib import Path

from hil.analysis.diagnosis import INTERRUPTED, Diagnosis
from hil.app.diagnose import FILES, diagnose_recordings
from hil.app.interrupts import EXIT_CODE
from hil.app.requests import DiagnoseRequest
from hil.app.result_file import reading_in_words
from hil.cli.inputs import named_numbers, request_of
from hil.cli.options.models import Diagnose
from hil.cli.output import TERMINAL, print_json
from hil.core.errors.wording import factor, share
from reports.diagnosis_content import MOST_WORSE
from reports.labels import chance

_WORTH_A_LINE = 0.02


def execute(options: Diagnose) -> int:
    """Execute the command; its exit code."""
    noise = named_numbers(options.noise or [], "--noise")
    least = named_numbers(options.least or [], "--least")
    outcome = diagnose_recordings(request_of(DiagnoseRequest, options, noise=noise, least=least), TERMINAL)
    if options.json_:
        print_json(outcome.summary)
    else:
        again = {note.partition(": ")[2] for note in outcome.found.notes}  # by the recordings' names
        read = outcome.summary["read"].items()
        first = {path: {"notes": [note for note in one["notes"] if note not in again]} for path, one in read}
        for line in reading_in_words(first):
            print(line)
        print(text_of(outcome.found, outcome.folder))
    return EXIT_CODE if outcome.found.unfinished == INTERRUPTED else 0


def text_of(found: Diagnosis, out: Path) -> str:
    """What a person reads."""
    unfinished = f" (unfinished: {found.unfinished}; result so far)" if found.unfinished else ""
    lines = [f"verdict: {found.verdict}{unfinished}"]
    for e in found.effects:
        values = ", ".join(
            f"{name} = {value}"
            if isinstance(value, str)
            else f"{name} = {value:.5g}"
            + (f" ± {e.standard_error[name]:.2g}" if name in e.standard_error else "")
            for name, value in e.use.values.items()
        )
        lines.append(f"  {e.class_ or e.use.id} ({chance(e.confidence)}): {values}")
        low, high = e.where.band_hz
        lines.append(f"    seen in {', '.join(e.where.channels)}, {low:g}-{high:g} Hz, {e.where.condition}")
    if found.signature:
        lines.append(f"  {found.signature}")
    for a in found.alternatives:
        if a.confidence >= _WORTH_A_LINE and found.verdict != "none" and not found.class_of(a):
            about = a.use.values.get("channel", a.use.values.get("parameter"))
            name = f"{a.use.id} of {about}" if about else a.use.id
            test = f"hil run {out / a.plan}" if a.plan else a.separating_test
            link, them = ("or", "them") if found.effects else ("perhaps", "it from others")
            lines.append(f"  {link} {name} ({chance(a.confidence)}); test to distinguish {them}: {test}")
    far = found.start.parameters if found.start is not None else {}
    for title, numbers in (
        ("the base model was far from the data; identified first", far),
        ("numbers of the base model corrected", found.parameter_updates),
    ):
        lines += [f"  {title}:"] if numbers else []
        for parameter, (old, new, error) in numbers.items():
            lines.append(f"    {parameter} = {new:.5g} ± {error:.2g} instead of {old:g}")
    lines += ["", f"{'gap, of the signal':<28}{'before':>14}{'after':>14}{'noise':>14}{'after/noise':>13}"]
    for suffix, before, after, angles in (
        ("", found.gap_before, found.gap_after, found.angles),
        (" (held)", found.holdout_before, found.holdout_after, found.holdout_angles),
    ):
        for name, gap in after.items():
            figures = (before[name].gap, gap.gap, gap.noise_floor)
            shown = "".join(f"{share(figure, 2, digits=3):>14}" for figure in figures)
            lines.append(f"{name + suffix:<28}{shown}{factor(gap.noises):>13}")
        for name, (had, has) in angles.items():
            figures = (had.gap, has.gap, has.noise_floor)
            lines.append(
                f"{name + suffix:<28}" + "".join(f"{share(one, 2, digits=3):>14}" for one in figures)
            )
    if found.open_channels and found.verdict == "named":
        lines.append(f"remaining error above noise: {', '.join(found.open_channels)}")
    lines += [f"made worse: {place}" for place in found.worse[:MOST_WORSE]]
    if len(found.worse) > MOST_WORSE:
        lines.append(f"made worse: {len(found.worse) - MOST_WORSE} more, see diagnosis.json")
    lines += [f"note: {note}" for note in found.notes]
    plans = sorted({a.plan for a in found.alternatives if a.plan and a.plan_text})
    lines += ["", f"written to {out}: {', '.join([*FILES, *plans])}"]
    return "\n".join(lines)
