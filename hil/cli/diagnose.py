"""`hil diagnose`: why recordings and a model differ, the missing effect, and the better model."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hil.analysis.diagnosis import INTERRUPTED, LEAST_SAMPLES, Diagnosis, diagnose
from hil.cli._interrupts import EXIT_CODE, INTERRUPTS
from hil.cli._named_values import named_numbers
from hil.cli._output import Show, print_json, progress, to_json, warn_of_damage
from hil.cli._results_folder import results_in
from hil.cli.commands.diagnose import Diagnose
from hil.core.digits import factor, share
from hil.core.errors import BadInputError
from hil.core.model import Model, load_model, model_to_toml
from hil.core.recording import Recording, driven_by_torque, read_recording
from reports.diagnosis import diagnosis_documents
from reports.origin import Origin, origin_of
from reports.quantities import chance

FILES = ("model.toml", "diagnosis.json", "report.html", "report.pdf")
_WORTH_A_LINE = 0.02
_MOST_WORSE = 3


def carry_out(options: Diagnose) -> int:
    """Carry the command out; its exit code."""
    base = load_model(options.model)
    known, smallest = (
        named_numbers(options.noise or [], "--noise"),
        named_numbers(options.least or [], "--least"),
    )
    _refuse_twice(options.recordings, options.holdout or [])
    inputs = [options.model, *options.recordings, *(options.holdout or [])]
    with results_in(
        options.out,
        FILES,
        inputs=inputs,
        overwrite=options.overwrite,
        default="diagnose",
        summary="diagnosis.json",
    ) as place:
        with progress("diagnosis") as show:
            read = stretches_of(options.recordings, base, show)
            held = stretches_of(options.holdout or [], base, show)
            found = diagnose(
                base, read, held, noise=known, least=smallest, at_most_s=60.0 * options.at_most, show=show
            )
            interrupted = found.unfinished == INTERRUPTED
            if interrupted:
                INTERRUPTS.answered()
            show("writing the report")
            origin = origin_of(
                {"model": [options.model], "recording": options.recordings, "held out": options.holdout or []}
            )
            files = output_files(found, options.model.name, origin)
        place.write(files, inputs)
    if options.json_:
        print_json(_summary(found, files))
    else:
        print(text_of(found, place.folder))
    return EXIT_CODE if interrupted else 0


def _summary(found: Diagnosis, files: Iterable[str]) -> dict[str, Any]:
    return {**found.as_json(), "files": sorted({*files, "diagnosis.json"})}


def _refuse_twice(recordings: list[Path], holdout: list[Path]) -> None:
    """A recording counts once, and one that a fit has seen is not held out.

    Raises:
        BadInputError: names the file.
    """
    seen: dict[Path, str] = {}
    for role, paths in (("a recording", recordings), ("--holdout", holdout)):
        for path in paths:
            other = seen.setdefault(path.resolve(), role)
            if other != role:
                raise BadInputError(
                    "is given both as a recording and as --holdout",
                    where=str(path),
                    fix="a recording used in the fit cannot validate it: give another one to --holdout",
                )
        if len({path.resolve() for path in paths}) < len(paths):
            twice = next(p for p in paths if sum(p.resolve() == q.resolve() for q in paths) > 1)
            raise BadInputError(f"is given twice as {role}", where=str(twice), fix="give it once")


def stretches_of(paths: list[Path], base: Model, show: Show) -> list[Recording]:
    """The stretches of all files that a model can explain: driven by torque alone, or by its load too."""
    parts = []
    for path in paths:
        show(f"reading {path.name}")
        whole = read_recording(path, least_samples=LEAST_SAMPLES)
        warn_of_damage([whole])
        parts += [whole] if base.load_input else driven_by_torque(whole)
    return parts


def output_files(found: Diagnosis, title: str, origin: Origin | None = None) -> dict[str, bytes]:
    """Names and contents of all that the command writes."""
    files = {
        "model.toml": model_to_toml(found.model).encode(),
        **diagnosis_documents(found, title, origin),
    }
    for a in found.alternatives:
        if a.plan and a.plan_text:
            files[a.plan] = a.plan_text.encode()
    files["diagnosis.json"] = (to_json(_summary(found, files)) + "\n").encode()
    return files


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
        lines.append(f"  {e.use.id} ({chance(e.confidence)}): {values}")
        low, high = e.where.band_hz
        lines.append(f"    seen in {', '.join(e.where.channels)}, {low:g}-{high:g} Hz, {e.where.condition}")
    if found.signature:
        lines.append(f"  {found.signature}")
    for a in found.alternatives:
        if a.confidence >= _WORTH_A_LINE and found.verdict != "none":
            about = a.use.values.get("channel", a.use.values.get("parameter"))
            name = f"{a.use.id} of {about}" if about else a.use.id
            test = f"hil run {out / a.plan}" if a.plan else a.separating_test
            lines.append(f"  or {name} ({chance(a.confidence)}); test to distinguish them: {test}")
    if found.start is not None:
        lines.append("  the base model was far from the data; identified first:")
        for parameter, (old, new, error) in found.start.parameters.items():
            lines.append(f"    {parameter} = {new:.5g} ± {error:.2g} instead of {old:g}")
    lines += ["", f"{'gap, of the signal':<28}{'before':>14}{'after':>14}{'noise':>14}{'after/noise':>13}"]
    for suffix, before, after in (
        ("", found.gap_before, found.gap_after),
        (" (held)", found.holdout_before, found.holdout_after),
    ):
        for name, gap in after.items():
            figures = (before[name].gap, gap.gap, gap.noise_floor)
            shown = "".join(f"{share(figure, 2, digits=3):>14}" for figure in figures)
            lines.append(f"{name + suffix:<28}{shown}{factor(gap.noises):>13}")
    if found.open_channels and found.verdict == "named":
        lines.append(f"remaining error above noise: {', '.join(found.open_channels)}")
    lines += [f"made worse: {place}" for place in found.worse[:_MOST_WORSE]]
    if len(found.worse) > _MOST_WORSE:
        lines.append(f"made worse: {len(found.worse) - _MOST_WORSE} more, see diagnosis.json")
    lines += [f"note: {note}" for note in found.notes]
    plans = sorted({a.plan for a in found.alternatives if a.plan and a.plan_text})
    lines += ["", f"written to {out}: {', '.join([*FILES, *plans])}"]
    return "\n".join(lines)
