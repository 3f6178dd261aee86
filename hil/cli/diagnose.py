"""`hil diagnose`: why recordings and a model differ, the missing effect, and the better model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.analysis.diagnosis import Diagnosis, diagnose
from hil.cli._together import progress, to_json, write_together
from hil.core.model import load_model, model_to_toml
from hil.core.recording import Recording, driven_by_torque, read_recording
from reports.diagnosis import diagnosis_html, diagnosis_pdf

_LEAST_SAMPLES = 200


def command(
    recordings: Annotated[
        list[Path], typer.Argument(help="Recordings to explain (.mcap, .csv, .parquet, .mf4).")
    ],
    model: Annotated[Path, typer.Option("--model", help="Model file to start from.")],
    out: Annotated[Path, typer.Option("--out", help="Directory for the results.")],
    holdout: Annotated[
        list[Path] | None,
        typer.Option(
            "--holdout", help="Recording that no fit sees, only the final figures; may be repeated."
        ),
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="Print diagnosis.json and nothing else.")] = False,
) -> None:
    """Find where a model and recordings disagree, name the missing effect, add it to the model.

    Writes model.toml, diagnosis.json, report.html and report.pdf, all or none.
    """
    base = load_model(model)
    with progress() as show:
        read = [part for path in recordings for part in driven_by_torque(_read(path, show))]
        held = [part for path in holdout or [] for part in driven_by_torque(_read(path, show))]
        found = diagnose(base, read, held, show=show)
        show("writing the report")
        files = output_files(found, f"{model.stem}: {found.verdict}")
        write_together(out, files)
    typer.echo(to_json(found.as_json()) if json_ else text_of(found, out))


def _read(path: Path, show) -> Recording:  # type: ignore[no-untyped-def]
    show(f"reading {path.name}")
    return read_recording(path, least_samples=_LEAST_SAMPLES)


def output_files(found: Diagnosis, title: str) -> dict[str, bytes]:
    """Names and contents of all that the command writes."""
    files = {
        "model.toml": model_to_toml(found.model).encode(),
        "diagnosis.json": (to_json(found.as_json()) + "\n").encode(),
        "report.html": diagnosis_html(found, title).encode(),
        "report.pdf": diagnosis_pdf(found, title),
    }
    for a in found.alternatives:
        if a.plan and a.plan_text:
            files[a.plan] = a.plan_text.encode()
    return files


def text_of(found: Diagnosis, out: Path) -> str:
    """What a person reads."""
    lines = [f"verdict: {found.verdict}"]
    for e in found.effects:
        values = ", ".join(
            f"{name} = {value}"
            if isinstance(value, str)
            else f"{name} = {value:.5g}"
            + (f" ± {e.standard_error[name]:.2g}" if name in e.standard_error else "")
            for name, value in e.use.values.items()
        )
        lines.append(f"  {e.use.id} ({e.confidence:.0%}): {values}")
        low, high = e.where.band_hz
        lines.append(f"    seen in {', '.join(e.where.channels)}, {low:g}-{high:g} Hz, {e.where.condition}")
    if found.signature:
        lines.append(f"  {found.signature}")
    for a in found.alternatives:
        if a.confidence >= 0.02:
            lines.append(f"  or {a.use.id} ({a.confidence:.0%}); to tell: {a.plan or a.separating_test}")
    lines += ["", f"{'gap':<22}{'before':>10}{'after':>10}{'noise':>10}"]
    for name, after in found.gap_after.items():
        before = found.gap_before[name]
        lines.append(f"{name:<22}{before.gap:>10.4g}{after.gap:>10.4g}{after.noise_floor:>10.4g}")
    for name, after in found.holdout_after.items():
        before = found.holdout_before[name]
        lines.append(f"{name + ' (held)':<22}{before.gap:>10.4g}{after.gap:>10.4g}{after.noise_floor:>10.4g}")
    lines += [f"note: {note}" for note in found.notes]
    lines += ["", f"written to {out}: model.toml, diagnosis.json, report.html, report.pdf"]
    return "\n".join(lines)
